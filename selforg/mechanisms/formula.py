"""The blueprint of a movement mechanism that is one formula, or makes a movement of pairs by a function of its own."""

from collections.abc import Callable
from functools import cache
from typing import Annotated, ClassVar, Unpack

import numpy as np

from selforg.arrays import READ, Flags, Floats, Ints
from selforg.commands import Moved
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Handle, Packed
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair import CHOOSE_NEAREST, Own, Pair, pair_at
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import Filter, PairRoom, Queries
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, Sight, Store, open_sight
from selforg.mechanisms.base import MovementMechanism, MoveOptions
from selforg.mechanisms.causes import Causes, note_cause
from selforg.mechanisms.movement import (
    ALL_IN_VIEW,
    WALLS_IGNORED,
    Combination,
    Formula,
    Rule,
    Signs,
    add,
    combined,
    full_length,
    move_rows,
    open_rule,
)
from selforg.parameters import at_least
from selforg.program import Rows, Step


class FormulaMechanism(MovementMechanism):
    """A movement mechanism that sums one formula over the pairs that a row sees; subclasses define `formula`.

    `formula` gets a `Pair` and returns the length of its contribution: towards the gradient if positive, away from it
    if negative; negative infinity is full repulsion. It must not return NaN. It is compiled, and so are functions that
    it calls, with `selforg.compiler.decorators.part`. A mechanism that is no such sum defines `combine`.

    Example:
        >>> @MECHANISMS.register
        ... class Spring(FormulaMechanism):
        ...     @staticmethod
        ...     def formula(pair: Pair) -> float:
        ...         return pair.distance - pair.own_reach

    Attributes:
        combine: what makes a vector of pairs in place of a sum, compiled with `part`.
        looks: how far gradients of attraction -1, 0, +1 are seen: NOT_AT_ALL, OWN_GOAL_RADIUS or VIEW_DISTANCE.
        wakes: whether a gradient in view, of attraction -1, 0, +1, makes a row active though it adds nothing.
        alone: whether a row moves that sees nothing, too; one that looks at nothing always does.
        least_poses: number of poses that a row must have spread.
        by_own_reach: full repulsion and the longest vector are the own reach, not the gradient's and `max_speed`.
        random: where the sum is zero the direction is random, at `max_speed`.
        chooses: rule of `selforg.gradients.pair` by which one gradient is followed.
        walls: what walls do to the movement: WALLS_IGNORED, REPEL or REFLECT.
        min_speed, max_speed: limits of the length of a vector that is not zero [m/s]; the class has the defaults.
        angle_xy, angle_yz: view angles [rad] to either side of the heading.
        parameters: numbers that `combine` finds in `Rule.parameters`.
        boid_columns: columns of the table of boids, 0 for a mechanism without one.

    """

    _kernel: ClassVar[Callable[..., int]]
    """What is called as `move_rows` is."""

    combine = staticmethod(combined)
    looks: ClassVar[Signs] = ALL_IN_VIEW
    wakes: ClassVar[Signs] = (0, 0, 0)
    alone: ClassVar[bool] = False
    least_poses: ClassVar[int] = 1
    boid_columns: ClassVar[int] = 0
    by_own_reach: ClassVar[bool] = False
    random: ClassVar[bool] = False
    chooses: ClassVar[int] = CHOOSE_NEAREST
    walls: ClassVar[int] = WALLS_IGNORED
    min_speed = 0.0
    max_speed = 1.0
    angle_xy = np.inf
    angle_yz = np.inf
    parameters: Annotated[Floats, "PARAMETER", READ]  # of the formula; each mechanism numbers its own

    @staticmethod
    def formula(pair: Pair) -> float:
        """Return the length of the contribution of a pair [m or -]."""
        raise NotImplementedError

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        sums = cls.combine is combined
        cls._kernel = staticmethod(
            move_rows.of(sum_of(cls.formula), cls.formula) if sums else move_rows.of(cls.combine)
        )

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        min_speed: float | None = None,
        max_speed: float | None = None,
        **options: Unpack[MoveOptions],
    ) -> None:
        super().__init__(buffer, **options)
        self.max_speed = at_least(self, "max_speed", self.max_speed if max_speed is None else max_speed, 0.0)
        self.min_speed = at_least(self, "min_speed", self.min_speed if min_speed is None else min_speed, 0.0)
        self.parameters = np.zeros(0)
        self._room = PairRoom(self.buffer)
        self._rule: Packed[Rule] | None = None

    def move_into(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        """Do what `MovementMechanism.move_into` does, with a longer table whenever a row sees too much for it."""
        self.directions.refill()
        moved, sight = Packed(Moved(vectors, active)).handle, self._room.sight(now, self.channels)
        poses, store = self.poses.packed.handle, self.buffer.table.packed.handle
        while left := self._kernel(now, rows, moved, sight, self._packed.handle, poses, store):
            rows, sight = rows[len(rows) - left :], self._room.double()
            self.directions.refill()

    def moving(self, stage: int, rows: Rows, moved: Packed[Moved]) -> list[Step]:
        """Return the step that does as `move_into` does; in Python, if all has to evaporate before each look."""
        if self.buffer.settings.whole_seconds or type(self).move_into is not FormulaMechanism.move_into:
            return super().moving(stage, rows, moved)
        records = moved, self._room.packed, self._packed, self.poses.packed, self.buffer.table.packed

        def go_on(now: float, rows: Ints, left: int) -> None:
            self.move_into(now, rows[len(rows) - left :], *moved.record)

        return [Step(stage, go_on, rows, self._kernel, records)]

    @property
    def _packed(self) -> Packed[Rule]:
        """The record of the mechanism, with room for as many boids as pairs, packed when it moves."""
        pairs = len(self._room.pairs)
        if self._rule is not None and len(self._rule.record.boids) < pairs:
            self._rule.replace(self._rule.record._replace(boids=np.empty((pairs, self.boid_columns))))
        if self._rule is None:
            self._rule = Packed(
                Rule(
                    looks=np.array(self.looks),
                    wakes=np.array(self.wakes),
                    by_own_reach=self.by_own_reach,
                    alone=self.alone or not any(self.looks),
                    least_poses=self.least_poses,
                    random=self.random,
                    chooses=self.chooses,
                    walls=self.walls,
                    sight_bits=self._sight_bits,
                    view_distance=self.view_distance,
                    min_speed=self.min_speed,
                    max_speed=self.max_speed,
                    angle_xy=self.angle_xy,
                    angle_yz=self.angle_yz,
                    directions=self.directions.vectors,
                    cursor=self.directions.cursor,
                    low=self.directions.low,
                    parameters=self.parameters,
                    boids=np.empty((pairs, self.boid_columns)),
                    velocity=np.zeros(3),
                    change=np.zeros(3),
                    total=np.zeros(3),
                )
            )
        return self._rule


@cache
def sum_of(formula: Formula) -> Combination:
    """Return what sums `formula` over all pairs of a row."""
    length_of = inlined(formula)

    @inlined
    def sum_all(
        row: int,
        found: int,
        own: Own,
        sight: Handle[Sight],
        rule: Handle[Rule],
        poses: Handle[Poses],
        store: Handle[Store],
    ) -> bool:
        m, pairs = open_rule(rule), open_sight(sight).pairs
        x, y, z = 0.0, 0.0, 0.0
        for index in range(found):
            pair = pair_at(index, pairs, own)
            length = length_of(pair)
            if pair.distance > 0.0 and length > -np.inf:
                scale = length / pair.distance
                x += scale * pairs[index, c.PAIR_DX]
                y += scale * pairs[index, c.PAIR_DY]
                z += scale * pairs[index, c.PAIR_DZ]
            else:
                add(index, length, own.reach if m.by_own_reach else full_length(index, sight), row, sight, rule)
        m.total[0] += x
        m.total[1] += y
        m.total[2] += z
        return True

    return sum_all


class NeighbourMechanism(FormulaMechanism):
    """Base class of mechanisms that look at the moving gradients of the neighbours, by default those of the poses."""

    sight_bits: ClassVar[int] = c.SEE_MOVING | c.SKIP_OWN

    def __init__(self, buffer: SoBuffer | OwnPoses, **options: Unpack[MoveOptions]) -> None:
        poses = buffer if isinstance(buffer, OwnPoses) else buffer.poses
        options["channels"] = tuple(options.get("channels", ())) or (poses.channel,)
        super().__init__(buffer, **options)
        self._sight_bits = self.sight_bits

    def weigh(self, now: float, rows: Ints, wishes: Floats, causes: Causes) -> None:
        """Note all others by the lengths of their contributions to a sum; a mechanism that is no sum has no causes."""
        poses = self.poses
        if self.combine is not combined or not len(rows):
            return
        seen = Queries(SoBuffer(BufferSettings(), poses.space, poses)).gather(  # nothing of its own buffer changes
            now, rows, Filter(static=False, view_distance=self.view_distance)
        )
        for index, row in enumerate(rows.tolist()):
            goal_radius, reach = poses.own[row, 0, c.GOAL_RADIUS], poses.own[row, 0, [c.DIFFUSION, c.GOAL_RADIUS]].sum()
            for pair in seen.pairs[seen.start[index] : seen.start[index + 1]]:
                own = Own(goal_radius, reach, self.view_distance)
                length = min(abs(self.formula(pair_at(0, pair[None], own))), reach)  # all of it where it is full
                other = int(-1 - pair[c.PAIR_SLOT]) % poses.rows
                note_cause(row, other, length, causes.who, causes.weights)
