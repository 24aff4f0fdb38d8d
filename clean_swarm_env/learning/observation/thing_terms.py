"""Terms of tasks other than cleaning: what mechanisms ask for, things around, facts, and what the task itself shows."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from clean_swarm_env.world.ground import Ground
from clean_swarm_env.world.parts.things import kinds_of
from selector.documents.plain import must_fit
from selforg.arrays import Flags, Floats, Ints
from selforg.elementary import unit_vectors
from selforg.plugins import check_answer

WAY = ("seen", "distance", "ahead", "left")


@TERMS.register
class CommandTerm(Term):
    """Vector that the mechanisms asked for last, ahead and left, by the largest speed; longer ones are shortened."""

    name = "command"
    components = ("command_ahead", "command_left")

    def write(self, rows: Ints, out: Floats) -> None:
        task = self.observed.worlds.task
        vectors = task.asked / task.world.max_speed
        short = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1.0)
        out[:] = in_own_frame(short, self.observed.worlds.physics.headings).T


@TERMS.register
class ThingsTerm(Term):
    """The way to the nearest thing of each kind that a robot senses: whether there is one, how far, ahead and left.

    A thing is sensed within its reach and `sight` [m]. Distances are divided by half the diagonal of the torus, or by
    the diagonal of the part of open land in which robots start.
    """

    name = "things"

    def __init__(self, observed: Observed, *, sight: float = 2.0) -> None:
        super().__init__(observed)
        self._sight = sight
        self.components = tuple(f"{kind}_{part}" for kind in kinds_of(observed.worlds.task.around) for part in WAY)

    def write(self, rows: Ints, out: Floats) -> None:
        worlds = self.observed.worlds
        world = worlds.world
        own = world.of_each("pose_goal_radius")[:, None]
        for number, thing in enumerate(worlds.task.around):
            offsets = world.ground.offsets(world.positions[:, :, None], thing.places[:, None])
            offsets = offsets.reshape(worlds.rows, -1, 2)
            clearance = np.linalg.norm(offsets, axis=2) - own - thing.goal_radius
            sensed = clearance <= thing.diffusion + self._sight
            way = way_to_nearest(offsets, sensed, worlds.physics.headings, world.ground)
            out[4 * number : 4 * number + 4] = way.T


@TERMS.register
class FactsTerm(Term):
    """What the robot knows: 1 for a fact that is true."""

    name = "facts"

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        self.components = observed.worlds.minds.memory.facts

    def write(self, rows: Ints, out: Floats) -> None:
        memory = self.observed.worlds.minds.memory
        for number, name in enumerate(self.components):
            out[number] = memory[name].values


@TERMS.register
class HeardTerm(Term):
    """What robots tell each other: the number of each fact that the robot has heard, and how long ago, by `oldest` [s].

    The number is 0 and the age 1 where it has heard nothing; numbers are divided by the fact's `scale`. Robots tell the
    facts of their documents, and those that the task notices.
    """

    name = "heard"

    def __init__(self, observed: Observed, *, oldest: float = 120.0) -> None:
        super().__init__(observed)
        worlds = observed.worlds
        worlds.minds.share(worlds.task.notices)
        self._facts, self._oldest = tuple(worlds.minds.facts.values()), max(oldest, worlds.period)
        where, telling = "observation: terms: heard", "robots that tell facts, by their document or their task"
        must_fit(oldest > 0.0, f"{where}: oldest", "more than 0 s", f"{oldest:g}")
        must_fit(len(self._facts) > 0, where, telling, f"none in {worlds.task.name}")
        self.components = tuple(f"{part}_{fact.name}" for fact in self._facts for part in (self.name, "age_of"))

    def write(self, rows: Ints, out: Floats) -> None:
        now = self.observed.worlds.now
        for number, fact in enumerate(self._facts):
            fact.observe(now, rows, self._oldest, out[2 * number], out[2 * number + 1])


@TERMS.register
class TaskTerm(Term):
    """What the task shows of itself: see `Task.observe`."""

    name = "task"

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        self.components = tuple(
            part
            for name, values in observed.worlds.task.observe().items()
            for part in ((name,) if values.ndim == 1 else [f"{name}_{k}" for k in range(values.shape[1])])
        )

    def write(self, rows: Ints, out: Floats) -> None:
        shown = [values.reshape(len(values), -1) for values in self.observed.worlds.task.observe().values()]
        if shown:
            values = np.concatenate(shown, axis=1).T
            check_answer(self.observed.worlds.task, "observe", values, out.shape)
            out[:] = np.clip(values, -1.0, 1.0)


def in_own_frame(vectors: Floats, headings: Floats) -> Floats:
    """Return vectors (R, 2) of the world's frame in the frames of robots with headings (R,): ahead and left."""
    cosine, sine = unit_vectors(headings)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=1)


def way_to_nearest(offsets: Floats, sensed: Flags, headings: Floats, ground: Ground) -> Floats:
    """Return the way (R, 4), see `WAY`, to the nearest of things at offsets (R, M, 2) [m] that is `sensed` (R, M)."""
    distances = np.where(sensed, np.linalg.norm(offsets, axis=2), np.inf)
    nearest = distances.argmin(axis=1)[:, None]
    away, found = np.take_along_axis(distances, nearest, axis=1)[:, 0], sensed.any(axis=1)
    chosen = np.take_along_axis(offsets, nearest[..., None], axis=1)[:, 0]
    unit = chosen / np.where(found & (away > 0.0), away, 1.0)[:, None]
    unit[~found] = 0.0
    scaled = np.where(found, np.minimum(away / ground.longest, 1.0), 1.0)
    return np.column_stack((found, scaled, in_own_frame(unit, headings)))
