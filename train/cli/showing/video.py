"""`clean-swarm video`: a run as a video."""

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import track

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import check_whole, error_console
from train.cli.repeat import ConditionOption, ScenarioOption
from train.cli.showing.picture import LEAST_SIZE, MOST_SIZE, PictureSize, ShownRun, check_times, course_of

FASTEST = 1000.0


def video_command(
    run: ShownRun,
    output: Annotated[
        Path,
        typer.Argument(
            help="File to write, .webp or .gif, or with the extra `video` .webm or .mp4; one that exists is replaced."
        ),
    ],
    begin: Annotated[float, typer.Option("--from", help="Time in the mission at which the video begins [s].")] = 0.0,
    end: Annotated[float | None, typer.Option("--to", help="Time at which it ends [s]; that of the run.")] = None,
    speed: Annotated[float, typer.Option(help="Seconds of the mission in a second of the video.")] = 1.0,
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    size: PictureSize = 700,
) -> None:
    """Write a run as a video of 20 pictures a second; a run without a recording is repeated."""
    from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND  # imports NumPy
    from clean_swarm_env.drawing.pixels import pixels_of
    from clean_swarm_env.drawing.video import check_video, write_video

    check_whole({"--size": (size, LEAST_SIZE, MOST_SIZE)})
    if not 0.0 < speed <= FASTEST:
        raise ConfigurationError(f"--speed: expected a positive number up to {FASTEST:g}, got {speed:g}")
    check_video(output, 1)
    with course_of(run, scenario, condition) as course:
        last = course.end if end is None else end
        check_times(course, {"--from": begin, "--to": last})
        if last < begin:
            raise ConfigurationError(f"--to: expected at least --from, {begin:g}, got {last:g}")
        count = math.floor((last - begin) * FRAMES_PER_SECOND / speed + 1e-6) + 1
        check_video(output, count)
        times = (begin + k * speed / FRAMES_PER_SECOND for k in range(count))
        pictures = (pixels_of(course.at(time), size) for time in times)
        write_video(output, iter(track(pictures, "pictures", count, console=error_console(), transient=True)))
    typer.echo(f"{output}: {count} pictures, {count / FRAMES_PER_SECOND:g} s")
