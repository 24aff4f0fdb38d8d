"""`python -m tests.clean_swarm_env.soak_copies [COUNT]`: copies and states of random missions at random moments.

Each of COUNT (1,000) rounds copies a random batch, by deepcopy and by pickle or cloudpickle, and puts a world of
another one into a third. Original and copies must have the same bits, side by side, and after the original is gone.
"""

import copy
import sys
from time import monotonic

import numpy as np

from tests.clean_swarm_env.copies import PICKLED, actions_of, advance, check_copy, random_batch
from tests.soaking import report, rounds


def check_state(rng: np.random.Generator) -> None:
    """Put a world of a random batch into all worlds of another one, at another time of its clock."""
    batch = random_batch(rng)
    advance(batch, rng, int(rng.integers(0, 60)))
    world, robots = int(rng.integers(batch.worlds.worlds)), batch.robots
    state = batch.get_state([world])
    other = copy.deepcopy(batch)
    advance(other, rng, int(rng.integers(1, 30)))
    other.set_state(state)
    own, copies = slice(world * robots, (world + 1) * robots), other.worlds.worlds
    if batch.action.mode == "option":
        assert np.array_equal(other.masks(), np.tile(batch.masks()[own], (copies, 1)))
    for _ in range(12):
        actions = actions_of(batch, rng)
        one, many = batch.step(actions), other.step(np.tile(actions[own], (copies, 1)))
        assert np.array_equal(many.rewards, np.tile(one.rewards[own], copies))
        assert np.array_equal(many.observations, np.tile(one.observations[own], (copies, 1)))
        assert np.array_equal(many.terminated, np.full(copies, one.terminated[world]))
        assert np.array_equal(many.truncated, np.full(copies, one.truncated[world]))


def check_round(number: int) -> None:
    """Copy a random batch at a random moment in two ways, and go on from a state of another one."""
    rng = np.random.default_rng((2026, number))
    batch = random_batch(rng)
    advance(batch, rng, int(rng.integers(0, 60)))
    check_copy(batch, PICKLED[list(PICKLED)[number % 2]], int(rng.integers(1 << 30)))
    check_state(np.random.default_rng((2027, number)))


def main(count: int) -> None:
    """Run the rounds; the first difference is an AssertionError that names the round."""
    begin, tried = monotonic(), 0
    for number in rounds(count):
        try:
            check_round(number)
        except AssertionError as error:
            report(tried + 1, tried)
            raise AssertionError(f"round {number}: {error}") from error
        tried += 1
        if (number + 1) % 50 == 0:
            print(f"{number + 1} of {count} rounds in {monotonic() - begin:.0f} s", flush=True)
    print(f"{tried} random copies and {tried} states: equal bits")
    report(tried, tried)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
