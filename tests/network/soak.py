"""`python -m tests.network.soak [NETWORKS] [FIRST_SEED]`: many more random networks than a test run has time for."""

import sys

from tests.network.side_by_side import first_difference

STEPS = 50


def main(arguments: list[str]) -> int:
    networks = int(arguments[0]) if arguments else 10_000
    first = int(arguments[1]) if len(arguments) > 1 else 0
    differing = [told for seed in range(first, first + networks) if (told := first_difference(seed, STEPS))]
    print(*differing, f"{networks} networks, {STEPS} steps each: {len(differing)} differ from the reference", sep="\n")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
