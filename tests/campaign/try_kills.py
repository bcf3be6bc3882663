"""The example campaign with many cases, killed at random moments: figures and the same table to the byte.
try_kills.py SOURCE BUILD [--cases N] [--kills N] [--cores N] [--seed N] [--campaign FILE --reference TABLE]

Not part of the tests: it takes many minutes. --reference is the table of the same campaign undisturbed, where there is one.
"""
import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

from test_kills import list_done
from try_slurm import digest, read_campaign_file, say


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source")
    parser.add_argument("build")
    parser.add_argument("--cases", type=int, default=1000, help="draws; each gives two cases")
    parser.add_argument("--batch", type=int, default=63)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--cores", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--campaign", help="this campaign file in place of the example")
    parser.add_argument("--reference", help="its table, made undisturbed before")
    options = parser.parse_args()
    choice = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="kill_trial_") as folder:
        file, reference = options.campaign or f"{folder}/campaign.toml", options.reference or f"{folder}/plain/table.h5"
        if not options.campaign:
            with open(file, "w", encoding="utf-8") as stream:
                stream.write(read_campaign_file(options.source, options.cases, options.batch))
        command = [sys.executable, f"{options.source}/scripts/campaign", file, "--programs", options.build,
                   "--cores", str(options.cores), "--folder"]
        if not options.reference:
            say("undisturbed")
            subprocess.run([*command, f"{folder}/plain"], check=True)
        killed = f"{folder}/killed"
        for kill in range(1, options.kills + 1):
            before = len(list_done(killed))
            # A moment drawn between none and all of the share of the cases that falls to this kill.
            more = before + choice.uniform(0, 2) * (2 * options.cases - before) / (options.kills - kill + 2)
            process = subprocess.Popen([*command, killed], stdout=subprocess.DEVNULL, start_new_session=True)
            while process.poll() is None and len(list_done(killed)) < more:
                time.sleep(0.2)
            time.sleep(choice.uniform(0, 1))
            ended = process.poll() is not None
            if not ended:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            say(f"kill {kill}: {'too late, ' if ended else ''}{len(list_done(killed))} cases done")
        subprocess.run([*command, killed], check=True)
        same = digest(reference) == digest(f"{killed}/table.h5")
        say("the same table to the byte" if same else "THE TABLE DIFFERS")
        return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
