"""`python -m tests.golden [DIRECTORY...]`: replay the recorded cases of the original implementation."""

import sys
from pathlib import Path

from tests.golden.runner import Outcome, find_files, replay_file

PARTS = tuple(Path(__file__).parent / "data" / part for part in ("first", "second", "third"))
"""The directories that are replayed if none is named."""
SHOWN = 20  # differences listed per file


def main(arguments: list[str]) -> int:
    """Print a line a file and the sum; return 1 if a case differs, 2 if there is nothing to replay."""
    try:
        files = [path for directory in map(Path, arguments or PARTS) for path in find_files(directory)]
    except ValueError as error:
        print(f"golden: {error}", file=sys.stderr)
        return 2
    total = Outcome()
    for path in files:
        outcome = replay_file(path)
        print(f"{path.parent.name}/{path.name}: {outcome}", flush=True)
        for difference in outcome.differences[:SHOWN]:
            print(f"  {difference}")
        total.add(outcome)
    print(total.counts)
    return 1 if total.differences else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
