"""Simulates comparisons: how often equal strategies are told apart, and how often different ones are.

    python -m tests.train.analysis.equal_strategies    # some minutes; see docs/decisions/0212-sign-flips.md

A cost is the scenario's part, which all strategies share, times the strategy's own; a mission that jams costs ten times
the mean. Beside sign flips stands what told strategies apart before: Student's intervals of the ratio of means, widened
for all pairs by Bonferroni.

Shapes: C comparisons, A strategies, K scenarios, P pairs.
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np
from scipy.special import stdtrit

from selforg.arrays import Flags, Floats
from train.analysis.flips import ALPHA, FLIPS, fewest, flip_ps, holm
from train.reports.text_table import markdown_table

REPEATS: Final = 2_000
"""Comparisons of a cell."""
DRAWN: Final = 2**12 - 1
"""Flips that are drawn in place of `train.analysis.flips.FLIPS`: fewer, which change no error rate."""
JAM: Final = 10.0
"""Cost of a mission that jams, in means."""
COUNTS: Final = (6, 10, 30, 100)
JAMS: Final = (0.0, 0.01, 0.05, 0.2)
Own = Callable[[np.random.Generator, tuple[int, ...]], Floats]


def log_normal(spread: float) -> Own:
    """Return a strategy's part of costs whose logarithms have this spread."""
    return lambda rng, shape: rng.lognormal(-(spread**2) / 2.0, spread, shape)


def steps(rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    """Return few different values, which tie in every third pair."""
    return 1.0 + 0.25 * rng.integers(-1, 2, shape)


OWN: Final[Mapping[str, Own]] = {
    "normal, 0.25": lambda rng, shape: np.maximum(rng.normal(1.0, 0.25, shape), 0.05),
    "log-normal, 0.25": log_normal(0.25),
    "log-normal, 0.5": log_normal(0.5),
    "log-normal, 1": log_normal(1.0),
    "ties": steps,
}
"""Name -> a strategy's own part of its costs."""


def told_apart(costs: Floats, jams: Flags, pairs: Sequence[tuple[int, int]]) -> Flags:
    """Return whether pairs (C, P) are told apart by costs (C, A, K), as `train.analysis.verdict.Ranking` does it."""
    first, second = (list(each) for each in zip(*pairs, strict=True))
    logs = np.log(costs)
    both = ~(jams[:, first] | jams[:, second])
    tests = (logs[:, first] - logs[:, second]) * both, jams[:, first] * 1.0 - jams[:, second]
    paid = np.where(jams, JAM, costs).mean(axis=2)
    sign = np.sign(paid[:, first] - paid[:, second])
    count, flips = costs.shape[2], FLIPS if costs.shape[2] <= 16 else DRAWN
    ps = np.concatenate([flip_ps(each.reshape(-1, count), flips=flips).reshape(sign.shape) for each in tests], axis=1)
    differing = np.concatenate([np.count_nonzero(each, axis=2) for each in tests], axis=1)
    least = np.maximum(0.5 ** np.maximum(differing - 1, 0), 1.0 / (flips + 1))
    corrected = np.array([holm(own, list(bounds)) for own, bounds in zip(ps, least, strict=True)])
    agree = np.concatenate([np.sign(each.sum(axis=2)) == sign for each in tests], axis=1)
    found = (corrected < ALPHA) & agree
    return found[:, : len(pairs)] | found[:, len(pairs) :]


def told_by_student(costs: Floats, jams: Flags, pairs: Sequence[tuple[int, int]]) -> Flags:
    """Return whether Student's intervals of ratios of means exclude 1, for all pairs (C, P) at once."""
    paid, count = np.where(jams, JAM, costs), costs.shape[2]
    if count < fewest(1):
        return np.zeros((len(paid), len(pairs)), dtype=bool)
    means = paid.mean(axis=2)
    shares = paid / means[:, :, None]
    first, second = (list(each) for each in zip(*pairs, strict=True))
    error = (shares[:, first] - shares[:, second]).std(axis=2, ddof=1) / np.sqrt(count)
    half = -float(stdtrit(count - 1, ALPHA / 2.0 / len(pairs))) * error
    return np.abs(np.log(means[:, first] / means[:, second])) > half


def share_told(
    own: Own,
    count: int,
    jam: Sequence[float],
    factors: Sequence[float],
    seed: Sequence[int],
    repeats: int = REPEATS,
) -> tuple[float, float]:
    """Return in which share of tables any pair is told apart: by sign flips, and by Student's intervals.

    `jam` and `factors` have the share of missions that jam, and the factor of the costs, of each strategy.
    """
    rng, shape = np.random.default_rng(seed), (repeats, len(jam), count)
    common = rng.lognormal(0.0, 0.5, (repeats, 1, count))
    costs = common * own(rng, shape) * np.array(factors)[:, None]
    jams = rng.uniform(size=shape) < np.array(jam)[:, None]
    pairs = list(itertools.combinations(range(len(jam)), 2))
    return tuple(float(tell(costs, jams, pairs).any(axis=1).mean()) for tell in (told_apart, told_by_student))  # type: ignore[return-value]


def equal_table(
    repeats: int = REPEATS, counts: Sequence[int] = COUNTS
) -> dict[tuple[str, float, int, int], tuple[float, float]]:
    """Return own part, share of jams, strategies, scenarios -> shares of tables that tell equal strategies apart."""
    return {
        (name, jam, strategies, count): share_told(
            own, count, [jam] * strategies, [1.0] * strategies, (212, k, int(1000 * jam), strategies, count), repeats
        )
        for k, (name, own) in enumerate(OWN.items())
        for jam in JAMS
        for strategies in (2, 6)
        for count in counts
    }


DIFFERENT: Final[Mapping[str, tuple[Sequence[float], Sequence[float]]]] = {
    "a tenth": ((0.0, 0.0), (1.0, 1.1)),
    "30 %": ((0.0, 0.0), (1.0, 1.3)),
    "30 %, 5 % of both jam": ((0.05, 0.05), (1.0, 1.3)),
    "1 % beside 20 % jam": ((0.01, 0.2), (1.0, 1.0)),
}
"""What differs -> shares of jams and factors of two strategies."""


def power_table(repeats: int = REPEATS) -> dict[tuple[str, str, int], tuple[float, float]]:
    """Return what differs, own part, scenarios -> shares of comparisons of two that are told apart."""
    return {
        (what, name, count): share_told(OWN[name], count, *two, (213, k, j, count), repeats)
        for k, (what, two) in enumerate(DIFFERENT.items())
        for j, name in enumerate(list(OWN)[:4])
        for count in COUNTS
    }


def cell(shares: tuple[float, float]) -> str:
    """Return both shares in per cent, the one by Student's intervals in brackets."""
    return "{:.1f} ({:.1f})".format(*(100.0 * share for share in shares))


def main() -> None:
    """Print both tables."""
    equal, power = equal_table(), power_table()
    columns = [(strategies, count) for strategies in (2, 6) for count in COUNTS]
    rows = [
        [f"{name}; {jam:.0%} jam", *(cell(equal[name, jam, *column]) for column in columns)]
        for name in OWN
        for jam in JAMS
    ]
    print(markdown_table(["costs", *(f"{strategies} of {count}" for strategies, count in columns)], rows))
    print(f"\nhighest: {max(share for share, _ in equal.values()):.2%} ({max(old for _, old in equal.values()):.2%})\n")
    rows = [
        [f"{what}; {name}", *(cell(power[what, name, count]) for count in COUNTS)]
        for what in DIFFERENT
        for name in list(OWN)[:4]
    ]
    print(markdown_table(["differs; costs", *(f"{count} scenarios" for count in COUNTS)], rows))


if __name__ == "__main__":
    main()
