"""The coordinator: a sub-network for one goal, whose content is the configuration of the option that serves it now.

To the network that holds it a coordinator shows the preconditions and effects of the configuration held now, so that
arbitration sees what it would see without the nesting. Different robots may hold different options at the same time;
the work grows with the number of options in use, not with robots.
"""

from __future__ import annotations

import numpy as np

from selector.content import Content
from selector.coordinator_model import CoordinatorModel
from selector.host import Host
from selforg.arrays import Floats, Ints
from selforg.compiled import kernel
from selforg.components import Commands
from selforg.network.network import BehaviourNetwork


class Coordinator:
    """R rows that each hold one option of a `CoordinatorModel`, inside the network `parent`.

    In every control period: `sense`, the step of the parent, `act`, and `leave` once all movements are known.

    Attributes:
        held: (R,) the option that each row holds; change it by `hold`.
        contents: (O,) the options at work.

    """

    def __init__(
        self, model: CoordinatorModel, parent: BehaviourNetwork, host: Host, *, explained: bool = False
    ) -> None:
        self.model = model
        self.parent = parent
        self.index = parent.model.behaviour_index[model.goal]
        self.held: Ints = np.zeros(parent.rows, dtype=np.int64)
        self.contents = tuple(
            Content(configuration, host, f"goal {model.goal}: option {name}", explained=explained)
            for name, configuration in zip(model.options, model.configurations, strict=True)
        )
        self._columns = [
            np.array([parent.model.sensor_index[sensor.name] for sensor in content.network.model.sensors], int)
            for content in self.contents
        ]
        self._all_columns = np.array([parent.model.sensor_index[sensor.name] for sensor in model.sensors], dtype=int)
        self._in_use: list[tuple[int, Ints]] = []
        self._acted: list[Content] = []
        self.reset(np.arange(parent.rows))

    def reset(self, rows: Ints) -> None:
        """Begin anew in `rows` (K,), holding the options they hold."""
        for content in self.contents:
            content.begin(rows)
        self.parent.hold(rows, self.index, self.held[rows])
        self._group()

    def hold(self, rows: Ints, options: Ints) -> None:
        """Let `rows` (K,) hold `options` (K,); the rest of each robot goes on undisturbed.

        An option that is taken up begins anew: nothing runs, nothing is known, decided or activated yet.
        """
        changed = self.held[rows] != options
        if not changed.any():
            return
        rows, options = rows[changed], options[changed]
        if options.min() < 0 or options.max() >= len(self.contents):
            raise ValueError(f"goal {self.model.goal}: expected options 0..{len(self.contents) - 1}, got {options}")
        self.held[rows] = options
        self.parent.hold(rows, self.index, options)
        self.parent.readings[np.ix_(rows, self._all_columns)] = 0.0
        for k, content in enumerate(self.contents):
            taken_up = rows[options == k]
            if len(taken_up):
                content.begin(taken_up)
        self._group()

    def _group(self) -> None:
        groups = [(k, np.flatnonzero(self.held == k)) for k in range(len(self.contents))]
        self._in_use = [(k, rows) for k, rows in groups if len(rows)]

    def sense(self, now: float) -> None:
        """Ask what is in use at `now` [s] and write its sensors into the parent's readings."""
        for k, rows in self._in_use:
            robots, columns = self.contents[k].robots, self._columns[k]
            if len(columns):
                robots.sense(now, rows)
                copy_columns(rows, robots.network.readings, self.parent.readings, columns)

    def act(self, now: float, commands: Commands) -> None:
        """Run the content where the parent runs the coordinator; its movement goes into `commands`."""
        for k, rows in self._in_use:
            acting, started = self.parent.running(self.index, rows)
            if not len(acting):
                continue
            content = self.contents[k]
            network = content.network
            if len(started):
                network.halt(started)
            network.step(acting, guarantee=True)
            content.robots.act(now, acting, commands)
            self._acted.append(content)

    def leave(self, now: float) -> None:
        """Leave in the world, at `now` [s], what others shall find from the next control period on."""
        for content in self._acted:
            content.robots.leave(now)
        self._acted.clear()


@kernel
def copy_columns(rows: Ints, inner: Floats, outer: Floats, columns: Ints) -> None:
    """Copy the readings of `rows` (K,) from `inner` (R, C) into `columns` (C,) of `outer` (R, S)."""
    for row in rows:
        for k in range(columns.shape[0]):
            outer[row, columns[k]] = inner[row, k]
