"""The buffer against a naive model of the storing rules, on random sequences."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.space import Euclidean, Torus
from tests.selforg.gradients.objects import histories, neighbours

EVERYTHING = Filter(view_distance=np.inf)


class NaiveBuffer:
    """The static rules max, min and new, and exact evaporation, in the plainest words."""

    def __init__(self, rule, distance, space):
        self.rule, self.distance, self.space, self.stored = rule, distance, space, []

    def diffusion(self, g, now):
        if g.evaporation_factor == 1.0:
            return g.diffusion
        if g.evaporation_period == 0.0:
            return 0.0
        periods = np.floor((now - g.stamp) / g.evaporation_period)
        return g.diffusion * g.evaporation_factor**periods

    def prune(self, now):
        self.stored = [g for g in self.stored if g.goal_radius > 0 or self.diffusion(g, now) >= 0.1]

    def store(self, g, now):
        self.prune(now)
        distances = [
            np.linalg.norm(self.space.offsets(np.array(g.position), np.array(o.position))) for o in self.stored
        ]
        nearest = int(np.argmin(distances)) if distances else -1
        if nearest < 0 or distances[nearest] > self.distance:
            self.stored.append(g)
            return
        old = self.stored[nearest]
        reach, other = self.diffusion(g, now) + g.goal_radius, self.diffusion(old, now) + old.goal_radius
        if {"max": reach >= other, "min": reach <= other, "new": g.stamp >= old.stamp}[self.rule]:
            del self.stored[nearest]
            self.stored.append(g)

    def answer(self, now):
        self.prune(now)
        return sorted((*g.position, self.diffusion(g, now), g.goal_radius) for g in self.stored)


messages = st.tuples(
    st.integers(0, 43), st.integers(0, 27), st.sampled_from([0.05, 0.5, 1.0, 2.0, 4.0]), st.sampled_from([0.0, 0.5]),
    st.sampled_from([1.0, 0.9, 0.5, 0.0]), st.sampled_from([0.0, 0.5, 1.0, 3.0]), st.integers(0, 8),
)  # fmt: skip


@settings(max_examples=150)
@given(st.sampled_from(["max", "min", "new"]), st.sampled_from([0.0, 0.3, 1.0]), st.booleans(), st.lists(messages))
def test_random_sequences_agree_with_the_naive_buffer(rule, distance, torus, sequence):
    space = Torus(11.0, 7.0) if torus else Euclidean(2)
    poses = OwnPoses(space, 1)
    buffer = SoBuffer(BufferSettings(aggregation={"DEFAULT": rule}, aggregation_distance=distance), space, poses)
    naive, now = NaiveBuffer(rule, distance, space), 0.0
    for x, y, diffusion, goal, factor, period, pause in sequence:
        now += pause * 0.25
        # jittered so that no two are equally near
        position = (x * 0.25 + 0.0001 * y, y * 0.25 + 0.00003 * x)
        g = Gradient("f", position, diffusion=diffusion, goal_radius=goal, evaporation_factor=factor,
                     evaporation_period=period, stamp=now)  # fmt: skip
        buffer.store(g, now)
        naive.store(g, now)
    for later in (0.0, 1.0, 7.3):
        found = Queries(buffer).gradients(0, now + later, EVERYTHING)
        mine = sorted((*g.position, g.diffusion, g.goal_radius) for g in found)
        np.testing.assert_allclose(mine, naive.answer(now + later), atol=1e-12)


def buffer_of(rows=1, space=None, teams=None, **settings):
    """Return a buffer of robots at the middle of a torus."""
    space = space or Torus(11.0, 11.0)
    buffer = SoBuffer(BufferSettings(**settings), space, OwnPoses(space, rows, teams))
    buffer.poses.update(np.full((rows, 2), 5.0), None, 0.0)
    return buffer


def test_when_it_is_looked_at_does_not_change_what_is_left():
    positions = np.random.default_rng(0).random((200, 2)) * 7
    lazy, eager = (buffer_of(space=Torus(11.0, 7.0)) for _ in range(2))
    for buffer in (lazy, eager):
        buffer.store_static(
            0, "f", positions, 0.0, diffusion=positions.sum(axis=1), evaporation_factor=0.9, evaporation_period=0.3
        )
    for tick in range(100):
        eager.evaporate(tick * 0.1)
    one, other = (
        sorted((g.position, g.diffusion, g.clock) for g in Queries(b).gradients(0, 9.9, EVERYTHING))
        for b in (lazy, eager)
    )
    assert one == other
    assert len(one) > 0


@pytest.mark.parametrize(("moving", "view", "period"), [(False, 2.0, 2.0), (True, np.inf, 0.5)])
def test_who_has_looked_before_changes_neither_what_is_seen_nor_its_order(moving, view, period):
    seen = []
    for looked_at in (False, True):
        rng, answers, settings = np.random.default_rng(5), [], {"aggregation_distance": 0.3, "moving_storage_size": 3}
        buffer = buffer_of(**settings)
        for tick in range(300):
            now = 0.2 * tick
            for factor in rng.choice([0.0, 0.5, 0.9, 1.0], 2):
                stamp, place, source = now - rng.choice([0.0, 0.6]), tuple(rng.random(2) * 11), "abc"[rng.integers(3)]
                fades = {"evaporation_factor": factor, "evaporation_period": period}
                buffer.store(Gradient("f", place, source=source, stamp=stamp, moving=moving, **fades), now)
            if looked_at and tick % 3 == 0:
                buffer.evaporate(now)
            if tick % 20 == 19:
                query, look = Queries(buffer), Filter(view_distance=view)
                answers += [query.gather(now, look=look, histories=all_of).pairs[:, :7] for all_of in (False, True)]
                state, buffer = buffer.part_of(0), buffer_of(**settings)
                buffer.put_part(0, state, 0.0)
        seen.append(answers)
    for one, other in zip(*seen, strict=True):
        np.testing.assert_array_equal(one, other)
    assert sum(map(len, seen[0])) > 50


def test_growing_keeps_everything_and_the_order_within_cells():
    small, large = (buffer_of(aggregation_distance=0.0) for _ in range(2))
    positions = np.random.default_rng(1).random((1000, 2)) * 11
    large.table.reserve(4000)
    for buffer in (small, large):
        buffer.store_static(0, "f", positions, 0.0)
    one, other = (Queries(b).gather(0.0).pairs[:, :7] for b in (small, large))
    np.testing.assert_array_equal(one, other)
    assert len(small) == 1000


def test_moving_neighbours_together_in_place_is_moving_them_to_new_tables(monkeypatch):
    seen = []
    for in_place in (False, True):
        monkeypatch.setattr("selforg.gradients.store.tables.SECOND_COPY", 0 if in_place else 1 << 18)
        monkeypatch.setattr("selforg.gradients.store.tables.SMALLEST_UNSORTED", 100)
        buffer = buffer_of(aggregation_distance=0.3)
        buffer.table.reserve(2000)
        rng = np.random.default_rng(1)
        for tick in range(100):
            buffer.store_static(0, "f", rng.random((10, 2)) * 11, 0.1 * tick)
        seen.append(Queries(buffer).gather(10.0).pairs)
    np.testing.assert_array_equal(*seen)
    assert len(seen[0]) > 10


def test_evaporated_gradients_are_freed_without_being_looked_at():
    buffer, rng = buffer_of(aggregation_distance=0.0), np.random.default_rng(1)
    for tick in range(2000):
        buffer.store_static(0, "f", rng.random((5, 2)) * 11, tick * 0.2, evaporation_factor=0.5, evaporation_period=1.0)
    assert len(buffer) < 300  # alive: 4 s * 25 a second = 100


def test_extinguishing_needs_the_rule_new_and_takes_the_nearest():
    buffer = buffer_of(rows=2, teams=[0, 1], aggregation={"g": "new"}, aggregation_distance=0.1)
    for team in (0, 1):
        buffer.store_static(team, "g", [[1.0, 1.0], [2.0, 2.0]], 0.0)
    buffer.extinguish(0, "g", [[2.0, 2.0]], 1.0)
    buffer.extinguish(0, "g", [[7.0, 7.0]], 1.0)  # nothing there
    assert (buffer.count(0, "g"), buffer.count(1, "g")) == (1, 2)
    with pytest.raises(ValueError, match="must aggregate by 'new'"):
        buffer.extinguish(0, "other", [[2.0, 2.0]], 1.0)


def test_clearing_one_team_leaves_the_others():
    buffer = buffer_of(rows=2, teams=[0, 1], aggregation_distance=0.0)
    for team in (0, 1):
        buffer.store_static(team, "g", np.random.default_rng(team).random((100, 2)), 0.0)
    before = Queries(buffer).gradients(1, 0.0, EVERYTHING)
    buffer.clear(0)
    assert buffer.count(0, "g") == 0
    assert Queries(buffer).gradients(1, 0.0, EVERYTHING) == before


def test_moving_gradients_keep_a_history_of_newer_ones_only():
    buffer = buffer_of(space=Euclidean(2), moving_storage_size=3)
    for stamp in (1.0, 2.0, 2.0, 1.5, 3.0, 4.0):
        buffer.store(Gradient("f", (stamp, 0.0), source="x", stamp=stamp, moving=True), 4.0)
    assert [g.stamp for g in histories(buffer, 4.0, EVERYTHING)] == [2.0, 3.0, 4.0]
    (newest,) = neighbours(buffer, 4.0, EVERYTHING)
    assert newest.stamp == 4.0


def test_payloads_of_gradients_that_are_gone_are_forgotten():
    buffer = buffer_of(space=Euclidean(2))
    for stamp in range(5000):
        buffer.store(Gradient("f", (0.0, 0.0), source="x", stamp=stamp, moving=True, payload={"n": stamp}), stamp)
    assert len(buffer.payloads) < 2000
    assert [g.payload["n"] for g in Queries(buffer).gradients(0, 5000.0, EVERYTHING)] == [4999]


def test_a_gradient_lies_in_memory_where_the_one_lay_that_it_replaces():
    buffer = buffer_of(space=Euclidean(2), aggregation_distance=0.1)
    for x in (1.0, 2.0, 3.0):
        buffer.store_static(0, "trail", [[x, 0.0]], 0.0)
    buffer.store_static(0, "trail", [[2.05, 0.0]], 1.0)
    assert buffer.table.record.near[:3, 0].tolist() == [1.0, 2.05, 3.0]
