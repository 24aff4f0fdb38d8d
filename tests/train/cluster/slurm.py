"""A SLURM of Debian's packages for the time of a test: two nodes in a network of their own, which has loopback only."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from tests.train.waiting import until

PROGRAMS = ("slurmctld", "slurmd", "sbatch", "munged", "unshare", "nsenter", "ip")
CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthInfo=socket={home}/munge.socket
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/spool-%n
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
CommunicationParameters=NoInAddrAny
JobAcctGatherType=jobacct_gather/none
KillWait=5
MinJobAge=3600
NodeName=node[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=1 RealMemory=4000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""


def missing() -> str:
    """Return why SLURM cannot be started here; empty if it can."""
    if os.geteuid() != 0:
        return "only root can start SLURM in a network of its own"
    lacking = [name for name in PROGRAMS if shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin") is None]
    return f"not installed: {', '.join(lacking)} (Debian: slurmctld slurmd slurm-client munge)" if lacking else ""


class Slurm:
    """Runs commands in the network of a SLURM."""

    def __init__(self, process: int, home: Path) -> None:
        self.home = home
        self._enter = ("nsenter", "--target", str(process), "--net", "--uts")
        path = f"{os.environ['PATH']}:/usr/sbin"
        self._environment = {**os.environ, "SLURM_CONF": str(home / "slurm.conf"), "PATH": path}

    def start(self, *command: str, folder: Path | None = None, **more: str) -> subprocess.Popen[bytes]:
        """Start a program that stays."""
        with (self.home / f"{Path(command[0]).name}.log").open("ab") as log:  # a pipe would stay open in its children
            given = {"stdin": subprocess.DEVNULL, "stdout": log, "stderr": log, "env": {**self._environment, **more}}
            return subprocess.Popen([*self._enter, *command], cwd=folder or self.home, **given)

    def do(self, *command: str, folder: Path | None = None, **more: str) -> str:
        """Return what a command prints."""
        given = {"cwd": folder or self.home, "env": {**self._environment, **more}, "capture_output": True, "text": True}
        done = subprocess.run([*self._enter, *command], check=False, timeout=120, **given)
        assert done.returncode == 0, done.stderr
        return done.stdout


@contextmanager
def running() -> Iterator[Slurm]:
    """Start SLURM; stop it at the end."""
    home = Path(tempfile.mkdtemp(prefix="clean-swarm-slurm-"))
    # getaddrinfo takes 127.0.0.1 only where there is another address, too
    up = "ip link set lo up && ip address add 10.0.0.1/32 dev lo && echo && exec sleep 1000000"
    (home / "state").mkdir()
    (home / "munge.key").write_bytes(os.urandom(128))
    (home / "munge.key").chmod(0o400)
    home.chmod(0o755)
    with ExitStack() as stack:
        stack.callback(shutil.rmtree, home, ignore_errors=True)
        namespace = subprocess.Popen(["unshare", "--net", "--uts", "sh", "-c", up], stdout=subprocess.PIPE)
        stack.enter_context(namespace)
        stack.callback(namespace.kill)
        assert namespace.stdout is not None
        namespace.stdout.readline()
        slurm = Slurm(namespace.pid, home)
        (home / "slurm.conf").write_text(CONFIGURATION.format(host=socket.gethostname(), home=home))
        places = {"socket": "socket", "key-file": "key", "pid-file": "pid", "log-file": "log", "seed-file": "seed"}
        munge = [f"--{option}={home}/munge.{ending}" for option, ending in places.items()]
        daemons = [("munged", "--foreground", "--force", *munge), ("slurmctld", "-D")]
        for command in (*daemons, ("slurmd", "-D", "-N", "node1"), ("slurmd", "-D", "-N", "node2")):
            daemon = slurm.start(*command)
            stack.callback(daemon.wait)
            stack.callback(daemon.terminate)
            if command[0] == "munged":
                until((home / "munge.socket").exists)
        until(lambda: slurm.do("sinfo", "--noheader", "--format=%D %t") == "2 idle\n")
        yield slurm
