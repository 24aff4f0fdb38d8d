"""Events with a period happen again and again until the mission ends, in the order of time, then of the list."""

import tracemalloc

import numpy as np
import pytest

from clean_swarm_env.config.events import happening
from clean_swarm_env.tasks.cleaning.cost import cost_terms
from clean_swarm_env.world.agenda import Agenda
from tests.clean_swarm_env.courses import mission

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


def test_the_agenda_holds_the_next_time_of_an_event_however_often_it_happens():
    often = [{"at": 0.0, "every": 1.0, "do": "move_spots", "spots": []}] * 10
    config = mission(events=often, time_limit=10_000.0)
    tracemalloc.start()
    Agenda(config, np.random.SeedSequence(0))
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 100_000


def test_the_price_of_items_counts_phases_of_arrival():
    rates = [
        {"at": 0.0, "every": 20.0, "do": "respawn", "rate": 6.0},
        {"at": 10.0, "every": 20.0, "do": "respawn", "rate": 0.0},
    ]
    config = mission(events=rates, garbage={"count": 0, "respawn": 1.0}, time_limit=100.0)
    assert cost_terms(config).worth == pytest.approx(100.0 / 5.0)  # 50 s at 6 a minute
