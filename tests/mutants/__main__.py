"""`python -m tests.mutants [--random N] [--seed S]`: random faults in the core, which tests have to notice.

Each is put into a copy of the sources and tried with the tests of its folder, without those that are marked `long`. The
survivors are listed. Not a part of CI: it takes minutes.
"""

import argparse
import shutil
import sys
import tempfile
import time
from pathlib import Path

from selforg.compiler.cache import cache_directory
from tests.mutants.drawing import draw
from tests.mutants.mutant import kernels_of, noticed
from tests.paths import ROOT


def main() -> int:
    """Try the mutants; return 1 if one is not noticed."""
    parser = argparse.ArgumentParser(description="Try random faults in the core, which tests have to notice.")
    parser.add_argument("--random", type=int, default=30, metavar="N", help="how many to draw")
    parser.add_argument("--seed", type=int, default=0, help="of the draw")
    given = parser.parse_args()
    drawn, survivors = draw(given.random, given.seed), []
    print("| mutant | file | noticed by |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        sources = Path(folder) / "main"
        shutil.copytree(ROOT, sources, ignore=shutil.ignore_patterns(".*", "results", "__pycache__"))
        if known := cache_directory():
            shutil.copytree(known, kernels_of(sources))
        for mutant in drawn:
            began = time.monotonic()
            by = noticed(mutant, sources)
            survivors += [] if by else [f"{mutant.file} {mutant.name}"]
            found = f"`{by}`" if by else "nothing"
            print(f"| {mutant.name} | `{mutant.file}` | {found} | {time.monotonic() - began:.0f} s", flush=True)
    print(f"{len(drawn)} mutants, {len(survivors)} survive", *survivors, sep="\n")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
