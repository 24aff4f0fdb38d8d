"""Sensor components, which make readings of a behaviour network from sources and from the memory of robots."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from selforg.arrays import KEPT, Flags, Floats, Ints
from selforg.commands import Moved, open_moved
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.components.memory import Remembered
from selforg.components.sources import (
    Answers,
    DecisionSource,
    GoalSource,
    MovementSource,
    Source,
    Surroundings,
    open_answers,
)
from selforg.network.model.behaviours import SensorKind
from selforg.parameters import AtLeastZero, Finite, at_least, check_choice
from selforg.plugins import Promises, are_numbers
from selforg.program import SENSE, Rows, Step
from selforg.registry import Registry

MOST_RAYS: Final = 360
MOST_METRES: Final = 100.0


class Reading(NamedTuple):
    """What a compiled sensor makes of an answer, and where it writes that, of R rows."""

    is_fact: int  # 1: whether there is an answer above `above`, and at most `most`; 0: the answer itself
    above: float  # nan: no bound
    most: float
    least: float  # smallest number that is read
    absent: float  # number that is read without an answer
    readings: Annotated[Floats, "R S", KEPT]  # of the network that has the sensor
    column: int  # of the sensor there
    shown: Annotated[Floats, "R T", KEPT]  # readings of a network that gets them too
    shown_column: int


open_reading = opening(Reading)


@inlined
def write_reading(row: int, there: bool, answer: float, reading: Written[Reading]) -> None:
    """Write what a row reads, of an answer if it is `there`."""
    t = open_reading(reading)
    if t.is_fact:
        value = 1.0 if there and not answer <= t.above and answer <= t.most else 0.0
    else:
        value = max(answer, t.least) if there else t.absent
    t.readings[row, t.column] = t.shown[row, t.shown_column] = value


@lean_kernel
def read_vectors(now: float, rows: Ints, moved: Handle[Moved], reading: Written[Reading]) -> int:
    """Write the readings of `rows` (K,) of the lengths of vectors; a step, see `selforg.program`."""
    given = open_moved(moved)
    for row in rows:
        squared = 0.0
        for axis in range(given.vectors.shape[1]):
            squared += given.vectors[row, axis] * given.vectors[row, axis]
        write_reading(row, given.active[row], np.sqrt(squared), reading)
    return 0


@lean_kernel
def read_answers(now: float, rows: Ints, answers: Handle[Answers], reading: Written[Reading]) -> int:
    """Write the readings of `rows` (K,) of answers; a step, see `selforg.program`."""
    given = open_answers(answers)
    for row in rows:
        write_reading(row, given.there[row], given.values[row], reading)
    return 0


class SensorComponent(ABC):
    """Base class of sensors: `read` is called once in a tick, after the sources were asked.

    Subclasses state their `kind`, name their `sources` and implement `read`. Documents can declare registered sensors;
    the keys are the parameters of the constructor. For a parameter of type `MovementSource`, `DecisionSource`,
    `GoalSource`, `Remembered` or of a mechanism, a document gives the name of a mechanism, a target or a piece of
    knowledge.

    Example:
        >>> @SENSORS.register
        ... class Heading(SensorComponent):
        ...     def __init__(self, mechanism: MovementSource) -> None:
        ...         self.sources = (mechanism,)
        ...         self._vectors = mechanism.vectors
        ...
        ...     def read(self, rows):
        ...         return np.arctan2(self._vectors[rows, 1], self._vectors[rows, 0])

    """

    promises: ClassVar[Promises] = {
        "read": ("finite numbers, one of each row", lambda sensor, answer, rows: are_numbers(answer, len(rows)), 0)
    }
    kind: SensorKind = "number"
    kind_of: ClassVar[str | None] = None
    """Name of the parameter (a `Remembered`) that decides the kind of the sensor; None: `kind` does."""
    sources: Sequence[Source] = ()

    example: ClassVar[Mapping[str, Any]] = {}
    """Arguments with which the contract tests build the class; the tests replace None."""

    @abstractmethod
    def read(self, rows: Ints) -> npt.NDArray[np.generic]:
        """Return the readings (K,) of `rows` (K,) as bool or number."""

    def reading(self, rows: Rows, readings: Floats, column: int, shown: Floats, shown_column: int) -> Step:
        """Return the step that writes what is read into a column of `readings` (N, S), and into one of `shown`."""

        def write(now: float, reading: Ints) -> None:
            readings[reading, column] = shown[reading, shown_column] = self.read(reading)

        return Step(SENSE, write, rows)


SENSORS: Registry[SensorComponent] = Registry("sensor", base=SensorComponent)


class CompiledSensor(SensorComponent):
    """Base class of sensors that a kernel reads: from a record, by the bounds of a `Reading`."""

    kernel: ClassVar[Any] = staticmethod(read_answers)
    above, most, least, absent = np.nan, np.inf, -np.inf, 0.0

    def __init__(self, answers: Packed[Any], *sources: Source) -> None:
        self._answers, self.sources = answers, sources

    def read(self, rows: Ints) -> npt.NDArray[np.generic]:
        read: Floats = np.zeros((len(self._answers.record[0]), 1))
        type(self).kernel(0.0, rows, self._answers.handle, self._into(read, 0, read, 0).handle)
        readings: Floats = read[rows, 0]
        return readings

    def reading(self, rows: Rows, readings: Floats, column: int, shown: Floats, shown_column: int) -> Step:
        if type(self).read is not CompiledSensor.read:
            return super().reading(rows, readings, column, shown, shown_column)
        kernel, where = type(self).kernel, self._into(readings, column, shown, shown_column)
        return Step(SENSE, kernel, rows, kernel, (self._answers, where))

    def _into(self, *where: Any) -> Packed[Reading]:  # noqa: ANN401  (arrays and columns)
        bounds = self.above, self.most, self.least, self.absent
        return Packed(Reading(int(self.kind == "fact"), *bounds, *where))


class VectorSensor(CompiledSensor):
    """Base class of sensors of the length of a movement vector."""

    kernel = staticmethod(read_vectors)

    def __init__(self, mechanism: MovementSource) -> None:
        super().__init__(mechanism.moved, mechanism)


@SENSORS.register
class VectorPresent(VectorSensor):
    """A fact: there is a movement vector longer than `longer_than` [m/s]; a zero vector does not count."""

    kind = "fact"

    def __init__(self, mechanism: MovementSource, longer_than: AtLeastZero = 1e-9) -> None:
        super().__init__(mechanism)
        self.above = at_least(self, "longer_than", longer_than, 0.0)


@SENSORS.register
class VectorLength(VectorSensor):
    """Length of the movement vector [m/s], 0 without one."""


class GoalSensor(CompiledSensor):
    """Base class of sensors of the clearance to a goal gradient."""

    def __init__(self, target: GoalSource) -> None:
        super().__init__(target.answers, target)


@SENSORS.register
class GoalPresent(GoalSensor):
    """A fact: a goal gradient is in view."""

    kind = "fact"


@SENSORS.register
class GoalReached(GoalSensor):
    """A fact: the own goal area touches that of the goal."""

    kind = "fact"
    most = 0.0


@SENSORS.register
class GoalDistance(GoalSensor):
    """Clearance to the goal [m], at least 0; `unseen` [m] without a goal in view."""

    example: ClassVar[Mapping[str, Any]] = {"unseen": 9.0}
    least = 0.0

    def __init__(self, target: GoalSource, unseen: AtLeastZero) -> None:
        if not (unseen >= 0.0 and np.isfinite(unseen)):
            raise ValueError(f"GoalDistance: unseen must be a distance, got {unseen}")
        super().__init__(target)
        self.absent = float(unseen)


@SENSORS.register
class FartherThan(GoalSensor):
    """A fact: a goal is in view with a clearance larger than `distance` [m]."""

    kind = "fact"
    example: ClassVar[Mapping[str, Any]] = {"distance": 3.0}

    def __init__(self, target: GoalSource, distance: AtLeastZero) -> None:
        super().__init__(target)
        self.above = float(distance)


@SENSORS.register
class Value(CompiledSensor):
    """The value that a decision mechanism would decide now [-]."""

    def __init__(self, mechanism: DecisionSource) -> None:
        super().__init__(mechanism.answers, mechanism)


@SENSORS.register
class StateIs(SensorComponent):
    """A fact: a decision mechanism would decide for one certain state now."""

    kind = "fact"
    example: ClassVar[Mapping[str, Any]] = {"state": "True"}

    def __init__(self, mechanism: DecisionSource, state: str) -> None:
        known = mechanism.mechanism.states
        check_choice("StateIs: state", state, known)
        self.source, self.sources, self.code = mechanism, (mechanism,), known.index(state)

    def read(self, rows: Ints) -> npt.NDArray[np.generic]:
        there: Flags = self.source.states[rows] == self.code
        return there


@SENSORS.register
class Changed(CompiledSensor):
    """A fact: a decision mechanism would now decide something else than it has spread last."""

    kind = "fact"

    def __init__(self, mechanism: DecisionSource) -> None:
        super().__init__(mechanism.changes, mechanism)


@SENSORS.register
class Known(CompiledSensor):
    """The value that the robot remembers under a name."""

    kind_of = "name"

    def __init__(self, name: Remembered) -> None:
        super().__init__(name.answers)
        self.kind = name.kind
        self.above = 0.0


@SENSORS.register
class Lidar(SensorComponent):
    """Distance from the middle of the robot to the nearest wall, robot or thing that its rays meet [m].

    It is `farthest` [m] where they meet nothing. The rays are spread evenly over a sector of `width` [rad] about
    `towards` [rad], 0 ahead, positive to the left. Things that have no size count as discs of radius `things` [m];
    0: they are not met.
    """

    def __init__(
        self,
        surroundings: Surroundings,
        *,
        towards: Finite = 0.0,
        width: AtLeastZero = 0.0,
        rays: int = 1,
        farthest: AtLeastZero = 4.0,
        things: AtLeastZero = 0.1,
    ) -> None:
        check_rays("Lidar", rays, farthest, things)
        if not (abs(towards) <= 2.0 * np.pi and 0.0 <= width <= 2.0 * np.pi):
            raise ValueError(f"Lidar: expected angles of at most 2 pi, got towards {towards:g} and width {width:g}")
        angles = towards + width * (np.arange(rays) / max(rays - 1, 1) - (0.5 if rays > 1 else 0.0))
        self._cast = surroundings.rays(angles, float(farthest), float(things))

    def read(self, rows: Ints) -> npt.NDArray[np.generic]:
        nearest: Floats = self._cast(rows).min(axis=1)
        return nearest


def check_rays(where: str, rays: float, farthest: float, things: float) -> None:
    """Raise ValueError unless there may be so many rays, so far [m], that meet things of such a radius [m]."""
    if not (rays == int(rays) and 1 <= rays <= MOST_RAYS):
        raise ValueError(f"{where}: rays: expected a whole number from 1 to {MOST_RAYS}, got {rays:g}")
    if not (0.0 < farthest <= MOST_METRES and 0.0 <= things <= MOST_METRES):
        expected = f"farthest above 0 and things from 0 to {MOST_METRES:g} m"
        raise ValueError(f"{where}: expected {expected}, got {farthest:g} and {things:g}")
