"""`python -m tests.attacks.soak TARGET [EXAMPLES]`: many more random contents of one fuzz target than a test run.

A content that fails is kept below `tests/attacks/findings`, where the tests read it again.
"""

import hashlib
import sys
import tempfile
from pathlib import Path
from traceback import print_exc

from tests.attacks.targets import FINDINGS, TARGETS, Target, attack
from tests.soaking import report, rounds

EACH = 500
"""Contents of a round, which has a seed of its own."""


def main(arguments: list[str]) -> int:
    """Run the soak; return 1 at the first content that fails."""
    name, examples = arguments[0], int(arguments[1]) if len(arguments) > 1 else 100_000
    tried, last = 0, b""
    with tempfile.TemporaryDirectory() as folder:
        target = TARGETS[name](Path(folder))

        def read(content: bytes) -> object:
            nonlocal tried, last
            tried, last = tried + 1, content
            return target.read(content)

        for number in rounds(-(-examples // EACH)):
            try:
                attack(Target(target.drawn, read), EACH, number)
            except Exception:
                print_exc()
                kept = FINDINGS / name / hashlib.sha256(last).hexdigest()[:12]
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_bytes(last)  # Hypothesis reads the smallest one last
                print(f"kept: {kept}")
                report(tried, tried - 1)
                return 1
    report(tried, tried)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
