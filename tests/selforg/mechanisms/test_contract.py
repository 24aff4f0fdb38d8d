"""What every registered mechanism promises; a reader's own class joins by registering."""

import numpy as np
import pytest

from selforg import mechanisms
from selforg.gradients.gradient import Gradient
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, Carried, DecisionMechanism, FormulaMechanism, MovementMechanism
from selforg.mechanisms.depositing import DepositingMechanism
from tests.selforg.worlds import directions, make_world, scatter, set_pose


@MECHANISMS.register
class Spring(FormulaMechanism):
    """Keeps neighbours at the own reach: the worked example of the documentation."""

    @staticmethod
    def formula(pair):
        return pair.distance - pair.own_reach


MOVEMENTS = [n for n in MECHANISMS.names() if issubclass(MECHANISMS.find(n), MovementMechanism)]
DECISIONS = [n for n in MECHANISMS.names() if issubclass(MECHANISMS.find(n), DecisionMechanism)]
FIXED_ROWS = ("Exploration", "DepositPheromonesRandom")  # their answer is the luck of the row, not its place


def crowded(space="torus", rows=6, order=None, seed=1):
    """A world with everything in it, the rows in some order."""
    world = make_world(space, rows=rows, seed=seed, size=5.0, settings=BufferSettings(aggregation_distance=0.0))
    if order is not None:
        places, headings = world.poses.positions[order].copy(), world.poses.own[order, 0, 6:9].copy()
        for row in range(rows):
            world.poses.forget([row])
            set_pose(world.poses, row, places[row], headings[row][: world.space.dim], 0.0)
    for sign in (-1, 0, 1):
        scatter(world, 15, channel=f"sign{sign}", attraction=sign, diffusion=2.0, goal_radius=0.2, size=5.0)
    for row in range(rows):  # a second pose, so that everybody has a velocity
        place = world.poses.positions[row] + 0.1
        set_pose(world.poses, row, place, world.poses.own[row, 0, 6 : 6 + world.space.dim], 0.5)
    return world


def build(name, world, seed=3):
    parameters = dict(MECHANISMS.find(name).example)
    if name in MOVEMENTS:
        parameters["directions"] = directions(world.poses.rows, world.space.dim, seed)
    return MECHANISMS.create(name, world.buffer, **parameters)


@pytest.mark.parametrize("space", ["torus", "plane", "volume"])
@pytest.mark.parametrize("name", MOVEMENTS)
def test_movements_are_finite_of_the_promised_shape_and_zero_where_inactive(name, space):
    world = crowded(space)
    world.poses.forget([2])
    vectors, active = build(name, world).move(1.0)
    assert (vectors.shape, vectors.dtype) == ((6, world.space.dim), np.float64)
    assert (active.shape, active.dtype) == ((6,), np.bool_)
    assert np.isfinite(vectors).all()
    assert not active[2]
    assert not vectors[~active].any()
    assert active.any()


@pytest.mark.parametrize("name", MOVEMENTS)
def test_speeds_are_kept(name):
    mechanism = build(name, crowded())
    vectors, active = mechanism.move(1.0)
    lengths = np.linalg.norm(vectors[active], axis=1)
    highest = getattr(mechanism, "max_speed", np.inf)
    if name.startswith("Repulsion"):
        highest = 1.5
    assert (lengths <= highest * (1 + 1e-12)).all()
    lowest = 0.0 if name.startswith("Repulsion") else getattr(mechanism, "min_speed", 0.0)
    assert (lengths[lengths > 0] >= lowest * (1 - 1e-12)).all()


@pytest.mark.parametrize("name", MOVEMENTS)
def test_permuted_rows_give_permuted_movements(name):
    order = np.array([3, 0, 5, 1, 4, 2])
    one, other = (build(name, crowded(order=o)) for o in (None, order))
    vectors, active = one.move(1.0)
    permuted, permuted_active = other.move(1.0)
    np.testing.assert_array_equal(active[order], permuted_active)
    if name not in FIXED_ROWS:
        np.testing.assert_allclose(vectors[order], permuted, atol=1e-12)


@pytest.mark.parametrize("name", MOVEMENTS)
def test_the_same_seed_moves_the_same_and_moving_changes_nothing(name):
    first, second = crowded(), crowded()
    one, other = build(name, first), build(name, second)
    before = first.buffer.table.record.near[: len(first.buffer)].copy()
    np.testing.assert_array_equal(one.move(1.0)[0], other.move(1.0)[0])
    np.testing.assert_array_equal(one.move(1.2)[0], other.move(1.2)[0])
    np.testing.assert_array_equal(first.buffer.table.record.near[: len(first.buffer)], before)


@pytest.mark.parametrize("name", MOVEMENTS)
def test_a_subset_of_rows_in_any_order(name):
    vectors, active = (array.copy() for array in build(name, crowded()).move(1.0))
    some, some_active = build(name, crowded()).move(1.0, np.array([4, 1], dtype=np.int32))
    np.testing.assert_array_equal(some, vectors[[4, 1]])
    np.testing.assert_array_equal(some_active, active[[4, 1]])


@pytest.mark.parametrize("name", MOVEMENTS)
@pytest.mark.parametrize("space", ["torus", "volume"])
def test_coincident_centres_and_infinite_radii_move_finitely(name, space):
    world = make_world(space, rows=3, settings=BufferSettings(aggregation_distance=0.0))
    spot = np.ones((3, world.space.dim))
    for stamp in (1.0, 2.0):
        world.poses.update(spot, None, stamp)
    for sign in (-1, 0, 1):
        world.buffer.store_static(0, "here", spot[:1], 2.0, attraction=sign, diffusion=[np.inf], goal_radius=0.5)
        world.buffer.store_static(0, "there", spot[:1] * 3, 2.0, attraction=sign, diffusion=[np.inf])
        world.buffer.store_static(0, "point", spot[:1], 2.0, attraction=sign, diffusion=[1.0])
    vectors, _ = build(name, world).move(2.0)
    assert np.isfinite(vectors).all()


@pytest.mark.parametrize("name", [n for n in MOVEMENTS if issubclass(MECHANISMS.find(n), DepositingMechanism)])
def test_depositing_leaves_one_pheromone_per_row_with_a_pose(name):
    world = make_world(rows=4, settings=BufferSettings(aggregation_distance=0.0))
    world.poses.forget([1])
    mechanism = build(name, world)
    mechanism.move(1.0)
    assert len(world.buffer) == 0
    mechanism.deposit(1.0)
    assert world.buffer.count(0, "Pheromone") == 3
    mechanism.deposit(1.2, np.array([0]))  # on the same spot: the newer replaces the older
    assert world.buffer.count(0, "Pheromone") == 3
    world.poses.update(world.poses.positions + 0.1, None, 1.4)
    mechanism.deposit(1.4, np.array([0]))
    assert world.buffer.count(0, "Pheromone") == 4


@pytest.mark.parametrize("name", DECISIONS)
def test_decisions_have_a_value_and_a_state_and_change_only_by_spreading(name):
    world = crowded()
    world.poses.forget([2])
    mechanism = MECHANISMS.create(name, world.buffer, **MECHANISMS.find(name).example)
    before = mechanism.values.copy(), mechanism.state_codes.copy()
    decision = mechanism.decide(1.0)
    np.testing.assert_array_equal(mechanism.values, before[0])
    assert decision.values.shape == decision.states.shape == decision.decided.shape == (6,)
    mechanism.spread(1.0)
    kept = decision.decided & world.poses.known
    np.testing.assert_array_equal(mechanism.values[kept], decision.values[kept])
    assert mechanism.values[2] == before[0][2]
    mechanism.reset(np.arange(6))
    np.testing.assert_array_equal(mechanism.values, before[0])
    np.testing.assert_array_equal(mechanism.state_codes, before[1])


@pytest.mark.parametrize("name", MECHANISMS.names())
def test_wrong_parameters_are_named(name):
    world = make_world()
    with pytest.raises(TypeError, match="maximal_speed"):
        MECHANISMS.create(name, world.buffer, **MECHANISMS.find(name).example, maximal_speed=1.0)
    if name != "SpreadGradient":
        with pytest.raises(ValueError, match="view_distance must be at least 0"):
            MECHANISMS.create(name, world.buffer, **MECHANISMS.find(name).example, view_distance=float("nan"))


def test_unknown_names_list_the_known_ones_and_no_name_is_taken_twice():
    with pytest.raises(KeyError, match=r"unknown mechanism 'Repulsion' \(known: ApproachLeastBusy, AvoidAll, .*Spring"):
        MECHANISMS.create("Repulsion")
    with pytest.raises(ValueError, match="'Spring' is registered already"):
        MECHANISMS.register(Spring)


def test_a_formula_of_ones_own_sums_what_a_loop_sums():
    world = make_world(rows=5, size=3.0)
    mechanism = Spring(world.poses, view_distance=1.0, max_speed=100.0)
    vectors, _ = mechanism.move(0.0)
    for row in range(5):
        offsets = np.delete(world.space.offsets(world.poses.positions[row], world.poses.positions), row, axis=0)
        lengths = np.linalg.norm(offsets, axis=1)
        near = lengths <= 2.5
        expected = (offsets * ((lengths - 1.5) / lengths)[:, None])[near].sum(axis=0)
        np.testing.assert_allclose(vectors[row], expected, atol=1e-12)


def test_gossip_brings_the_highest_value_to_all_within_as_many_rounds_as_the_chain_is_long():
    world = make_world("plane", rows=5)
    gossip = mechanisms.GossipMax(
        world.buffer, value=[1, 9, 2, 3, 4], view_distance=0.0,
        carried=Carried("gossip", "max", attraction=0, diffusion=1.2),
    )  # fmt: skip
    for tick in range(4):
        now = 1.0 + tick
        world.poses.update(np.arange(5.0)[:, None] * [1.0, 0.0], None, now)
        if tick == 2:
            assert gossip.values[3] == 4.0
        gossip.spread(now)
    assert (gossip.values[:4] == 9).all()


def test_payloads_come_back_and_numbers_in_them_are_decided_upon():
    world = make_world(rows=1)
    world.buffer.store(
        Gradient("gossip", (1.0, 1.0), source="x", diffusion=50.0, moving=True, payload={"who": "x", "max": 7}), 0.0
    )
    assert mechanisms.GossipMax(world.buffer).decide(0.0).values[0] == 7.0
