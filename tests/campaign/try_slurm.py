"""A campaign on a real Slurm of four nodes on this machine, nodes and the campaign itself killed on the way: the same table to
the byte as here without Slurm. try_slurm.py SOURCE BUILD [--cases N] [--kills N] [--seed N] [--campaign FILE --reference TABLE]

Not part of the tests: it takes minutes, and root. Skipped, saying so, where something is missing.
"""
import argparse
import hashlib
import json
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter

from slurm_cluster import SlurmCluster, find_missing
from test_kills import list_done


def read_campaign_file(source, cases, batch):
    with open(f"{source}/scripts/campaign_files/example.toml", encoding="utf-8") as file:
        text = file.read()
    text = re.sub(r"(?m)^cases = \d+", f"cases = {cases}\nbatch = {batch}", text)
    return text.replace("../../models", f"{os.path.abspath(source)}/models")


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def say(text):
    print(f"{time.strftime('%H:%M:%S')} {text}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source")
    parser.add_argument("build")
    parser.add_argument("--cases", type=int, default=100, help="draws; each gives two cases")
    parser.add_argument("--batch", type=int, default=5)
    parser.add_argument("--kills", type=int, default=4, help="of nodes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--campaign", help="this campaign file in place of the example")
    parser.add_argument("--reference", help="its table, made before without Slurm")
    options = parser.parse_args()
    missing = find_missing()
    if missing:
        print(f"skipped: no {', no '.join(missing)}")
        return 4
    choice = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="slurm_trial_") as folder:
        file, reference = options.campaign or f"{folder}/campaign.toml", options.reference or f"{folder}/here/table.h5"
        if not options.campaign:
            with open(file, "w", encoding="utf-8") as stream:
                stream.write(read_campaign_file(options.source, options.cases, options.batch))
        command = [sys.executable, f"{options.source}/scripts/campaign", file, "--programs", options.build, "--folder"]
        if not options.reference:
            say("without Slurm")
            subprocess.run([*command, f"{folder}/here"], check=True)
        os.makedirs(f"{folder}/cluster")
        cluster = SlurmCluster(f"{folder}/cluster")
        try:
            cluster.wait_until_idle()
            say(f"on {len(cluster.names)} nodes")
            on_slurm = [*command, f"{folder}/there", "--slurm", "--minutes", "60", "--memory", "500"]
            process = subprocess.Popen(on_slurm, start_new_session=True)
            for kill in range(options.kills):
                at = len(list_done(f"{folder}/there")) + choice.randint(3, 15)
                while process.poll() is None and len(list_done(f"{folder}/there")) < at:
                    time.sleep(0.1)
                if process.poll() is not None:
                    break
                if kill == options.kills // 2:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
                    say(f"campaign killed with {len(list_done(f'{folder}/there'))} cases done, and begun again")
                    process = subprocess.Popen(on_slurm, start_new_session=True)
                name = choice.choice(cluster.names)
                cluster.kill_node(name)
                say(f"{name} killed with {len(list_done(f'{folder}/there'))} cases done")
                time.sleep(choice.uniform(1, 20))
                cluster.start_node(name)
            status = process.wait()
            figures = []
            for name in sorted(os.listdir(f"{folder}/there/batches")):
                if name.endswith(".figures.json"):
                    with open(f"{folder}/there/batches/{name}", encoding="utf-8") as stream:
                        figures.append(json.load(stream))
            say(f"batches by node: {dict(sorted(Counter(f['node'] for f in figures).items()))}")
        finally:
            cluster.stop()
        same = os.path.exists(f"{folder}/there/table.h5") and digest(reference) == digest(f"{folder}/there/table.h5")
        say(f"exit status {status}; {'the same table to the byte' if same else 'THE TABLE DIFFERS'}")
        if not same:
            os.rename(folder, folder + "_kept")
            os.makedirs(folder)
        return 0 if same and status == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
