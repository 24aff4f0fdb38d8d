"""The tasks of missions by name, and their settings: the key `task:` of a mission.

Cleaning is the task of missions that name none. The tasks themselves are in `clean_swarm_env.tasks`, which is imported
with the first mission, and in plug-ins (`selforg.plugins`).
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any, ClassVar, Final, TypeAlias, TypeVar

import numpy as np

from clean_swarm_env.config.events import Fail, Join, Land, Remove, Respawn, SetDelivery
from clean_swarm_env.config.robots import RobotModel
from clean_swarm_env.config.task_names import TASKS_HOME
from clean_swarm_env.config.types import ArrivalRate, Items, Length, Point, Spots
from selector.documents.errors import DocumentError, impossible
from selector.documents.fields import Closed, Name
from selector.documents.imported import registered
from selector.documents.trust import is_import
from selforg.registry import Registry, UnknownNameError

CLEANING: Final = "Cleaning"
"""Name of the task of missions that name none."""


Mission: TypeAlias = Any
"""A `MissionConfig`, which stands above this module."""
S = TypeVar("S", bound=Closed)
RANDOM_ITEMS: Final = 40
"""Default number of rows for items in a world in which they keep coming."""


class TaskSettings(Closed):
    """Settings of a task: its name, and the keys that its own class adds."""

    name: Name = CLEANING
    """Name of the task, as it is registered."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the keys: a process that unpickles them finds the class by the name of the task."""
        return settings_from, (self.model_dump(),)


class ItemsConfig(Closed):
    """The items of a task, which starts have the places of; a setting of this kind declares them.

    Where a task has them, starts say where robots and items are, and families draw how many there are.
    """

    count: Items = 10
    """Number of items at the start."""
    respawn: ArrivalRate = 0.0
    """Items that arrive in a minute, at random times and places; above 0 a mission lasts its time limit [1/min]."""
    capacity: Items = 0
    """Most items lying or carried at a time, further ones are lost; 0: as needed, at least 40 with respawn."""
    spots: Spots = ()
    """Centres of the places about which items lie and arrive, all equally likely; empty: anywhere [m]."""
    spot_radius: Length = 1.0
    """Distance from the centre of its spot within which an item comes, evenly over the disc [m]."""


NO_ITEMS: Final = ItemsConfig(count=0)
"""Those of tasks without any."""


def items_of(mission: Mission) -> ItemsConfig:
    """Return the items of a mission."""
    return next((value for _, value in mission.task if isinstance(value, ItemsConfig)), NO_ITEMS)


def expected_items(mission: Mission) -> int:
    """Return how many items there are at the start, or land by events."""
    return items_of(mission).count + sum(event.items for event in mission.events if isinstance(event, Land))


def items_keep_coming(mission: Mission) -> bool:
    """Return whether items keep coming at some time, so that only the time limit ends the mission."""
    rates = (event.rate for event in mission.events if isinstance(event, Respawn))
    return max(items_of(mission).respawn, *rates, 0.0) > 0.0


def item_rows(mission: Mission) -> int:
    """Return for how many items a world has rows."""
    least = RANDOM_ITEMS if items_keep_coming(mission) else 0
    return items_of(mission).capacity or max(expected_items(mission), least)


def with_items(settings: S, **changes: object) -> S:
    """Return the settings of a task with other items, if it has any."""
    own = {name: value for name, value in settings if isinstance(value, ItemsConfig)}
    return settings.model_copy(update={name: value.model_copy(update=changes) for name, value in own.items()})


def rows_only(settings: S, mission: Mission) -> S:
    """Return the settings of a task without items, but with as many rows for them as its mission needs."""
    return with_items(settings, **dict(NO_ITEMS) | {"capacity": item_rows(mission)})


class TaskKind:
    """A class of tasks, as missions, starts and families know it; `Task` is what worlds know of it.

    Attributes:
        name: that of the class, unless given.
        Settings: the settings of the task.
        story: one sentence: the robots, their place and their task.
        mission: keys of a mission that names the task, unless they are given: the task's own mission.
        changes: whether robots and things may come and go during a mission; not where measures are of all robots.

    """

    name: ClassVar[str] = ""
    Settings: ClassVar[type[TaskSettings]] = TaskSettings
    story: ClassVar[str] = ""
    mission: ClassVar[Mapping[str, Any]] = {}
    changes: ClassVar[bool] = False

    @classmethod
    def check(cls, mission: Mission) -> None:
        """Raise the error of the first key of a mission that is impossible with the task."""
        for number, event in enumerate(mission.events):
            if not (cls.changes and isinstance(event, Join | Remove | Fail | SetDelivery)):
                expected = "join, remove, fail or deliver" if cls.changes else "none"
                raise impossible(f"events.{number}", f"{expected} with the task {cls.name}", event.do)

    @classmethod
    def frame_settings(cls, mission: Mission) -> TaskSettings:
        """Return the settings without the parts that may differ among the worlds of a batch: all but rows of items."""
        settings: TaskSettings = rows_only(mission.task, mission)
        return settings

    @classmethod
    def draw_scenario(
        cls,
        family: Any,  # noqa: ANN401  (a FamilyConfig, which stands above this module)
        size: Point,
        robots: int,
        rng: np.random.Generator,
    ) -> tuple[TaskSettings, list[dict[str, Any]]]:
        """Return settings and random events of a scenario of a family, with `robots` on a torus of a `size` [m]."""
        return family.mission.task, []


TASKS: Registry[TaskKind] = Registry("task", lambda kind: kind.name, TASKS_HOME, TaskKind)
"""Tasks by name."""


def find_task(name: str) -> type[TaskKind]:
    """Return the class of a task, or of `module:Class`; DocumentError for an unknown one lists the known ones."""
    import_module(TASKS_HOME)
    try:
        return TASKS.find(registered(name, TASKS) if is_import(name) else name)
    except UnknownNameError as error:
        raise DocumentError(f"{error}, in Python imports=") from error


def settings_from(given: object) -> object:
    """Return the settings of a task from its name or its keys; anything else is left for pydantic to refuse."""
    content = {"name": given} if isinstance(given, str) else given
    if not isinstance(content, Mapping) or not isinstance(name := content.get("name", CLEANING), str):
        return given
    kind = find_task(name)
    return kind.Settings.model_validate({key: kind.name if key == "name" else given for key, given in content.items()})


def with_task_defaults(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a mission with those that its task has in place of the usual ones, unless they are given.

    A setting of the task beside `task:` raises the error that says where it belongs.
    """
    task = content.get("task", CLEANING)
    name = task.get("name", CLEANING) if isinstance(task, Mapping) else getattr(task, "name", task)
    if not isinstance(name, str):
        return dict(content)
    kind = find_task(name)
    for key in content.keys() & kind.Settings.model_fields.keys() - {"name"}:
        raise impossible(key, f"it below `task:`, as task.{key}", f"{key} beside `task:`")
    return with_changes(
        with_changes({"name": kind.name, "knowledge": "library", "task": {"name": name}}, kind.mission), content
    )


def with_changes(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with the values of `changes` in place of its own; mappings are merged.

    Settings of a task are merged with those of the same task only; groups of robots replace what all robots were.
    """
    return {**base, **{key: MERGED.get(key, _merged)(base.get(key), value) for key, value in changes.items()}}


def _merged(below: object, changes: object) -> object:
    if isinstance(below, Mapping) and isinstance(changes, Mapping):
        return with_changes(below, changes)
    return changes


def _merged_robots(below: object, changes: object) -> object:
    before = {"groups": below} if isinstance(below, list | tuple) else below
    if isinstance(before, Mapping) and isinstance(changes, Mapping) and "groups" in changes:
        before = {key: value for key, value in before.items() if key not in RobotModel.model_fields}
    return _merged(before, changes)


def _merged_task(below: object, changes: object) -> object:
    before, after = ({"name": given} if isinstance(given, str) else given for given in (below, changes))
    if not (isinstance(before, Mapping) and isinstance(after, Mapping)):
        return changes
    own = before.get("name", CLEANING)
    return with_changes(before, after) if after.get("name", own) == own else after


MERGED = {"robots": _merged_robots, "task": _merged_task}
"""Key of a mission -> how its values are merged, where not as those of others."""
