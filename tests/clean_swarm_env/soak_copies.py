"""`python -m tests.clean_swarm_env.soak_copies [COUNT]`: copies and states of random missions at random moments.

Each of COUNT (1,000) rounds copies a random batch by one of three ways and puts a world of another one into a third.
Original and copy must have the same bits, side by side, alone, and after the original is gone.
"""

import sys
from time import monotonic

from tests.clean_swarm_env.test_copies import WAYS, check_copy
from tests.clean_swarm_env.test_states import check_state
from tests.soaking import report, rounds


def main(count: int) -> None:
    """Run the rounds; the first difference is an AssertionError that names the round."""
    begin, tried = monotonic(), 0
    for number in rounds(count):
        way = list(WAYS)[number % len(WAYS)]
        try:
            check_copy((2026, number), WAYS[way])
            check_state((2027, number))
        except AssertionError as error:
            report(tried + 1, tried)
            raise AssertionError(f"round {number}, {way}: {error}") from error
        tried += 1
        if (number + 1) % 50 == 0:
            print(f"{number + 1} of {count} rounds in {monotonic() - begin:.0f} s", flush=True)
    print(f"{tried} random copies and {tried} states: equal bits")
    report(tried, tried)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
