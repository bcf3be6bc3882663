"""The folder of a campaign: what is written before its workflow begins, and what is said when it ends.

campaign.json   the campaign as it was begun            batches/N.jsonl  the rows of a batch that is done
begun/N         cases of a batch under way              kept/CASE        files that the campaign keeps
flags/N.done    what Snakemake knows of a batch
table.h5, report.html                                   snakemake.log, slurm/JOB.log
"""
import json
import os
import shutil
import subprocess
import time

from definition import CampaignError

PLACES = {"simulate": "plugin/simulate", "identify": "identify/cli/identify"}  # in a build tree


def is_ours(path):
    """ImageMagick has an identify, too."""
    said = subprocess.run([path, "--version"], capture_output=True, text=True, check=False).stdout
    return said.startswith("wems ")


def find_programs(tree, campaign):
    """Where the project's programs are that a campaign calls: a build tree, then PATH with and without the prefix."""
    source = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    trees = [tree] if tree else [os.environ.get("WEMS_PROGRAMS", ""), f"{source}/build/release"]
    called = {command["run"].split()[0] for command in campaign.commands + campaign.text.get("finally", [])} | ({"identify"} if campaign.text.get("parameter") else set())
    programs = {}
    for name, place in PLACES.items():
        if name not in called:
            continue
        paths = [f"{t}/{place}" for t in trees if t] + [shutil.which(n) for n in ([] if tree else [f"wems-{name}", name])]
        path = next((p for p in paths if p and os.access(p, os.X_OK) and is_ours(p)), None)
        if not path:
            raise CampaignError(f"the program {name} is not found (accepted: --programs BUILD, or {name} on PATH)")
        programs[name] = os.path.abspath(path)
    return programs


def open_folder(folder, campaign, programs, files, options):
    """Writes campaign.json; CampaignError if the folder holds cases of another campaign."""
    path = f"{folder}/campaign.json"
    identity, batch = campaign.identity(), campaign.batch
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            before = json.load(file)
        if before["identity"] != identity:
            raise CampaignError(f"{campaign.file}: {folder} holds cases of another campaign (accepted: a folder of its own; "
                                "the same campaign and models with more cases)")
        batch = before["batch"]
        if campaign.count < before["count"]:
            raise CampaignError(f"{campaign.file}: cases: fewer than in {folder} (accepted: {before['count']} or more)")
        if campaign.count > before["count"]:
            reopen_last(folder, before)
    campaign.batch = batch
    stored = {"identity": identity, "count": campaign.count, "batch": batch, "batches": campaign.batch_count(), "base": campaign.base,
              "file": campaign.file, "text": campaign.text, "programs": programs, "files": files, "threads": options.threads,
              "minutes": options.minutes, "memory": options.memory}
    with open(path + ".part", "w", encoding="utf-8") as file:
        json.dump(stored, file, indent=1, sort_keys=True)
    os.replace(path + ".part", path)


def reopen_last(folder, before):
    """Cases were added: the last batch may grow, the rows that it has count as done, and the table is made anew."""
    for name in ("table.h5", "report.html", "flags/finally.done"):
        if os.path.exists(f"{folder}/{name}"):
            os.remove(f"{folder}/{name}")
    number = before["batches"] - 1
    rows, work = f"{folder}/batches/{number:06d}.jsonl", f"{folder}/begun/{number:06d}"
    if before["count"] % before["batch"] == 0 or not os.path.exists(rows):
        return
    os.makedirs(work, exist_ok=True)
    with open(rows, encoding="utf-8") as file:
        for line in file:
            with open(f"{work}/{json.loads(line)['case']}.json", "w", encoding="utf-8") as case:
                case.write(line.rstrip("\n"))
    os.remove(rows)
    if os.path.exists(f"{folder}/flags/{number:06d}.done"):
        os.remove(f"{folder}/flags/{number:06d}.done")


def read_figures(folder):
    figures = []
    for name in sorted(os.listdir(f"{folder}/batches")) if os.path.isdir(f"{folder}/batches") else []:
        if name.endswith(".figures.json"):
            with open(f"{folder}/batches/{name}", encoding="utf-8") as file:
                figures.append(json.load(file))
    return figures


def describe_end(folder, campaign, status, started, options):
    """Prints how it went; the exit status of the campaign."""
    failed, rows = [], 0
    for number in range(campaign.batch_count()):
        path = f"{folder}/batches/{number:06d}.jsonl"
        if not os.path.exists(path):
            continue
        with open(path, encoding="utf-8") as file:
            for line in file:
                row = json.loads(line)
                rows += 1
                if row["status"] != "done":
                    failed.append(row)
    for row in failed[:20]:
        print(f"case {row['case']} failed: {row['command']}: {row['exit_status']}: {row['last_line']}")
    if len(failed) > 20:
        print(f"… and {len(failed) - 20} more; all are in the table")
    if rows < campaign.count or (status != 0 and not os.path.exists(f"{folder}/finally_failed.txt")):
        print(f"{campaign.count - rows} of {campaign.count} cases are open: {folder}/snakemake.log says why; the same command goes on")
        return 1
    if os.path.exists(f"{folder}/finally_failed.txt"):
        with open(f"{folder}/finally_failed.txt", encoding="utf-8") as file:
            print(file.read().rstrip())
        return 1
    if not options.quiet:
        seconds, figures = time.time() - started, read_figures(folder)
        commands, own = (sum(f[key] for f in figures) for key in ("commands", "own"))
        print(f"{rows - len(failed)} cases done, {len(failed)} failed; {seconds:.1f} s; processor time of the commands of batches that "
              f"ended: {commands:.1f} s, of the batches themselves {own:.1f} s")
        here = [f for f in figures if f["begun"] >= started]
        if len(here) == len(figures) and not (options.slurm or options.profile):
            busy = sum(f["in_commands"] for f in here) / (seconds * options.cores)
            print(f"{100 * busy:.1f} % of the time of {options.cores} cores, by the clock, a command ran")
        print(f"{folder}/table.h5, {folder}/report.html")
    return 1 if failed else 0
