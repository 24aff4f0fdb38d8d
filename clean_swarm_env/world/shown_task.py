"""What pictures, recordings, the global state and learners show of a task, and what its parts have to return.

Shapes: W worlds of N robots, R = W * N rows (robots).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Final

import numpy as np

from clean_swarm_env.config.tasks import ItemCounts, TaskKind, TaskSettings
from clean_swarm_env.physics.rays import Bodies
from clean_swarm_env.world.task_parts import ItemArrays, Recorded, Things, kinds_of
from clean_swarm_env.world.view import CARRYING, World
from selector.coordination.robot_network import RobotNetwork
from selforg.arrays import Floats, Ints
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


def _rows(task: Any, answer: Any) -> bool:  # noqa: ANN401
    """Return whether rows are those of robots at work, as kernels take them."""
    return answer is None or (
        isinstance(answer, np.ndarray)
        and (answer.ndim, answer.dtype, answer.flags.c_contiguous) == (1, np.int64, True)
        and bool((np.diff(answer, prepend=-1) > 0).all())
        and bool((answer < task.world.rows).all())
        and bool(task.world.team.working[answer].all())
    )


def _places(task: Any, *_: Any) -> bool:  # noqa: ANN401
    """Return whether robots and things are somewhere."""
    world = task.world
    return are_numbers(world.positions, world.worlds, world.robots, 2) and all(
        are_numbers(thing.places, world.worlds, thing.count, 2) for thing in task.around
    )


OF_WORLDS: Final = "arrays of finite numbers ({0.world.worlds},) by name"
OF_ROBOTS: Final = "arrays of finite numbers ({0.world.rows},) by name"
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
    "known": (OF_ROBOTS, lambda task, answer, *_: _by_name(answer, task.world.rows)),
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
        ("cost", "unavoidable", "duration"),
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
        ("command", "bend", "lead", "after_acting", "before_moving"),
        (
            "finite commands ({0.world.rows}, 2), written into the arrays that there are",
            lambda task, _, commands: (
                commands.vectors is commands.packed.record.vectors and are_numbers(commands.vectors, task.world.rows, 2)
            ),
        ),
    ),
    "start_tick": ("None, or rows of robots at work, in rising order, as a whole array of int64 (K,)", _rows),
    "headline": ("a text", lambda task, answer, *_: isinstance(answer, str)),
    "hindered": ("seconds and a flag", lambda task, answer, *_: isinstance(answer, tuple) and len(answer) == 2),
    "bodies": ("Bodies", lambda task, answer, *_: _all(Bodies, answer)),
    "item_arrays": ("ItemArrays", lambda task, answer, *_: isinstance(answer, ItemArrays)),
    "cargo": ("finite numbers ({0.world.rows},)", lambda task, answer, *_: are_numbers(answer, task.world.rows)),
    "recorded": ("a tuple of Recorded", lambda task, answer, *_: _all(Recorded, answer)),
    "drawn": ("values by name", lambda task, answer, *_: isinstance(answer, Mapping)),
    "facts_of_robots": (OF_ROBOTS, lambda task, answer, *_: _by_name(answer, task.world.rows)),
    "facts_of_worlds": (OF_WORLDS, lambda task, answer, *_: _by_name(answer, task.world.worlds)),
    "thing_names": ("names", lambda task, answer, *_: _all(str, answer)),
    "thing_values": (
        "finite numbers ({0.world.worlds}, K)",
        lambda task, answer, *_: are_numbers(answer, task.world.worlds, *np.shape(answer)[1:]),
    ),
    "goals": ("names of goals", lambda cls, answer, *_: bool(answer) and _all(str, answer)),
    "robot": ("a RobotNetwork", lambda cls, answer, *_: isinstance(answer, RobotNetwork)),
    "buffers": (
        "buffers by name",
        lambda cls, answer, *_: isinstance(answer, Mapping) and _all(SoBuffer, [*answer.values()]),
    ),
    "frame_settings": ("TaskSettings", lambda cls, answer, *_: isinstance(answer, TaskSettings)),
    "with_items": ("TaskSettings", lambda cls, answer, *_: isinstance(answer, TaskSettings)),
    "count_items": ("ItemCounts", lambda cls, answer, *_: isinstance(answer, ItemCounts)),
    "item_ranges": ("values by name", lambda cls, answer, *_: isinstance(answer, Mapping)),
    "draw_scenario": (
        "settings of the task, and a list of events",
        lambda cls, answer, *_: isinstance(answer, tuple) and list(map(type, answer)) == [cls.Settings, list],
    ),
}
"""Part of a task -> what is expected of it, and whether that is so; `selforg.plugins.guard` checks plug-ins."""


class ShownTask(TaskKind):
    """A task as others show it. You need to override nothing: robots, `around` and what robots carry are shown.

    Attributes:
        world: the worlds.
        around: the things, as `Task.things` returned them.

    """

    promises: ClassVar[Promises] = TASK_PROMISES
    world: World
    around: tuple[Things, ...]

    def hindered(self, row: int) -> float:
        """Return how long a collision still stops the robot of a row [s]."""
        return 0.0

    def bodies(self) -> Sequence[Bodies]:
        """Return the things that rays meet beside robots and walls: those in `around`, with their goal radii."""
        return [Bodies(thing.places, thing.goal_radius) for thing in self.around]

    def item_arrays(self) -> ItemArrays:
        """Return items, cargo and stations, the same arrays all the time; none unless robots carry items."""
        return ItemArrays.none(self.world.worlds, self.world.rows)

    def cargo(self) -> Ints:
        """Return the thing that each robot (R,) carries, -1 for none; 0 where all that is known is that it carries."""
        return np.where(self.world.carrying, 0, -1)

    def recorded(self) -> tuple[Recorded, ...]:
        """Return arrays that recordings keep beside poses, contacts and options; the same ones all the time."""
        if CARRYING not in self.world.memory.kinds:
            return ()
        cargo = self.cargo()

        def note() -> None:
            cargo[:] = self.cargo()

        return (Recorded("cargo", "robot", cargo, "the item that the robot carries, -1 for none", note),)

    def drawn(self, world: int, rows: Ints) -> Mapping[str, Any]:
        """Return what pictures show beside robots, `around` and trails: fields of `drawing.canvas.Canvas`."""
        return {"cargo": np.where(self.cargo()[rows] >= 0, 1, 0)}

    def facts_of_robots(self) -> Mapping[str, Floats]:
        """Return what the global state has of each robot beside its pose: name -> (R,), within [-1, 1]."""
        memory = self.world.memory
        return {name: memory[name].values for name in memory.facts}

    def facts_of_worlds(self) -> Mapping[str, Floats]:
        """Return what the global state has of each world beside its time: name -> (W,), within [-1, 1]."""
        return {}

    def thing_names(self) -> list[str]:
        """Return the names (K,) of what `thing_values` returns."""
        kinds = zip(kinds_of(self.around), self.around, strict=True)
        return [f"{kind}_{k}_{axis}" for kind, thing in kinds for k in range(thing.count) for axis in ("x", "y")]

    def thing_values(self, scaled: Callable[[Floats], Floats]) -> Floats:
        """Return what the global state has of things (W, K), within [-1, 1]; `scaled` makes this of places [m]."""
        worlds = self.world.worlds
        places = [scaled(thing.places).reshape(worlds, -1) for thing in self.around]
        return np.concatenate((np.zeros((worlds, 0)), *places), axis=1)
