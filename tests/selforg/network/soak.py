"""`python -m tests.selforg.network.soak [NETWORKS] [FIRST_SEED]`: many more random networks than a test run."""

import sys

from tests.selforg.network.side_by_side import live
from tests.soaking import report, rounds

STEPS = 50


def main(arguments: list[str]) -> int:
    networks = int(arguments[0]) if arguments else 10_000
    first = int(arguments[1]) if len(arguments) > 1 else 0
    differing, steps, cut_short, tried = [], 0, 0, 0
    for seed in rounds(networks, first):
        told, lived = live(seed, STEPS)
        differing += [told] if told else []
        cut_short += told is None and lived < STEPS
        steps += lived
        tried += 1
    print(*differing, sep="\n", end="\n" if differing else "")
    print(f"{tried} networks, {steps} steps, {cut_short} lives cut short where rounding had to decide")
    print(f"{len(differing)} differ from the reference")
    report(tried, tried - len(differing))
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
