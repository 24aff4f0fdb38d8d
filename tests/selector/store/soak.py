"""`python -m tests.selector.store.soak [ROUNDS]`: as many (10) rounds of the kills and updates of a test run."""

import sys
import tempfile
from pathlib import Path

from tests.selector.store.killing import kill_many, lost_updates
from tests.soaking import report, rounds


def main(arguments: list[str]) -> int:
    failed, tried, mistakes = 0, 0, 0
    with tempfile.TemporaryDirectory() as name:
        for number in rounds(int(arguments[0]) if arguments else 10):
            failed += lost_updates(Path(name) / f"{number}.sqlite", 8, 100)
            kills, wrong = kill_many(Path(name), 200, number)
            tried, mistakes = tried + kills, mistakes + wrong
    report(tried, tried - mistakes)
    return 1 if failed or mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
