"""Contract of every registered observation term; a user's own terms join by being registered."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.around import open_around
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.term import TERMS, Term
from clean_swarm_env.testing import check_term
from selforg.compiler.decorators import kernel
from tests.clean_swarm_env.courses import begun, mission

CROWD = mission(robots={"count": 12}, garbage={"count": 30})


@TERMS.register
class Eastness(Term):
    """How far east on the torus the robot is, times `factor`."""

    name = "eastness"
    components = ("eastness",)

    def __init__(self, observed, *, factor=1.0):
        super().__init__(observed)
        self.factor = factor

    def write(self, rows, out):
        around = self.observed.around.record
        out[0] = self.factor * around.positions[:, 0] / around.extent[0]


@TERMS.register
class Alone(Term):
    """Whether no other robot is nearer than half of the largest range, by a kernel of the user's own."""

    name = "alone"
    components = ("alone", "not_alone")

    def write(self, rows, out):
        write_alone(self.observed.around.handle, rows, out)


@kernel
def write_alone(around, rows, out):
    a = open_around(around)
    for row in rows:
        out[0 if a.neighbour[row] < 0 else 1, row] = 1.0


def batch_of(*terms, worlds=2, config=CROWD):
    return Batch(config, worlds, observation=ObservationConfig(terms=terms, full_crowd=2))


def course(batch, periods=25):
    """Yield the observations of each period."""
    options = np.random.default_rng(3).integers(0, 3, (periods, batch.rows))
    yield batch.reset(list(range(batch.worlds.worlds)))
    for chosen in options:
        yield batch.step(chosen).observations


LUCK = np.random.default_rng(1)
"""Random numbers that no seed decides, for classes that break their promises."""
SLOW = {"loads": pytest.mark.long}
"""Terms that are zero for long in a mission of one station."""
OF_OTHER_TASKS = ("command", "things", "facts")
"""Terms without a meaning where robots clean; `task` is in tests/clean_swarm_env/tasks/test_thing_terms.py."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW.get(name, ())) for name in TERMS.names() if name != "task"]
)
def test_a_term_keeps_its_contract(name):
    check_term(TERMS.find(name), **({"mission": {"task": "Foraging"}} if name in OF_OTHER_TASKS else {}))


def of_the_world(self, rows, out):
    out[0, rows] = rows / (1.0 + rows.max(initial=0))


@pytest.mark.parametrize(
    ("write", "said"),
    [
        (lambda self, rows, out: out[0].fill(np.nan), "finite numbers|NaN"),
        (lambda self, rows, out: out[0].fill(7.0), r"mine.write: expected components within \[-1, 1\], got 7"),
        (lambda self, rows, out: None, "expected something else than zeros in 300 periods"),
        (lambda self, rows, out: out[0, rows].__iadd__(1) is rows.fill(0), "to change no array that it reads"),
        (
            lambda self, rows, out: out.__setitem__((0, rows), LUCK.random(len(rows))),
            "the same beside other terms",
        ),
        (of_the_world, "rows in another order|in a world alone"),
        (lambda self, rows, out: self.nothing, "AttributeError: 'mine' object has no attribute 'nothing'"),
        (lambda self, rows, out: out[:, rows].__add__(np.zeros(5)), "ValueError: operands could not be broadcast"),
    ],
)
def test_a_term_that_breaks_its_contract_is_one_line(write, said, monkeypatch):
    members = {"name": "mine", "components": ("mine",), "write": write, "__doc__": "Mine.", "__module__": __name__}
    monkeypatch.setattr(TERMS, "_classes", dict(TERMS._classes))
    cls = TERMS.register(type("mine", (Term,), members))
    with pytest.raises(ValueError, match=said) as raised:
        check_term(cls)
    assert "\n" not in str(raised.value)


def test_a_term_of_the_users_own_takes_settings_of_its_own():
    batch = Batch(observation=ObservationConfig(terms=["cargo", {"name": "eastness", "factor": 0.5, "weight": 2.0}]))
    seen = batch.reset([1])
    assert batch.observer.names == ("carrying", "recycled", "eastness")
    np.testing.assert_allclose(seen[:, 2], batch.worlds.physics.positions[:, 0] / 11.0, rtol=1e-6)


def test_finds_are_none_apart_or_together():
    nothing = {"base": "exploring", "task": {"garbage": {"count": 0, "respawn": 0.001}}}
    batch = Batch(nothing, observation=ObservationConfig(terms=["finds", "recent_finds"]))
    flags = batch.reset([1]).copy()
    assert (flags == [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]).all()
    pheromones, now = batch.worlds.minds.buffers["pheromones"], batch.worlds.now
    told = []
    for number, (x, y) in enumerate([(29.5, 3.0), (15.0, 15.0), (0.4, 3.2), (29.9, 4.5), (7.0, 9.0), (29.9, 2.0)]):
        told.append((x, y))
        place = np.array([[x, y]])
        for channel in ("find", "recent find"):  # the latest reaches farthest
            pheromones.store_static(0, channel, place, now, diffusion=1.0 + 0.01 * number)
        flags = batch.step(np.zeros((batch.rows, 2), np.int64)).observations
        ways = np.abs(np.array(told) - told[-1])
        near = np.hypot(*np.minimum(ways, 30.0 - ways).T) <= 2.0
        together = near[:-1].sum() >= 0.5 * (len(told) - 1)
        one = len(told) == 1
        expected = [0.0, not together, together, 0.0, one, together and not one, not together]
        assert (flags == expected).all(), told
        now = batch.worlds.now


def test_robots_are_numbered_by_the_room_of_their_team():
    batch = Batch(mission(robots={"count": 3, "capacity": 4}), observation=ObservationConfig(terms=["identity"]))
    assert batch.reset([1])[:, 0].tolist() == [0.0, 0.25, 0.5, 0.0]  # the last one is not there


def test_yards_tell_whether_stations_of_the_kind_wanted_next_stand_together():
    stations = {"recycling": [0.5, 3.0], "further_recycling": [[10.5, 3.0]], "dump": [8.0, 8.0]}
    stations |= {"further_dumps": [[8.0, 5.9]]}
    nothing = mission(stations=stations, garbage={"count": 1}, robots={"count": 2})
    batch = begun(Batch(nothing, observation=ObservationConfig(terms=["yards"])), [1])
    batch.worlds.task.garbage.recycled[1] = 1
    seen = np.zeros((2, 2), dtype=np.float32)
    batch.observer.observe(seen)
    assert seen.tolist() == [[1.0, 0.0], [0.0, 1.0]]
    batch.worlds.task.stations[0, 1] = 8.0, 7.8
    batch.observer.observe(seen)
    assert seen.tolist() == [[1.0, 0.0], [1.0, 0.0]]


@pytest.mark.parametrize(("consequences", "flag"), [({"stop": 2.0, "back_off": 3.0}, 2), ({}, 1)])
def test_a_robot_remembers_for_two_minutes_that_it_collided_and_whether_that_stopped_it(consequences, flag):
    meeting = mission(robots={"count": 2}, garbage={"count": 0, "respawn": 0.001}, consequences=consequences)
    batch = Batch(meeting, observation=ObservationConfig(terms=["stops"]), action={"mode": "velocity"})
    start = StartConfiguration(id="meeting", robots=[[4.0, 3.0, 0.0], [6.0, 3.0, np.pi]])
    assert batch.reset([1], [start]).tolist() == [[1.0, 0.0, 0.0, 0.0, 0.0]] * 2
    towards, still = np.array([[1.0, 0.0], [1.0, 0.0]]), np.zeros((2, 2))
    collided, stopped, seen = np.zeros(2), np.zeros(2), [batch.observations.copy()]
    for period in range(140):
        told, held = batch.get_state(), np.zeros(2)
        for worlds in batch.ticks(towards if period < 5 else still):
            stands = worlds.task.consequences.standing > 1
            collided = collided * (1.0 - 0.2 / 120.0) + worlds.collisions.entered_in_tick
            stopped, held = stopped * (1.0 - 0.2 / 120.0) + stands, held + stands
        seen.append(batch.end_period().observations.copy())
        np.testing.assert_allclose(seen[-1][:, 3], np.minimum(collided / 6.0, 1.0), rtol=1e-6)
        np.testing.assert_allclose(seen[-1][:, 4], stopped * 0.2 / 120.0, rtol=1e-6)
        if period in (1, 5):  # the same again, from the state before it
            batch.set_state(told)
            assert_array_equal(batch.step(towards if period < 5 else still).observations, seen[-1])
    flags = np.array(seen)[:, :, :3].argmax(axis=2)
    assert flags[0].tolist() == flags[-1].tolist() == [0, 0]
    assert set(flags[10]) == {flag}
    assert (stopped > 0.0).all() == (flag == 2)
    assert batch.reset([1], [start]).tolist() == [[1.0, 0.0, 0.0, 0.0, 0.0]] * 2


@pytest.mark.parametrize("loss", [0.0, 1.0])
def test_loads_count_who_was_heard_before_the_robot_at_the_nearest_station_and_the_next(loss):
    batch = begun(
        Batch(mission("transport", delivery={"loss": loss}), observation=ObservationConfig(terms=["loads"])), [1]
    )
    cargo, places, met = batch.worlds.task.garbage, batch.worlds.task.stations[0], np.zeros(3)
    kinds, half = batch.worlds.task.site.kinds, 0.5 * np.hypot(20.0, 20.0)
    for _ in range(60):
        seen = batch.step(np.zeros((batch.rows, len(batch.options)), np.int64)).observations
        own = batch.worlds.minds.poses.packed.record.own[:, 0, :2]
        for row in range(batch.rows):
            expected = np.zeros(3)
            if cargo.cargo[row] >= 0:
                needed = places[kinds == cargo.recycled[row]]
                near, further = needed[np.argsort(away(needed, own[row]))[:2]]
                for rank, station in enumerate((near, further)):
                    others = np.delete(own, row, axis=0)
                    before = away(others, station) < min(3.0, away(station, own[row]))
                    expected[rank] = min(before.sum() / 6.0, 1.0) * (loss < 1.0)
                expected[2] = (away(further, own[row]) - away(near, own[row])) / half
            np.testing.assert_allclose(seen[row], expected, atol=1e-6)
        met = np.maximum(met, seen.max(axis=0))
    assert (met > 0.0).tolist() == [loss < 1.0, loss < 1.0, True]


def test_the_season_is_where_garbage_comes_now():
    events = [{"at": 2.0, "do": "move_spots", "spots": [[3.0, 3.0]]}, {"at": 5.0, "do": "move_spots", "spots": []}]
    batch = begun(Batch(mission(events=events), observation=ObservationConfig(terms=["true_season"])), [1])
    seen = [batch.step(np.zeros(batch.rows, np.int64)).observations[0].tolist() for _ in range(7)]
    anywhere, spots = [1.0, 0.0], [0.0, 1.0]
    assert seen == [anywhere, anywhere, spots, spots, spots, anywhere, anywhere]


def away(places, place):
    """Return how far places (..., 2) are from a place on the torus of the mission `transport` [m]."""
    ways = np.abs(places - place)
    return np.hypot(*np.minimum(ways, 20.0 - ways).T)
