# SPDX-License-Identifier: BSD-3-Clause
"""Slurm on this machine alone: munge, controller and one node, started by a test and stopped by it.

Nothing of an installed Slurm's own configuration is read or changed: keys, sockets, state and logs lie in a
directory of the test, ports are free ones, and SLURM_CONF tells Slurm's commands where to look.

It needs Debian's slurm-wlm and munge, and to be root, for slurmd starts jobs of other users.
"""

import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "sinfo", "squeue", "scancel", "scontrol")
SBIN = "/usr/sbin:/sbin"

CONFIGURATION = """
ClusterName=harmos
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={directory}/munge.socket
CredType=cred/munge
StateSaveLocation={directory}/state
SlurmdSpoolDir={directory}/spool
SlurmctldPidFile={directory}/slurmctld.pid
SlurmdPidFile={directory}/slurmd.pid
SlurmctldLogFile={directory}/slurmctld.log
SlurmdLogFile={directory}/slurmd.log
PluginDir={plugins}
PlugStackConfig=/dev/null
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
MailProg=/bin/true
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=5,bf_interval=5,batch_sched_delay=1
MinJobAge=600
KillWait=20
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=60 State=UP
"""


def missing():
    """Why it cannot be started here; None if it can."""
    path = f"{os.environ['PATH']}:{SBIN}"
    absent = [program for program in PROGRAMS if not shutil.which(program, path=path)]
    if absent:
        return f"{', '.join(absent)} not installed (Debian: slurm-wlm, munge)"
    if os.geteuid() != 0:
        return "Slurm's daemons have to be started by root"
    return None


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class PrivateSlurm:
    """With `cpus` processors and `memory` MiB, whatever the machine has. A context."""

    def __init__(self, directory, cpus=2, memory=2000):
        self.directory = Path(directory)
        self.directory.mkdir(parents=True)
        for name in ("state", "spool"):
            (self.directory / name).mkdir()
        self.host = socket.gethostname().split(".")[0]
        plugins = next(Path("/usr/lib").glob("*/slurm-wlm"), Path("/usr/lib/slurm"))
        (self.directory / "slurm.conf").write_text(CONFIGURATION.format(
            host=self.host, directory=self.directory, plugins=plugins, cpus=cpus, memory=memory,
            controller_port=free_port(), node_port=free_port(),
        ), encoding="utf-8")
        self.environment = {"SLURM_CONF": str(self.directory / "slurm.conf")}
        self.daemons = []

    def start(self, name, *words):
        path = shutil.which(name, path=f"{os.environ['PATH']}:{SBIN}")
        environment = {**os.environ, **self.environment}
        with open(self.directory / f"{name}.out", "wb") as log:
            self.daemons.append(subprocess.Popen([path, *map(str, words)], env=environment, stdin=subprocess.DEVNULL,
                                                 stdout=log, stderr=subprocess.STDOUT, cwd=self.directory))

    def command(self, *words):
        """What one of Slurm's commands prints."""
        done = subprocess.run([*map(str, words)], env={**os.environ, **self.environment}, capture_output=True, text=True)
        return done.stdout if done.returncode == 0 else ""

    def __enter__(self):
        try:
            key = self.directory / "munge.key"
            key.write_bytes(os.urandom(1024))
            key.chmod(0o400)
            self.directory.chmod(0o755)  # munge looks at it
            self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.directory}/munge.socket",
                       f"--pid-file={self.directory}/munged.pid", f"--log-file={self.directory}/munged.log",
                       f"--seed-file={self.directory}/munged.seed")
            self.wait(lambda: (self.directory / "munge.socket").exists(), "munge does not answer")
            self.start("slurmctld", "-D", "-i")
            self.start("slurmd", "-D", "-N", self.host)
            self.wait(lambda: self.command("sinfo", "--noheader", "--format=%t").strip() == "idle", "the node is not idle")
        except BaseException:
            self.__exit__()
            raise
        return self

    def wait(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                logs = "\n".join(f"--- {path.name}\n{path.read_text(errors='replace')[-2000:]}"
                                 for path in sorted(self.directory.glob("*.log")) + sorted(self.directory.glob("*.out")))
                raise RuntimeError(f"Slurm: {what} after {seconds} s\n{logs}")
            time.sleep(0.2)

    def jobs(self):
        """(number, state, name, reason) of all jobs, those that ended too, oldest first."""
        rows = self.command("squeue", "--all", "--states=all", "--noheader", "--sort=i", "--format=%i|%T|%j|%r")
        return [tuple(row.split("|")) for row in rows.split("\n") if row]

    def __exit__(self, *_):
        self.command("scancel", "--quiet", "--full", "--user=root")
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in reversed(self.daemons):
            try:
                daemon.wait(timeout=20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
