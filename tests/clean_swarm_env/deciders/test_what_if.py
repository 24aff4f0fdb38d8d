"""What if: what is foretold of each option is what then happens when a robot takes it."""

from itertools import count

import numpy as np
import pytest

from clean_swarm_env.deciders.what_if import FORETOLD
from tests.train.live.sessions import SMALL, ordered, play_of, served
from train.live.chosen import chosen
from train.live.session import Session

GATE = {"MaxScore": 0, "Random": 23, "policy:one": 40, "fixed:ORCA": 23}
"""Strategy -> periods after which the gate asks: at the beginning, in the middle of a decision period, at its end."""
CASES = [
    pytest.param(strategy, ticks, marks=[] if ticks == GATE[strategy] else [pytest.mark.long])
    for strategy in GATE
    for ticks in (0, 23, 40)
]


def done(session) -> int:
    return sum(int(count[0]) for count in session.worlds.task.totals().values())


def happened(session, robot: int, option: str) -> dict:
    """Let a robot take an option in a session, and return what happens then."""
    counts = session.worlds.collisions
    before, path = (int(counts.events[0, 0]), done(session)), [session.worlds.physics.positions[robot].tolist()]
    session.do({"do": "hold_option", "robots": [robot], "option": option})
    for _ in range(round(FORETOLD / session.period)):
        session.tick()
        path.append(session.worlds.physics.positions[robot].tolist())
    return {"path": path, "collisions": int(counts.events[0, 0]) - before[0], "items": done(session) - before[1]}


@pytest.mark.parametrize(("strategy", "ticks"), CASES)
def test_what_is_foretold_happens(tmp_path, strategy, ticks):
    """In the middle of a decision period, at its end and at the beginning; other robots go on as they would."""
    paths = (tmp_path / f"{number}.swarm" for number in count())

    def begun() -> Session:
        session = Session(play_of(SMALL, strategy), next(paths))
        for tick in range(ticks):
            if tick == 11:
                session.do({"do": "hold_option", "robots": [4], "option": "RepulsionGradient-view0.5"})
                session.do({"do": "set_loss", "loss": 0.3})
            session.tick()
        return session

    session = begun()
    state = session.batch.get_state()
    foretold = {one.pop("option"): one for one in session.what_if(2)}
    assert session.batch.get_state() == state
    assert list(foretold) == list(session.options)
    assert ticks == 0 or len({str(one["path"]) for one in foretold.values()}) > 1  # at first nobody is near
    for option in ("RepulsionFernandez-view2.0", "ORCA", "Off"):
        other = begun()
        told = happened(other, 2, option)
        assert {name: foretold[option][name] for name in told} == told
        assert foretold[option]["seconds"] == FORETOLD
        other.close()
    for _ in range(30):  # and the one that was asked goes on as if it had not been
        session.tick()
    untouched = begun()
    for _ in range(30):
        untouched.tick()
    assert session.batch.get_state() == untouched.batch.get_state()


def test_options_of_several_goals_are_held_and_foretold(tmp_path):
    paths = (tmp_path / f"{number}.swarm" for number in count())
    session, other = (Session(chosen("crowded-exploring", 1, 0, None, ()), next(paths)) for _ in range(2))
    for each in (session, other):
        for _ in range(12):
            each.tick()
    foretold = {one["option"]: one for one in session.what_if(3)}
    assert "ORCA" in foretold
    told = happened(other, 3, "Off")
    assert {name: foretold["Off"][name] for name in told} == told
    coordinator = other.worlds.minds.coordinator_of("AvoidCollision")
    assert coordinator.model.options[coordinator.held[3]] == "Off"


def test_of_a_task_with_measures_these_and_its_cost_are_foretold(tmp_path):
    session, other = (Session(chosen("Foraging", 1, 0, None, ()), tmp_path / name, minds=False) for name in "ab")
    for each in (session, other):
        for _ in range(190):
            each.tick()
    (foretold,) = [one for one in session.what_if(3) if one["option"] == "Foraging"]
    task = other.worlds.task
    before = task.cost(0, task.result())
    told = happened(other, 3, "Foraging")
    assert {name: foretold[name] for name in told} == told
    assert foretold["measures"] == {name: values[0] for name, values in task.result().items()}
    assert foretold["cost_s"] == pytest.approx(task.cost(0, task.result()) - before)
    assert foretold["cost_s"] < 0.0


def test_the_end_of_the_mission_ends_what_is_foretold(tmp_path):
    session = Session(play_of({**SMALL, "time_limit": 4.0}), tmp_path / "end.swarm")
    for _ in range(10):
        session.tick()
    assert {one["seconds"] for one in session.what_if(0)} == {2.0}


def test_odd_questions_are_one_line_and_change_nothing(tmp_path):
    session = Session(play_of(SMALL), tmp_path / "odd.swarm", minds=False)
    session.tick()
    with served(session) as server:
        state = session.batch.get_state()
        for robot in (-1, 6, 10**30, None, "0", 1.0, float("nan"), True, [], {}):
            said = ordered(server, do="what_if", robot=robot)
            assert said.removeprefix("order: ").startswith("robot"), robot
            assert len(said.splitlines()) == 1, robot
        assert session.batch.get_state() == state


def test_robots_that_are_driven_or_gone_have_no_options(tmp_path):
    session = Session(play_of(SMALL), tmp_path / "gone.swarm", minds=False)
    session.do({"do": "fail_robot", "robot": 2})
    with pytest.raises(ValueError, match="robot 2: expected a robot at work"):
        session.what_if(2)
    assert np.isfinite([one["cost_s"] for one in session.what_if(1)]).all()
