"""Events with a period happen again and again until the mission ends, in the order of time, then of the list."""

import numpy as np
import pytest
from pydantic import ValidationError

from clean_swarm_env.config.events import happening
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.tasks.cleaning.cost import cost_terms
from selector.documents.errors import one_line
from tests.clean_swarm_env.courses import mission, worlds_at_start

PHASES = (
    {"at": 0.0, "every": 8.0, "do": "move_spots", "spots": []},
    {"at": 4.0, "every": 8.0, "do": "move_spots", "spots": [[2.0, 2.0]]},
    {"at": 4.0, "do": "respawn", "rate": 600.0},
)


def test_phases_come_in_order_and_end_with_the_mission():
    config = mission(events=PHASES, time_limit=20.0)
    times = [(at, event.do) for at, event in happening(config.events, config.time_limit)]
    assert times == [
        (0.0, "move_spots"),
        (4.0, "move_spots"),
        (4.0, "respawn"),
        (8.0, "move_spots"),
        (12.0, "move_spots"),
        (16.0, "move_spots"),
    ]
    late = mission(events=[{"at": 30.0, "every": 8.0, "do": "respawn", "rate": 1.0}], time_limit=20.0)
    assert [at for at, _ in happening(late.events, late.time_limit)] == [30.0]  # as without a period


def test_garbage_comes_at_a_spot_and_anywhere_in_turn():
    worlds = worlds_at_start(mission(events=PHASES, garbage={"count": 0, "capacity": 300}, time_limit=20.0), [1, 2])
    known, near = 0, {}
    for tick in range(1, 90):
        worlds.tick()
        come = worlds.task.garbage.arrived[0]
        places = worlds.task.garbage.positions[0, known:come]
        phase = (tick - 2) // 20  # what is due in the tick of an event still comes before it
        near.setdefault(phase, []).extend((np.abs(places - 2.0) <= 1.0).all(axis=1))
        known = come
    assert all(near[1])
    assert all(near[3])
    assert len(near[2]) > 0
    assert np.mean(near[2]) < 0.3


def test_the_price_of_items_counts_phases_of_arrival():
    rates = [
        {"at": 0.0, "every": 20.0, "do": "respawn", "rate": 6.0},
        {"at": 10.0, "every": 20.0, "do": "respawn", "rate": 0.0},
    ]
    config = mission(events=rates, garbage={"count": 0, "respawn": 1.0}, time_limit=100.0)
    assert cost_terms(config).worth == pytest.approx(100.0 / 5.0)  # 50 s at 6 a minute


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            {"at": 0.0, "every": 0.1, "do": "respawn", "rate": 1.0},
            "events.0.every: expected 0 or at least 0.3 s, got 0.1",
        ),
        ({"at": 0.0, "every": -1.0, "do": "respawn", "rate": 1.0}, "every: expected greater than or equal to 0"),
        ({"at": 0.0, "every": 9.0, "do": "join"}, "every: unknown key 'every'"),
        ({"at": 0.0, "every": 9.0, "do": "land", "items": 2}, "every: unknown key 'every'"),
    ],
)
def test_a_mistake_is_one_line(event, words):
    with pytest.raises(ValidationError) as caught:
        MissionConfig.model_validate({"events": [event]})
    assert words in one_line(caught.value, "m.yaml")
