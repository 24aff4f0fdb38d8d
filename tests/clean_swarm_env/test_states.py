"""Copies and states at every border: whatever takes them goes on with the same bits, also in another process."""

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.learning.batch import Batch, run_out
from clean_swarm_env.learning.interface import BATCH_STATES
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.worlds import Worlds
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.sealing import sealed, unsealed
from selforg.space import Torus
from tests.clean_swarm_env import soak_copies
from tests.clean_swarm_env.copies import BORDERS, PICKLED, SHORT, check_copy, played
from tests.clean_swarm_env.courses import CROWD, avoidance, begun, course_of, ticked
from tests.paths import ROOT

each_border = pytest.mark.parametrize("border", BORDERS)


@pytest.mark.parametrize(
    ("border", "way"), [*((border, "pickle") for border in BORDERS), ("parallel_env of a family", "cloudpickle")]
)
def test_a_copy_has_all_further_bits_also_without_its_original(border, way):
    """SuperSuit makes its copies of an environment by cloudpickle."""
    made = BORDERS[border]()
    played(made, 1, 8)
    check_copy(made, PICKLED[way], 2)


@each_border
def test_a_state_is_gone_back_to_and_gone_on_from_elsewhere(border):
    """Over the ends of missions, and while agents leave and join."""
    made, other = BORDERS[border](), BORDERS[border]()
    played(made, 1, 8)
    played(other, 2, 15)
    state = made.get_state()
    course = played(made, 3, 35)
    for one in (made, other):
        one.set_state(state)
        assert played(one, 3, 35) == course


@each_border
def test_a_damaged_state_is_refused_in_one_line_and_changes_nothing(border):
    made, other = BORDERS[border](), BORDERS["Batch" if border == "Worlds" else "Worlds"]().get_state()
    own = made.get_state()
    half, size = len(own) // 2, len(own)
    flipped = [own[:k] + bytes([own[k] ^ 1]) + own[k + 1 :] for k in (0, 25, 40, 60, half, size - 1)]
    for broken in (
        b"",
        own[:half],
        own[1:],
        own[half:] + own[:half],
        own + b"\0",
        other,
        own[:60] + other[60:],
        *flipped,
    ):
        with pytest.raises(ValueError, match=r"\A[^\n]+\Z"):
            made.set_state(broken)
        assert made.get_state() == own


def test_a_state_of_classes_of_other_sources_is_refused_in_one_line():
    with pytest.raises(ValueError, match=r"\Astate: expected one of the classes that are installed, got [^\n]+\Z"):
        BORDERS["Batch"]().set_state(sealed(BATCH_STATES, [b"cno_such_module\nState\n."]))


@pytest.mark.long
def test_random_missions_are_copied_and_go_on_from_states_at_random_moments(capsys):
    soak_copies.main(60)
    assert "60 random copies and 60 states: equal bits" in capsys.readouterr().out


def go_on(saved: Path) -> str:
    """Return how a pickled mission ends, and how a batch goes on from a state."""
    course, state = pickle.loads(saved.read_bytes())
    batch = Batch(SHORT)
    batch.set_state(state)
    return repr((run_out(course), course.worlds.physics.positions.tolist(), played(batch, 1)))


def test_a_mission_and_a_state_go_on_in_another_process(tmp_path):
    course, batch = course_of(SHORT, 4, 4), begun(Batch(SHORT), [3])
    played(batch, 0)
    (tmp_path / "saved").write_bytes(pickle.dumps((ticked(course, 37), batch.get_state())))
    code = f"from tests.clean_swarm_env.test_states import *; print(go_on(Path({str(tmp_path / 'saved')!r})))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == go_on(tmp_path / "saved")


def test_a_batch_that_records_is_not_copied_and_takes_no_state(tmp_path):
    """Both would write the same files, and a recording has no jumps."""
    recorded = Batch(SHORT, record=RecordSettings(tmp_path))
    with pytest.raises(TypeError, match="a batch that records its missions cannot be copied"):
        pickle.dumps(recorded)
    with pytest.raises(ValueError, match="set_state: expected a batch that records nothing"):
        recorded.set_state(begun(Batch(SHORT), [1]).get_state())


def test_an_environment_with_fewer_cycles_than_a_state_has_done_is_over():
    env, short = clean_swarm_v0.parallel_env(SHORT), clean_swarm_v0.parallel_env(SHORT, max_cycles=2)
    played(env, 0, 3)
    short.set_state(env.get_state())
    assert short.agents == []


@pytest.fixture
def batch():
    return begun(Batch(SHORT, 2), [1, 2])


def test_a_batch_of_which_the_last_world_does_not_fit_stays_as_it_was(batch):
    before = batch.get_state()
    (own, _), (_, foreign) = (unsealed("batch", b.get_state()) for b in (batch, begun(Batch(CROWD, 2), [1, 2])))
    with pytest.raises(ValueError, match="world: expected"):
        batch.set_state(sealed("batch", [own, foreign]))
    assert batch.get_state() == before


class OfAPlugin:
    """Something that is pickled by its name."""


def test_a_state_of_a_class_that_is_not_installed_is_refused_in_one_line(monkeypatch):
    state = sealed("world", OfAPlugin())
    monkeypatch.delattr(sys.modules[__name__], "OfAPlugin")
    with pytest.raises(ValueError, match=r"^state: expected one of the classes that are installed, got .*OfAPlugin"):
        unsealed("world", state)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda batch: batch.set_state(b"clean-swarm state 5\n" + pickle.dumps([])),  # as they were saved before
            r"^state: expected b'clean-swarm state 1 batch', got b'clean-swarm state 5'$",
        ),
        (lambda batch: batch.set_state(None), r"^state: expected the bytes of get_state, got NoneType$"),
        (
            lambda batch: Worlds(SHORT, avoidance()).set_state(batch.get_state()),
            r"^state: expected b'clean-swarm state 1 world', got",
        ),
        (
            lambda _: Batch(SHORT).set_state(Batch(SHORT, observation={"terms": ["cargo"]}).get_state()),
            r"^state: terms: expected .*, got \('carrying', 'recycled'\)$",
        ),
        (lambda batch: batch.set_state(batch.get_state(), [0]), "state: expected one world, or 1, got 2"),
        (lambda batch: batch.get_state([2]), "worlds: expected 0 to 1, got 2"),
        (lambda batch: Batch(CROWD).set_state(batch.get_state([0])), "world: expected"),
        (
            lambda _: Worlds(SHORT, avoidance(), explained=True).set_state(Worlds(SHORT, avoidance()).get_state()),
            r"^state: coordinators.0.contents.0.network.state.marks: expected ",
        ),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(batch, call, message):
    with pytest.raises(ValueError, match=message) as told:
        call(batch)
    assert "\n" not in str(told.value)


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
