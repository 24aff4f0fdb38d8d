"""`clean-swarm look`, `video` and `report`: pictures, videos and pages of runs, diagrams of networks and machines.

Libraries that take seconds are imported inside the functions, so that help is quick.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.progress import track

from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.plain import must_know
from selector.documents.writing import check_output, write_whole
from train.cli.options import (
    MAY_NAME_CODE,
    Configs,
    check_there,
    check_whole,
    error_console,
)
from train.cli.repeat import ConditionOption, ScenarioOption, recording_at

if TYPE_CHECKING:
    from clean_swarm_env.drawing.canvases import RecordedCourse
    from train.reports.network_content import NetworkPanel

app = typer.Typer(
    no_args_is_help=True, rich_markup_mode=None, help="picture, draw: a run or a document as a file (seconds)"
)
LEAST_SIZE, MOST_SIZE = 200, 4000
DIAGRAMS = (".svg", ".png", ".pdf")
"""Endings of diagrams."""
ShownRun = Annotated[
    Path, typer.Argument(help=f"A recording, or a directory of results; {MAY_NAME_CODE}.", metavar="RUN")
]
PictureSize = Annotated[int, typer.Option(help="Longer side of the world [pixels].")]
Numbers = Annotated[bool, typer.Option(help="Show the numbers of the robots, where there is room.")]


@app.command("picture")
def picture_command(
    run: ShownRun,
    output: Annotated[Path, typer.Argument(help="File to write, .svg, .png or .webp; one that exists is replaced.")],
    time: Annotated[float, typer.Option(help="Time in the mission [s].")],
    scenario: ScenarioOption = None,
    condition: ConditionOption = None,
    size: PictureSize = 700,
    numbers: Numbers = True,
) -> None:
    """Draw a moment of a run, with the option that each robot holds; a run without a recording is repeated."""
    check_there(run)
    from clean_swarm_env.drawing.picture import FORMATS, write_picture  # imports NumPy

    check_whole({"--size": (size, LEAST_SIZE, MOST_SIZE)})
    check_output(output, FORMATS)
    with course_of(run, scenario, condition) as course:
        check_times(course, {"--time": time})
        write_picture(course.at(time), output, size, numbers=numbers)
    typer.echo(f"{output}: the run at {time:g} s")


def check_times(course: "RecordedCourse", times: dict[str, float]) -> None:
    """Raise ConfigurationError for a time outside a course; `times`: option -> time [s]."""
    for name, time in times.items():
        if not 0.0 <= time <= course.end:
            raise ConfigurationError(f"{name}: expected seconds from 0 to {course.end:g}, got {time:g}")


@contextmanager
def course_of(run: Path, scenario: str | None, condition: str | None) -> Iterator["RecordedCourse"]:
    """Give the course of a recording, or of a run in a directory of results, which is repeated if need be."""
    from clean_swarm_env.drawing.canvases import RecordedCourse, pictured
    from clean_swarm_env.recording.reader import RecordedMission
    from train.running.needs import most_numbers

    with recording_at(run, scenario, condition, minds=False) as path:
        yield RecordedCourse(RecordedMission(path, pictured, most_numbers()))


FASTEST = 1000.0
USUAL_LENGTH = 30.0
"""Length of a video whose speed is not given [s]; a shorter run is shown as fast as it was."""


def video_command(
    run: ShownRun,
    output: Annotated[
        Path,
        typer.Argument(help="File to write, .webp or .gif; one that exists is replaced."),
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
    numbers: Numbers = True,
) -> None:
    """Write a run as a video of 20 pictures a second; a run without a recording is repeated."""
    check_there(run)
    from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND  # imports NumPy
    from clean_swarm_env.drawing.picture import pixels_of
    from clean_swarm_env.drawing.video import WRITERS, write_video
    from train.running.needs import check_file  # imports Numba

    check_whole({"--size": (size, LEAST_SIZE, MOST_SIZE)})
    if speed is not None and not 0.0 < speed <= FASTEST:
        raise ConfigurationError(f"--speed: expected a positive number up to {FASTEST:g}, got {speed:g}")
    check_output(output, WRITERS, hint="; of a .gif, ffmpeg makes other videos")
    with course_of(run, scenario, condition) as course:
        last = course.end if end is None else end
        check_times(course, {"--from": begin, "--to": last})
        if last < begin:
            raise ConfigurationError(f"--to: expected at least --from, {begin:g}, got {last:g}")
        pace = max(1.0, math.ceil((last - begin) / USUAL_LENGTH)) if speed is None else speed
        count = math.floor((last - begin) * FRAMES_PER_SECOND / pace + 1e-6) + 1
        needs = check_file(output, count * size**2, f"{count} pictures", "--speed and --size make it smaller")
        moments = (begin + k * pace / FRAMES_PER_SECOND for k in range(count))
        pictures = (pixels_of(course.at(moment), size, numbers=numbers) for moment in moments)
        write_video(output, iter(track(pictures, needs, count, console=error_console(), transient=True)))
    told = "" if pace == 1.0 else f", {pace:g} times as fast as the mission (--speed)"
    typer.echo(f"{output}: {count} pictures, {count / FRAMES_PER_SECOND:g} s{told}")


def report_command(
    directories: Annotated[
        list[Path],
        typer.Argument(help="One or two evaluations, or trainings: those of one name are seeds.", metavar="DIR ..."),
    ],
    output: Annotated[
        Path | None, typer.Option(help="Page to write, one that exists is replaced; DIR/report.html unless given.")
    ] = None,
) -> None:
    """Write results as one page without network: tables, distributions, selection, learning curves."""
    check_there(*directories)
    from train.report_page.page import report_of_results  # imports SciPy
    from train.reports.results import results_in

    results = [results_in(directory) for directory in directories]
    page = output or directories[0] / "report.html"
    write_whole(page, report_of_results(results).encode())
    typer.echo(f"{page}: open it in a browser")


@app.command("draw")
def draw_command(
    robot: Annotated[
        str,
        typer.Argument(help="Name of a robot, a mechanism configuration or a state machine, or path to its YAML file."),
    ],
    output: Annotated[
        Path | None, typer.Option(help="File to write, .svg, .png or .pdf; NAME.svg in this directory unless given.")
    ] = None,
    knowledge: Annotated[
        str | None,
        typer.Option(
            help="Expert knowledge whose options the coordinators show; that of the robot's name unless given."
        ),
    ] = None,
    configs: Configs = None,
) -> None:
    """Draw sensors, preconditions, behaviours, effects and goals of a network as a diagram."""
    from selector.documents.reading import read_mapping
    from selector.strategies.machine_file import load_machine
    from train.reports.charts import picture_of
    from train.reports.machine_picture import draw_machine
    from train.reports.network_picture import draw_panels

    if output is not None:
        check_output(output, DIAGRAMS)
    path = _found(robot, configs or [])
    file = output or Path(f"{path.stem}.svg")
    if "states" in read_mapping(path):
        if knowledge is not None:
            raise ConfigurationError("--knowledge: expected a robot, got a state machine")
        machine = load_machine(str(path))
        figure, drawn = draw_machine(machine), f"{len(machine.states)} states"
    else:
        panels = _panels(path, knowledge, configs or [])
        figure, drawn = draw_panels(panels), f"{len(panels)} network{'s' if len(panels) > 1 else ''}"
    write_whole(file, picture_of(figure, file.suffix.lower()))
    typer.echo(f"{drawn} in {file}")


def _found(name: str, directories: list[Path]) -> Path:
    """Return the file of a robot, a configuration or a machine by its name, in this order, or by its path."""
    from selector.documents.find import files_of, find_file

    if Path(name).suffix:
        return find_file("robots", name, directories)
    found = {
        **files_of("machines", directories),
        **files_of("mechanisms", directories),
        **files_of("robots", directories),
    }
    must_know("robot, configuration or machine", name, sorted(found))
    return found[name]


def _panels(path: Path, knowledge: str | None, directories: list[Path]) -> "list[NetworkPanel]":
    from selector.configurations.library import library_of
    from selector.coordination.model import coordinator_models
    from selector.coordination.robot_document import coordinated_goals
    from selector.documents.reading import read_mapping
    from selector.knowledge import Knowledge, load_knowledge
    from train.reports.network_content import configuration_panels, robot_panels

    if "networks" not in read_mapping(path):
        if knowledge is not None:
            raise ConfigurationError("--knowledge: expected a robot, got a mechanism configuration")
        return configuration_panels(path)
    goals = coordinated_goals(path)
    known = load_knowledge(knowledge or path.stem, directories) if goals or knowledge else Knowledge({})
    models = coordinator_models(goals, known, library_of(tuple(directories)))
    return robot_panels(path, {model.goal: model for model in models}, known)
