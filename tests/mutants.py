"""`python -m tests.mutants [--write] [NAME...]`: mutants of core lines, each of which a test has to notice.

A mutant is one text of one file in place of another, in a copy of the sources, without compiled code. `--write` puts
the table into docs/reliability.md. Not a part of CI: it takes minutes.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from tests.paths import ROOT

PAGE = ROOT / "docs" / "reliability.md"
BEGIN, END = "<!-- begin: mutants -->\n", "<!-- end: mutants -->\n"


class Mutant(NamedTuple):
    """A fault made on purpose, and the tests that have to notice it."""

    name: str
    file: str
    before: str
    """A text that is in the file once."""
    after: str
    tests: tuple[str, ...]


POTENTIALS, SPACE = "selforg/potentials.py", "selforg/space.py"
COLLISIONS, PHYSICS = (
    "clean_swarm_env/physics/collisions.py",
    "tests/clean_swarm_env/physics/test_collisions.py::test_a_pair_at_the_distance_itself_is_not_closer",
)
UCB, BANDITS = "selector/strategies/bandits/discounted_ucb.py", "tests/selector/strategies/test_bandits.py"
JOURNAL, WRITING = "train/running/finished_runs.py", "selector/documents/writing.py"
ENDINGS, SEARCH = (
    "tests/train/cli/test_endings.py::test_what_is_promised_to_be_kept_is_on_the_disk_before_it_counts",
    "selforg/network/planning/search.py",
)
OF_POTENTIALS, OF_SPACE, OF_PLANS = (
    ("tests/selforg/test_potentials.py",),
    ("tests/selforg/test_space.py",),
    ("tests/selforg/network/planning/test_planner.py",),
)
MUTANTS = (
    Mutant(
        "repulsion of Balch at no clearance",
        POTENTIALS,
        "if clearance <= 0.0 or np.isinf(diffusion):",
        "if clearance < 0.0 or np.isinf(diffusion):",
        OF_POTENTIALS,
    ),
    Mutant(
        "repulsion of Fernandez at no clearance",
        POTENTIALS,
        "    if clearance <= 0.0:\n        return np.inf\n    return distance",
        "    if clearance < 0.0:\n        return np.inf\n    return distance",
        OF_POTENTIALS,
    ),
    Mutant(
        "repulsion of Ge at no clearance",
        POTENTIALS,
        "    if clearance <= 0.0:\n        return np.inf, 0.0",
        "    if clearance < 0.0:\n        return np.inf, 0.0",
        OF_POTENTIALS,
    ),
    Mutant(
        "attraction of Balch at its diffusion",
        POTENTIALS,
        "    if clearance <= diffusion:\n        return clearance / diffusion",
        "    if clearance < diffusion:\n        return clearance / diffusion",
        OF_POTENTIALS,
    ),
    Mutant("half a torus, forwards", SPACE, "if delta > half:", "if delta >= half:", OF_SPACE),
    Mutant("half a torus, backwards", SPACE, "if delta < -half:", "if delta <= -half:", OF_SPACE),
    Mutant("end of a torus", SPACE, "coordinate >= extent):", "coordinate > extent):", OF_SPACE),
    Mutant(
        "sample at the distance",
        COLLISIONS,
        "c.samples[world, k] += now < c.squares[k]",
        "c.samples[world, k] += now <= c.squares[k]",
        (PHYSICS,),
    ),
    Mutant(
        "event at the distance",
        COLLISIONS,
        "c.events[world, k] += now < c.squares[k] <= was",
        "c.events[world, k] += now <= c.squares[k] <= was",
        (PHYSICS,),
    ),
    Mutant(
        "event after the distance",
        COLLISIONS,
        "c.events[world, k] += now < c.squares[k] <= was",
        "c.events[world, k] += now < c.squares[k] < was",
        (PHYSICS,),
    ),
    Mutant(
        "contact at the distance",
        COLLISIONS,
        "if now < c.squares[0]:",
        "if now <= c.squares[0]:",
        (PHYSICS,),
    ),
    Mutant(
        "totals of groups without rewards",
        UCB,
        "self.totals[touched] *= self.parameters.discount",
        "self.totals *= self.parameters.discount",
        (BANDITS,),
    ),
    Mutant(
        "counts of groups without rewards",
        UCB,
        "self.counts[touched] *= self.parameters.discount",
        "self.counts *= self.parameters.discount",
        (BANDITS,),
    ),
    Mutant(
        "discount of totals",
        UCB,
        "        self.totals[touched] *= self.parameters.discount\n",
        "",
        (BANDITS,),
    ),
    Mutant("fsync of the journal", JOURNAL, "                os.fsync(file.fileno())\n", "", (ENDINGS,)),
    Mutant("fsync of whole files", WRITING, "                os.fsync(file.fileno())\n", "", (ENDINGS,)),
    Mutant(
        "whole files",
        WRITING,
        'path.with_name(f".{path.name}.{os.getpid()}.part")',
        "path",
        (ENDINGS,),
    ),
    Mutant(
        "transactions that write",
        "selector/store/connection.py",
        '"BEGIN IMMEDIATE" if writes else "BEGIN"',
        '"BEGIN"',
        ("tests/selector/store/test_processes.py",),
    ),
    Mutant(
        "one transaction for an update",
        "selector/store/connection.py",
        "        connection.exec_driver_sql(",
        "        return\n        connection.exec_driver_sql(",
        ("tests/selector/store/test_processes.py",),
    ),
    Mutant(
        "the cheapest way to a state",
        SEARCH,
        "best.get(following, reached) < reached:",
        "best.get(following, reached) > reached:",
        OF_PLANS,
    ),
    Mutant("cost of a plan", SEARCH, "reached = (cost + step.cost,", "reached = (cost + 1,", OF_PLANS),
    Mutant(
        "goal when a state is taken",
        SEARCH,
        "                if following in opened or",
        "                if is_met(task.goal, *following):\n"
        "                    return self.found((*sequence, step.action))\n"
        "                if following in opened or",
        OF_PLANS,
    ),
)


def passes(tests: tuple[str, ...], sources: Path) -> bool:
    """Return whether tests pass on a copy of the sources."""
    environment = {**os.environ, "PYTHONPATH": str(sources), "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
    done = subprocess.run(command, cwd=sources, env=environment, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{tests}: pytest ended with {done.returncode}\n{done.stdout[-2000:]}")
    return done.returncode == 0


def noticed(mutant: Mutant, sources: Path) -> bool:
    """Return whether the tests of a mutant fail on it, in a copy of the sources that is as before afterwards."""
    path = sources / mutant.file
    whole = path.read_text(encoding="utf-8")
    if whole.count(mutant.before) != 1:
        raise ValueError(f"{mutant.name}: expected its text once in {mutant.file}, found {whole.count(mutant.before)}")
    path.write_text(whole.replace(mutant.before, mutant.after), encoding="utf-8")
    try:
        return not passes(mutant.tests, sources)
    finally:
        path.write_text(whole, encoding="utf-8")


def main(arguments: list[str]) -> int:
    """Try the mutants; return 1 if one is not noticed."""
    names = tuple(word for word in arguments if word != "--write")
    chosen = [mutant for mutant in MUTANTS if not names or mutant.name.startswith(names)]
    lines = ["| mutant | file | noticed by |", "|---|---|---|"]
    survivors = 0
    with tempfile.TemporaryDirectory() as folder:
        sources = Path(folder) / "main"
        shutil.copytree(ROOT, sources, ignore=shutil.ignore_patterns(".*", "results", "__pycache__", "shared"))
        for tests in {mutant.tests: None for mutant in chosen}:
            if not passes(tests, sources):
                raise RuntimeError(f"{tests}: expected to pass without a mutant")
        for mutant in chosen:
            found = noticed(mutant, sources)
            survivors += not found
            by = f"`{mutant.tests[0]}`" if found else "nothing"
            lines.append(f"| {mutant.name} | `{mutant.file}` | {by} |")
            print(lines[-1], flush=True)
    print(f"{len(chosen)} mutants, {survivors} survive")
    if "--write" in arguments:
        before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
        PAGE.write_text(before + BEGIN + "\n".join(lines) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
