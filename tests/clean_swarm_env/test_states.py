"""States: bytes from which a world goes on, in its own batch, in another one, as many copies, in another process."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import TeamVectorEnv
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.worlds import Worlds
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.sealing import sealed, unsealed
from selforg.space import Torus
from tests.clean_swarm_env.copies import actions_of, advance, random_batch
from tests.clean_swarm_env.courses import CROWD, avoidance, long_course, mission, snapshot, worlds_at_start
from tests.clean_swarm_env.soak_states import BORDERS, tried
from tests.paths import ROOT

SHORT = mission(garbage={"count": 2}, time_limit=30.0)


def check_state(seed):
    """Put a world of a random batch into all worlds of another one, at another time of its clock."""
    rng = np.random.default_rng(seed)
    batch = random_batch(rng)
    advance(batch, rng, int(rng.integers(0, 60)))
    world, robots = int(rng.integers(batch.worlds.worlds)), batch.robots
    state = batch.get_state([world])
    other = copy.deepcopy(batch)
    advance(other, rng, int(rng.integers(1, 30)))
    other.set_state(state)
    own, copies = slice(world * robots, (world + 1) * robots), other.worlds.worlds
    if batch.action.mode == "option":
        assert np.array_equal(other.masks(), np.tile(batch.masks()[own], (copies, 1)))
    for _ in range(12):
        actions = actions_of(batch, rng)
        one, many = batch.step(actions), other.step(np.tile(actions[own], (copies, 1)))
        assert np.array_equal(many.rewards, np.tile(one.rewards[own], copies))
        assert np.array_equal(many.observations, np.tile(one.observations[own], (copies, 1)))
        assert np.array_equal(many.terminated, np.full(copies, one.terminated[world]))
        assert np.array_equal(many.truncated, np.full(copies, one.truncated[world]))


@long_course
@pytest.mark.parametrize("seed", range(8))
def test_all_worlds_of_another_batch_go_on_from_one_world_with_its_bits(seed):
    check_state((seed, 99))


@pytest.mark.parametrize("ticks", [0, 1, 57])
def test_a_world_goes_on_in_another_place_at_any_tick_also_while_robots_touch(ticks):
    worlds, others = worlds_at_start(CROWD, [5, 6, 7]), worlds_at_start(CROWD, [8, 9])
    for _ in range(ticks):
        worlds.tick()
    for _ in range(13):
        others.tick()
    others.set_state(worlds.get_state(1), 0)
    touched = False
    for _ in range(40):
        worlds.tick()
        others.tick()
        touched |= bool(worlds.physics._motion.record.patience[1])
        expected, found = snapshot(worlds, 1), snapshot(others, 0)
        assert [name for name in expected if not np.array_equal(expected[name], found[name])] == []
    assert touched


def test_a_state_leaves_the_other_worlds_as_they_are():
    worlds, alone = worlds_at_start(CROWD, [5, 6]), worlds_at_start(CROWD, [6])
    state = worlds.get_state(0)
    for tick in range(40):
        worlds.tick()
        alone.tick()
        if tick == 20:
            worlds.set_state(state, 0)
    expected, found = snapshot(alone, 0), snapshot(worlds, 1)
    assert [name for name in expected if not np.array_equal(expected[name], found[name])] == []


def test_a_batch_looks_ahead_and_comes_back():
    """What planning and tree search need: try, go back, and do it again with the same bits, over ends of episodes."""
    batch = Batch(SHORT, 2)
    batch.reset([1, 2])
    advance(batch, np.random.default_rng(0), 20)
    state, seen = batch.get_state(), batch.observations.copy()
    course = advance(batch, np.random.default_rng(1), 40)
    assert any(b"Finished" in part for part in course)
    assert np.array_equal(batch.set_state(state), seen)
    assert advance(batch, np.random.default_rng(1), 40) == course


def test_an_environment_goes_back_and_another_one_goes_on():
    """Agents that are gone, and cycles that are left, are those of the state."""

    def play(env):
        seen = []
        while env.agents:
            answers = env.step(dict.fromkeys(env.agents, 1))
            seen += [{agent: np.asarray(part).tolist() for agent, part in answer.items()} for answer in answers[:4]]
        return seen

    settings = {"family": "shifting", "max_cycles": 150}
    env, other = clean_swarm_v0.parallel_env(**settings), clean_swarm_v0.parallel_env(**settings)
    env.reset(seed=2)
    for _ in range(100):
        env.step(dict.fromkeys(env.agents, 0))
    assert len(env.agents) < len(env.possible_agents)
    state, course = env.get_state(), play(env)
    seen, infos = env.set_state(state)
    assert seen.keys() == infos.keys() == set(env.agents)
    assert play(env) == course
    assert len(course) == 4 * 50
    other.set_state(state)
    assert play(other) == course
    over = env.get_state()
    other.set_state(over)
    assert other.agents == []


def test_a_gymnasium_environment_and_a_vector_go_on_from_one_state():
    env, envs = CleanSwarmTeam(SHORT), TeamVectorEnv(3, mission=SHORT)
    env.reset(seed=2)
    for _ in range(10):
        env.step(np.ones(5, np.int64))
    assert np.array_equal(envs.set_state(env.get_state()), np.tile(env.batch.observations.ravel(), (3, 1)))
    for _ in range(10):
        one, many = env.step(np.zeros(5, np.int64)), envs.step(np.zeros((3, 5), np.int64))
        assert np.array_equal(many[0], np.tile(one[0], (3, 1)))
        assert many[1].tolist() == [one[1]] * 3


def test_a_batch_that_records_takes_no_state(tmp_path):
    batch = Batch(SHORT)
    batch.reset([1])
    with pytest.raises(ValueError, match="set_state: expected a batch that records nothing"):
        Batch(SHORT, record=RecordSettings(tmp_path)).set_state(batch.get_state())


def test_a_state_goes_on_in_another_process(tmp_path):
    batch = Batch(CROWD, 1)
    batch.reset([3])
    advance(batch, np.random.default_rng(0), 12)
    (tmp_path / "state").write_bytes(batch.get_state())
    advance(batch, np.random.default_rng(1), 10)
    code = (
        "import numpy as np; from clean_swarm_env.learning.batch import Batch\n"
        "from tests.clean_swarm_env.copies import advance; from tests.clean_swarm_env.courses import CROWD\n"
        f"batch = Batch(CROWD, 1); batch.set_state(open({str(tmp_path / 'state')!r}, 'rb').read())\n"
        "advance(batch, np.random.default_rng(1), 10); print(batch.observations.tobytes().hex())"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == batch.observations.tobytes().hex()


@pytest.mark.parametrize("name", BORDERS)
def test_damaged_states_are_refused_and_change_nothing(name, capfd):
    assert tried(name, 40) == 0, capfd.readouterr().err


def test_a_batch_of_which_the_last_world_does_not_fit_stays_as_it_was():
    batch, other = Batch(SHORT, 2), Batch(CROWD, 2)
    for one in (batch, other):
        one.reset([1, 2])
        advance(one, np.random.default_rng(0), 5)
    before, (own, _), (_, foreign) = batch.get_state(), *(unsealed("batch", b.get_state()) for b in (batch, other))
    with pytest.raises(ValueError, match="world: expected"):
        batch.set_state(sealed("batch", [own, foreign]))
    assert batch.get_state() == before


def test_batches_of_which_the_last_one_does_not_fit_stay_as_they_were():
    pytest.importorskip("stable_baselines3", reason="needs the extra 'train'")
    from clean_swarm_env.sb3 import RobotVecEnv

    def envs(last):
        made = RobotVecEnv(batches=[Batch(SHORT), Batch(SHORT, action={"mode": last})])
        made.reset()
        return made

    whole, other = envs("option"), envs("option")
    other.batches = (other.batches[0], Batch(CROWD))
    other.batches[1].reset([1])
    before = whole.get_state()
    sizes, states, *rest = unsealed("robots", before)
    first, foreign = (unsealed("batch", one)[0] for one in (states, other.batches[1].get_state()))
    with pytest.raises(ValueError, match="world: expected"):
        whole.set_state(sealed("robots", (sizes, sealed("batch", [first, foreign]), *rest)))
    assert whole.get_state() == before
    with pytest.raises(ValueError, match=r"^state: worlds: expected 2, got 1$"):
        whole.set_state(RobotVecEnv(worlds=1, mission=SHORT).get_state())


def test_an_environment_with_fewer_cycles_than_a_state_has_done_is_over():
    env, short = clean_swarm_v0.parallel_env(SHORT), clean_swarm_v0.parallel_env(SHORT, max_cycles=2)
    env.reset(seed=2)
    for _ in range(3):
        env.step(dict.fromkeys(env.agents, 0))
    short.set_state(env.get_state())
    assert short.agents == []


class OfAPlugin:
    """Something that is pickled by its name."""


def test_a_state_of_a_class_that_is_not_installed_is_refused_in_one_line(monkeypatch):
    state = sealed("world", OfAPlugin())
    monkeypatch.delattr(sys.modules[__name__], "OfAPlugin")
    with pytest.raises(ValueError, match=r"^state: expected one of the classes that are installed, got .*OfAPlugin"):
        unsealed("world", state)


def test_what_does_not_fit_is_refused_in_one_line():
    batch = Batch(SHORT, 2)
    batch.reset([1, 2])
    state = batch.get_state()
    with pytest.raises(ValueError, match=r"^state: expected b'clean-swarm state 8 batch', got b'clean-swarm state 5'$"):
        batch.set_state(b"clean-swarm state 5\n" + pickle.dumps([]))  # as they were saved before
    with pytest.raises(ValueError, match=r"^state: expected the bytes of get_state, got NoneType$"):
        batch.set_state(None)
    with pytest.raises(ValueError, match=r"^state: expected b'clean-swarm state 8 world', got"):
        Worlds(SHORT, avoidance()).set_state(state)
    with pytest.raises(ValueError, match=r"^state: terms: expected .*, got \('carrying', 'recycled'\)$"):
        Batch(SHORT).set_state(Batch(SHORT, observation={"terms": ["cargo"]}).get_state())
    with pytest.raises(ValueError, match="state: expected one world, or 1, got 2"):
        batch.set_state(state, [0])
    with pytest.raises(ValueError, match="worlds: expected 0 to 1, got 2"):
        batch.get_state([2])
    with pytest.raises(ValueError, match="world: expected"):
        Batch(CROWD).set_state(batch.get_state([0]))
    with pytest.raises(ValueError, match=r"^state: coordinators.0.contents.0.robots.network.state.marks: expected "):
        Worlds(SHORT, avoidance(), explained=True).set_state(Worlds(SHORT, avoidance()).get_state())


def buffer_of(rows, names=None, **options):
    poses = OwnPoses(Torus(10.0, 10.0), rows, np.arange(rows) // 2, names=names)
    poses.update(np.tile([[1.0, 1.0], [2.0, 1.0]], (rows // 2, 1)), np.zeros(rows), 0.0)
    settings = BufferSettings(aggregation={"DEFAULT": "new"}, aggregation_distance=0.1)
    return SoBuffer(settings, poses.space, poses, **options)


def pair_of(buffer, channel):
    """A pair of the only gradient on a channel."""
    layers = buffer.table.record.links[: len(buffer) + 1, c.LINK_LAYER] // (c.LEVELS * buffer.table.spaces)
    pair = np.zeros(c.PAIR_COLUMNS)
    pair[c.PAIR_SLOT] = np.flatnonzero(layers == buffer.channels.code(channel))[0]
    return pair


def test_gradients_of_a_team_come_with_their_senders_names_and_payloads():
    buffer, other = buffer_of(4), buffer_of(6)
    other.store(Gradient("mine", (1.0, 1.5), payload={"other": 1.0}), 5.0, team=0)
    beacon = Gradient("beacon", (1.0, 2.0), source="lamp", payload={"colour": "red", "size": 2.0}, stamp=1.0)
    buffer.store(beacon, 1.0, team=1)
    buffer.store(Gradient("robot 2", (1.5, 1.0), source=3, moving=True, payload={"value": 7.0}, stamp=1.0), 1.0, team=1)
    other.put_part(0, buffer.part_of(1), 4.0)
    assert other.count(0, "mine") == 0
    found = {name: other.gradient_of(pair_of(other, name)) for name in ("beacon", "robot 2")}
    assert found["beacon"].payload == {"colour": "red", "size": 2.0}
    assert (found["beacon"].source, found["beacon"].stamp) == ("lamp", 5.0)
    assert (found["robot 2"].source, found["robot 2"].payload) == (1, {"value": 7.0})


def test_messages_under_way_are_part_of_a_state():
    buffer, other = (buffer_of(rows, delivery=Delivery(delay=1.0)) for rows in (4, 6))
    messages, tags = buffer.blank(1, "trail")
    messages[:, [c.DIFFUSION, c.MESSAGE_FAR + c.FAR_FACTOR]] = 1.0
    other.channel_code("mine")
    buffer.deposit(np.array([0, 3]), messages[0], tags[0], 5.0)
    other.put_part(2, buffer.part_of(1), 10.0)
    other.deliver(15.9)
    assert other.count(2, "trail") == 0
    other.deliver(16.0)
    assert other.count(2, "trail") == 2  # one for each row of the team
    gradient = other.gradient_of(pair_of(other, "trail"))
    assert (gradient.source, gradient.position, gradient.stamp) == (5, (2.0, 1.0), 15.0)


def test_a_state_is_a_copy():
    worlds = worlds_at_start(CROWD, [5])
    state = worlds.get_state()
    before = pickle.dumps(state)
    for _ in range(30):
        worlds.tick()
    assert pickle.dumps(state) == before
