"""Runs the cases of one batch, one after the other: run_batch.py FOLDER BATCH.

A case's row is a file written by rename in begun/BATCH, so that a case that is done is never run again. Once all are there,
they become batches/BATCH.jsonl and begun/BATCH goes. A command that fails, ends by a fault of its own or takes too long makes
a row that says so. A command that somebody ended (TERM, KILL, INT, HUP) makes none: the batch ends with status 3, and is
begun again.
"""
import fcntl
import json
import os
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from definition import Campaign  # noqa: E402
from results import read_results  # noqa: E402

ENDED_BY_OTHERS = {signal.SIGTERM, signal.SIGKILL, signal.SIGINT, signal.SIGHUP}


class Interrupted(Exception):
    """A command that somebody ended."""


class Failed(Exception):
    """A command that gave no result: its number (0: the change of the model), status and last line."""

    def __init__(self, number, command, status, line):
        super().__init__()
        self.row = {"failed_command": number, "command": shlex.join(command), "exit_status": status, "last_line": line}


def write_file(path, text):
    """Complete or not at all, also where two processes write."""
    partial = f"{path}.{socket.gethostname()}.{os.getpid()}"
    with open(partial, "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(partial, path)


def last_line(path):
    with open(path, "rb") as file:
        lines = [line for line in file.read().decode("utf-8", "replace").splitlines() if line.strip()]
    return lines[-1].strip()[:300] if lines else ""


class Batch:
    def __init__(self, folder, number):
        self.folder = os.path.abspath(folder)
        with open(f"{self.folder}/campaign.json", encoding="utf-8") as file:
            stored = json.load(file)
        self.programs = stored["programs"]
        self.campaign = Campaign(stored["text"], stored["base"], stored["file"])
        self.number = number
        first = number * stored["batch"]
        self.cases = range(first, min(first + stored["batch"], self.campaign.count))
        self.work = f"{self.folder}/begun/{number:06d}"
        self.cpu, self.clock = 0.0, 0.0

    def run_command(self, number, command, accepted, seconds, where):
        """Throws Failed or Interrupted unless the command ends with an accepted status."""
        program = self.programs.get(command[0], command[0])
        said = f"{where}/errors_{number}.txt"
        late, started = threading.Event(), time.monotonic()
        with open(f"{where}/output_{number}.txt", "wb") as out, open(said, "wb") as err:
            try:
                process = subprocess.Popen([program, *command[1:]], cwd=where, stdin=subprocess.DEVNULL, stdout=out, stderr=err)
            except OSError as error:
                raise Failed(number, command, "did not start", f"{program}: {error.strerror}") from error

            def end():
                late.set()
                process.kill()
            stopwatch = threading.Timer(seconds, end) if seconds else None
            if stopwatch:
                stopwatch.start()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            if stopwatch:
                stopwatch.cancel()
        self.cpu += usage.ru_utime + usage.ru_stime
        self.clock += time.monotonic() - started
        if process.returncode in accepted:
            return
        if late.is_set():
            raise Failed(number, command, f"no answer in {seconds:g} s", last_line(said))
        if process.returncode >= 0:
            raise Failed(number, command, str(process.returncode), last_line(said))
        name = signal.Signals(-process.returncode).name
        if -process.returncode in ENDED_BY_OTHERS:
            raise Interrupted(f"case {os.path.basename(where)}: {shlex.join(command)}: ended by {name}")
        raise Failed(number, command, name, last_line(said))

    def run_case(self, index, where):
        case = self.campaign.make_case(index)
        row = case["row"]
        try:
            if case["changes"]:
                self.run_command(0, ["identify", "set", case["model"], *case["changes"], "-o", "model.toml", "--json", "set.json", "-q"],
                                 [0], None, where)
                with open(f"{where}/set.json", encoding="utf-8") as file:
                    row.update({p["name"]: p["value"] for p in json.load(file)["parameters"]})
            for number, (command, entry) in enumerate(zip(case["commands"], self.campaign.commands), 1):
                self.run_command(number, command, entry.get("accept", [0]), entry.get("seconds"), where)
            try:
                row.update(read_results(self.campaign.results, where))
            except (OSError, ValueError) as error:
                raise Failed(len(case["commands"]), case["commands"][-1], "0", f"its result cannot be read: {error}") from error
            row["status"] = "done"
        except Failed as failure:
            row.update(failure.row, status="failed")
        return row

    def keep_files(self, index, where):
        kept = f"{self.folder}/kept/{index:06d}"
        for name in self.campaign.keep:
            if os.path.exists(f"{where}/{name}"):
                os.makedirs(kept, exist_ok=True)
                shutil.copyfile(f"{where}/{name}", f"{kept}/{name}.part")
                os.replace(f"{kept}/{name}.part", f"{kept}/{name}")

    def run(self):
        started, rows = time.time(), {}
        os.makedirs(f"{self.folder}/begun", exist_ok=True)
        with open(f"{self.folder}/begun/{self.number:06d}.lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # one that was left behind by a kill finishes its work first
            if os.path.exists(f"{self.folder}/batches/{self.number:06d}.jsonl"):
                return
            os.makedirs(self.work, exist_ok=True)
            for index in self.cases:
                path = f"{self.work}/{index}.json"
                if os.path.exists(path):
                    with open(path, encoding="utf-8") as file:
                        rows[index] = file.read()
                    continue
                where = f"{self.work}/{index}"
                shutil.rmtree(where, ignore_errors=True)
                os.makedirs(where)
                row = self.run_case(index, where)
                self.keep_files(index, where)
                rows[index] = json.dumps(row, sort_keys=True)
                write_file(path, rows[index])
                shutil.rmtree(where, ignore_errors=True)
            os.makedirs(f"{self.folder}/batches", exist_ok=True)
            own = time.process_time()
            figures = {"batch": self.number, "host": socket.gethostname(), "node": os.environ.get("SLURMD_NODENAME", ""),
                       "begun": started, "wall": time.time() - started, "commands": self.cpu, "own": own,
                       "in_commands": self.clock}
            write_file(f"{self.folder}/batches/{self.number:06d}.figures.json", json.dumps(figures))
            write_file(f"{self.folder}/batches/{self.number:06d}.jsonl", "".join(rows[i] + "\n" for i in self.cases))
            shutil.rmtree(self.work, ignore_errors=True)


def main():
    try:
        Batch(sys.argv[1], int(sys.argv[2])).run()
    except Interrupted as interruption:
        time.sleep(1)  # whoever ended the command may end this, too, which then is no failure of the job
        print(interruption, file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
