"""`python -m tests.golden [DIR ...]`: replay the golden data of the original implementation."""

import sys
from collections.abc import Sequence
from pathlib import Path

from tests.golden import registered
from tests.golden.runner import Outcome, find_files, replay_file

DIRECTORIES = tuple(Path("../shared") / part for part in ("golden", "golden-2", "golden-3"))
"""The parts, replayed where no directory is named; all after the first one only where they exist."""
SHOWN = 20  # failures listed per file


def main(arguments: list[str], usual: Sequence[Path] = DIRECTORIES) -> int:
    """Print a line a file and the sum; return 1 if anything failed, 2 if there is nothing to replay.

    arguments: directories; none: the `usual` ones.
    """
    first, *others = usual
    directories = [Path(argument) for argument in arguments] or [first, *(path for path in others if path.is_dir())]
    try:
        files = [path for directory in directories for path in find_files(directory)]
    except ValueError as error:
        print(f"golden: {error}", file=sys.stderr)
        return 2
    total = Outcome()
    for path in files:
        outcome = replay_file(path)
        print(f"{path.parent.name}/{path.name}: {outcome}")
        for failure in outcome.failures[:SHOWN]:
            print(f"  {failure}")
        total.add(outcome)
    print(f"{total.passed} passed, {len(total.failures)} failed, {total.set_aside.total()} set aside")
    return 1 if total.failures else 0


if __name__ == "__main__":
    assert registered.FILES
    sys.exit(main(sys.argv[1:]))
