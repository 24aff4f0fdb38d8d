"""Configurations that use every component: what each becomes, and mistakes with their places."""

import re

import numpy as np
import pytest
import yaml

from selector.configurations.configuration import ConfigurationSpec
from selector.configurations.host import Host, host_memory
from selector.configurations.library import Library
from selector.configurations.running import RunningConfiguration
from selector.coordination.model import CoordinatorModel
from selector.coordination.robots import CoordinatedRobots
from selector.documents.errors import DocumentError, validated
from selector.knowledge import knowledge_from, load_knowledge
from selforg.components import RobotMemory
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.randomness import DirectionStream
from selforg.space import Euclidean
from tests.selector.refusing import refusal
from tests.selforg.programs import Alone

EVERYTHING = """
parameters: {sight: 5.0}
mechanisms:
  go: {type: ChemotaxisBalch, hold: 1.0, parameters: {channels: [goal], view_distance: $sight}}
  patrol: {type: Patrol, buffer: trails, parameters: {pheromone: {channel: trail, attraction: -1}, channels: [trail]}}
  quorum: {type: Quorum, parameters: {threshold: 2, carried: {channel: quorum, key: many}}}
  gossip: {type: GossipMax, parameters: {value: measured}}
  light: {type: SpreadGradient, parameters: {carried: {channel: light, diffusion: 2.0}}}
targets:
  goal: {channels: [goal], moving: false, view_distance: $sight}
  oldest: {rule: least_reach_attractive, buffer: trails}
knowledge: {told: false, role: 0.0}
expects: {measured: number, ready: fact}
sensors:
  present: {type: VectorPresent, mechanism: go, longer_than: 0.01}
  length: {type: VectorLength, mechanism: go}
  seen: {type: GoalPresent, target: goal}
  there: {type: GoalReached, target: goal}
  far: {type: GoalDistance, target: goal, unseen: 9.0}
  farther: {type: FartherThan, target: goal, distance: 3.0}
  many: {type: Value, mechanism: quorum}
  crowded: {type: StateIs, mechanism: quorum, state: "True"}
  news: {type: Changed, mechanism: gossip}
  told: {type: Known, name: told}
  role: {type: Known, name: role}
  ready: {type: Known, name: ready}
behaviours:
  Look:
    action: [{type: Turn, target: goal}, {type: Spread, mechanism: light}]
    preconditions: [{sensor: ready, activator: {type: Boolean, desired: false}}]
  Go: {action: {type: Move, mechanism: go}, preconditions: [{sensor: ready, activator: {type: Boolean}}]}
  Tell:
    action:
      - {type: Decide, mechanism: gossip}
      - {type: DecideState, mechanism: quorum, name: role}
      - {type: SetState, name: told, value: true}
      - {type: Act, call: ring}
    preconditions: [{sensor: told, activator: {type: Boolean, desired: false}}]
"""


def content(**changes):
    return yaml.safe_load(EVERYTHING) | changes


def library_of(directory, document):
    (directory / "mechanisms").mkdir(exist_ok=True)
    (directory / "mechanisms" / "All.yaml").write_text(yaml.safe_dump(document))
    library = Library([directory])
    library.configuration("All")
    return library


@pytest.fixture
def model(tmp_path):
    options = [{"configuration": "All", "score": 1.0}, {"configuration": "RandomWalk", "score": 0.5}]
    return CoordinatorModel("Do", knowledge_from({"goals": {"Do": options}}), library_of(tmp_path, content()))


def host_of(model, rung=None):
    poses = OwnPoses(Euclidean(2), 3, goal_radius=0.25)
    buffers = {name: SoBuffer(BufferSettings(), poses.space, poses) for name in ("gradients", "trails")}
    buffers["gradients"].store_static(0, "goal", np.array([[4.0, 0.0]]), 0.0, diffusion=2.0, goal_radius=0.5)
    memory = host_memory(model.configurations, 3)
    memory["measured"].write([0, 1, 2], [3.0, 7.0, 5.0])
    calls = {"ring": lambda now, rows: None if rung is None else rung.append(rows.tolist())}
    poses.update(np.array([[0.0, 0.0], [1.0, 0.0], [30.0, 0.0]]), np.zeros(3), 0.1)
    return Host(poses, buffers, None, [np.random.default_rng(0)] * 3, memory, calls)


def test_every_sensor_and_action_is_what_it_says(model):
    rung = []
    host = host_of(model, rung)
    robots = CoordinatedRobots(model, host)
    host.memory["ready"].write([0], True)
    commands = robots.tick(0.2)
    inner = robots.coordinators[0].contents[0]
    read = dict(zip(inner.network.model.sensor_index, inner.network.readings.T.tolist(), strict=True))
    assert (read["seen"], read["there"], read["farther"]) == ([1, 1, 0], [0, 0, 0], [1, 0, 0])
    assert read["far"] == [3.25, 2.25, 9.0]
    assert (read["many"], read["crowded"]) == ([1.0, 1.0, 0.0], [0, 0, 0])
    assert (read["present"], read["ready"], read["told"]) == ([1, 1, 0], [1, 0, 0], [0, 0, 0])
    assert commands.in_place.tolist() == [False, True, True]
    assert commands.commanded.tolist() == [True, True, False]
    assert commands.vectors[0, 0] > 0.0
    assert rung == [[0, 1, 2]]
    assert host.buffers["gradients"].count(0, "light") == 2  # of those who look
    assert host.buffers["gradients"].count(0, "gossip") == host.buffers["gradients"].count(0, "quorum") == 3
    assert inner.mechanisms["gossip"].values.tolist() == [3.0, 7.0, 5.0]
    poses = host.poses
    poses.update(poses.positions + 0.1, np.zeros(3), 0.3)
    robots.tick(0.4)
    assert read != dict(zip(inner.network.model.sensor_index, inner.network.readings.T.tolist(), strict=True))
    assert inner.network.readings[:, inner.network.model.sensor_index["told"]].tolist() == [1, 1, 1]
    assert inner.network.readings[:, inner.network.model.sensor_index["news"]].tolist() == [1, 0, 1]  # 7 was heard of


def test_an_option_taken_up_begins_anew_and_others_go_on(model):
    host = host_of(model)
    robots = CoordinatedRobots(model, host)
    for step in range(1, 6):
        robots.tick(0.2 * step)
    (coordinator,) = robots.coordinators
    inner = coordinator.contents[0]
    told = inner.network.model.sensor_index["told"]
    kept = inner.network.state.values[0].copy()
    host.memory["measured"].write([1], 1.0)
    host.memory["ready"].write([1], True)
    robots.hold(np.array([1]), np.array([1]))
    assert np.array_equal(inner.network.state.values[0], kept)
    robots.hold(np.array([0]), np.array([1]))
    assert inner.mechanisms["gossip"].values.tolist() == [3.0, 1.0, 5.0]  # begun with what is measured now
    robots.tick(1.2)
    assert inner.network.readings[:, told].tolist() == [1, 0, 1]
    assert host.memory["ready"].values.tolist() == [0, 1, 0]


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        ("mechanisms.go.type", "Chemotaxis", "mechanisms.go.type: unknown mechanism 'Chemotaxis'"),
        (
            "mechanisms.go.parameters.speed",
            1.0,
            "mechanisms.go.parameters: speed: unknown key 'speed' (known: c",
        ),
        ("mechanisms.go.parameters.max_speed", "fast", "mechanisms.go.parameters: max_speed: expected a valid number"),
        ("mechanisms.go.parameters.max_speed", -1.0, "mechanisms.go.parameters: ChemotaxisBalch: max_speed must be at"),
        ("mechanisms.go.parameters.channels", "goal", "mechanisms.go.parameters: channels: expected a valid tuple"),
        ("mechanisms.quorum.parameters", {}, "mechanisms.quorum.parameters: threshold: missing key"),
        (
            "mechanisms.quorum.parameters.carried",
            {"key": "x"},
            "mechanisms.quorum.parameters: carried.channel: missing",
        ),
        ("mechanisms.light.parameters.carried.radius", 1.0, "light.parameters: carried.radius: unknown key"),
        ("mechanisms.light.parameters.carried.attraction", 2, "light.parameters: gradient: attraction must be"),
        (
            "mechanisms.gossip.parameters.value",
            "told",
            "value: expected a number or a name under expects (measured, re",
        ),
        ("targets.goal.rule", "best", "targets.goal.rule: expected 'nearest_attractive'"),
        (
            "sensors.seen.target",
            "gaol",
            "sensors.seen.target: unknown target 'gaol' (known: goal, oldest; did you mean",
        ),
        ("sensors.crowded.state", "Many", "sensors.crowded: StateIs: state must be one of False, True, got 'Many'"),
        (
            "sensors.length.mechanism",
            "quorum",
            "length.mechanism: expected a movement mechanism, got 'quorum', which is",
        ),
        (
            "sensors.many.mechanism",
            "go",
            "sensors.many.mechanism: expected a decision mechanism, got 'go', which is a C",
        ),
        (
            "sensors.told.name",
            "tale",
            "sensors.told.name: unknown knowledge 'tale' (known: measured, ready, role, told",
        ),
        ("behaviours.Go.action.type", "Fly", "behaviours.Go.action.0.type: unknown action "),
        ("behaviours.Go.action", [], "behaviours.Go.action: "),
        ("behaviours.Look.action", {"type": "Turn"}, "expected a mechanism or a target"),
        (
            "behaviours.Go.action",
            {"type": "Spread", "mechanism": "go"},
            "Go.action.mechanism: expected a SpreadGradient",
        ),
        ("behaviours.Go.action", {"type": "SetState", "name": "told", "value": 0.5}, "'told' is a fact: expected True"),
        ("expects.told", "fact", "expects.told: is under knowledge too"),
        ("expects.ready", "truth", "expects.ready: expected 'fact' or 'number', got 'truth'"),
        ("settings", {"max_parallel": 0}, "settings.max_parallel: expected"),
    ],
)
def test_a_mistake_is_one_line_with_file_and_key(tmp_path, place, value, message):
    document = content()
    *path, last = place.split(".")
    inner = document
    for key in path:
        inner = inner[key]
    inner[last] = value
    line = refusal(library_of, tmp_path, document)
    assert "All.yaml: " in line
    assert message in line


def test_a_host_that_lacks_something_is_told_what(model):
    whole = host_of(model)
    for changes, message in (
        ({"buffers": {"gradients": whole.buffers["gradients"]}}, r"unknown buffer 'trails' \(known: gradients\)"),
        ({"calls": {}}, r"unknown call 'ring' \(known: none\)"),
        ({"memory": RobotMemory(3, {})}, r"expects: unknown knowledge 'measured' \(known: none\)"),
        (
            {"memory": RobotMemory(3, {"measured": 1.0, "ready": 0.0})},
            "expects.ready: expected a fact, but the host kn",
        ),
    ):
        host = Host(**({name: getattr(whole, name) for name in Host.__dataclass_fields__} | changes))
        with pytest.raises(DocumentError, match=f"goal Do: option All: {message}"):
            CoordinatedRobots(model, host)


LIBRARY = load_knowledge("library")


@pytest.mark.parametrize("goal", LIBRARY.goals)
def test_every_option_of_the_library_gives_the_same_commands_to_equal_robots_alone_or_together(goal):
    """Two far apart teams of three: each is told what it is told alone, whatever the other holds."""
    model = CoordinatorModel(goal, LIBRARY, Library())
    places = np.array([[0.0, 0.0], [1.0, 0.5], [0.3, 1.5]])
    for option in range(len(model.options)):
        alone = commands_of(model, places, np.zeros(3, int), np.full(3, option))
        both = commands_of(
            model,
            np.vstack([places, places]),
            np.repeat([0, 1], 3),
            np.append(np.full(3, option), np.arange(3) % 2 % len(model.options)),
        )
        np.testing.assert_array_equal(both[:, :3], alone)


def commands_of(model, places, teams, options, steps=40):
    rows = len(places)
    poses = OwnPoses(Euclidean(2), rows, teams)
    buffers = {name: SoBuffer(BufferSettings(), poses.space, poses) for name in ("gradients", "pheromones")}
    buffers["own_pheromones"] = SoBuffer(BufferSettings(), poses.space, poses, Delivery(reach=0.0))
    for team in range(poses.team_count):
        for channel, x in (
            ("goal", 6.0),
            ("centre", 4.0),
            ("field", 5.0),
            ("food", 3.0),
            ("nest", -4.0),
            ("obstacle", 2.0),
        ):
            sign = -1 if channel == "obstacle" else 1
            buffers["gradients"].store_static(
                team, channel, np.array([[x, 1.0]]), 0.0, diffusion=3.0, goal_radius=0.3, attraction=sign
            )
    memory = host_memory(model.configurations, rows)
    generators = [np.random.default_rng([5, k % 3]) for k in range(rows)]
    host = Host(poses, buffers, None, generators, memory)
    robots, told = CoordinatedRobots(model, host), []
    robots.hold(options)
    positions = places.copy()
    for step in range(1, steps):
        poses.update(positions, np.zeros(rows), 0.2 * step)
        commands = robots.tick(0.2 * step)
        positions = positions + 0.2 * commands.vectors
        told.append(np.column_stack([commands.vectors, commands.commanded]))
    return np.array(told)


@pytest.mark.parametrize(
    ("of", "said"),
    [
        ("{go: 1.0, quorum: 1.0}", "of: unknown movement mechanism above it 'quorum' (known: go, patrol)"),
        ("{light: 1.0}", "of: unknown movement mechanism above it 'light'"),
        ("{both: 1.0}", "of: unknown movement mechanism above it 'both'"),
        ("{}", "of: expected the weights of one or more movement mechanisms, got none"),
        ("{go: much}", "of.go: expected a valid number, got 'much'"),
        ("{go: .inf}", "of.go: "),
        ("go", "of: expected a valid dictionary, got 'go'"),
    ],
)
def test_a_sum_of_what_is_no_movement_is_one_line(tmp_path, of, said):
    content = EVERYTHING.replace("targets:", f"  both: {{type: WeightedSum, parameters: {{of: {of}}}}}\ntargets:", 1)
    (tmp_path / "mechanisms").mkdir()
    (tmp_path / "mechanisms" / "Mine.yaml").write_text(content)
    with pytest.raises(DocumentError, match=re.escape(said)) as raised:
        Library([tmp_path]).configuration("Mine")
    assert "mechanisms.both.parameters" in str(raised.value)


def test_a_sum_asks_its_parts_once_for_all_who_read_them(tmp_path):
    """A held random walk is the same alone and in a sum that is read beside it."""
    content = {
        "mechanisms": {
            "walk": {"type": "Exploration", "hold": 1.0},
            "away": {"type": "RepulsionGradient"},
            "both": {"type": "WeightedSum", "parameters": {"of": {"walk": 0.5, "away": -2.0}}},
        },
        "sensors": {"length": {"type": "VectorLength", "mechanism": "walk"}},
        "behaviours": {"Go": {"action": {"type": "Move", "mechanism": "both"}}},
    }
    spec = validated(ConfigurationSpec, content, "mine.yaml")
    poses = OwnPoses(Euclidean(2), 3, goal_radius=0.25, diffusion=1.0)
    poses.update(np.array([[0.0, 0.0], [0.7, 0.0], [9.0, 9.0]]), np.zeros(3), 0.0)
    drawn = DirectionStream([np.random.default_rng(row) for row in range(3)])
    made = RunningConfiguration(
        spec, Host(poses, {"gradients": SoBuffer(BufferSettings(), poses.space, poses)}, drawn), ""
    )
    walk, away, _ = (made._movements[name] for name in ("walk", "away", "both"))
    alone = Alone(made, guarantee=True)
    for tick in range(1, 12):
        commands = alone.tick(0.2 * tick)
        assert commands.commanded.all()
        assert np.array_equal(commands.vectors, 0.5 * walk.vectors + -2.0 * away.vectors)
        assert drawn.cursor.tolist() == [1 + (tick - 1) // 5] * 3
