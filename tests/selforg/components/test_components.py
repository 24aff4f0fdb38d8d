"""Each source, sensor and action by itself, on robots and gradients placed by hand."""

import math

import numpy as np
import pytest

from selforg.commands import Commands
from selforg.components import (
    Changed,
    Decide,
    DecideState,
    DecisionSource,
    FartherThan,
    GoalDistance,
    GoalPresent,
    GoalReached,
    GoalSource,
    HandOver,
    Known,
    Move,
    MovementSource,
    RobotMemory,
    SetState,
    StateIs,
    Turn,
    Value,
    VectorLength,
    VectorPresent,
)
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair import Own, choose
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import ATTRACTIVE, CHOICES, EVERYTHING, Queries
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store.columns import DIFFUSION, PAIR_DISTANCE, PAIR_DX, PAIR_GOAL_RADIUS
from selforg.mechanisms import (
    Exploration,
    FollowAll,
    GossipMax,
    Patrol,
    Pheromone,
    Quorum,
    RepulsionGradient,
    WeightedSum,
)
from selforg.network.step.readings import ReadingError
from selforg.program import ACT, LEAVE, Rows
from selforg.randomness import DirectionStream
from selforg.space import Euclidean, Torus
from tests.selforg.programs import run

ALL, SOME = np.arange(3), np.array([2, 0])
PLACES = np.array([[0.0, 0.0], [1.2, 0.0], [9.0, 0.0]])


@pytest.fixture
def buffer():
    """Three robots on a line, the first two close together, the last alone; goals at x = 10 and x = 30."""
    poses = OwnPoses(Euclidean(2), 3, goal_radius=0.25, diffusion=1.0)
    poses.update(PLACES, np.zeros(3), 1.0)
    made = SoBuffer(BufferSettings(view_distance=2.0), poses.space, poses)
    made.store_static(0, "goal", np.array([[10.0, 0.0], [30.0, 0.0]]), 1.0, diffusion=1.0, goal_radius=0.25)
    return made


def asked(source, now=1.0, rows=ALL):
    source.ask(now, rows)
    return source


def test_presence_and_length_of_a_movement(buffer):
    source = asked(MovementSource(RepulsionGradient(buffer)))
    assert VectorPresent(source).read(ALL).tolist() == [1.0, 1.0, 0.0]
    lengths = VectorLength(source).read(ALL)
    np.testing.assert_allclose(lengths, np.linalg.norm(source.vectors, axis=1))
    assert lengths[0] == pytest.approx(0.3)  # clearance 0.7 of a diffusion of 1.0
    assert VectorPresent(source, longer_than=0.31).read(ALL).tolist() == [0.0, 0.0, 0.0]
    assert VectorLength(source).read(SOME).tolist() == lengths[SOME].tolist()


def test_a_source_renews_only_the_rows_it_is_asked_for(buffer):
    source = asked(MovementSource(RepulsionGradient(buffer)))
    before = source.vectors.copy()
    buffer.poses.update(np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.9]]), np.zeros(3), 2.0)
    asked(source, 2.0, np.array([2]))
    np.testing.assert_array_equal(source.vectors[:2], before[:2])
    assert source.active[2]


def test_times_of_a_levy_walk_against_a_naive_reference(buffer):
    streams, naive = (DirectionStream([np.random.default_rng(row) for row in range(3)]) for _ in range(2))
    source = asked(MovementSource(Exploration(buffer, directions=streams), 2.0, 1.5, 300.0))
    chances, ways = naive.next_directions(ALL), naive.next_directions(ALL)
    shares = [0.5 + math.atan2(y, x) / math.tau for x, y, _ in chances]
    expected = [min(2.0 * share ** (-1.0 / 0.5), 300.0) for share in shares]
    np.testing.assert_allclose(source._holds, expected, rtol=1e-12)
    np.testing.assert_array_equal(source.vectors, ways[:, :2])
    first, shortest = source.vectors.copy(), min(expected)
    asked(source, 1.0 + shortest - 0.01)
    np.testing.assert_array_equal(source.vectors, first)
    asked(source, 1.0 + shortest)
    assert (source.vectors != first).any(axis=1).tolist() == [time == shortest for time in expected]
    source.forget(SOME)
    asked(source, 1.0 + shortest)
    assert (source.vectors != first).any(axis=1)[SOME].all()


@pytest.mark.parametrize("exponent", [1.0, -2.0, np.nan])
def test_an_exponent_without_a_power_law_is_refused(buffer, exponent):
    with pytest.raises(ValueError, match="exponent must be 0 or above 1"):
        MovementSource(Exploration(buffer), 1.0, exponent)


def test_sensors_over_a_goal(buffer):
    goal = asked(GoalSource(buffer))
    assert GoalPresent(goal).read(ALL).tolist() == [0.0, 0.0, 1.0]
    np.testing.assert_allclose(goal.offsets, [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    np.testing.assert_allclose(GoalDistance(goal, unseen=5.0).read(ALL), [5.0, 5.0, 0.5])
    assert FartherThan(goal, 0.4).read(ALL).tolist() == [0.0, 0.0, 1.0]
    assert FartherThan(goal, 0.6).read(ALL).tolist() == [0.0, 0.0, 0.0]
    assert GoalReached(goal).read(ALL).tolist() == [0.0, 0.0, 0.0]
    buffer.poses.update(np.array([[0.0, 0.0], [1.2, 0.0], [9.6, 0.0]]), np.zeros(3), 2.0)
    asked(goal, 2.0)
    assert GoalReached(goal).read(ALL).tolist() == [0.0, 0.0, 1.0]
    assert GoalDistance(goal, unseen=5.0).read(SOME).tolist() == [0.0, 5.0]


def test_an_unseen_distance_must_be_one():
    with pytest.raises(ValueError, match="GoalDistance: unseen must be a distance, got inf"):
        GoalDistance(None, unseen=np.inf)


def test_sensors_over_a_decision(buffer):
    quorum = Quorum(buffer, threshold=1.0)
    source = asked(DecisionSource(quorum))
    assert Value(source).read(ALL).tolist() == [1.0, 1.0, 0.0]
    assert StateIs(source, "True").read(ALL).tolist() == [1.0, 1.0, 0.0]
    assert Changed(source).read(ALL).tolist() == [1.0, 1.0, 0.0]
    Decide(quorum).leave(1.0, np.array([0]))
    asked(source)
    assert Changed(source).read(ALL).tolist() == [0.0, 1.0, 0.0]  # the second has not kept what it would decide
    with pytest.raises(ValueError, match="StateIs: state must be one of False, True, got 'Many'"):
        StateIs(source, "Many")


def test_deciding_spreads_to_the_others(buffer):
    gossip = GossipMax(buffer, channel="highest", value=[3.0, 5.0, 9.0], view_distance=3.0)
    source = DecisionSource(gossip)
    decide = Decide(gossip)
    decide.leave(1.0, np.array([1]))
    assert Value(asked(source)).read(ALL).tolist() == [5.0, 5.0, 9.0]
    decide.leave(1.0, np.array([0]))
    assert gossip.values.tolist() == [5.0, 5.0, 9.0]


def test_a_decided_state_becomes_knowledge(buffer):
    memory = RobotMemory(3, {"crowded": False, "role": 0.0})
    crowded = DecideState(Quorum(buffer, threshold=1.0), memory["crowded"])
    crowded.leave(1.0, np.array([1, 2]))
    assert Known(memory["crowded"]).kind == "fact"
    assert Known(memory["crowded"]).read(ALL).tolist() == [0.0, 1.0, 0.0]
    with pytest.raises(ValueError, match="knowledge: unknown name 'crowd'"):
        DecideState(Quorum(buffer, threshold=1.0), memory["crowd"])


def test_a_set_state_is_known_from_the_start_of_its_behaviour_on():
    memory = RobotMemory(3, {"role": 0.0, "home": True})
    leave_home = SetState(memory["home"], False)
    leave_home.act(1.0, ALL, np.array([1]), Commands(3, 2))
    SetState(memory["role"], 4.0).act(1.0, ALL, np.array([0, 2]), Commands(3, 2))
    assert Known(memory["home"]).read(ALL).tolist() == [1.0, 0.0, 1.0]
    assert Known(memory["role"]).read(SOME).tolist() == [4.0, 4.0]
    memory.reset([0, 1])
    assert (memory["role"].values.tolist(), memory["home"].values.tolist()) == ([0.0, 0.0, 4.0], [1.0, 1.0, 1.0])


def test_cargo_is_handed_over_once_it_has_gained_its_span_unless_it_is_near():
    memory = RobotMemory(4, {"gained": 0.0, "left": 0.0, "ask": 0.0})
    names = [memory[name] for name in ("gained", "left", "ask")]
    memory["gained"].write(range(4), [3.9, 4.0, 9.0, 9.0])
    memory["left"].write(range(4), [5.0, 2.1, 2.0, 5.0])
    hand_over = HandOver(*names, span=4.0, near=2.0, blind=7.0)
    hand_over.act(1.0, np.arange(3), np.arange(0), Commands(4, 2))
    assert memory["ask"].values.tolist() == [0.0, 7.0, 0.0, 0.0]
    memory.reset(range(4))
    HandOver(*names, span=0.0, near=0.0, blind=7.0).act(1.0, np.arange(4), np.arange(4), Commands(4, 2))
    assert not memory["ask"].values.any()
    with pytest.raises(ValueError, match=r"HandOver: blind must be at least 1e-06, got 0\.0"):
        HandOver(*names, span=4.0, near=2.0, blind=0.0)


def test_what_cannot_be_known_is_refused():
    memory = RobotMemory(2, {"home": True, "charge": 1.0})
    with pytest.raises(ValueError, match=r"knowledge 'home' is a fact: expected True or False, got 0\.5"):
        SetState(memory["home"], 0.5)
    with pytest.raises(ValueError, match="knowledge 'charge': expected numbers, got nan"):
        memory["charge"].write([0], np.nan)
    with pytest.raises(ValueError, match=r"unknown name 'charg' \(known: home, charge\)"):
        Known(memory["charg"])
    with pytest.raises(ReadingError, match="sensor 'charge': expected a number, got 'full'"):
        RobotMemory(1, {"charge": "full"})


def test_move_and_turn_command_what_their_source_says(buffer):
    source = asked(MovementSource(RepulsionGradient(buffer)))
    commands = Commands(3, 2)
    some = Rows.of(np.array([0, 2]))
    run(Move(source).steps(some, some, commands), 1.0)
    np.testing.assert_array_equal(commands.vectors[[0, 1]], [source.vectors[0], [0.0, 0.0]])
    assert commands.commanded.tolist() == [True, False, False]
    Turn(target=asked(GoalSource(buffer))).act(1.0, np.array([1, 2]), ALL, commands)
    np.testing.assert_allclose(commands.vectors[2], [1.0, 0.0])
    assert commands.commanded.tolist() == [True, False, True]
    assert commands.in_place.tolist() == [False, True, True]


def test_a_sum_adds_movements_with_their_weights(buffer):
    away, towards = (asked(MovementSource(kind(buffer))) for kind in (RepulsionGradient, FollowAll))
    both = MovementSource(WeightedSum(buffer, of={away: 1.0, towards: -0.5}))
    assert both.parts == [away, towards]
    both.ask(1.0, ALL)
    assert np.array_equal(both.vectors, away.vectors - 0.5 * towards.vectors)
    assert not np.array_equal(both.vectors, away.vectors)
    assert np.array_equal(both.active, away.active | towards.active)
    alone = WeightedSum(buffer, of={RepulsionGradient(buffer): 1.0, FollowAll(buffer): -0.5})
    assert np.array_equal(alone.move(1.0)[0], both.vectors)
    nested = MovementSource(WeightedSum(buffer, of={both: 2.0, away: 1.0}))
    assert nested.parts == [away, towards, both, away]
    nested.ask(1.0, ALL)
    assert np.array_equal(nested.vectors, 2.0 * both.vectors + away.vectors)


def test_a_part_of_a_sum_deposits(buffer):
    trail = Pheromone("trail", -1, 1.0, 0.9, 30.0)
    patrol = asked(MovementSource(Patrol(buffer, pheromone=trail, channels=("trail",))))
    move = Move(MovementSource(WeightedSum(buffer, of={patrol: 1.0})))
    one = Rows.of(np.array([1]))
    run(move.steps(one, one, Commands(3, 2)), 1.0, LEAVE)
    assert FollowAll(buffer, channels=("trail",)).move(1.0)[1].any()


def test_a_depositing_mechanism_deposits_when_all_movements_are_known(buffer):
    trail = Pheromone("trail", -1, 1.0, 0.9, 30.0)
    move = Move(asked(MovementSource(Patrol(buffer, pheromone=trail, channels=("trail",)))))
    seen = FollowAll(buffer, channels=("trail",))
    one = Rows.of(np.array([1]))
    steps = move.steps(one, one, Commands(3, 2))
    run(steps, 1.0, ACT)
    assert not seen.move(1.0)[1].any()
    run(steps, 1.0, LEAVE)
    assert seen.move(1.0)[1].tolist() == [True, True, False]


@pytest.mark.parametrize("rule", CHOICES)
@pytest.mark.parametrize("whole_seconds", [False, True])
def test_a_target_is_what_a_query_chooses_also_where_much_is_in_view_and_channels_are_new(rule, whole_seconds):
    rng, rows = np.random.default_rng(3), np.array([4, 0, 3, 1])
    poses = OwnPoses(Torus(6.0, 6.0), 5, goal_radius=0.2, diffusion=rng.uniform(0.5, 2.0, 5))
    poses.update(rng.uniform(0.0, 6.0, (5, 2)), np.zeros(5), 1.0)
    poses.silence([3])
    buffer = SoBuffer(BufferSettings(whole_seconds=whole_seconds, aggregation_distance=0.0), poses.space, poses)
    source = GoalSource(buffer, rule)
    for channel in ("first", "second"):
        places, sign = rng.uniform(0.0, 6.0, (300, 2)), rng.integers(-1, 2, 300)
        buffer.store_static(0, channel, places, 1.0, attraction=sign, diffusion=rng.uniform(0.5, 2.0, 300))
        source.ask(1.2, rows)
        assert source.present[rows].tolist() == [True, True, False, True]
        seen = Queries(buffer).gather(1.2, rows, signs=EVERYTHING if rule == "strongest" else ATTRACTIVE)
        for k, row in enumerate(rows.tolist()):
            pairs = seen.pairs[seen.start[k] : seen.start[k + 1]]
            own = Own(0.2, 0.2 + poses.own[row, 0, DIFFUSION], buffer.settings.view_distance)
            best = choose(CHOICES[rule], pairs, len(pairs), own)
            assert source.present[row] == (best >= 0)
            if best >= 0:
                np.testing.assert_array_equal(source.offsets[row], pairs[best, PAIR_DX : PAIR_DX + 2])
                reached = pairs[best, PAIR_DISTANCE] - pairs[best, PAIR_GOAL_RADIUS]
                assert source.clearance[row] == pytest.approx(reached - 0.2)
            else:
                assert (source.offsets[row] == 0.0).all()
                assert source.clearance[row] == 0.0
    with pytest.raises(KeyError, match="unknown choice 'best'; known: nearest_attractive"):
        GoalSource(buffer, "best").ask(1.2, rows)
