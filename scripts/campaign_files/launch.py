"""Starts the workflow of a campaign and waits for its end."""
import fcntl
import os
import subprocess
import sys
import time

from definition import CampaignError
from folder import describe_end, find_programs, open_folder

FILES = os.path.dirname(os.path.abspath(__file__))


def make_command(options, folder):
    command = [sys.executable, "-m", "snakemake", "--snakefile", f"{FILES}/Snakefile", "--directory", folder, "--keep-going",
               "--rerun-incomplete", "--rerun-triggers", "mtime", "--nolock"]
    if options.slurm:
        submit = "sbatch --parsable --requeue --open-mode=append --job-name=batch --output=slurm/%j.log --nodes=1 --ntasks=1" \
                 " --cpus-per-task={threads} --mem={resources.mem_mb} --time={resources.runtime}"
        command += ["--cluster", f"{submit} {options.sbatch}".strip(), "--cluster-status", f"{FILES}/slurm_status",
                    "--cluster-cancel", "scancel", "--jobs", str(options.jobs), "--latency-wait", "60",
                    "--max-jobs-per-second", "20", "--max-status-checks-per-second", "20"]
    elif options.profile:
        command += ["--profile", options.profile]
    else:
        command += ["--cores", str(options.cores)]
    return command


def run_campaign(campaign, options):
    """The exit status; what is asked of the options is what scripts/campaign has."""
    folder = os.path.abspath(options.folder)
    os.makedirs(folder, exist_ok=True)
    with open(f"{folder}/lock", "w", encoding="utf-8") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise CampaignError(f"{folder}: another campaign works in this folder (accepted: a folder of its own)") from None
        open_folder(folder, campaign, find_programs(options.programs, campaign), FILES, options)
        if options.slurm:
            os.makedirs(f"{folder}/slurm", exist_ok=True)
        if not options.quiet:
            print(f"{campaign.count} cases in {campaign.batch_count()} batches", flush=True)
        started = time.time()
        with open(f"{folder}/snakemake.log", "ab") as log:
            status = subprocess.run(make_command(options, folder), stdout=log, stderr=log, pass_fds=[lock.fileno()],
                                    check=False).returncode
        return describe_end(folder, campaign, status, started, options)
