"""Records: compiled code gets the fields that were packed, by name, and writes into the same memory."""

import copy
import gc
import os
import pickle
import subprocess
import sys
import weakref
from types import GenericAlias
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from selforg.arrays import KEPT, Flags, Floats, Ints, Links
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, numba_type, opening
from tests.paths import ROOT


class Sample(NamedTuple):
    places: Annotated[Floats, "N 2", KEPT]
    counts: Annotated[Ints, "N", KEPT]
    links: Annotated[Links, "N 2", KEPT]
    flags: Annotated[Flags, "N", KEPT]
    factor: float
    offset: int


class Other(NamedTuple):
    places: Annotated[Floats, "N 2", KEPT]


open_sample, open_other = opening(Sample), opening(Other)


def test_arrays_are_understood_in_the_hints_of_all_versions_of_numpy():
    alias = GenericAlias(type("NDArray", (), {}), (np.int32,))  # NumPy 2.5 and Python 3.12: a name for ndarray[...]
    assert numba_type(Annotated[alias, "N 2"], "links") == numba_type(Annotated[Links, "N 2", KEPT], "links")


@lean_kernel
def look_and_write(words: Handle[Sample], row: int) -> int:
    s = open_sample(words)
    s.places[row, 1] = s.factor * s.counts[row] + s.offset
    s.links[row, 0] = s.places.shape[0]
    s.flags[row] = True
    return s.places.shape[1] + s.links[row, 1]


def sample() -> Sample:
    return Sample(
        places=np.zeros((3, 2)),
        counts=np.arange(3),
        links=np.full((3, 2), 4, dtype=np.int32),
        flags=np.zeros(3, dtype=np.bool_),
        factor=2.5,
        offset=-7,
    )


def test_compiled_code_reads_and_writes_the_arrays_of_a_record():
    packed = Packed(sample())
    assert [look_and_write(packed.handle, row) for row in range(3)] == [6, 6, 6]
    assert packed.record.places[:, 1].tolist() == [-7.0, -4.5, -2.0]
    assert packed.record.links.tolist() == [[3, 4]] * 3
    assert packed.record.flags.all()


@pytest.mark.parametrize(
    ("field", "wrong"),
    [
        ("places", np.zeros((2, 3)).T),
        ("places", np.zeros(3)),
        ("places", np.zeros((3, 3))),
        ("counts", np.zeros(3)),
        ("links", np.zeros((2, 3), dtype=np.int64)),
        ("flags", None),
    ],
)
def test_a_field_that_compiled_code_would_misread_is_refused_by_name(field, wrong):
    with pytest.raises(TypeError, match=rf"Sample\.{field}: expected a C-contiguous"):
        Packed(sample()._replace(**{field: wrong}))


def test_a_record_of_another_class_is_refused():
    with pytest.raises(TypeError, match="expected a Sample, got Other"):
        Packed(sample()).replace(Other(np.zeros((3, 2))))


def test_words_keep_the_arrays_alive():
    given = sample()
    kept = weakref.ref(given.counts)
    words = Packed(given).handle
    del given
    gc.collect()
    assert kept() is not None
    assert look_and_write(words, 2) == 6


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda packed: pickle.loads(pickle.dumps(packed))])
def test_a_copy_works_on_arrays_of_its_own(copied):
    original = Packed(sample())
    twin: Packed[Sample] = copied(original)
    look_and_write(twin.handle, 1)
    assert twin.record.places[1, 1] == -4.5
    assert not original.record.places.any()
    del original
    gc.collect()
    assert look_and_write(twin.handle, 2) == 6


def test_owner_and_record_share_their_arrays_in_a_copy_too():
    given = sample()
    owner = {"places": given.places, "packed": Packed(given)}
    twin = copy.deepcopy(owner)
    look_and_write(twin["packed"].handle, 1)
    assert twin["places"][1, 1] == -4.5


SWITCHED = """
from tests.selforg.compiler.test_records import Other, Packed, look_and_write, np, sample
packed = Packed(sample())
print([int(look_and_write(packed.handle, row)) for row in range(3)], packed.record.places[:, 1])
try:
    print(look_and_write(Packed(Other(np.zeros((3, 2)))).handle, 1))
except Exception as error:
    print(type(error).__name__)
"""


@pytest.mark.parametrize(
    ("switch", "refused"),
    [
        ("CLEAN_SWARM_CHECK_RECORDS", "TypeError"),
        ("CLEAN_SWARM_PLAIN_NUMBA", "TypingError"),
        ("NUMBA_DISABLE_JIT", "AttributeError"),
    ],
)
def test_under_each_switch_a_kernel_gives_the_same_numbers_and_refuses_another_record(switch, refused):
    done = subprocess.run(
        [sys.executable, "-c", SWITCHED], cwd=ROOT, env={**os.environ, switch: "1"}, capture_output=True, text=True
    )
    assert done.stdout.splitlines() == ["[6, 6, 6] [-7.  -4.5 -2. ]", refused], done.stderr
