"""A Slurm of several nodes on this machine: munged, slurmctld and one slurmd for each node, on loopback addresses alone.

A node is a process namespace with a name of its own. Killing its first process kills all that runs on it at once, as a power
cut does. Needs root, and Debian's slurmctld, slurmd, slurm-client and munge; nothing of theirs need be set up.
"""
import os
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "unshare"]
PORT = 27817

CONFIGURATION = """
ClusterName=trial
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool_%n
SlurmdPidFile={folder}/%n.pid
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=1,sched_interval=2
SlurmdTimeout=10
KillWait=5
MinJobAge=600
ReturnToService=2
JobRequeue=1
MpiDefault=none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SlurmdParameters=config_overrides
{nodes}
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE
"""


def find_missing():
    """What is missing for a cluster; empty if nothing is."""
    path = os.environ["PATH"] + ":/usr/sbin"
    missing = [program for program in PROGRAMS if not shutil.which(program, path=path)]
    if os.geteuid() != 0:
        missing.append("root")
    return missing


class SlurmCluster:
    def __init__(self, folder, count=4):
        self.folder, self.names, self.nodes = folder, [f"node{k}" for k in range(1, count + 1)], {}
        os.environ["PATH"] += ":/usr/sbin"
        os.environ["SLURM_CONF"] = f"{folder}/slurm.conf"
        os.makedirs(f"{folder}/state")
        with open(f"{folder}/munge.key", "wb") as key:
            os.fchmod(key.fileno(), 0o400)
            key.write(os.urandom(1024))
        nodes = "\n".join(f"NodeName={name} NodeAddr=127.0.0.1 Port={PORT + k} CPUs=1 RealMemory=4000"
                          for k, name in enumerate(self.names, 1))
        with open(f"{folder}/slurm.conf", "w", encoding="utf-8") as file:
            file.write(CONFIGURATION.format(host=socket.gethostname().split(".")[0], port=PORT, folder=folder, nodes=nodes))
        self.daemons = [
            self.start(["munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={folder}/munge.key",
                        f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log", f"--seed-file={folder}/munged.seed"],
                       "munged"),
        ]
        time.sleep(1)
        self.daemons.append(self.start(["slurmctld", "-D", "-i"], "slurmctld"))
        time.sleep(1)
        for name in self.names:
            self.start_node(name)

    def start(self, command, name):
        with open(f"{self.folder}/{name}.out", "ab") as out:
            return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True)

    def start_node(self, name):
        self.nodes[name] = self.start(["unshare", "--uts", "--pid", "--mount-proc", "--fork", "--kill-child=KILL", "sh", "-c",
                                       f"hostname {name} && slurmd -D; true"], name)

    def kill_node(self, name):
        """All at once: the namespace's first process takes everything on the node along."""
        node = self.nodes.pop(name)
        node.send_signal(signal.SIGKILL)
        node.wait()

    def wait_until_idle(self, seconds=60):
        end = time.time() + seconds
        while time.time() < end:
            said = subprocess.run(["sinfo", "-h", "-N", "-o", "%N %t"], capture_output=True, text=True, check=False).stdout
            if sum(line.split()[1] == "idle" for line in said.splitlines()) == len(self.names):
                return
            time.sleep(0.5)
        raise RuntimeError(f"the nodes do not come up: {said}\nsee {self.folder}/*.log")

    def stop(self):
        for name in list(self.nodes):
            self.kill_node(name)
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait()
