"""The cost of a mission cannot be gamed: finished ones are cheapest, each item pays, standing still never does."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from clean_swarm_env.learning.batch import run_out
from clean_swarm_env.tasks.cleaning.cost import cost_terms, mission_cost, unavoidable_cost
from tests.clean_swarm_env.courses import course_of, forced, mission

ITEMS, LIMIT = 10, 600.0
FINITE = mission(collision_cost=7.0, contact_cost=2.0, garbage={"count": ITEMS}, time_limit=LIMIT)
COMING = mission(collision_cost=7.0, contact_cost=2.0, garbage={"count": 0, "respawn": 3.0}, time_limit=LIMIT)
events, samples = st.integers(0, 10**6), st.integers(0, 10**8)
durations = st.floats(0.0, LIMIT)


def test_the_cost_is_time_and_the_price_of_collisions_and_of_what_is_left():
    assert mission_cost(FINITE, 20.0, 3, 0, ITEMS) == 20.0 + 3 * 7.0
    assert mission_cost(FINITE, 20.0, 3, 40, ITEMS) == 20.0 + 3 * 7.0 + 2 * 2.0  # two seconds at 20 counts a second
    assert mission_cost(FINITE, LIMIT, 3, 0, ITEMS - 2) == LIMIT + 3 * 7.0 + 2 * 2 * LIMIT
    assert mission_cost(COMING, LIMIT, 3, 0, 4) == (LIMIT + 3 * 7.0) / 4
    assert mission_cost(mission(garbage={"count": 0}), 0.0, 0, 0, 0) == 0.0


@given(durations, events, samples, events, samples, st.integers(0, ITEMS - 1))
def test_an_unfinished_mission_never_beats_a_finished_one(time, hits, touches, other_hits, other_touches, done):
    finished = mission_cost(FINITE, time, hits, touches, ITEMS)
    assert finished < mission_cost(FINITE, LIMIT, other_hits, other_touches, done)


@given(st.sampled_from([FINITE, COMING]), events, samples, st.integers(0, ITEMS - 2))
def test_more_items_cost_less_whatever_happens_meanwhile(config, hits, touches, done):
    for more in range(done + 1, ITEMS):
        assert mission_cost(config, LIMIT, hits, touches, more) < mission_cost(config, LIMIT, hits, touches, done)
    assert mission_cost(FINITE, LIMIT, hits, touches, done + 1) < mission_cost(FINITE, LIMIT, 0, 0, done)


@given(st.sampled_from([FINITE, COMING]), events, samples, st.integers(0, ITEMS))
def test_every_collision_and_every_second_in_contact_costs(config, hits, touches, done):
    cost = mission_cost(config, LIMIT, hits, touches, done)
    assert cost < mission_cost(config, LIMIT, hits + 10, touches, done)
    assert cost < mission_cost(config, LIMIT, hits, touches + 1000, done)


@given(events, samples, st.integers(1, 200))
def test_standing_still_costs_more_than_anything_that_dumps_an_item(hits, touches, done):
    assert mission_cost(COMING, LIMIT, hits, touches, done) < mission_cost(COMING, LIMIT, 0, 0, 0)
    assert mission_cost(FINITE, LIMIT, hits, touches, min(done, ITEMS)) < mission_cost(FINITE, LIMIT, 0, 0, 0)


@given(st.integers(0, 60), st.integers(0, 60), events)
def test_the_unavoidable_part_is_a_lower_bound(came, done, hits):
    done = min(done, came)
    assert unavoidable_cost(COMING, came) <= mission_cost(COMING, LIMIT, hits, 0, done)


def test_arrivals_make_a_part_of_the_cost_unavoidable():
    landing = mission("reference", garbage={"count": 0}, events=[{"at": 10.0, "do": "land", "items": 2}])
    result = run_out(course_of(landing, 1, 1))
    assert (result.unavoidable_s, unavoidable_cost(FINITE, ITEMS)) == (10.0, 0.0)
    assert result.cost_s > 10.0
    coming = mission(garbage={"count": 2, "respawn": 30.0, "capacity": 5}, time_limit=120.0)
    options = "RepulsionFernandez-view2.0", "RepulsionGradient-view1.5"
    same = [run_out(forced(course_of(coming, 1, 5), AvoidCollision=option)) for option in options]
    assert same[0].unavoidable_s == same[1].unavoidable_s == pytest.approx(2.0, rel=0.4)
    assert same[0] != same[1]
    assert all(result.unavoidable_s < result.cost_s for result in same)


def test_an_item_is_worth_the_mean_time_between_arrivals_where_garbage_keeps_coming():
    change = {"at": 300.0, "do": "respawn", "rate": 9.0}
    changing = mission(garbage={"count": 2, "respawn": 3.0}, time_limit=LIMIT, events=[change])
    assert cost_terms(changing).worth == pytest.approx(LIMIT / (2 + 5 * 3.0 + 5 * 9.0))
