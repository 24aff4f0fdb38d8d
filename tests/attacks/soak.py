"""`python -m tests.attacks.soak TARGET [EXAMPLES]`: many more random contents of one fuzz target than a test run.

Hypothesis prints the smallest content that fails. Keep it in `tests/attacks/findings/TARGET`: the tests read it again.
"""

import sys
import tempfile
from pathlib import Path

from tests.attacks.targets import TARGETS, attack
from tests.soaking import report, rounds

EACH = 500
"""Contents of a round, which has a seed of its own."""


def main(name: str, examples: str = "100_000") -> None:
    """Run the soak until its time is over; the first content that fails raises its error."""
    tried = 0
    with tempfile.TemporaryDirectory() as folder:
        target = TARGETS[name](Path(folder))
        for number in rounds(-(-int(examples) // EACH)):
            attack(target, EACH, number)
            tried += EACH
    report(tried, tried)


if __name__ == "__main__":
    main(*sys.argv[1:])
