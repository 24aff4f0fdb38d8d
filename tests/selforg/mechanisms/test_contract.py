"""What every registered mechanism promises; a reader's own class joins by registering."""

import numpy as np
import pytest

from clean_swarm_env.testing import check_mechanism
from clean_swarm_env.testing.mechanisms import NOWHERE, SPACES, crowded
from selforg import mechanisms
from selforg.gradients.gradient import Gradient
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, Carried, DecisionMechanism, FormulaMechanism, MovementMechanism
from selforg.mechanisms.depositing import DepositingMechanism
from selforg.plugins import PluginError
from tests.selforg.worlds import build, make_world

LUCK = np.random.default_rng(1)
"""Random numbers that no seed decides, for classes that break their promises."""


@MECHANISMS.register
class Spring(FormulaMechanism):
    """Keeps neighbours at the own reach: the worked example of the documentation."""

    @staticmethod
    def formula(pair):
        return pair.distance - pair.own_reach


MOVEMENTS = [n for n in MECHANISMS.names() if issubclass(MECHANISMS.find(n), MovementMechanism)]
DECISIONS = [n for n in MECHANISMS.names() if issubclass(MECHANISMS.find(n), DecisionMechanism)]


@pytest.mark.parametrize("name", MECHANISMS.names())
def test_a_mechanism_keeps_its_contract(name):
    check_mechanism(MECHANISMS.find(name))


def of_breaking(move):
    """A mechanism that moves as promised, and then breaks a promise."""

    def move_into(self, now, rows, vectors, active):
        active[rows] = self.poses.known[rows]
        vectors[rows] = active[rows, None] * 0.5
        move(self, rows, vectors, active)

    return type("Mine", (MovementMechanism,), {"move_into": move_into, "__module__": __name__})


def put(array, place, value):
    array[place] = value


@pytest.mark.parametrize(
    ("move", "said"),
    [
        (lambda self, rows, vectors, active: put(vectors, rows, np.nan), "finite numbers, got NaN or infinity"),
        (lambda self, rows, vectors, active: put(vectors, rows, rows[:, None]), "rows in another order"),
        (lambda self, rows, vectors, active: put(vectors, rows, len(rows)), "for some of the rows what all of them"),
        (lambda self, rows, vectors, active: put(active, rows, False), "no vector without a movement|a movement of"),
        (lambda self, rows, vectors, active: put(active, 2, True), "rows in another order|no vector without"),
        (lambda self, rows, vectors, active: put(rows, 0, 1), "expected to change no array that it reads"),
        (lambda self, rows, vectors, active: put(self.poses.positions, 0, 0.0), "to change nothing in the world"),
        (lambda self, rows, vectors, active: [].pop(), "IndexError: pop from empty list"),
        (lambda self, rows, vectors, active: put(vectors, rows, LUCK.random()), "the same for the same seed"),
    ],
)  # fmt: skip
def test_a_mechanism_that_breaks_its_contract_is_one_line(move, said, monkeypatch):
    cls = of_breaking(move)
    monkeypatch.setitem(MECHANISMS._classes, "Mine", cls)
    with pytest.raises(PluginError, match=said) as raised:
        check_mechanism(cls)
    assert "\n" not in str(raised.value)
    check_mechanism(Spring)  # a class that changes what all share breaks no other's check


def test_a_mechanism_that_is_not_registered_is_one_line():
    with pytest.raises(PluginError, match=r"test_contract: Mine: expected to be registered as a mechanism$"):
        check_mechanism(of_breaking(lambda *_: None))
    with pytest.raises(PluginError, match="expected a class of a mechanism"):
        check_mechanism(np.zeros)


@pytest.mark.parametrize("name", MOVEMENTS)
def test_speeds_are_kept(name):
    mechanism = crowded(MECHANISMS.find(name), SPACES[0], {})
    vectors, active = mechanism.move(1.0)
    lengths = np.linalg.norm(vectors[active], axis=1)
    highest = getattr(mechanism, "max_speed", np.inf)
    if name.startswith("Repulsion"):
        highest = 1.5
    assert (lengths <= highest * (1 + 1e-12)).all()
    lowest = 0.0 if name.startswith("Repulsion") else getattr(mechanism, "min_speed", 0.0)
    assert (lengths[lengths > 0] >= lowest * (1 - 1e-12)).all()


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
    mechanism = crowded(MECHANISMS.find(name), SPACES[0], {})
    before = mechanism.values.copy(), mechanism.state_codes.copy()
    decision = mechanism.decide(1.0)
    np.testing.assert_array_equal(mechanism.values, before[0])
    assert decision.values.shape == decision.states.shape == decision.decided.shape == (6,)
    mechanism.spread(1.0)
    kept = decision.decided & mechanism.poses.known
    np.testing.assert_array_equal(mechanism.values[kept], decision.values[kept])
    assert mechanism.values[NOWHERE] == before[0][NOWHERE]
    mechanism.reset(np.arange(6))
    np.testing.assert_array_equal(mechanism.values, before[0])
    np.testing.assert_array_equal(mechanism.state_codes, before[1])


@pytest.mark.parametrize("name", MECHANISMS.names())
def test_wrong_parameters_are_named(name):
    world = make_world()
    with pytest.raises(TypeError, match="maximal_speed"):
        MECHANISMS.find(name)(world.buffer, **MECHANISMS.find(name).example, maximal_speed=1.0)
    if name not in ("SpreadGradient", "WeightedSum"):
        with pytest.raises(ValueError, match="view_distance must be at least 0"):
            MECHANISMS.find(name)(world.buffer, **MECHANISMS.find(name).example, view_distance=float("nan"))


def test_unknown_names_list_the_known_ones_and_no_name_is_taken_twice():
    with pytest.raises(KeyError, match=r"unknown mechanism 'Repulsion' \(known: ApproachLeastBusy, .* more; did"):
        MECHANISMS.find("Repulsion")
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
