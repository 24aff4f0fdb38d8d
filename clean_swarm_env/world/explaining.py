"""What a robot decided in its last step, and why, as data: what `clean-swarm explain` prints.

It is read after a tick, from arrays that the tick left behind; nothing is changed.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Annotated, Any

import numpy as np

from clean_swarm_env.config.events import join_time
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.world.worlds import Worlds
from selector.coordination.coordinator import Coordinator
from selector.coordination.inner_network import InnerNetwork
from selforg.arrays import SCRATCH, Floats, Ints
from selforg.declared import make_arrays
from selforg.mechanisms.base import Mechanism
from selforg.mechanisms.causes import MOST_CAUSES, Causes
from selforg.mechanisms.formula import NeighbourMechanism
from selforg.network.explanation import Explanation, explain
from selforg.network.network import BehaviourNetwork


@dataclass(frozen=True)
class Coordinated:
    """One coordinator of a robot in one step: its option, and the step of the network inside if it ran."""

    goal: str
    option: str
    inner: Explanation | None

    @property
    def title(self) -> str:
        """Goal and option."""
        return f"{self.goal}: {self.option}"


@dataclass(frozen=True)
class Nested:
    """One network inside a behaviour of a robot in one step; the title names the behaviours around it."""

    title: str
    inner: Explanation | None


@dataclass(frozen=True)
class RobotStep:
    """One step of one robot."""

    robot: int
    step: int
    """Number of the control period, from 0 on."""
    time_s: float
    """Its beginning [s]."""
    state: str
    """`at work`, `failed` or `taken away`; a robot that is not at work decides nothing."""
    stopped_s: float
    """How long a collision still stops the robot, this step included [s]."""
    options: dict[str, str]
    """Goal -> option that serves it."""
    network: Explanation
    """The robot's own network."""
    coordinators: tuple[Coordinated, ...]
    networks: tuple[Nested, ...]
    """Networks inside behaviours."""
    heard: tuple[dict[str, Any], ...]
    """The facts that it has noticed or heard: `fact`, `value`, the `robot` that told it, `age_s`, and a `sentence`."""

    def as_mapping(self) -> dict[str, Any]:
        """Return the step as plain data, with the entries of the robot's network beside the others."""
        own: dict[str, Any] = asdict(self)
        network: dict[str, Any] = own.pop("network")
        inside = {name: own.pop(name) for name in ("coordinators", "networks")}
        return own | network | inside


def explain_robot(worlds: Worlds, row: int) -> RobotStep:
    """Return what the robot of a row decided in the last control period.

    Raises:
        ValueError: the worlds note no reasons, or have not begun, or there is no such robot, or it has not joined yet.

    """
    if not worlds.network.explained:
        raise ValueError("explain: expected worlds with explained=True, got worlds that note no reasons")
    if not 0 <= row < worlds.rows:
        raise ValueError(f"robot: expected a row from 0 to {worlds.rows - 1}, got {row}")
    world = row // worlds.robots
    step = int(worlds.ticks[world]) - 1
    if step < 0:
        raise ValueError("explain: expected a world that has run a control period, got one at its beginning")
    facts = worlds.minds.facts.values()
    for fact in facts:
        fact.note(worlds.now - worlds.period)
    robot, time = row % worlds.robots, round(step * worlds.period, 9)
    if robot >= worlds.team.joined[world]:
        mission = worlds.missions[world]
        joins = join_time(mission.events, mission.robots.count, robot)
        when = "never joins" if joins is None else f"joins at {joins:g} s, or later if its place is not free"
        raise ConfigurationError(f"robot {robot}: expected a robot that is in the team at {time:g} s; it {when}")
    return RobotStep(
        robot,
        step,
        time,
        "at work" if worlds.team.working[row] else "failed" if worlds.physics.present[row] else "taken away",
        round(int(worlds.task.standing[row]) * worlds.period, 9),
        {c.model.goal: c.model.options[c.held[row]] for c in worlds.coordinators},
        explain(worlds.network, row),
        tuple(_coordinated(coordinator, row) for coordinator in worlds.coordinators),
        tuple(Nested(one.name, _inner_step(one, one.network, row)) for one in worlds.minds.nested),
        tuple(report for fact in facts if (report := fact.report(row))),
    )


def _coordinated(coordinator: Coordinator, row: int) -> Coordinated:
    option = int(coordinator.held[row])
    network = coordinator.contents[option].network
    inner = explain(network, row) if coordinator.steers[option] else _inner_step(coordinator, network, row)
    return Coordinated(coordinator.model.goal, coordinator.model.options[option], inner)


def _inner_step(holder: Coordinator | InnerNetwork, network: BehaviourNetwork, row: int) -> Explanation | None:
    """Return the step of a network inside a behaviour; None if the behaviour does not run."""
    return explain(network, row) if holder.parent.executing[row, holder.index] == 1 else None


class Movements:
    """What robots were told to drive, what they wanted, and because of whom these differ.

    Attributes:
        commands: (R, 2) [m/s] what each robot was told to drive, zero for nothing.
        wishes: (R, 2) [m/s] the same without what keeps it away from others; zero where that is all it does.
        who: (R, MOST_CAUSES) numbers of the robots in its world that count most, -1 for none.
        shares: (R, MOST_CAUSES) how much each counts, of all together.

    """

    commands: Annotated[Floats, "R 2", SCRATCH]
    wishes: Annotated[Floats, "R 2", SCRATCH]
    who: Annotated[Ints, "R MOST", SCRATCH]
    shares: Annotated[Floats, "R MOST", SCRATCH]

    def __init__(self, worlds: Worlds) -> None:
        self._worlds, self._causes = worlds, Causes(worlds.rows)
        make_arrays(self, R=worlds.rows, MOST=MOST_CAUSES)

    def note(self) -> None:
        """Read what the last tick left behind."""
        worlds, causes = self._worlds, self._causes
        commands, now = worlds.minds.commands, worlds.now - worlds.period
        self.commands[:] = np.where(commands.commanded[:, None], commands.vectors, 0.0)
        self.wishes[:] = np.where(commands.commanded[:, None], commands.wishes, 0.0)
        causes.clear()
        for coordinator in worlds.coordinators:
            for option in coordinator.used:
                for mechanism in coordinator.contents[option].mechanisms.values():
                    rows = self._changed(coordinator, option, mechanism)
                    mechanism.weigh(now, rows, commands.wishes, causes)
        self.who[:] = np.where(causes.who < 0, -1, causes.who % worlds.robots)
        self.shares[:] = causes.shares()

    def _changed(self, coordinator: Coordinator, option: int, mechanism: Mechanism) -> Ints:
        """Return the rows whose movement the mechanism of an option changed; what it moves itself has no wish."""
        held = (coordinator.held == option) & self._worlds.team.working
        if isinstance(mechanism, NeighbourMechanism):
            rows = np.flatnonzero(held & (coordinator.parent.executing[:, coordinator.index] == 1))
            self.wishes[rows] = 0.0
            return rows
        return np.flatnonzero(held & (self.wishes != self.commands).any(axis=1))
