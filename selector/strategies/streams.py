"""Random numbers of decisions by a counter-based generator: a row draws the same numbers alone and in a batch.

The numbers are a function of the key of a row and the number of its decision (Philox4x32-10; Salmon et al. 2011,
doi:10.1145/2063384.2063405). Compiled code computes the deviates of other distributions one by one, because array
functions may round differently in batches of different sizes (docs/decisions/0029-decision-randomness.md).
"""

import numpy as np
import numpy.typing as npt

from selforg.arrays import Floats
from selforg.compiler.decorators import kernel
from selforg.elementary import growth, logarithm, sine_cosine

Keys = npt.NDArray[np.uint64]
Word = np.uint64

ROUNDS = 10
LOW, SHIFT = np.uint64(0xFFFFFFFF), np.uint64(32)
FIRST_FACTOR, SECOND_FACTOR = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
FIRST_STEP, SECOND_STEP = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
FINE_SHIFT, COARSE_SHIFT, ONE, NONE = np.uint64(5), np.uint64(6), np.uint64(1), np.uint64(0)
TWO_26, TWO_53 = 67108864.0, 9007199254740992.0


def row_keys(seed: np.random.SeedSequence, rows: int) -> Keys:
    """Return a key (rows,) for each row; the key of row k does not depend on how many rows there are."""
    return seed.generate_state(rows, np.uint64).astype(np.uint64)


def uniforms(keys: Keys, counters: Keys, count: int) -> Floats:
    """Return `count` numbers in [0, 1) for each key (K,) and number of its decision (K,): (K, count)."""
    drawn = np.empty((keys.shape[0], count))
    fill_uniforms(keys, counters, drawn)
    return drawn


@kernel
def philox(c0: Word, c1: Word, c2: Word, c3: Word, k0: Word, k1: Word) -> tuple[Word, Word, Word, Word]:
    """Return four random words of 32 bits for a counter of four words and a key of two."""
    for _ in range(ROUNDS):
        first, second = FIRST_FACTOR * c0, SECOND_FACTOR * c2
        c0, c1, c2, c3 = (second >> SHIFT) ^ c1 ^ k0, second & LOW, (first >> SHIFT) ^ c3 ^ k1, first & LOW
        k0, k1 = (k0 + FIRST_STEP) & LOW, (k1 + SECOND_STEP) & LOW
    return c0, c1, c2, c3


@kernel
def fill_uniforms(keys: Keys, counters: Keys, drawn: Floats) -> None:
    """Fill `drawn` (K, count); a block of four words gives two numbers of 53 bits."""
    count = drawn.shape[1]
    for k in range(keys.shape[0]):
        k0, k1 = keys[k] & LOW, keys[k] >> SHIFT
        c1, c2 = counters[k] & LOW, counters[k] >> SHIFT
        block = NONE
        for start in range(0, count, 2):
            a, b, c, d = philox(block, c1, c2, NONE, k0, k1)
            drawn[k, start] = (float(a >> FINE_SHIFT) * TWO_26 + float(b >> COARSE_SHIFT)) / TWO_53
            if start + 1 < count:
                drawn[k, start + 1] = (float(c >> FINE_SHIFT) * TWO_26 + float(d >> COARSE_SHIFT)) / TWO_53
            block += ONE


@kernel
def normals(draws: Floats, deviates: Floats) -> None:
    """Fill `deviates` (K, O) with standard normal deviates from uniform `draws` (K, 2 O), by Box and Muller."""
    for k in range(deviates.shape[0]):
        for o in range(deviates.shape[1]):
            radius = np.sqrt(-2.0 * logarithm(1.0 - draws[k, 2 * o]))
            deviates[k, o] = radius * sine_cosine(2.0 * np.pi * draws[k, 2 * o + 1])[1]


@kernel
def student_t(draws: Floats, freedom: Floats, deviates: Floats) -> None:
    """Fill `deviates` (K, O) with Student's t of `freedom` (K, O) degrees from uniform `draws` (K, 2 O).

    Polar method of Bailey (1994), doi:10.1090/S0025-5718-1994-1219702-8, without rejection: two numbers give a deviate.
    """
    for k in range(deviates.shape[0]):
        for o in range(deviates.shape[1]):
            degrees = freedom[k, o]
            radius = np.sqrt(degrees * growth(-2.0 / degrees * logarithm(1.0 - draws[k, 2 * o])))
            deviates[k, o] = radius * sine_cosine(2.0 * np.pi * draws[k, 2 * o + 1])[1]
