"""Small rules of the original's buffer, by their numbers in docs/quirks.md."""

import numpy as np
import pytest

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import ATTRACTIVE, EVERYTHING, REPULSIVE, Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.space import Euclidean
from tests.selforg.worlds import set_pose

FAR = Filter(view_distance=np.inf)


def make_buffer(**settings):
    space = Euclidean(2)
    return SoBuffer(BufferSettings(**settings), space, OwnPoses(space, 1))


@pytest.mark.parametrize(("signs", "seen"), [(EVERYTHING, 2), (ATTRACTIVE, 0), (REPULSIVE, 0)])
def test_b1_without_own_pose_an_infinite_view_shows_gradients_of_all_signs_or_none(signs, seen):
    buffer = make_buffer()
    for sign in (-1, 1):
        buffer.store_static(0, "f", [[1.0, float(sign)]], 0.0, attraction=sign)
    queries = Queries(buffer)
    assert len(queries.gradients(0, 0.0, FAR, signs=signs)) == seen
    set_pose(buffer.poses, 0, (0.0, 0.0), (1.0, 0.0), 0.0)
    assert len(queries.gradients(0, 0.0, FAR, signs=signs)) == max(seen, 1)


@pytest.mark.parametrize(("channel", "left"), [("robot", 0.5), ("other", 0.5), (None, 0.25)])
def test_b2_storing_an_own_pose_evaporates_by_whole_seconds_like_any_storing(channel, left):
    # whole seconds: 2 s hold one period of 1.5 s, and the 1.5 s that are left at 3 s none; 3 s at once hold two
    buffer = make_buffer(whole_seconds=True)
    buffer.store_static(0, "f", [[1.0, 0.0]], 0.0, evaporation_factor=0.5, evaporation_period=1.5)
    if channel:
        buffer.receive(Gradient(channel, (0.0, 0.0), source=0, stamp=2.0, moving=True), 2.0, row=0)
    assert [g.diffusion for g in Queries(buffer).gradients(0, 3.0, Filter(("f",), view_distance=np.inf))] == [left]


@pytest.mark.parametrize("whole_seconds", [False, True])
def test_b3_a_factor_of_zero_ends_an_infinite_diffusion(whole_seconds):
    buffer = make_buffer(whole_seconds=whole_seconds)
    fading = {"diffusion": np.inf, "evaporation_period": 1.0}
    buffer.store_static(0, "ends", [[1.0, 0.0]], 0.0, evaporation_factor=0.0, **fading)
    buffer.store_static(0, "stays", [[2.0, 0.0]], 0.0, evaporation_factor=0.5, **fading)
    queries = Queries(buffer)
    assert [g.diffusion for g in queries.gradients(0, 0.9, FAR)] == [np.inf, np.inf]
    assert [(g.channel, g.diffusion) for g in queries.gradients(0, 2.0, FAR)] == [("stays", np.inf)]
    assert [g.diffusion for g in queries.gradients(0, 2000.0, FAR)] == [np.inf]  # 0.5 ** 2000 is 0
    buffer.evaporate(2000.0)
    assert len(buffer) == 1


def test_b8_the_clock_of_what_arrives_late_goes_on_whatever_its_factor_and_then_rests_at_a_factor_of_one():
    buffer = make_buffer(whole_seconds=True)
    for moving in (False, True):
        late = Gradient("f", (1.0, 0.0), evaporation_factor=1.0, evaporation_period=1.0, stamp=2.0, moving=moving)
        buffer.store(late, 4.5)
    found = Queries(buffer).gradients(0, 9.0, FAR)
    assert [(g.clock, g.stamp, g.diffusion) for g in found] == [(4.0, 2.0, 1.0)] * 2
