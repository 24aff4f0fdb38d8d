"""What the parts of a task have to return."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.tasks import TaskSettings
from clean_swarm_env.world.parts.shown import ROBOT, SIGNS, WORLD, Destination, Drawn, Shown
from clean_swarm_env.world.parts.things import Things
from selector.coordination.robot_network import RobotNetwork
from selforg.gradients.buffer import SoBuffer
from selforg.plugins import Promises, are_numbers


def _all(kind: type, answer: Any) -> bool:  # noqa: ANN401  (whatever a task returns)
    return isinstance(answer, list | tuple) and all(isinstance(one, kind) for one in answer)


def _by_name(answer: Any, count: int, most_axes: int = 1) -> bool:  # noqa: ANN401
    """Return whether an answer is arrays of finite numbers (`count`, ...) by name."""
    return isinstance(answer, Mapping) and all(
        isinstance(name, str)
        and isinstance(values, np.ndarray)
        and 1 <= values.ndim <= most_axes
        and are_numbers(values, count, *values.shape[1:])
        for name, values in answer.items()
    )


def _places(task: Any, *_: Any) -> bool:  # noqa: ANN401
    """Return whether robots and things are somewhere."""
    world = task.world
    return are_numbers(world.positions, world.worlds, world.robots, 2) and all(
        are_numbers(thing.places, world.worlds, thing.count, 2) for thing in task.around
    )


def _is_part(part: Any, shape: tuple[int, ...]) -> bool:  # noqa: ANN401
    """Return whether the global state can have a part of what is shown: a span, or numbers of a shape."""
    if isinstance(part, tuple):
        return len(part) == 2 and _all(int, part)
    return are_numbers(part, *shape) and bool((np.abs(part) <= 1.0).all())


def _shown(task: Any, answer: Any, *_: Any) -> bool:  # noqa: ANN401
    """Return whether what is shown has finite numbers for each robot, each world, or each thing of each world."""
    if not _all(Shown, answer):
        return False
    world, names = task.world, {one.name for one in answer}
    counts = {ROBOT: (world.rows,), WORLD: (world.worlds,)}
    for one in answer:
        if not isinstance(one.values, np.ndarray):
            return False
        shape = counts.setdefault(one.axis, (world.worlds, *one.values.shape[1:2]))
        places = one.values.shape[len(shape) :] in ((), (2,)) and (len(shape) == 2 or one.values.ndim == 1)
        whole = one.values.ndim == 3 or not one.recorded or one.values.dtype.kind in "iub"
        told = isinstance(one.event, str) and (not one.event or (one.recorded and one.values.ndim < 3))
        if not (places and whole and told and are_numbers(one.values, *shape, *one.values.shape[len(shape) :])):
            return False
        if not all(_is_part(part, shape) for part in one.parts.values()) or not one.where.keys() <= names:
            return False
    return len(names) == len(answer)


def _is_shown(task: Any, one: Drawn | Destination, *others: str) -> bool:  # noqa: ANN401
    """Return whether a task shows where something is, or at `others`, and the arrays that choose it."""
    known = {shown.name: shown.values.ndim for shown in task.shown()}
    return (one.at in others or known.get(one.at) == 3) and one.where.keys() <= known.keys()


def _drawn(task: Any, answer: Any, *_: Any) -> bool:  # noqa: ANN401
    """Return whether signs are drawn for what is shown."""
    return _all(Drawn, answer) and all(one.sign in SIGNS and _is_shown(task, one, ROBOT) for one in answer)


OF_WORLDS: Final = "arrays of finite numbers ({0.world.worlds},) by name"
TASK_PROMISES: Final[Promises] = {
    "__init__": ("a call of that of Task", lambda task, *_: hasattr(task, "around")),
    "sizes": (
        "whole numbers, at least 0, by names that are not W, N or R",
        lambda task, answer: (
            isinstance(answer, Mapping)
            and _all(str, [*answer])
            and not {"W", "N", "R"} & answer.keys()
            and all(isinstance(size, int | np.integer) and size >= 0 for size in answer.values())
        ),
    ),
    "reset": ("", lambda *_: True),  # places, reach, and attraction of things
    "sense": ("", lambda *_: True),
    "place": (
        "finite poses of robots ({0.world.robots}, 3), and finite places of things",
        lambda task, _, start: are_numbers(start.poses, start.robots, 3) and _places(task),
    ),
    "things": (
        "a tuple of Things with a name and finite places ({0.world.worlds}, M, 2)",
        lambda task, answer: (
            isinstance(answer, tuple)
            and _all(Things, answer)
            and _all(str, [thing.channel for thing in answer])
            and _all(np.ndarray, [thing.places for thing in answer])
            and all(are_numbers(one.places, task.world.worlds, *one.places.shape[1:2], 2) for one in answer)
        ),
    ),
    "known": (
        "arrays of finite numbers ({0.world.rows},) by name",
        lambda task, answer, *_: _by_name(answer, task.world.rows),
    ),
    "after_moving": ("robots and things to be at finite places", _places),
    **dict.fromkeys(
        ("done", "completed"),
        (
            "an array of bool ({0.world.worlds},)",
            lambda task, answer, *_: (
                isinstance(answer, np.ndarray) and (answer.shape, answer.dtype) == ((task.world.worlds,), np.bool_)
            ),
        ),
    ),
    **dict.fromkeys(
        ("cost", "cost_so_far", "unavoidable", "duration"),
        (
            "finite seconds, at least 0",
            lambda task, answer, *_: isinstance(answer, int | float | np.number) and 0.0 <= answer < np.inf,
        ),
    ),
    "result": (
        f"{OF_WORLDS}, those of the measures",
        lambda task, answer: (
            _by_name(answer, task.world.worlds)
            and (not task.measures or answer.keys() == {measure.name for measure in task.measures})
        ),
    ),
    "observe": (
        "arrays of finite numbers ({0.world.rows},) or ({0.world.rows}, K) by name",
        lambda task, answer, *_: _by_name(answer, task.world.rows, 2),
    ),
    "reward": (
        "None, or finite numbers ({0.world.rows},)",
        lambda task, answer, *_: answer is None or are_numbers(answer, task.world.rows),
    ),
    **dict.fromkeys(
        ("command", "bend", "command_baseline", "after_acting"),
        (
            "finite commands ({0.world.rows}, 2), written into the arrays that there are",
            lambda task, _, commands: (
                commands.vectors is commands.packed.record.vectors and are_numbers(commands.vectors, task.world.rows, 2)
            ),
        ),
    ),
    **dict.fromkeys(
        ("headline", "cost_words", "kind_of"), ("a text", lambda task, answer, *_: isinstance(answer, str))
    ),
    "target": (
        "None, or a word and finite metres",
        lambda task, answer, *_: (
            answer is None
            or (isinstance(answer, tuple) and _all(str, answer[:1]) and len(answer) == 2 and are_numbers(answer[1]))
        ),
    ),
    "destinations": (
        "a tuple of Destination at places that are shown, `where` shown arrays are",
        lambda task, answer: _all(Destination, answer) and all(_is_shown(task, one) for one in answer),
    ),
    "achieved": (
        "whole numbers or flags ({0.world.rows},), those of the achievements",
        lambda task, answer: (
            _by_name(answer, task.world.rows)
            and answer.keys() == {one.name for one in task.achievements}
            and all(times.dtype.kind in "biu" for times in answer.values())
        ),
    ),
    "totals": (OF_WORLDS, lambda task, answer: _by_name(answer, task.world.worlds)),
    "phase": (
        "numbers of the phases ({0.world.rows},)",
        lambda task, answer: (
            are_numbers(answer, task.world.rows) and bool(np.isin(answer, range(len(task.phases) or 1)).all())
        ),
    ),
    "shown": (
        "a tuple of Shown with a name each: whole numbers, axis robot (R,), world (W,) or a kind of things (W, M); "
        "or places (W, M, 2), which are no events",
        _shown,
    ),
    "drawn": (
        f"a tuple of Drawn at robot or at places that are shown, `where` shown arrays are, as {', '.join(SIGNS)}",
        _drawn,
    ),
    "goals": ("names of goals", lambda cls, answer, *_: bool(answer) and _all(str, answer)),
    "robot": ("a RobotNetwork", lambda cls, answer, *_: isinstance(answer, RobotNetwork)),
    "buffers": (
        "buffers by name",
        lambda cls, answer, *_: isinstance(answer, Mapping) and _all(SoBuffer, [*answer.values()]),
    ),
    "frame_settings": ("TaskSettings", lambda cls, answer, *_: isinstance(answer, TaskSettings)),
    "draw_scenario": (
        "settings of the task, and a list of events",
        lambda cls, answer, *_: isinstance(answer, tuple) and list(map(type, answer)) == [cls.Settings, list],
    ),
}
"""Part of a task -> what is expected of it, and whether that is so; `selforg.plugins.guard` checks plug-ins."""
