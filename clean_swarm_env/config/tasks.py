"""The tasks of missions by name, and their settings: the key `task:` of a mission.

Cleaning is the task of missions that name none. The tasks themselves are in `clean_swarm_env.tasks`, which is imported
as soon as a mission names another one.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any, Final, Protocol, TypeVar

from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Name
from selforg.registry import Registry, UnknownNameError

CLEANING: Final = "Cleaning"
"""Name of the task of missions that name none."""
TaskClass = TypeVar("TaskClass", bound="type[Any]")


class TaskSettings(Closed):
    """Settings of a task: its name, and the keys that its own class adds."""

    name: Name = CLEANING
    """Name of the task, as it is registered."""


class TaskKind(Protocol):
    """A class of tasks, as missions know it."""

    Settings: type[TaskSettings]
    """The settings of the task."""
    mission: Mapping[str, Any]
    """Keys of a mission that names the task, unless they are given."""


TASKS: Registry[TaskKind] = Registry("task")
"""Tasks by the names of their classes."""


def find_task(name: str) -> type[TaskKind]:
    """Return the class of a task; DocumentError for an unknown one lists the known ones."""
    import_module("clean_swarm_env.tasks")  # which registers ours
    try:
        return TASKS.find(name)
    except UnknownNameError as error:
        raise DocumentError(str(error)) from error


def is_task(name: str) -> bool:
    """Return whether a task has this name."""
    import_module("clean_swarm_env.tasks")
    return name in TASKS


def task_names() -> tuple[str, ...]:
    """Return the names of all tasks, sorted."""
    import_module("clean_swarm_env.tasks")
    return TASKS.names()


def settings_from(given: object) -> object:
    """Return the settings of a task from its name or its keys; anything else is left for pydantic to refuse."""
    content = {"name": given} if isinstance(given, str) else given
    if not isinstance(content, Mapping) or not isinstance(name := content.get("name", CLEANING), str):
        return given
    return (TaskSettings if name == CLEANING else find_task(name).Settings).model_validate(dict(content))


def with_task_defaults(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a mission with those that its task has in place of the usual ones, unless they are given."""
    task = content.get("task", CLEANING)
    name = (
        task
        if isinstance(task, str)
        else getattr(task, "name", None) or (task.get("name", CLEANING) if isinstance(task, Mapping) else CLEANING)
    )
    if not isinstance(name, str) or name == CLEANING:
        return dict(content)
    usual = {"name": name, "knowledge": "library", "garbage": {"count": 0}}
    return _below(content, _below(find_task(name).mission, usual))


def _below(content: Mapping[str, Any], usual: Mapping[str, Any]) -> dict[str, Any]:
    """Return `content` with what it lacks of `usual`, in parts that are mappings, too."""
    merged = dict(content)
    for key, value in usual.items():
        if key not in merged:
            merged[key] = value
        elif isinstance(value, Mapping) and isinstance(merged[key], Mapping):
            merged[key] = _below(merged[key], value)
    return merged
