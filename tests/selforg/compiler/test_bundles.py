"""Bundles: compiled code gets the arrays and numbers that were put in, and writes into the same memory."""

import weakref

import numpy as np
import pytest

from selforg.compiler.bundles import Layout
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.switches import COMPILED

LAYOUT = Layout("f2", "i1", "l2", "b1", "number", "whole")
entries_of = LAYOUT.unbundle


@lean_kernel
def look_and_write(bundle, row):
    places, counts, links, flags, factor, offset = entries_of(bundle)
    places[row, 1] = factor * counts[row] + offset
    links[row, 0] = places.shape[0]
    flags[row] = True
    return places.shape[1] + links[row, 1]


def entries():
    return (
        np.zeros((3, 2)), np.arange(3), np.full((3, 2), 4, dtype=np.int32), np.zeros(3, dtype=np.bool_), 2.5, -7,
    )  # fmt: skip


def test_compiled_code_reads_and_writes_the_arrays_of_a_bundle():
    places, counts, links, flags, factor, offset = entries()
    bundle = LAYOUT.bundle(places, counts, links, flags, factor, offset)
    assert [look_and_write(bundle, row) for row in range(3)] == [6, 6, 6]
    assert places[:, 1].tolist() == [-7.0, -4.5, -2.0]
    assert links.tolist() == [[3, 4]] * 3
    assert flags.all()


@pytest.mark.skipif(not COMPILED, reason="where nothing is compiled a bundle is what it is made of")
@pytest.mark.parametrize(
    ("number", "wrong"),
    [(0, np.zeros((2, 3)).T), (0, np.zeros(3)), (1, np.zeros(3)), (2, np.zeros((3, 2), dtype=np.int64)), (3, None)],
)
def test_what_compiled_code_would_misread_is_refused(number, wrong):
    given = list(entries())
    given[number] = wrong
    with pytest.raises(TypeError, match=f"entry {number}: expected a C-contiguous"):
        LAYOUT.bundle(*given)


@pytest.mark.skipif(not COMPILED, reason="where nothing is compiled a bundle is what it is made of")
def test_a_bundle_has_all_entries():
    with pytest.raises(TypeError, match="expected 6 entries, got 5"):
        LAYOUT.bundle(*entries()[:5])


def test_a_bundle_keeps_its_arrays():
    kept = weakref.ref(counts := np.arange(3))
    given = list(entries())
    given[1] = counts
    bundle = LAYOUT.bundle(*given)
    del counts, given
    assert kept() is not None
    assert look_and_write(bundle, 2) == 6
    del bundle
    assert kept() is None
