"""`python -m tests.mutants [--write] [NAME...]`: mutants of core lines, each of which a test has to notice.

A mutant is one text of one file in place of another, in a copy of the sources. `--write` puts the table into
docs/reliability.md. `--random N --seed S` tries N that are drawn over the core, with the tests of their folders, and
lists the survivors. Not a part of CI: it takes minutes.
"""

import argparse
import shutil
import sys
import tempfile
import time
from pathlib import Path

from docs.figures.stored import put
from tests.mutants.drawing import draw
from tests.mutants.mutant import noticed
from tests.mutants.named import MUTANTS
from tests.paths import ROOT

PAGE = ROOT / "docs" / "reliability.md"


def main() -> int:
    """Try the mutants; return 1 if one is not noticed."""
    parser = argparse.ArgumentParser(description="Try mutants of core lines, each of which a test has to notice.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="how the names begin of those to try")
    parser.add_argument("--write", action="store_true", help="put the table into docs/reliability.md")
    parser.add_argument("--random", type=int, default=0, metavar="N", help="draw N over the core in their place")
    parser.add_argument("--seed", type=int, default=0, help="of the draw")
    given = parser.parse_args()
    names = tuple(given.names)
    drawn = draw(given.random, given.seed) if given.random else MUTANTS
    chosen = [mutant for mutant in drawn if not names or mutant.name.startswith(names)]
    lines = ["| mutant | file | noticed by |", "|---|---|---|"]
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        sources = Path(folder) / "main"
        shutil.copytree(ROOT, sources, ignore=shutil.ignore_patterns(".*", "results", "__pycache__", "shared"))
        for mutant in chosen:
            began = time.monotonic()
            by = noticed(mutant, sources)
            survivors += [mutant] * (not by)
            lines.append(f"| {mutant.name} | `{mutant.file}` | {f'`{by}`' if by else 'nothing'} |")
            print(lines[-1], f"{time.monotonic() - began:.0f} s", flush=True)
    print(f"{len(chosen)} mutants, {len(survivors)} survive")
    print(*(f"{mutant.file} {mutant.name}" for mutant in survivors), sep="\n", end="\n" if survivors else "")
    if given.write and not given.random:
        PAGE.write_text(put(PAGE.read_text(encoding="utf-8"), "mutants", "\n".join(lines)), encoding="utf-8")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
