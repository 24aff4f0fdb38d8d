"""The coordinator: the network above sees what it would see without the nesting; the content runs inside."""

from functools import partial

import numpy as np
import pytest

from clean_swarm_env.config.mission import NetworkConfig
from clean_swarm_env.tasks.cleaning.robot import robot_network
from selector.configurations.host import Host
from selector.configurations.library import Library
from selector.coordination.coordinator import Coordinator
from selector.coordination.model import CoordinatorModel
from selector.documents.errors import DocumentError
from selector.knowledge import load_knowledge
from selforg.commands import Commands
from selforg.compiler.records import Packed
from selforg.components.robot import Turning, list_turns
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MovementMechanism
from selforg.network.model.behaviours import Behaviour, Sensor
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from selforg.program import DECIDE, SENSE, Program, Rows
from selforg.space import Euclidean
from tests.selforg.programs import run

ROWS, GOAL = 20, "AvoidCollision"
MINE = """
mechanisms: {push: {type: RepulsionGradient}, pull: {type: RepulsionFernandez}}
sensors: {near: {type: VectorPresent, mechanism: push}, far: {type: VectorPresent, mechanism: pull}}
behaviours:
  Push: {action: {type: Move, mechanism: push}, preconditions: [{sensor: near, activator: {type: Boolean}}],
         effects: [{sensor: near, change: -1.0}]}
  Pull: {action: {type: Move, mechanism: pull}, preconditions: [{sensor: far, activator: {type: Boolean}}],
         effects: [{sensor: far, change: -1.0}]}
"""


class Fixed:
    """Gives each row the vector it is told, in place of what a mechanism says; rows asked for are noted."""

    def __init__(self, mechanism, vectors):
        self.vectors, self.asked = vectors, []
        mechanism.move_into = self.move_into
        mechanism.moving = partial(MovementMechanism.moving, mechanism)

    def move_into(self, now, rows, vectors, active):
        self.asked.append(np.asarray(rows).tolist())
        vectors[rows] = self.vectors[rows]
        active[rows] = np.hypot(*self.vectors[rows].T) > 0.0


@pytest.fixture
def avoidance():
    return CoordinatorModel(GOAL, load_knowledge("cleaning"), Library())


def _flat(nested: NetworkModel, avoidance: CoordinatorModel, option: int) -> NetworkModel:
    """Return the model with the option's own behaviour in place of the coordinator."""
    inner = avoidance.configurations[option].network_behaviours()
    return NetworkModel(nested.sensors, (*nested.behaviours[:-1], *inner), nested.goals, nested.settings)


@pytest.mark.parametrize("planner", [False, True])
@pytest.mark.parametrize("option", [0, 2])
def test_the_network_above_does_what_it_would_do_without_the_nesting(avoidance, option, planner):
    model = robot_network(NetworkConfig(), [avoidance]).model
    flat_model = _flat(model, avoidance, option)
    nested = BehaviourNetwork(model, ROWS, Planner(model) if planner else None)
    flat = BehaviourNetwork(flat_model, ROWS, Planner(flat_model) if planner else None)
    nested.hold(np.arange(ROWS), model.behaviour_index[GOAL], option)
    rng, ran = np.random.default_rng(1), set()
    readings = np.zeros_like(nested.readings)
    for _ in range(300):
        changed = rng.random(readings.shape) < 0.1
        readings = np.where(changed, rng.integers(2, size=readings.shape), readings).astype(float)
        for network in (nested, flat):
            network.readings[:] = readings
            network.step()
        assert np.array_equal(nested.executing, flat.executing)
        np.testing.assert_allclose(nested.state.values[:, 0], flat.state.values[:, 0], rtol=0.0, atol=1e-12)
        ran |= set(np.flatnonzero(nested.executing.any(axis=0)).tolist())
    assert model.behaviour_index[GOAL] in ran
    assert len(ran) > 4


def _coordinator(avoidance, vectors):
    model = robot_network(NetworkConfig(), [avoidance]).model
    network, poses = BehaviourNetwork(model, ROWS), OwnPoses(Euclidean(2), ROWS)
    host = Host(poses, {"gradients": SoBuffer(BufferSettings(), poses.space, poses)})
    coordinator = Coordinator(avoidance, network, host)
    return coordinator, network, [Fixed(c.mechanisms["avoidance"], vectors) for c in coordinator.contents]


def test_only_the_mechanisms_held_are_asked_and_only_by_their_rows(avoidance):
    coordinator, _, made = _coordinator(avoidance, np.zeros((ROWS, 2)))
    coordinator.hold(np.arange(ROWS), np.where(np.arange(ROWS) < 15, 0, 2))
    run(coordinator.serving(Commands(ROWS, 2)), 0.0, SENSE)
    assert [mechanism.asked for mechanism in made] == [[list(range(15))], [], [list(range(15, 20))]]


def test_presence_and_length_of_the_vector_are_read_and_forgotten_when_the_option_changes(avoidance):
    vectors = np.zeros((ROWS, 2))
    vectors[3], vectors[4] = (0.3, 0.4), (1e-10, 0.0)
    coordinator, network, _ = _coordinator(avoidance, vectors)
    run(coordinator.serving(Commands(ROWS, 2)), 0.0, SENSE)
    presence, length = (network.model.sensor_index[name] for name in ("rep_bool", "rep_len"))
    assert np.flatnonzero(network.readings[:, presence]).tolist() == [3]
    assert network.readings[3, length] == pytest.approx(0.5)
    coordinator.hold(np.array([3]), np.array([1]))
    assert network.readings[3, presence] == network.readings[3, length] == 0.0


def test_a_running_coordinator_moves_its_rows_by_the_vector_of_the_option_they_hold(avoidance):
    vectors = np.random.default_rng(1).normal(size=(ROWS, 2)) + 2.0
    coordinator, network, made = _coordinator(avoidance, vectors)
    made[2].vectors = -vectors
    coordinator.hold(np.arange(ROWS), np.arange(ROWS) % 2 * 2)
    ran = np.zeros(ROWS, np.bool_)
    network.read({"garbage_found": True})  # nothing else is ready: there is nothing to patrol for
    commands = Commands(ROWS, 2)
    steps = [*coordinator.serving(commands), network.deciding(DECIDE, Rows.of(np.arange(ROWS)), False)]
    program = Program(lambda: steps)
    for _ in range(60):
        commands.clear()
        program.run(0.0)
        moved, commanded = commands.vectors, commands.commanded
        running = network.executing[:, coordinator.index] == 1
        assert np.array_equal(commanded, running)
        sign = np.where(np.arange(ROWS) % 2, -1.0, 1.0)[:, None]
        assert np.array_equal(moved[running], (sign * vectors)[running])
        assert not moved[~running].any()
        ran |= running
    assert ran.all()


def test_of_several_behaviours_the_coordinator_is_ready_when_one_is(tmp_path):
    (tmp_path / "mechanisms").mkdir()
    (tmp_path / "mechanisms" / "Mine.yaml").write_text(MINE)
    (tmp_path / "knowledge").mkdir()
    (tmp_path / "knowledge" / "mine.yaml").write_text("goals: {Keep: [{configuration: Mine, score: 1.0}]}")
    model = CoordinatorModel("Keep", load_knowledge("mine", [tmp_path]), Library([tmp_path]))
    above = NetworkModel(model.sensors, (model.behaviour(),), ())
    network = BehaviourNetwork(above, 4)
    network.hold(np.arange(4), 0, 0)
    network.readings[:] = [[0, 0], [0, 1], [1, 0], [1, 1]]
    for _ in range(60):
        network.step()
    ran = network.executing[:, 0].astype(bool) | (network.state.values[:, 0][:, 0] > 0.0)
    assert ran.tolist() == [False, True, True, True]


def test_options_that_do_not_exist_are_refused(avoidance):
    coordinator, *_ = _coordinator(avoidance, np.zeros((ROWS, 2)))
    with pytest.raises(ValueError, match=r"AvoidCollision: expected options 0\.\.2, got \[3\]"):
        coordinator.hold(np.array([1]), np.array([3]))
    with pytest.raises(DocumentError, match="Flocking"):
        CoordinatorModel("Flocking", load_knowledge("cleaning"), Library())


def test_a_network_inside_is_listed_as_stale_once():
    model = NetworkModel([Sensor("near", "fact")], [Behaviour("Go")], [])
    outer, inner = BehaviourNetwork(model, 3), BehaviourNetwork(model, 3)
    none = np.zeros(0, dtype=np.int64)
    room = (np.zeros(size, dtype=np.int64) for size in (3, 3, 1))
    turning = Turning(none, 0, none, none, np.array([1, 1, 0]), *room)
    inner.state.values[:] = 1.0
    records = (Packed(turning), outer.packed, model.packed, inner.packed)
    for reset in ([0.0, 1.0, 1.0], [1.0, 1.0, 1.0]):
        list_turns(0.0, np.array([0, 2]), *(packed.handle for packed in records))
        assert (turning.acting[:2].tolist(), turning.length[0], turning.stale.tolist()) == ([0, 2], 2, [0, 1, 0])
        assert inner.state.values[:, 0, 0].tolist() == reset
        inner.state.values[:] = 1.0
