"""Actions of a learner: the option that serves each goal, the robot's movement vector, or an option and a correction.

Shapes: R rows (robots), C coordinated goals, O options of all goals one after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from reprlib import repr as brief
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from clean_swarm_env.world.worlds import Worlds
from selector.coordination.model import CoordinatorModel
from selector.documents.fields import Closed, Name
from selector.documents.plain import must_fit, must_know
from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import kernel, lean_kernel
from selforg.elementary import sine_cosine

Mode = Literal["option", "velocity", "both"]


class ActionConfig(Closed):
    """The actions of a learner, one in each decision period."""

    mode: Mode = "option"
    """Whether an action is the option that serves each goal, the movement vector in the robot's frame, or both: options
    and a correction of the movement."""
    serves: dict[Name, tuple[Name, ...]] = Field(default={})
    """Option -> the only phases of the task in which it can serve; an option that is not named can always serve."""


class LearnerActions:
    """Checks the actions of a learner, and gives them to worlds: options, movement vectors, or both.

    Options are one whole number for each coordinated goal. An option that cannot serve in a phase is replaced by the
    option of the highest expert score that can.

    Vectors are ahead and left in the robot's frame, in shares of the largest speed; components are clipped to [-1, 1].
    The vector keeps its direction in the world through the decision period. The drive follows the vector in place of
    those of behaviours. The robot's network decides nothing. The robot picks, recycles and dumps wherever it can.
    Corrections are added to the vectors of behaviours instead, and the network decides as ever.

    Attributes:
        counts: (C,) number of options of each goal.
        default: (C,) option of the highest expert score of each goal.

    Raises:
        DocumentError: an unknown option or phase in `serves`, or a phase in which no option of a goal could serve.

    """

    def __init__(
        self, models: Sequence[CoordinatorModel], config: ActionConfig, always: Ints, phases: Sequence[str]
    ) -> None:
        """Bind robots to the option of each goal that they always hold, `always` (R, C); -1 for none.

        `phases` are those of the task, in the order of their numbers.
        """
        self._mode = config.mode
        self.counts = tuple(len(model.options) for model in models)
        self.default: Ints = np.array([int(np.argmax(model.scores)) for model in models], dtype=np.int64)
        names = [name for model in models for name in model.options]
        for name, served in config.serves.items():
            must_know("option", name, names, "actions: serves")
            for phase in served:
                must_know("phase", phase, phases, f"actions: serves: {name}")
        self._table: Flags = np.array([[p in config.serves.get(n, phases) for n in names] for p in phases])  # (P, O)
        self._stand_in: Ints = np.zeros((len(phases), len(models)), dtype=np.int64)
        for k, model in enumerate(models):
            first = sum(self.counts[:k])
            for number, able in enumerate(self._table[:, first : first + self.counts[k]]):
                serving = f"an option for goal {model.goal} in phase {phases[number]!r}"
                must_fit(bool(able.any()), "actions: serves", serving, "none")
                self._stand_in[number, k] = int(np.argmax(np.where(able, model.scores, -np.inf)))
        self.masked = not self._table.all()
        self._limits = np.array(self.counts)
        self._firsts = np.cumsum([0, *self.counts])[:-1]
        self._bound: Flags = np.repeat(always >= 0, self.counts, axis=1)  # (R, O)
        self._held: Flags = np.repeat(self._firsts + always, self.counts, axis=1) == np.arange(len(names))
        self._some_bound = bool(self._bound.any())
        self._usual: Flags = np.isin(np.arange(len(names)), self._firsts + self.default)

    def masks(self, phases: Ints, working: Flags) -> Flags:
        """Return which options (R, O) can serve in the `phases` (R,), or the only one that a robot always holds.

        Robots that are not `working` (R,) have the option of the highest expert score and no choice: a mask without
        any option would be nan in the distributions of some libraries.
        """
        masks: Flags = self._table.take(phases, axis=0)
        masks = np.where(self._bound, self._held, masks) if self._some_bound else masks
        masks[~working] = self._usual
        return masks

    def able(self, options: Ints, phases: Ints) -> Ints:
        """Return `options` (R, C) with stand-ins for those that cannot serve in the `phases` (R,)."""
        able = self._table[phases[:, None], self._firsts + options]
        return np.where(able, options, self._stand_in[phases])

    def check(self, options: NDArray[Any], rows: int) -> Ints:
        """Return `options` (R, C), or (R,) for one goal, as (R, C) whole numbers, or raise ValueError."""
        given, expected = np.asarray(options), (rows, len(self.counts))
        if given.shape != expected and (given.shape != expected[:1] or len(self.counts) > 1):
            raise ValueError(f"options: expected shape {expected}, got {given.shape}")
        if given.dtype.kind not in "iu":
            raise ValueError(f"options: expected whole numbers, got {given.dtype}")
        table: Ints = np.ascontiguousarray(given.reshape(expected), dtype=np.int64)
        place = first_wrong(table, self._limits)
        if place >= 0:
            row, goal = divmod(place, len(self.counts))
            raise ValueError(f"options[{row}]: expected 0..{self.counts[goal] - 1}, got {table[row, goal]}")
        return table

    def checked(self, actions: NDArray[Any], rows: int) -> tuple[Ints | None, Floats | None]:
        """Return the options (R, C) and the vectors (R, 2) of actions, those that there are, or raise ValueError."""
        options = vectors = actions
        if self._mode == "both":
            options, vectors = parted(np.asarray(actions), rows, len(self.counts))
        known = None if self._mode == "velocity" else self.check(options, rows)
        return known, None if self._mode == "option" else checked_vectors(vectors, rows)

    def apply(self, worlds: Worlds, actions: NDArray[Any]) -> None:
        """Apply the actions of a period that begins now; see `Batch.ticks`."""
        options, given = self.checked(actions, worlds.rows)
        if options is not None:
            worlds.hold(self.able(options, worlds.task.phase()) if self.masked else options)
        if given is None:
            return
        turned = np.empty((worlds.rows, 2))
        turn_to_world(given, worlds.physics.headings, worlds.floor.drive.max_speed, turned)
        if self._mode == "both":
            worlds.correct(turned if given.any() else None)  # -0.0 + 0.0 would be another bit
        else:
            worlds.drive(turned)


def parted(actions: NDArray[Any], rows: int, goals: int) -> tuple[Ints, NDArray[Any]]:
    """Return the options (R, C) of C goals and the vectors (R, 2) in `actions` (R, C + 2), or raise ValueError."""
    if actions.shape != (rows, goals + 2) or (actions[:, :goals] % 1.0 != 0.0).any():
        expected = "an option" if goals == 1 else f"{goals} options"
        raise ValueError(f"actions: expected {expected} and a vector for each of {rows} rows, got {brief(actions)}")
    return actions[:, :goals].astype(np.int64), actions[:, goals:]


def checked_vectors(actions: NDArray[Any], rows: int) -> Floats:
    """Return vectors (R, 2) as float64, or raise ValueError."""
    given = np.asarray(actions)
    if given.shape != (rows, 2) or not np.isfinite(given).all():
        raise ValueError(f"actions: expected finite numbers of shape {(rows, 2)}, got {given.shape}")
    return given.astype(np.float64)


@lean_kernel
def first_wrong(options: Ints, limits: Ints) -> int:
    """Return the place, counted row by row, of the first of `options` (R, C) outside 0..limits-1; -1 without one."""
    for row in range(options.shape[0]):
        for goal in range(options.shape[1]):
            if not 0 <= options[row, goal] < limits[goal]:
                place: int = row * options.shape[1] + goal
                return place
    return -1


@kernel
def turn_to_world(actions: Floats, headings: Floats, max_speed: Floats, vectors: Floats) -> None:
    """Write the vectors (R, 2) [m/s] in the world's frame of `actions` (R, 2) in the robots' frames.

    Actions are shares of `max_speed` (R,) [m/s].
    """
    for row in range(actions.shape[0]):
        ahead = max_speed[row] * min(max(actions[row, 0], -1.0), 1.0)
        left = max_speed[row] * min(max(actions[row, 1], -1.0), 1.0)
        sine, cosine = sine_cosine(headings[row])
        vectors[row, 0] = cosine * ahead - sine * left
        vectors[row, 1] = sine * ahead + cosine * left
