"""`clean-swarm look draw`: a diagram of a robot's network, of a mechanism configuration, or of a state machine.

The functions import Matplotlib and the library themselves, so that help is quick.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import Configs

if TYPE_CHECKING:
    from train.reports.network_content import NetworkPanel

RobotOrConfiguration = Annotated[
    str, typer.Argument(help="Name of a robot, a mechanism configuration or a state machine, or path to its YAML file.")
]
PictureFile = Annotated[
    Path | None, typer.Option(help="File to write, .svg, .png or .pdf; NAME.svg in this directory unless given.")
]
ExpertKnowledge = Annotated[
    str | None,
    typer.Option(help="Expert knowledge whose options the coordinators show; that of the robot's name unless given."),
]


def draw_command(
    robot: RobotOrConfiguration,
    output: PictureFile = None,
    knowledge: ExpertKnowledge = None,
    configs: Configs = None,
) -> None:
    """Draw sensors, preconditions, behaviours, effects and goals of a network as a diagram."""
    from selector.documents.reading import read_mapping
    from selector.strategies.machine_file import load_machine
    from train.reports.charts import PICTURE_SUFFIXES, save_picture
    from train.reports.machine_picture import draw_machine
    from train.reports.network_picture import draw_panels

    if output is not None and output.suffix not in PICTURE_SUFFIXES:
        raise ConfigurationError(f"--output: expected a name that ends in {', '.join(PICTURE_SUFFIXES)}, got {output}")
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
    try:
        save_picture(figure, file)
    except OSError as error:
        raise ConfigurationError(f"--output: {file}: {error.strerror or error}") from error
    typer.echo(f"{drawn} in {file}")


def _found(name: str, directories: list[Path]) -> Path:
    """Return the file of a robot, a configuration or a machine by its name, in this order, or by its path."""
    from selector.documents.find import files_of, find_file
    from selforg.registry import unknown

    if Path(name).suffix:
        return find_file("robots", name, directories)
    found = {
        **files_of("machines", directories),
        **files_of("mechanisms", directories),
        **files_of("robots", directories),
    }
    if name not in found:
        raise ConfigurationError(unknown("robot, configuration or machine", name, sorted(found)))
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
