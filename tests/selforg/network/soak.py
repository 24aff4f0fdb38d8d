"""`python -m tests.selforg.network.soak [NETWORKS] [FIRST_SEED]`: many more random networks than a test run."""

import sys

from tests.selforg.network.side_by_side import live
from tests.soaking import report, rounds

STEPS = 50


def main(networks: int = 10_000, first: int = 0) -> int:
    lives = [live(seed, STEPS) for seed in rounds(networks, first)]
    differing = [told for told, _ in lives if told]
    print(*differing, sep="\n", end="\n" if differing else "")
    cut_short = sum(steps < STEPS for _, steps in lives) - len(differing)
    print(f"{len(lives)} networks, {sum(steps for _, steps in lives)} steps, {cut_short} lives cut short by rounding")
    report(len(lives), len(lives) - len(differing))
    return int(bool(differing))


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
