"""Facts: numbers under names that robots tell each other, as gradients with a value and a time.

A robot's newest gradient replaces its older one: a team stores at most one for each robot and name. Why they are
gradients: docs/decisions/0225-facts-are-gradients.md.
"""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from selforg.arrays import READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.components.actions import ACTIONS, Action
from selforg.components.memory import Remembered
from selforg.components.sensors import SENSORS, SensorComponent
from selforg.components.sources import CLOCK_TOLERANCE, Source
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import check_fields
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.gradients.store.evaporation import still_there
from selforg.gradients.store.linking import first_layer, space_of
from selforg.gradients.store.records import Poses, Store, open_poses, open_store
from selforg.mechanisms.spreading import Carried, Spreader
from selforg.parameters import AtLeastZero, Finite, UpToOne, check_choice
from selforg.program import Rows, Step
from selforg.space import squared_length

SHARED_FACTS: Final = BufferSettings(aggregation={"DEFAULT": "newparent"}, min_diffusion=0.3)
"""Settings of the buffer of facts: the newest of each robot counts, and is gone below the diffusion of a pheromone."""
LARGEST: Final = 1e9
"""Largest amount of a number that is told."""


@dataclass(frozen=True)
class FactRule:
    """How a fact is told, kept and shown.

    Attributes:
        keep: which of those heard counts, the newest or the largest.
        diffusion [m], evaporation_factor [-], evaporation_period [s]: as in `Gradient`; it never evaporates by default.
        view_distance: how far beyond its diffusion it is known around the place where it was told [m].
        scale: number that counts as 1 in observations.
        means: what it says, for explanations, as in "that collisions stop".

    """

    keep: str = "newest"
    diffusion: AtLeastZero = 1.0
    evaporation_factor: UpToOne = 1.0
    evaporation_period: AtLeastZero = 0.0
    view_distance: float = np.inf
    scale: AtLeastZero = 1.0
    means: str = ""
    __pydantic_config__: ClassVar = {"allow_inf_nan": True}  # of `view_distance`, where a task is validated

    def __post_init__(self) -> None:
        """Check what no single field says."""
        check_choice("keep", self.keep, ("newest", "largest"))
        check_fields(0, self.diffusion, 0.0, self.evaporation_factor, self.evaporation_period, 0.0)
        for name, least, most in (
            ("diffusion", SHARED_FACTS.min_diffusion, LARGEST),
            ("view_distance", 0.0, np.inf),
            ("scale", 1.0 / LARGEST, LARGEST),
        ):
            if not least <= getattr(self, name) <= most:
                raise ValueError(f"{name}: expected {least:g} to {most:g}, got {getattr(self, name):g}")


class Hearing(NamedTuple):
    """One fact: which of those in view counts, what each row has heard, and room for messages."""

    channel: int  # number of its channel
    largest: int  # 1: the largest counts, 0: the newest
    view_distance: float  # [m]
    knows: Annotated[Flags, "R", READ]  # whether the row tells and hears it
    values: Annotated[Floats, "R", SCRATCH]  # what was heard [-], 0 for nothing
    stamps: Annotated[Floats, "R", SCRATCH]  # when it was told [s]
    tellers: Annotated[Ints, "R", SCRATCH]  # row that told it, -1 for nothing
    due: Annotated[Floats, "1", SCRATCH]  # when one of those stored evaporates next [s]
    messages: Annotated[Floats, "R MESSAGE", SCRATCH]
    tags: Annotated[Ints, "R TAG", SCRATCH]


open_hearing = opening(Hearing)


class SharedFact(Source):
    """One fact of N robots, and what each has heard of it, itself included.

    Attributes:
        name, rule: its name, and how it is told and kept.
        values: (N,) what was heard [-], 0 for nothing.
        stamps: (N,) when that was told [s].
        tellers: (N,) the row that told it, -1 for nothing.
        ages: (N,) time since then [s], -1 for nothing, as `note` has written them.
        robots: (N,) number of the teller in its team, -1 for nothing, likewise.
        asked_at: time of the last question [s].

    Args:
        buffer: the buffer of all facts.
        name, rule: see above.
        knows: (N,) robots that tell and hear it, all unless given; others do neither.

    Example:
        >>> fact = SharedFact(buffer, "door_shut", FactRule(keep="newest"))
        >>> fact.tell(now=0.2, rows=np.array([3]))
        >>> fact.ask(now=4.2, rows=np.array([0]))
        >>> fact.values[0], fact.tellers[0]

    """

    values: Annotated[Floats, "N", SCRATCH]
    stamps: Annotated[Floats, "N", SCRATCH]
    tellers: Annotated[Ints, "N", SCRATCH]
    ages: Annotated[Floats, "N", SCRATCH]
    robots: Annotated[Ints, "N", SCRATCH]
    _all: Annotated[Ints, "N", READ]
    _first: Annotated[Ints, "N", READ]  # first row of each row's team

    def __init__(self, buffer: SoBuffer, name: str, rule: FactRule, knows: Flags | None = None) -> None:
        self.name, self.rule, self._buffer, rows = name, rule, buffer, buffer.poses.rows
        evaporation = {"evaporation_factor": rule.evaporation_factor, "evaporation_period": rule.evaporation_period}
        carried = Carried(name, name, attraction=0, diffusion=rule.diffusion, moving=False, **evaporation)
        messages, tags = Spreader(buffer, carried).blank(rows)
        record = Hearing(
            channel=buffer.channel_code(name),
            largest=int(rule.keep == "largest"),
            view_distance=rule.view_distance,
            knows=np.ones(rows, dtype=np.bool_) if knows is None else knows,
            values=np.zeros(rows),
            stamps=np.zeros(rows),
            tellers=np.full(rows, -1),
            due=np.zeros(1),
            messages=messages,
            tags=tags,
        )
        self._packed, poses = Packed(record), buffer.poses.packed.record
        self.values, self.stamps, self.tellers = record.values, record.stamps, record.tellers
        self.ages, self.robots = np.full(rows, -1.0), np.full(rows, -1)
        self._all, self._first = np.arange(rows), poses.members[poses.first[poses.teams]]
        self.asked_at = 0.0
        self._looked = -1, -1  # messages and gradients of the buffer at the last look

    def tell(self, now: float, rows: Ints, values: npt.ArrayLike = 1.0) -> None:
        """Let `rows` (K,), each at most once, tell one number or `values` (K,) at `now` [s].

        Raises ValueError for what is no finite number up to 1e9.
        """
        given = np.full(len(rows), values, dtype=np.float64)
        count = tell_rows(now, rows, given, self._packed.handle, self._buffer.poses.packed.handle)
        if count < 0:
            wrong = given[~(np.abs(given) <= LARGEST)][0]
            raise ValueError(f"fact {self.name}: expected finite numbers up to {LARGEST:g}, got {wrong:g}")
        if count:
            record = self._packed.record
            self._buffer.spread(record.messages[:count], record.tags[:count], now)

    def ask(self, now: float, rows: Ints) -> None:
        """Renew what `rows` (K,) have heard, or all rows; nothing is looked at where nothing can have changed."""
        self.asked_at, table, hearing = now, self._buffer.table, self._packed
        counters, anywhere = table.record.counters, self.rule.view_distance == np.inf
        if anywhere and now < hearing.record.due[0] and self._looked == (counters[c.COUNTER_SERIAL], table.used):
            return
        hear_rows(
            now, self._all if anywhere else rows, hearing.handle, self._buffer.poses.packed.handle, table.packed.handle
        )
        self._looked = int(counters[c.COUNTER_SERIAL]), table.used  # looking frees what is gone

    def asking(self, stage: int, rows: Rows) -> list[Step]:
        """Return the step that does as `ask` does."""
        return [Step(stage, self.ask, rows)]

    def observe(self, now: float, rows: Ints, oldest: float, numbers: Floats, ages: Floats) -> None:
        """Write for `rows` (K,) number by `scale` and age by `oldest` [s] (N,), within [-1, 1]; 0 and 1 for nothing."""
        self.ask(now, rows)
        observe_rows(now, rows, self.rule.scale, oldest, self._packed.handle, numbers, ages)

    def note(self, now: float) -> None:
        """Write `ages` and `robots` at `now` [s]."""
        self.ask(now, self._all)
        heard = self.tellers >= 0
        self.ages[:] = np.where(heard, now - self.stamps, -1.0)
        self.robots[:] = np.where(heard, self.tellers - self._first, -1)

    def report(self, row: int) -> dict[str, Any]:
        """Return what a row has heard, as `note` wrote it, and the end of a sentence about it; empty for nothing."""
        value, robot, age = float(self.values[row]), int(self.robots[row]), float(self.ages[row])
        if age < 0.0:
            return {}
        who = "noticed itself" if robot == row - self._first[row] else f"heard from robot {robot}"
        says = " ".join(self.rule.means.split()) or f"that {self.name} is {value:g}"
        sentence = f"has {who}, {age:.0f} s ago, {says}"
        return {"fact": self.name, "value": value, "robot": robot, "age_s": age, "sentence": sentence}


@lean_kernel
def tell_rows(now: float, rows: Ints, values: Floats, hearing: Handle[Hearing], poses: Handle[Poses]) -> int:
    """Fill the room for messages with what `rows` (K,) tell, `values` (K,); return how many messages there are.

    A row tells nothing without a pose. The result is -1 if one of the values is no number up to LARGEST.
    """
    h, p = open_hearing(hearing), open_poses(poses)
    count = 0
    for index in range(len(rows)):
        row, value = int(rows[index]), values[index]
        if not abs(value) <= LARGEST:
            return -1
        if not h.knows[row] or p.rows[row, c.ROW_POSES] == 0 or count == len(h.tags):
            continue
        for axis in range(3):
            h.messages[count, c.X + axis] = p.own[row, 0, c.X + axis]
        h.messages[count, c.MESSAGE_FAR + c.FAR_STAMP] = h.messages[count, c.MESSAGE_FAR + c.FAR_CLOCK] = now
        h.messages[count, c.MESSAGE_FAR + c.FAR_VALUE], h.tags[count, c.TAG_SOURCE] = value, row
        count += 1
    return count


@lean_kernel
def hear_rows(now: float, rows: Ints, hearing: Handle[Hearing], poses: Handle[Poses], store: Written[Store]) -> None:
    """Write what `rows` (K,) have heard: the newest or the largest in view, of equal ones the first that was stored."""
    h, s, p = open_hearing(hearing), open_store(store), open_poses(poses)
    h.due[0], anywhere, before = np.inf, h.view_distance == np.inf, -1
    for index in range(len(rows)):
        row, best = int(rows[index]), (-np.inf, -np.inf)
        h.values[row], h.stamps[row], h.tellers[row] = 0.0, 0.0, -1
        if not h.knows[row] or not (anywhere or p.rows[row, c.ROW_POSES] > 0):
            continue
        if anywhere and s.per_row == 0 and before >= 0 and p.teams[before] == p.teams[row]:
            h.values[row], h.stamps[row], h.tellers[row] = h.values[before], h.stamps[before], h.tellers[before]
            continue
        before = row
        first = first_layer(h.channel, space_of(row, p.teams, store), store)
        for layer in range(first, first + c.UNBOUNDED + 1):
            slot = s.layers[layer, c.LAYER_HEAD]
            while slot >= 0:
                at, slot = slot, s.marks[slot, c.MARK_AFTER]
                if not still_there(at, now, store):
                    continue
                h.due[0] = min(h.due[0], s.near[at, c.NEAR_DUE])
                dx, dy = s.near[at, c.X] - p.own[row, 0, c.X], s.near[at, c.Y] - p.own[row, 0, c.Y]
                dz, reach = s.near[at, c.Z] - p.own[row, 0, c.Z], h.view_distance + s.near[at, c.DIFFUSION]
                if squared_length(dx, dy, dz, p.extent) > reach * reach:
                    continue
                value, stamp = s.far[at, c.FAR_VALUE], s.far[at, c.FAR_STAMP]
                rank = (value, stamp) if h.largest == 1 else (stamp, value)
                if rank > best:
                    best = rank
                    h.values[row], h.stamps[row], h.tellers[row] = value, stamp, s.marks[at, c.MARK_SOURCE]


@lean_kernel
def observe_rows(
    now: float, rows: Ints, scale: float, oldest: float, hearing: Handle[Hearing], numbers: Floats, ages: Floats
) -> None:
    """Write number and age (N,) of what `rows` (K,) have heard, see `SharedFact.observe`."""
    h = open_hearing(hearing)
    for row in rows:
        numbers[row], ages[row] = min(max(h.values[row] / scale, -1.0), 1.0), 1.0
        if h.tellers[row] >= 0:
            ages[row] = min((now - h.stamps[row]) / oldest, 1.0)


class FactSensor(SensorComponent):
    """Base class of sensors of a fact."""

    def __init__(self, fact: SharedFact, unheard: Finite = 0.0) -> None:
        self.fact, self._unheard = fact, unheard
        self.sources = (fact,)


@SENSORS.register
class Heard(FactSensor):
    """A fact: the robot, or another one that it has heard, told it within the last `within` [s]."""

    kind = "fact"

    def __init__(self, fact: SharedFact, within: AtLeastZero = LARGEST) -> None:
        super().__init__(fact)
        self._within = within + CLOCK_TOLERANCE

    def read(self, rows: Ints) -> npt.NDArray[np.generic]:
        fact = self.fact
        there: Flags = (fact.tellers[rows] >= 0) & (fact.asked_at - fact.stamps[rows] <= self._within)
        return there


@SENSORS.register
class HeardValue(FactSensor):
    """The number that was told [-], `unheard` where none was heard."""

    def read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return np.where(self.fact.tellers[rows] >= 0, self.fact.values[rows], self._unheard)


@SENSORS.register
class HeardAge(FactSensor):
    """Time since it was told [s], `unheard` [s] where none was heard."""

    def __init__(self, fact: SharedFact, unheard: AtLeastZero = 3600.0) -> None:
        super().__init__(fact, unheard)

    def read(self, rows: Ints) -> npt.NDArray[np.generic]:
        return np.where(self.fact.tellers[rows] >= 0, self.fact.asked_at - self.fact.stamps[rows], self._unheard)


@ACTIONS.register
class Tell(Action):
    """Tell a fact while the behaviour runs: `value`, or what each robot knows under a `name`."""

    def __init__(self, fact: SharedFact, value: Finite = 1.0, name: Remembered | None = None) -> None:
        self._fact, self._value, self._name = fact, value, name

    def leave(self, now: float, rows: Ints) -> None:
        self._fact.tell(now, rows, self._value if self._name is None else self._name.values[rows])
