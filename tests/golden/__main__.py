"""`python -m tests.golden [DIR]`: replay the golden data of the original implementation."""

import sys
from pathlib import Path

from tests.golden import registered
from tests.golden.runner import Outcome, find_files, replay_file

DEFAULT = Path("../shared/golden")
SHOWN = 20  # failures listed per file


def main(arguments: list[str]) -> int:
    """Print a line a file and the sum; return 1 if anything failed, 2 if there is nothing to replay."""
    directory = Path(arguments[0]) if arguments else DEFAULT
    try:
        files = find_files(directory)
    except ValueError as error:
        print(f"golden: {error}", file=sys.stderr)
        return 2
    total = Outcome()
    for path in files:
        outcome = replay_file(path)
        print(f"{path.name}: {outcome}")
        for failure in outcome.failures[:SHOWN]:
            print(f"  {failure}")
        total.add(outcome)
    print(f"{total.passed} passed, {len(total.failures)} failed, {total.set_aside.total()} set aside")
    return 1 if total.failures else 0


if __name__ == "__main__":
    assert registered.FILES
    sys.exit(main(sys.argv[1:]))
