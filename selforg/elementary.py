"""Sine, cosine, arctangent, exponential and logarithm in basic operations only, so that all CPUs give the same bits.

A C library takes other code for these functions on a CPU with fused multiply-add, and the last bit then differs. What a
course depends on therefore uses the functions of this file. Arguments are reduced by constants in two or three pieces
and put into power series. The error is below three units of the last place, and below five of growth and of the
hyperbolic tangent. What they cost: docs/decisions/0160-elementary-functions.md.

Source: Cody and Waite, Software Manual for the Elementary Functions (1980).
"""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import kernel, part

QUARTER_TURN: Final = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
"""Half of pi in three pieces; up to a million times the first two are exact."""
DOUBLING: Final = (0.6931471804855391, 7.440617110012397e-11)
"""The logarithm of 2 in two pieces."""
ARCTANGENTS: Final = (
    *(0.0, 0.12435499454676144, 0.24497866312686414, 0.35877067027057225, 0.4636476090008061),
    *(0.5585993153435624, 0.6435011087932844, 0.7188299996216245, 0.7853981633974483),
)
"""The arctangents of 0, 1/8, 2/8, ... 1 [rad]."""
HIGHEST, LOWEST = 709.78, -745.2  # beyond these an exponential counts as infinite or zero


@part
def sine_cosine(angle: float) -> tuple[float, float]:
    """Return sine and cosine of an `angle` [rad] of at most a million radians."""
    turns = np.floor(angle * (2.0 / np.pi) + 0.5)
    r = ((angle - turns * QUARTER_TURN[0]) - turns * QUARTER_TURN[1]) - turns * QUARTER_TURN[2]
    s = r * r
    sine = s * (1.0 / 6227020800.0 + s * (-1.0 / 1307674368000.0 + s * (1.0 / 355687428096000.0)))
    sine = s * (-1.0 / 5040.0 + s * (1.0 / 362880.0 + s * (-1.0 / 39916800.0 + sine)))
    sine = r + r * (s * (-1.0 / 6.0 + s * (1.0 / 120.0 + sine)))
    cosine = s * (1.0 / 479001600.0 + s * (-1.0 / 87178291200.0 + s * (1.0 / 20922789888000.0)))
    cosine = s * (-1.0 / 720.0 + s * (1.0 / 40320.0 + s * (-1.0 / 3628800.0 + cosine)))
    cosine = 1.0 + s * (-0.5 + s * (1.0 / 24.0 + cosine))
    quarter = int(turns) & 3
    if quarter & 1:
        sine, cosine = cosine, -sine
    return (-sine, -cosine) if quarter & 2 else (sine, cosine)


@part
def direction(y: float, x: float) -> float:
    """Return the angle [rad] in [-pi, pi] of the vector (x, y), 0 for a zero vector: the arctangent of two numbers.

    The quotient is brought below 1/16 by the nearest of nine known arctangents.
    """
    wide, high = abs(x), abs(y)
    longer, shorter = max(wide, high), min(wide, high)
    if longer == 0.0:
        return 0.0
    step = np.floor(8.0 * (shorter / longer) + 0.5)
    t = (shorter - 0.125 * step * longer) / (longer + 0.125 * step * shorter)
    s = t * t
    series = s * (-1.0 / 7.0 + s * (1.0 / 9.0 + s * (-1.0 / 11.0 + s * (1.0 / 13.0))))
    angle: float = ARCTANGENTS[int(step)] + (t + t * (s * (-1.0 / 3.0 + s * (1.0 / 5.0 + series))))
    if high > wide:
        angle = 0.5 * np.pi - angle
    if x < 0.0:
        angle = np.pi - angle
    return -angle if y < 0.0 else angle


@part
def length_of(x: float, y: float) -> float:
    """Return the length of the vector (x, y), also where the squares are too small or too large for a float."""
    longer, shorter = max(abs(x), abs(y)), min(abs(x), abs(y))
    if longer == 0.0:
        return 0.0
    return longer * float(np.sqrt(1.0 + (shorter / longer) * (shorter / longer)))


@part
def powers_of_two(value: float) -> tuple[int, float]:
    """Return (k, g): the exponential of a finite `value` is 2**k * (1 + g), and |g| < 0.42."""
    k = np.floor(value * 1.4426950408889634 + 0.5)
    r = (value - k * DOUBLING[0]) - k * DOUBLING[1]
    g = r * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0))
    g = r * (1.0 / 362880.0 + r * (1.0 / 3628800.0 + r * (1.0 / 39916800.0 + g)))
    g = r * (1.0 / 720.0 + r * (1.0 / 5040.0 + r * (1.0 / 40320.0 + g)))
    g = r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + g)))
    return int(k), r + r * (r * (0.5 + g))


@part
def exponential(value: float) -> float:
    """Return e to the power of `value`; 0 for minus infinity and too small values, infinity for too large ones."""
    if value < LOWEST:
        return 0.0
    if value > HIGHEST:
        return np.inf
    k, g = powers_of_two(value)
    return math.ldexp(1.0 + g, k)


@part
def growth(value: float) -> float:
    """Return e to the power of `value`, less 1, also where that is small."""
    if abs(value) > 0.34:
        return exponential(value) - 1.0
    return powers_of_two(value)[1]


@part
def logarithm(value: float) -> float:
    """Return the natural logarithm of a finite `value`, minus infinity for 0."""
    if value <= 0.0:
        return -np.inf if value == 0.0 else np.nan
    mantissa, k = math.frexp(value)
    if mantissa < 0.7071067811865476:
        mantissa, k = 2.0 * mantissa, k - 1
    q = (mantissa - 1.0) / (mantissa + 1.0)
    s = q * q
    series = s * (1.0 / 17.0 + s * (1.0 / 19.0 + s * (1.0 / 21.0 + s * (1.0 / 23.0))))
    series = s * (1.0 / 11.0 + s * (1.0 / 13.0 + s * (1.0 / 15.0 + series)))
    series = s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0 + s * (1.0 / 9.0 + series))))
    return k * DOUBLING[0] + (k * DOUBLING[1] + (2.0 * q + 2.0 * q * series))


@part
def hyperbolic_tangent(value: float) -> float:
    """Return the hyperbolic tangent of a finite `value`."""
    grown = growth(-2.0 * abs(value))
    tangent = -grown / (grown + 2.0)
    return -tangent if value < 0.0 else tangent


@part
def whole_power(base: float, exponent: float) -> float:
    """Return `base` to the power of a whole `exponent` of at least 0."""
    power, left = 1.0, exponent
    while left > 0.0:
        if left % 2.0 == 1.0:
            power *= base
        base *= base
        left = np.floor(0.5 * left)
    return power


@kernel
def fill_exponentials(values: Floats, results: Floats) -> None:
    """Fill `results` (M,) with the exponentials of `values` (M,)."""
    for index in range(len(values)):
        results[index] = exponential(values[index])


@kernel
def fill_logarithms(values: Floats, results: Floats) -> None:
    """Fill `results` (M,) with the logarithms of `values` (M,)."""
    for index in range(len(values)):
        results[index] = logarithm(values[index])


@kernel
def fill_unit_vectors(angles: Floats, cosines: Floats, sines: Floats) -> None:
    """Fill cosines and sines (M,) of `angles` (M,) [rad]."""
    for index in range(len(angles)):
        sines[index], cosines[index] = sine_cosine(angles[index])


@kernel
def directions(vectors: Floats) -> Floats:
    """Return the angles (M,) [rad] in [-pi, pi] of `vectors` (M, 2)."""
    angles = np.empty(len(vectors))
    for index in range(len(vectors)):
        angles[index] = direction(vectors[index, 1], vectors[index, 0])
    return angles


def unit_vectors(angles: Floats) -> tuple[Floats, Floats]:
    """Return cosines and sines (M,) of `angles` (M,) [rad]."""
    cosines, sines = np.empty(len(angles)), np.empty(len(angles))
    fill_unit_vectors(np.ascontiguousarray(angles, dtype=np.float64), cosines, sines)
    return cosines, sines


def exponentials(values: Floats) -> Floats:
    """Return the exponentials of an array of any shape."""
    return filled(fill_exponentials, values)


def logarithms(values: Floats) -> Floats:
    """Return the natural logarithms of an array of any shape."""
    return filled(fill_logarithms, values)


def filled(fill: Callable[[Floats, Floats], None], values: Floats) -> Floats:
    """Return what `fill` writes for an array of any shape."""
    given = np.ascontiguousarray(values, dtype=np.float64)
    results = np.empty_like(given)
    fill(given.reshape(-1), results.reshape(-1))
    return results
