"""Every kind of document with its reader, and what an answer to a bad one has to be."""

import resource
import time
from collections.abc import Callable
from pathlib import Path

from clean_swarm_env.config.load import load_experiment, load_family, load_mission
from clean_swarm_env.tasks.cleaning.missions import CleaningStarts
from selector.configurations.configuration import ConfigurationSpec
from selector.configurations.host import trial_host
from selector.configurations.library import library_of
from selector.configurations.running import RunningConfiguration
from selector.coordination.model import CoordinatorModel
from selector.coordination.robot_document import coordinated_goals, load_network
from selector.documents.errors import DocumentError, validated, within
from selector.documents.parameters import check_parameters_used, resolved
from selector.documents.reading import read_mapping
from selector.knowledge import load_knowledge, options_in
from selector.store import contents
from selector.strategies.machine_file import load_machine
from train.learning.config import load_training

MOST_SECONDS, MOST_BYTES = 5.0, 300e6


def read_configuration(path: Path) -> None:
    content = read_mapping(path)
    with within(str(path)):  # as the library does
        check_parameters_used(content)
        content = resolved(content, {})
    spec = validated(ConfigurationSpec, content, str(path))
    RunningConfiguration(spec, trial_host(spec), str(path))


def read_robot(path: Path) -> None:
    known, library = load_knowledge("transport"), library_of()
    goals = [goal for goal in coordinated_goals(path) if goal in known.goals]
    load_network(path, {goal: CoordinatorModel(goal, known, library) for goal in goals})


READERS: dict[str, Callable[[Path], object]] = {
    "experiments": lambda path: load_experiment(str(path)),
    "families": lambda path: load_family(str(path)),
    "knowledge": lambda path: load_knowledge(str(path)),
    "machines": lambda path: load_machine(str(path)),
    "mechanisms": read_configuration,
    "missions": lambda path: load_mission(str(path)),
    "options": options_in,
    "robots": read_robot,
    "training": lambda path: load_training(str(path), "bandit"),
}
KINDS = tuple(READERS)
"""The kinds of YAML documents."""
READERS |= {
    "given starts": CleaningStarts.read,
    "exported store": contents.read,
}


def refused_in_one_line(read: Callable[[Path], object], path: Path) -> bool:
    """Return whether a document is refused; AssertionError if not in one line, in time and in little memory.

    What takes long is read once more: the first one of a process loads libraries and kernels, or compiles them.
    """
    before, message, took = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, None, float("inf")
    for _ in range(2):
        if took >= MOST_SECONDS:
            began = time.process_time()
            try:
                read(path)
            except DocumentError as error:
                message = str(error)
            took = time.process_time() - began
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    assert took < MOST_SECONDS, f"{path} took {took:.1f} s"
    assert grown < MOST_BYTES, f"{path} took {grown / 1e6:.0f} MB"
    if message is not None:
        assert str(path.name) in message, message
        assert len(message.splitlines()) == 1, message
    return message is not None
