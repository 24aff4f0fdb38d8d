"""The face of a batch of worlds, which borders step by decision periods, whatever the robots of these worlds do."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from numpy.typing import NDArray

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.learning.actions import OptionActions
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.mission import MissionResult
from selforg.arrays import Flags, Floats, Ints

FigureColumns = dict[str, list[Any]]
"""Key of an info -> values of all worlds or of all rows."""
NO_JUMPS = "set_state: expected a batch that records nothing, because a recording has no jumps"
"""What `set_state` says in a batch that records."""


class BatchStep(NamedTuple):
    """The result of one decision period; the arrays belong to the batch and are valid until the next call."""

    observations: Observations
    """(R, F) float32; of worlds that have begun anew, the first observations of the new episode."""
    rewards: Floats
    """(R,) float64."""
    terminated: Flags
    """(W,) whether all garbage of the world was dumped in this period."""
    truncated: Flags
    """(W,) whether the time of the world was over with this period and garbage was left."""
    final_observations: Observations
    """(R, F) float32; the observations at the end of the mission, in rows of worlds whose missions ended."""


class ActionFace(Protocol):
    """The configuration of actions."""

    @property
    def mode(self) -> str:
        """What an action is."""

    def model_dump(self) -> dict[str, Any]:
        """Return all settings by their names."""


class ObserverFace(Protocol):
    """What the components of an observation are."""

    names: tuple[str, ...]
    bounds: Observations


class GlobalFace(Protocol):
    """The global state of each world."""

    names: tuple[str, ...]

    def now(self) -> Observations:
        """Return the state (W, G) of the worlds as they are."""


@dataclass(frozen=True)
class Ended(ABC):
    """An episode that ended in the last period."""

    world: int
    """Number of the world in the batch."""

    @property
    @abstractmethod
    def statistics(self) -> dict[str, Any]:
        """The figures that borders report at the end."""


@dataclass(frozen=True)
class Finished(Ended):
    """A mission that ended in the last period."""

    scenario: Scenario
    """The scenario of the mission."""
    result: MissionResult
    """The figures of the mission."""
    collision_events: int
    """Number of times that a pair came closer than the first collision distance."""

    @property
    def statistics(self) -> dict[str, Any]:
        """The figures that borders report of a mission."""
        return {
            "duration_s": self.result.duration_s,
            "garbage_done": self.result.garbage_done,
            "mission_collision_events": self.collision_events,
            "completed": self.result.completed,
        }


class AnyBatch(ABC):
    """W worlds of N robots, R = W * N rows.

    Attributes:
        rows, robots, count: R, N and W.
        period, decision_period: lengths of a control period and of a decision period [s].
        action: what an action is.
        options: coordinated goal -> names of its options.
        choices: the options as actions.
        mission: the mission of all worlds, or what its changes have in common; None with a goal.
        observer: names and bounds of the components of an observation.
        observations: (R, F) float32, the last ones, always the same array.
        working: (R,) bool, whether there is a robot that works.
        took_part: (R,) bool, whether the robot was at work in the last period.
        phases: (R,) phases of the robots, which decide what options can serve.

    """

    rows: int
    robots: int
    count: int
    period: float
    decision_period: float
    action: ActionFace
    options: Mapping[str, tuple[str, ...]]
    choices: OptionActions
    mission: MissionConfig | None
    observer: ObserverFace
    observations: Observations
    working: Flags
    took_part: Flags
    phases: Ints

    @property
    @abstractmethod
    def over(self) -> Flags:
        """(W,) whether the episode of a world is over and no other has begun."""

    @property
    @abstractmethod
    def finished(self) -> tuple[Ended, ...]:
        """The episodes that ended in the last period."""

    @abstractmethod
    def reset(
        self, seeds: Sequence[int | None] | None = None, starts: Sequence[StartConfiguration | None] | None = None
    ) -> Observations:
        """Begin an episode in every world and return the observations (R, F)."""

    @abstractmethod
    def reset_worlds(
        self,
        worlds: Ints,
        seeds: Sequence[int | None] | None = None,
        starts: Sequence[StartConfiguration | None] | None = None,
    ) -> Observations:
        """Begin an episode in `worlds` (K,) only, and return the observations (R, F)."""

    def step(self, actions: NDArray[Any]) -> BatchStep:
        """Run one decision period."""
        for _ in self.ticks(actions):
            pass
        return self.end_period()

    @abstractmethod
    def ticks(self, actions: NDArray[Any]) -> Iterator[object]:
        """Run one decision period; yield after each control period. `end_period` must follow."""

    @abstractmethod
    def end_period(self) -> BatchStep:
        """Begin the next episodes, and return what the period gave."""

    def masks(self) -> Flags:
        """Return which options (R, O) of all goals, one goal after the other, can serve in the coming period.

        Raises:
            ValueError: actions are vectors.

        """
        if self.action.mode == "velocity":
            raise ValueError("masks: expected options as actions, got mode 'velocity'")
        return self.choices.masks(self.phases)

    @abstractmethod
    def get_state(self, worlds: Sequence[int] | None = None) -> bytes:
        """Return the states of `worlds` (K,), or of all, as sealed bytes that say their version."""

    def set_state(self, state: bytes, worlds: Sequence[int] | None = None) -> Observations:
        """Make `worlds` (K,), or all, go on from `get_state`; return the observations (R, F).

        The further course has the same bits. ValueError says what is damaged or does not fit, and then nothing has
        changed.
        """
        return self.enter_state(self.open_state(state, worlds))

    @abstractmethod
    def open_state(self, state: bytes, worlds: Sequence[int] | None = None) -> Any:  # noqa: ANN401  (as it needs it)
        """Return a state as `enter_state` takes it; ValueError says what is damaged or does not fit."""

    @abstractmethod
    def enter_state(self, opened: Any) -> Observations:  # noqa: ANN401
        """Go on from what `open_state` has returned; return the observations (R, F)."""

    @abstractmethod
    def steps(self, world: int) -> int:
        """Return how many decision periods of its episode a world has done."""

    @abstractmethod
    def team_figures(self) -> FigureColumns:
        """Return the infos that are the same for all robots of a world, of each world."""

    @abstractmethod
    def own_figures(self) -> FigureColumns:
        """Return the infos of each row."""

    @abstractmethod
    def global_state(self) -> GlobalFace:
        """Return what tells the global state of the worlds."""

    def close(self) -> None:  # noqa: B027  (most have nothing to end)
        """End what a batch keeps open."""
