"""`clean-swarm look picture`: a moment of a run as a file."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import MAY_NAME_CODE, check_whole
from train.cli.repeat import ConditionOption, ScenarioOption, repeating

if TYPE_CHECKING:
    from clean_swarm_env.drawing.recorded_picture import RecordedCourse

LEAST_SIZE, MOST_SIZE = 200, 4000
ShownRun = Annotated[
    Path, typer.Argument(help=f"A recording, or a directory of results; {MAY_NAME_CODE}.", metavar="RUN")
]
PictureSize = Annotated[int, typer.Option(help="Longer side of the world [pixels].")]


def picture_command(
    run: ShownRun,
    output: Annotated[Path, typer.Argument(help="File to write, .svg, .png or .webp; one that exists is replaced.")],
    time: Annotated[float, typer.Option(help="Time in the mission [s].")],
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    size: PictureSize = 700,
) -> None:
    """Draw a moment of a run, with the option that each robot holds; a run without a recording is repeated."""
    from clean_swarm_env.drawing.picture import check_picture, write_picture  # imports NumPy

    check_whole({"--size": (size, LEAST_SIZE, MOST_SIZE)})
    check_picture(output)
    with course_of(run, scenario, condition) as course:
        check_times(course, {"--time": time})
        write_picture(course.at(time), output, size)
    typer.echo(f"{output}: the run at {time:g} s")


def check_times(course: "RecordedCourse", times: dict[str, float]) -> None:
    """Raise ConfigurationError for a time outside a course; `times`: option -> time [s]."""
    for name, time in times.items():
        if not 0.0 <= time <= course.end:
            raise ConfigurationError(f"{name}: expected seconds from 0 to {course.end:g}, got {time:g}")


@contextmanager
def course_of(run: Path, scenario: str | None, condition: str | None) -> Iterator["RecordedCourse"]:
    """Give the course of a recording, or of a run in a directory of results, which is repeated if need be."""
    from clean_swarm_env.drawing.recorded_picture import DRAWN, RecordedCourse
    from clean_swarm_env.recording.reader import RecordedMission
    from train.evaluation.repeat import recording_of
    from train.running.needs import most_numbers

    with TemporaryDirectory() as folder:
        with repeating(run) if run.is_dir() else nullcontext():
            recording = recording_of(run, scenario, condition, Path(folder), minds=False)
        yield RecordedCourse(RecordedMission(recording, DRAWN, most_numbers()))
