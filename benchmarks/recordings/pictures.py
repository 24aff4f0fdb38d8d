"""The cost of pictures of 20 robots at 700 pixels: what `rgb_array` returns, and ten seconds of video of each kind.

    python -m benchmarks.recordings.pictures

One process, CPU time, on the family `crowded`. A picture of a video is drawn and packed.
"""

from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time

from benchmarks.shared.record import record
from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.config.load import load_family
from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND
from clean_swarm_env.drawing.canvases import RecordedCourse
from clean_swarm_env.drawing.picture import pixels_of
from clean_swarm_env.drawing.video import WRITERS, write_video
from clean_swarm_env.learning.batch import mission_begun, run_out
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings

SIDE = 700
STEPS = 100
BEGIN, SECONDS = 60.0, 10.0


def render() -> float:
    """Return the CPU milliseconds of `render()` in the middle of many steps."""
    env = parallel_env(load_family("crowded").scenario(0, 0, "test").mission, render_mode="rgb_array")
    env.reset(seed=1)
    spent = []
    for _ in range(STEPS):
        env.step(dict.fromkeys(env.agents, 0))
        begin = process_time()
        env.render()
        spent.append(1000.0 * (process_time() - begin))
    env.close()
    return median(spent)


def videos(folder: Path) -> dict[str, dict[str, float]]:
    """Return CPU milliseconds a picture and megabytes of the video of each kind."""
    scenario = load_family("crowded").scenario(0, 0, "test")
    mission = scenario.mission.model_copy(update={"time_limit": BEGIN + SECONDS + 1.0})
    run_out(mission_begun(mission, scenario.start, scenario.seed, record=RecordSettings(folder, name="run")))
    course, count = RecordedCourse(RecordedMission(folder / "run.swarm")), round(SECONDS * FRAMES_PER_SECOND)
    figures = {}
    for suffix in WRITERS:
        path = folder / f"run{suffix}"
        begin = process_time()
        write_video(path, (pixels_of(course.at(BEGIN + k / FRAMES_PER_SECOND), SIDE) for k in range(count)))
        spent = 1000.0 * (process_time() - begin) / count
        figures[suffix] = {"CPU-ms a picture": spent, "MB": path.stat().st_size / 1e6}
    return figures


def main() -> None:
    """Measure, print and keep the figures."""
    with TemporaryDirectory() as name:
        figures = {"rgb_array": {"CPU-ms a picture": render()}, **videos(Path(name))}
    for title, values in figures.items():
        print(title, {key: round(value, 1) for key, value in values.items()})
    record("pictures", figures)


if __name__ == "__main__":
    main()
