"""What classes declare about their arrays, and the walk that finds it."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
import pytest

from selforg.arrays import CLOCKED, KEPT, OUTSIDE, READ, SCRATCH, Flags, Floats, Ints, Within, derived
from selforg.compiler.records import Recording
from selforg.declared import fields_of, make_arrays, walk
from selforg.mechanisms import MECHANISMS
from tests.selforg.worlds import build, world_of


class Flock:
    """Arrays of W worlds."""

    places: Annotated[Floats, "W sheep 2", KEPT]
    nearest: Annotated[Ints, "W sheep", KEPT, Within(-1, "robots")]
    distances: Annotated[Floats, "W sheep robots", SCRATCH]
    chances: Annotated[list[np.random.Generator], "W", KEPT]
    ring: Annotated[Floats, "2", READ]
    owner: Annotated[object, OUTSIDE]

    def __init__(self) -> None:
        make_arrays(self, W=2, sheep=3, robots=4)
        self.chances = [np.random.default_rng(world) for world in range(2)]
        self.ring = np.ones(2)
        self.owner = np.ones(2)


class Black(Flock):
    """With an array more, and one that was forgotten."""

    left_at: Annotated[Floats, "W sheep", CLOCKED]
    grouped: Annotated[Flags, "1", derived(False)]

    def __init__(self) -> None:
        super().__init__()
        self.names = ["dolly"]
        self.forgotten = {"somewhere": [np.zeros(3)]}
        self.part = self.places[0]


def test_all_arrays_but_those_that_are_read_are_made_of_zeros():
    flock = Black()
    assert {name: getattr(flock, name).shape for name in ("places", "nearest", "distances", "left_at", "grouped")} == {
        "places": (2, 3, 2),
        "nearest": (2, 3),
        "distances": (2, 3, 4),
        "left_at": (2, 3),
        "grouped": (1,),
    }
    assert (flock.nearest.dtype, flock.grouped.dtype) == (np.int64, np.bool_)


def test_fields_of_bases_are_declared_too():
    assert list(fields_of(Black)) == [*fields_of(Flock), "left_at", "grouped"]
    assert fields_of(Black)["nearest"].bounds == Within(-1, "robots")


def test_what_is_kept_is_found_once_wherever_it_hangs():
    flock = Black()
    found = walk({"first": [flock], "second": (flock, flock.places)})
    below = "first.0."
    assert sorted(found.kept) == sorted(below + name for name in ("places", "nearest", "chances", "left_at", "grouped"))
    assert found.kept[below + "nearest"].limit == 4


def test_a_forgotten_array_is_named_and_parts_of_declared_ones_are_none():
    assert walk(Black()).forgotten == ["forgotten.somewhere.0"]


def test_a_random_generator_is_declared_too():
    flock = Flock()
    flock.luck = np.random.default_rng(0)
    assert walk(flock).forgotten == ["luck"]


def test_a_record_without_marks_is_refused():
    class Unmarked(NamedTuple):
        places: Annotated[Floats, "N 2"]

    with pytest.raises(TypeError, match=r"^Unmarked.places: expected Annotated\[ARRAY, 'AXES', MARK\], got"):
        Recording(Unmarked)


@pytest.mark.parametrize("name", MECHANISMS.names())
def test_no_mechanism_forgets_an_array(name):
    mechanism = build(name, world_of())
    if hasattr(mechanism, "move"):
        mechanism.move(1.0)
    assert walk({"mechanism": mechanism}).forgotten == []
