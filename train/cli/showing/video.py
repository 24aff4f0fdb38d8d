"""`clean-swarm video`: a run as a video, picture by picture."""

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import track

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import check_whole, error_console
from train.cli.repeat import ConditionOption, ScenarioOption
from train.cli.showing.picture import LEAST_SIZE, MOST_SIZE, PictureSize, ShownRun, check_times, course_of

FASTEST = 1000.0
USUAL_LENGTH = 30.0
"""Length of a video whose speed is not given [s]; a shorter run is shown as fast as it was."""


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
    speed: Annotated[
        float | None,
        typer.Option(help="Seconds of the mission in a second of the video; so that it lasts some 30 s unless given."),
    ] = None,
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    size: PictureSize = 700,
) -> None:
    """Write a run as a video of 20 pictures a second; a run without a recording is repeated."""
    from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND  # imports NumPy
    from clean_swarm_env.drawing.picture import pixels_of
    from clean_swarm_env.drawing.video import check_video, write_video
    from train.running.needs import check_file  # imports Numba

    check_whole({"--size": (size, LEAST_SIZE, MOST_SIZE)})
    if speed is not None and not 0.0 < speed <= FASTEST:
        raise ConfigurationError(f"--speed: expected a positive number up to {FASTEST:g}, got {speed:g}")
    check_video(output)
    with course_of(run, scenario, condition) as course:
        last = course.end if end is None else end
        check_times(course, {"--from": begin, "--to": last})
        if last < begin:
            raise ConfigurationError(f"--to: expected at least --from, {begin:g}, got {last:g}")
        pace = max(1.0, math.ceil((last - begin) / USUAL_LENGTH)) if speed is None else speed
        count = math.floor((last - begin) * FRAMES_PER_SECOND / pace + 1e-6) + 1
        needs = check_file(output, count * size**2, f"{count} pictures", "--speed and --size make it smaller")
        pictures = (pixels_of(course.at(begin + k * pace / FRAMES_PER_SECOND), size) for k in range(count))
        write_video(output, iter(track(pictures, needs, count, console=error_console(), transient=True)))
    told = "" if pace == 1.0 else f", {pace:g} times as fast as the mission (--speed)"
    typer.echo(f"{output}: {count} pictures, {count / FRAMES_PER_SECOND:g} s{told}")
