"""Names of tasks, missions and families, found without importing any task, which takes a second."""

import ast
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Final

from selector.documents.find import files_of, find_file, is_path
from selector.documents.plain import DocumentError
from selector.documents.reading import read_text
from selector.documents.trust import is_import
from selforg.plugins import load
from selforg.registry import REGISTRIES, unknown

TASK: Final = "task"
"""What the registry of tasks calls one."""
TASKS_HOME: Final = "clean_swarm_env.tasks"
"""The package whose import registers our tasks."""
KIND_WORDS: Final = {"missions": "mission", "families": "family", "experiments": "experiment"}
"""Kind -> what one is called; a name of one kind means something wherever one of a later kind is expected."""
OWN_TASK: Final = "; a task of your own: --import MODULE or FILE.py"
"""What follows the error of an unknown name."""


def task_stories() -> dict[str, str]:
    """Return the stories of all tasks by name; sources of ours are read, not run: importing them takes a second."""
    here = Path(__file__).parents[1]
    load()
    registries = [registry for registry in REGISTRIES if registry.kind == TASK]  # none if no task has been imported
    stories = {kind.name: kind.story for registry in registries for kind in registry}
    for file in (*here.glob("tasks/cleaning/*.py"), *here.glob("tasks/*.py")):
        stories |= _declared(file)
    return dict(sorted(stories.items()))


@cache
def _declared(file: Path) -> dict[str, str]:
    """Return the stories of the tasks that a file of Python code registers."""
    found, text = {}, read_text(file)
    for node in ast.parse(text).body if "@TASKS.register" in text else ():
        if isinstance(node, ast.ClassDef) and "TASKS.register" in map(ast.unparse, node.decorator_list):
            given = {
                ast.unparse(part.targets[0]): part.value.value
                for part in node.body
                if isinstance(part, ast.Assign) and isinstance(part.value, ast.Constant)
            }
            found[str(given.get("name", node.name))] = str(given.get("story", ""))
    return found


def task_names() -> tuple[str, ...]:
    """Return the names of all tasks, those of plug-ins included."""
    return tuple(task_stories())


def named_file(kind: str, name_or_path: str, directories: Sequence[Path] = (), where: str = "") -> Path | None:
    """Return the file of a kind of `KIND_WORDS`; None where a task has the name, or a file of a kind before it.

    Raises:
        DocumentError: nothing has the name; `where` starts the line, which lists the known names.

    """
    if is_import(name_or_path):
        from selector.documents.imported import registered  # these import pydantic

        registered(name_or_path, import_module(TASKS_HOME).TASKS)
        return None
    found = files_of(kind, directories)
    if name_or_path in found or is_path(kind, name_or_path):
        return find_file(kind, name_or_path, directories, where)
    kinds = [*KIND_WORDS][: [*KIND_WORDS].index(kind) + 1]
    known = dict.fromkeys((*(name for each in kinds for name in files_of(each, directories)), *task_names()))
    if name_or_path in known:
        return None
    called = ", ".join(KIND_WORDS[each] for each in kinds)
    raise DocumentError(where + unknown(f"{called} or task", name_or_path, tuple(known)) + OWN_TASK)
