"""Runs the commands of [[finally]] in the campaign's folder once all cases are done: conclude.py FOLDER.

What fails is said in finally_failed.txt, and the commands run again when the campaign is begun again.
"""
import json
import os
import shlex
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from collect import read_rows  # noqa: E402
from definition import Campaign  # noqa: E402
from run_batch import last_line, write_file  # noqa: E402


def find_kept(folder, campaign, rows):
    """{name: files in the order of the cases}, and what is missing in words."""
    kept, missing = {}, []
    for name in campaign.keep:
        paths = [(row["case"], f"kept/{row['case']:06d}/{name}") for row in rows]
        kept[name] = [path for _, path in paths]
        missing += [f"case {case} left no {name}" for case, path in paths if not os.path.exists(f"{folder}/{path}")]
    return kept, missing


def conclude(folder):
    """In words what went wrong; empty if nothing did."""
    with open(f"{folder}/campaign.json", encoding="utf-8") as file:
        stored = json.load(file)
    campaign = Campaign(stored["text"], stored["base"], stored["file"])
    if not campaign.make_last_commands({}):
        return ""
    kept, missing = find_kept(folder, campaign, read_rows(folder))
    if missing:
        return f"finally: not run: {missing[0]}" + (f" and {len(missing) - 1} more" if len(missing) > 1 else "")
    for number, command in enumerate(campaign.make_last_commands(kept), 1):
        program = stored["programs"].get(command[0], command[0])
        with open(f"{folder}/finally_{number}.txt", "wb") as said:
            done = subprocess.run([program, *command[1:]], cwd=folder, stdin=subprocess.DEVNULL, stdout=said, stderr=said, check=False)
        if done.returncode != 0:
            return f"finally {number} failed: {shlex.join(command)[:200]}: {done.returncode}: {last_line(f'{folder}/finally_{number}.txt')}"
    return ""


def main():
    folder = sys.argv[1]
    said, path = conclude(folder), f"{folder}/finally_failed.txt"
    if said:
        write_file(path, said + "\n")
        return 1
    if os.path.exists(path):
        os.remove(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
