"""What environments show: pictures, twenty a second for videos, and a window on the dummy display of SDL."""

import copy
import sys
import types
from itertools import pairwise

import numpy as np
import pytest
from gymnasium.wrappers import RecordVideo

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.wrappers import RecordMission
from tests.clean_swarm_env.courses import begun

SHORT = {"base": "table1", "time_limit": 5.0}
PERIODS = 5  # of control, in a decision period


def play(env):
    """Run an episode; return the number of steps."""
    env.reset(seed=1)
    steps, over = 0, False
    while not over:
        _, _, terminated, truncated, _ = env.step(np.arange(5) % 3)
        steps, over = steps + 1, terminated or truncated
    return steps


def test_a_list_has_twenty_pictures_for_each_second_of_the_mission():
    env = CleanSwarmTeam(SHORT, render_mode="rgb_array_list")
    assert env.metadata["render_fps"] == 20.0
    steps = play(env)
    pictures = env.render()
    assert (steps, len(pictures)) == (5, 1 + 20 * 5)
    assert env.render() == []
    moves = [np.any(first != second) for first, second in pairwise(pictures)]
    assert sum(moves) > 0.9 * len(moves)
    single = CleanSwarmTeam(SHORT, render_mode="rgb_array")
    assert single.metadata["render_fps"] == 1.0
    play(single)
    assert np.array_equal(single.render(), pictures[-1])


@pytest.mark.parametrize("mission", [SHORT, {"task": "Foraging", "robots": {"count": 5}}], ids=["cleaning", "task"])
def test_pictures_change_no_course(mission):
    plain, drawn = CleanSwarmTeam(mission), CleanSwarmTeam(mission, render_mode="rgb_array_list")
    for env in (plain, drawn):
        env.reset(seed=3)
    for _ in range(4):
        first, second = (env.step(np.arange(5) % 2) for env in (plain, drawn))
        assert np.array_equal(first[0], second[0])
        assert first[1] == second[1]


@pytest.mark.parametrize(
    "make",
    [
        lambda: CleanSwarmTeam(SHORT, render_mode="human"),
        lambda: clean_swarm_v0.parallel_env({"task": "ReachGoal", "time_limit": 5.0}, render_mode="human"),
        lambda: clean_swarm_v0.parallel_env(SHORT, render_mode="human"),
        lambda: clean_swarm_v0.raw_env(SHORT, render_mode="human"),
    ],
)
@pytest.mark.extra
def test_a_window_shows_every_control_period(make, monkeypatch):
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    shown = []
    monkeypatch.setattr(
        pygame.display, "flip", lambda: shown.append(pygame.surfarray.array3d(pygame.display.get_surface()))
    )
    env = begun(make(), seed=1)
    assert len(shown) == 1
    if isinstance(env, CleanSwarmTeam):
        env.step(np.zeros(5, dtype=np.int64))
    elif hasattr(env, "agent_selection"):
        for _ in range(5):
            env.step(0)
    else:
        env.step(dict.fromkeys(env.agents, 0))
    assert len(shown) == 1 + PERIODS
    assert all(np.any(first != second) for first, second in pairwise(shown))
    assert env.render() is None
    assert np.array_equal(shown[-1], shown[-2])
    other = copy.deepcopy(env)
    other.render()
    assert np.array_equal(shown[-1], shown[-2])
    env.close()
    other.close()
    assert not pygame.display.get_init()


class _Frames:
    """What moviepy would write."""

    written = ()

    def __init__(self, frames, fps):
        _Frames.written = (len(frames), fps, {frame.shape for frame in frames})

    def write_videofile(self, path, logger):
        pass


@pytest.fixture
def _moviepy(monkeypatch):
    """Stand for moviepy, which is not installed: it brings a GPL binary."""
    parts = "moviepy", "moviepy.video", "moviepy.video.io", "moviepy.video.io.ImageSequenceClip"
    for name in parts:
        monkeypatch.setitem(sys.modules, name, types.ModuleType(name))
    sys.modules[parts[-1]].ImageSequenceClip = _Frames


@pytest.mark.usefixtures("_moviepy")
@pytest.mark.parametrize(
    ("recorder", "mode", "expected"),
    [(RecordVideo, "rgb_array", (6, 1.0)), (RecordMission, "rgb_array_list", (101, 20.0))],
)
def test_videos_last_as_long_as_the_mission(recorder, mode, expected, tmp_path):
    env = recorder(CleanSwarmTeam(SHORT, render_mode=mode), str(tmp_path / "videos"))
    assert play(env) == 5
    env.close()
    frames, fps, shapes = _Frames.written
    assert (frames, fps) == expected
    ((height, width, _),) = shapes
    assert height % 2 == width % 2 == 0
