"""Ticks of our worlds beside those of other environments: world-ticks per CPU second on one core.

    python -m benchmarks.peers DIRECTORY

Each peer has a virtual environment of its own below DIRECTORY, which is made where it does not exist. Each contestant
is a process bound to the same core; they take turns, a CPU second each. Ticks are not equal work: what each contains is
in `docs/benchmarks.md`. A peer that cannot be installed, or that fails, is one line.
"""

import os
import subprocess
import sys
from dataclasses import dataclass
from json import loads
from pathlib import Path

from benchmarks.shared.measuring import by_turns, middle
from benchmarks.shared.record import record
from tests.examples.environment import environment
from tests.paths import ROOT

PEERS = {
    "JaxMARL": ("jaxmarl==0.2.0", "jax[cpu]==0.10.2"),
    "VMAS": ("vmas==1.5.2", "torch"),  # its version is in constraints.txt; a later one may come with CUDA
    "mpe2": ("mpe2==1.1.1",),
    "pogema": ("pogema==1.4.0",),
}
"""Peer -> its packages, each the newest one on 26 November 2026."""
WORLDS = {
    "tick": (1, 64, 256),
    "Batch": (1, 64, 256),
    "Batch, each tick": (1, 64, 256),
    "JaxMARL": (64, 256, 4096),
    "VMAS": (64, 256, 4096),
    "mpe2": (1,),
    "pogema": (1,),
}
ROUNDS = 10
ONE_THREAD = {
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
    "JAX_PLATFORMS": "cpu",
    "OMP_NUM_THREADS": "1",
}


@dataclass(frozen=True)
class Contestant:
    """A process that measures when it is asked, and the versions of its packages."""

    process: subprocess.Popen[str]
    versions: dict[str, str]

    @staticmethod
    def started(python: Path, name: str, worlds: int, core: int) -> "Contestant":
        """Start a contestant and wait until it is ready."""
        command = (python, "-W", "ignore", "-m", "benchmarks.shared.contestants", name, str(worlds), str(core))
        own, pipe = {**os.environ, **ONE_THREAD}, subprocess.PIPE
        process = subprocess.Popen(command, cwd=ROOT, env=own, stdin=pipe, stdout=pipe, text=True)
        assert process.stdout is not None
        ready = process.stdout.readline()
        if not ready:
            raise ChildProcessError(f"{name}, {worlds} worlds: ended with {process.wait()}")
        return Contestant(process, loads(ready))

    def rate(self) -> float:
        """Return world-ticks per CPU second of one round."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(file=self.process.stdin, flush=True)
        return float(self.process.stdout.readline())


def pythons(directory: Path) -> dict[str, Path]:
    """Return the Pythons of all contestants whose packages could be installed."""
    found = {name: Path(sys.executable) for name in WORLDS if name not in PEERS}
    for name, packages in PEERS.items():
        try:
            found[name] = environment(directory / name, *packages)
        except subprocess.CalledProcessError as error:
            print(f"{name}: not installed, pip ended with {error.returncode}", flush=True)
    return found


def main(directory: str) -> None:
    """Print and record the figures."""
    core = max(os.sched_getaffinity(0))
    load = {"before": os.getloadavg()[0]}
    contestants: dict[str, Contestant] = {}
    for name, python in pythons(Path(directory).absolute()).items():
        for worlds in WORLDS[name]:
            try:
                contestants[f"{name} x {worlds}"] = Contestant.started(python, name, worlds, core)
            except ChildProcessError as error:
                print(error, flush=True)
    rates = by_turns({name: one.rate for name, one in contestants.items()}, ROUNDS)
    for one in contestants.values():
        one.process.communicate()
    load["after"] = os.getloadavg()[0]
    for name, figures in rates.items():
        print(f"{name:24}{middle(figures):12.0f} world-ticks per CPU second ({min(figures):.0f} to {max(figures):.0f})")
    versions: dict[str, str] = {}
    for one in contestants.values():
        versions = {**one.versions, **versions}
    found = {"median": middle, "least": min, "most": max}
    figures_of = {what: {name: float(of(figures)) for name, figures in rates.items()} for what, of in found.items()}
    record("peers", {**figures_of, "load": load}, versions)


if __name__ == "__main__":
    main(sys.argv[1])
