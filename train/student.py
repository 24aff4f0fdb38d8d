"""Student's distribution: the probability of a tail, and where a tail of a probability begins.

SciPy has both, at the price of 143 MB on the disk and a second of each process that reports; a test compares with it.
"""

import math
from itertools import count

ROUNDING = 1e-15
"""Relative changes below this one end a search."""


def tail_beyond(t: float, freedom: float) -> float:
    """Return the probability of a value above `t`, which is at least 0, for degrees of freedom of at least 1.

    >>> tail_beyond(1.0, 1.0)
    0.25

    """
    a, square = 0.5 * freedom, min(t * t, 1e300)
    within, beyond = square / (freedom + square), freedom / (freedom + square)
    factor = math.exp(math.lgamma(a + 0.5) - math.lgamma(a)) * math.pow(beyond, a) * math.sqrt(within / math.pi)
    far = beyond < (a + 1.0) / (a + 2.5)
    return 0.5 * factor * _beta_fraction(a, 0.5, beyond) / a if far else 0.5 - factor * _beta_fraction(0.5, a, within)


def tail_begins(tail: float, freedom: float) -> float:
    """Return the value that is exceeded with the probability `tail`, which is at most 0.5.

    >>> round(tail_begins(0.25, 1.0), 12)
    1.0

    """
    a, t, step = 0.5 * freedom, 0.0, math.inf
    peak = math.exp(math.lgamma(a + 0.5) - math.lgamma(a)) / math.sqrt(freedom * math.pi)
    while step > 10.0 * ROUNDING * t:  # by Newton: the tail is convex, so each step goes up and none too far
        step = (tail_beyond(t, freedom) - tail) / (peak * math.pow(1.0 + t * t / freedom, -a - 0.5))
        t += step
    return t


def _beta_fraction(a: float, b: float, x: float) -> float:
    """Return the continued fraction of the incomplete beta function, by the algorithm of Lentz."""
    above, below = 1.0, 1.0 / (1.0 - (a + b) * x / (a + 1.0))
    value = below
    for m in count(1):
        even, odd = a + 2 * m, a + 2 * m + 1
        for part in (m * (b - m) * x / ((even - 1.0) * even), -(a + m) * (a + b + m) * x / (even * odd)):
            below, above = 1.0 / (1.0 + part * below), 1.0 + part / above
            value *= above * below
        if not abs(above * below - 1.0) >= ROUNDING:
            break
    return value
