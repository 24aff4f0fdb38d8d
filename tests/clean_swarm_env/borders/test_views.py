"""What environments show: pictures, and a window on the dummy display of SDL."""

import copy
import sys
import types
from itertools import pairwise

import numpy as np
import pytest
from gymnasium.wrappers import RecordVideo

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
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


@pytest.mark.parametrize("mission", [SHORT, {"task": "Foraging", "robots": {"count": 5}}], ids=["cleaning", "task"])
def test_pictures_change_no_course(mission):
    plain, drawn = CleanSwarmTeam(mission), CleanSwarmTeam(mission, render_mode="rgb_array")
    for env in (plain, drawn):
        env.reset(seed=3)
    for _ in range(4):
        first, second = (env.step(np.arange(5) % 2) for env in (plain, drawn))
        assert np.array_equal(first[0], second[0])
        assert first[1] == second[1]
        assert drawn.render().ndim == 3


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
def test_videos_last_as_long_as_the_mission(tmp_path):
    env = RecordVideo(CleanSwarmTeam(SHORT, render_mode="rgb_array"), str(tmp_path / "videos"))
    assert play(env) == 5
    env.close()
    frames, fps, shapes = _Frames.written
    assert (frames, fps) == (6, 1.0)
    ((height, width, _),) = shapes
    assert height % 2 == width % 2 == 0
