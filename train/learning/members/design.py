"""Automatic design of finite state machines by iterated races, as AutoMoDe does it for swarms.

Francesca et al. 2014, doi:10.1007/s11721-014-0092-4; the races are those of studies. In each race new machines and the
best ones so far meet scenarios on which none of them was chosen.

Shapes: C candidates, N scenarios of a block.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from selector.documents.fields import Closed
from selector.documents.reading import as_yaml
from selector.strategies.machine_file import MachineState, StateMachine
from selforg.arrays import Floats, Ints
from selforg.elementary import logarithms
from train.learning.config import DesignConfig
from train.learning.members.machine_space import MachineSpace
from train.learning.members.missions import MachineMember
from train.learning.members.training import Drawing, MembersTraining
from train.learning.racing import race

MACHINE_FILE = "machine.yaml"


class DesignState(Closed):
    """What a design knows after a race."""

    kept: Annotated[tuple[StateMachine, ...], Field(min_length=1)]
    """The best machines, best first."""


class DesignTraining(MembersTraining):
    """One design of a machine."""

    State = DesignState
    settings: DesignConfig
    state: DesignState
    _best: DesignState

    def export(self, command: str) -> Path:
        """Write the best machine so far and return its file."""
        about = {"description": self.config.description, "training": self.about(command)}
        machine = self._best.kept[0].model_copy(update=about)
        self.job.folder.write(MACHINE_FILE, as_yaml(machine.model_dump(mode="json", exclude_defaults=True)))
        return self.job.folder.path / MACHINE_FILE

    def _first(self, order: Ints) -> DesignState:
        alone = [MachineState(option=self.problem.options[option]) for option in order[: self.settings.kept]]
        return DesignState(
            kept=tuple(StateMachine(goal=self.problem.goal, start="state 1", states={"state 1": one}) for one in alone)
        )

    def _next(self, draw: Drawing, random: np.random.Generator) -> DesignState:
        settings, kept = self.settings, self.state.kept
        space = MachineSpace(self.problem, self.scale, settings, random)
        machines = [*kept]
        for _ in range(settings.candidates):
            parent = kept[random.integers(len(kept))]
            new = space.drawn() if random.random() < settings.fresh else space.changed(parent)
            if new not in machines:
                machines.append(new)
        done: list[list[Floats]] = [[] for _ in machines]

        def measure(alive: Sequence[int], _: int) -> Floats:
            """Let candidates do one block more; return the logarithms (C, 1, n) of all their costs."""
            costs = self.costs([MachineMember(machines[k]) for k in alive], draw(settings.race.block))
            for k, own in zip(alive, logarithms(costs).T, strict=True):
                done[k].append(own)
            return np.array([[np.concatenate(done[k])] for k in alive])

        left = race(range(len(machines)), measure, settings.race)
        left.sort(key=lambda k: float(np.mean(done[k])))
        return DesignState(kept=tuple(machines[k] for k in left[: settings.kept]))

    def _check(self, state: Closed, where: str) -> None:
        assert isinstance(state, DesignState)
        for machine in state.kept:
            machine.check_fits(self.problem, where)

    def _member(self) -> MachineMember:
        return MachineMember(self.state.kept[0])
