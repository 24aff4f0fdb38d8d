"""Names of tasks, missions, families and experiments; tasks are imported only where no file has a name."""

from collections.abc import Sequence
from importlib import import_module
from itertools import chain
from pathlib import Path
from typing import Final

from selector.documents.find import files_of, find_file, is_path
from selector.documents.plain import DocumentError
from selector.documents.trust import is_import
from selforg.registry import unknown

TASKS_HOME: Final = "clean_swarm_env.tasks"
"""The package whose import registers our tasks."""
KIND_WORDS: Final = {"missions": "mission", "families": "family", "experiments": "experiment"}
"""Kind of file that gives missions -> what one is called; names are looked for in this order."""
COMPARED: Final = ("experiments", "missions", "families")
"""The order for comparisons: of a name that is an experiment, too, its conditions are compared."""
OF_ROBUSTNESS: Final = {"disturbances", "strategies"}
"""Keys of an experiment that compares strategies, in place of conditions."""
OWN_TASK: Final = "; a task of your own: --import MODULE or FILE.py"
"""What follows the error of an unknown name."""
ID_PREFIX: Final = "CleanSwarm-"
"""Beginning of the ids of families."""


def task_names() -> tuple[str, ...]:
    """Return the names of all tasks, those of plug-ins included; importing these takes a second."""
    names: tuple[str, ...] = import_module(TASKS_HOME).TASKS.names()
    return names


def family_ids(directories: Sequence[Path] = ()) -> dict[str, str]:
    """Return id -> name of all families: `rooms-1` has `CleanSwarm-Rooms-v1`; one without a number has `-v1`, too."""
    ids = {}
    for name in files_of("families", directories):
        words, _, number = name.rpartition("-")
        first, version = (words, number) if number.isdigit() else (name, "1")
        ids[f"{ID_PREFIX}{first.title().replace('-', '')}-v{version}"] = name
    return ids


def named_file(
    name_or_path: str, directories: Sequence[Path] = (), where: str = "", kinds: Sequence[str] = tuple(KIND_WORDS)
) -> Path | None:
    """Return the file of a name, of the first of some `kinds` that has it; None where only a task has the name.

    A file in one of the `directories` stands before those of ours, of whatever kind. The id of a family serves as its
    name: `family_ids`.

    Raises:
        DocumentError: nothing has the name; `where` starts the line, which lists the known names.

    """
    if is_import(name_or_path):
        from selector.documents.imported import registered  # these import pydantic

        registered(name_or_path, import_module(TASKS_HOME).TASKS)
        return None
    if is_path("missions", name_or_path):
        return find_file("families" if "families" in kinds else "missions", name_or_path, directories, where)
    if name_or_path.startswith(ID_PREFIX) and "families" in kinds:
        ids = family_ids(directories)
        if name_or_path not in ids:
            raise DocumentError(where + unknown("id of a family", name_or_path, tuple(ids)))
        name_or_path = ids[name_or_path]
    files = {kind: files_of(kind, directories) for kind in kinds}
    if found := [own[name_or_path] for own in files.values() if name_or_path in own]:
        theirs = (file for root in directories for file in found if file.is_relative_to(root))
        return next(theirs, found[0])
    if name_or_path in (names := task_names()):
        return None
    called, known = (
        ", ".join(word for kind, word in KIND_WORDS.items() if kind in kinds),
        dict.fromkeys(chain(*files.values(), names)),
    )
    raise DocumentError(where + unknown(f"{called} or task", name_or_path, tuple(known)) + OWN_TASK)
