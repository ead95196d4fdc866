# SPDX-License-Identifier: GPL-3.0-or-later
"""A Slurm of one node: its controller, its node's daemon and munge, on this machine, in a folder of
their own, ended by their process ids."""

import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

CONFIGURATION = """
ClusterName=granita
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
KillWait=5
MinJobAge=600
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=low Nodes={host} Default=YES MaxTime=60 State=UP PriorityTier=1 PreemptMode=REQUEUE GraceTime=3
PartitionName=high Nodes={host} MaxTime=60 State=UP PriorityTier=10 PreemptMode=OFF
"""


def _free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class SlurmNode:
    """Up from `start` to `stop`.  `run(*command)` runs Slurm's commands against it."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.cpus = os.cpu_count()
        self._daemons = []

    def start(self):
        """Raises RuntimeError where Slurm is not installed, or who runs this is not root."""
        missing = [t for t in ("slurmctld", "slurmd", "sbatch", "munged") if not shutil.which(t)]
        if missing:
            raise RuntimeError(f"Slurm is not installed: there is no {', '.join(missing)}")
        if os.geteuid() != 0:
            raise RuntimeError("slurmd and munged want to be started by root")
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        host = socket.gethostname().split(".")[0]
        text = CONFIGURATION.format(
            host=host, folder=self.folder, ports=(_free_port(), _free_port()), cpus=self.cpus
        )
        configuration = self.folder / "slurm.conf"
        configuration.write_text(text)
        self.environment = os.environ | {"SLURM_CONF": str(configuration)}
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        munge = {"key-file": key, "socket": "munge.socket", "pid-file": "munge.pid"}
        munge |= {"log-file": "munge.log", "seed-file": "munge.seed"}
        options = [f"--{name}={self.folder / place}" for name, place in munge.items()]
        self._daemon("munged", "--foreground", "--force", *options)
        self._daemon("slurmctld", "-D", "-c")
        self._daemon("slurmd", "-D", "-N", host)
        self._wait_for(lambda: "idle" in self.run("sinfo", "-h", "-o", "%T").stdout, 60)

    def _daemon(self, *command):
        log = (self.folder / f"{command[0]}.out").open("w")
        process = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log)
        self._daemons.append(process)
        time.sleep(1.0)

    def stop(self):
        # With its batch scripts, or their stepds outlive the daemons.
        self.run("scancel", "--user=root", "--full", "--signal=KILL")
        time.sleep(2.0)
        for process in reversed(self._daemons):
            process.terminate()
        for process in self._daemons:
            process.wait(timeout=30)

    def run(self, *command, **changes):
        return subprocess.run(
            [str(word) for word in command],
            env=self.environment | changes,
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            cwd=self.folder,
        )

    def state(self, job):
        """States of a job's tasks, as a set; what scontrol no longer knows is not in it."""
        shown = self.run("scontrol", "-o", "show", "job", job).stdout
        return {w.partition("=")[2] for w in shown.split() if w.startswith("JobState=")}

    def wait_until(self, job, states, seconds=120):
        return self._wait_for(lambda: self.state(job) and self.state(job) <= set(states), seconds)

    def _wait_for(self, condition, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition():
                return
            time.sleep(0.5)
        logs = "\n".join(
            path.read_text(errors="replace")[-2000:] for path in self.folder.glob("*.log")
        )
        raise TimeoutError(f"Slurm did not get there:\n{self.run('squeue', '-a').stdout}\n{logs}")
