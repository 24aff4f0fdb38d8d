"""The coordinator: a behaviour that runs, for one goal, the configuration of the option that a robot holds.

The network around a coordinator sees the preconditions and effects of that configuration, so that arbitration decides
as it would without the nesting. Robots may hold different options at the same time. The number of calls grows with the
number of options in use, not with the number of robots.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from selector.configurations.configuration import PoseSpec
from selector.configurations.host import Host
from selector.configurations.running import RunningConfiguration
from selector.coordination.model import CoordinatorModel
from selforg.arrays import KEPT, READ, SCRATCH, Floats, Ints, Within, derived
from selforg.commands import Commands
from selforg.compiler.decorators import lean_kernel
from selforg.components.robot import Turning
from selforg.declared import make_arrays
from selforg.network import state as st
from selforg.network.network import BehaviourNetwork
from selforg.program import SENSE, Rows, Step

_NO_COLUMNS = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)


class Coordinator:
    """A coordinator in R rows of the network `parent`; each row holds one option of its `CoordinatorModel`.

    Options that only steer do so all the time, or while one of the behaviours `during` of the parent runs, if given.

    Attributes:
        held: (R,) the option that each row holds; `hold` changes it.
        contents: (O,) the running configurations of the options.
        always: (R,) the option that a row holds whatever is given to it, -1 for none; `bind` changes it.
        steers: (O,) 1 for those that only steer, which run beside the robot's behaviours and never take a turn.

    """

    held: Annotated[Ints, "R", KEPT, Within(0, "O")]
    always: Annotated[Ints, "R", READ]
    steers: Annotated[Ints, "O", READ]
    _radii: Annotated[list[Floats], "O", READ]  # (R, 2) radii of the poses [m], of each option
    _turn_of: Annotated[list[Ints], "O", READ]  # the behaviours of the parent with which each acts, none: always
    _all_columns: Annotated[Ints, "S", READ]  # of the sensors in the parent's readings
    _members: Annotated[Ints, "O R", SCRATCH]  # rows that hold each option, the first `_counts`
    _counts: Annotated[Ints, "O", SCRATCH]
    _ungrouped: Annotated[Ints, "1", derived(1)]  # 1 unless both are those of `held`
    _all: Annotated[Ints, "R", READ]
    _new: Annotated[Ints, "O R", SCRATCH]  # rows that begin to hold each option, the first `_new_counts`
    _new_counts: Annotated[Ints, "O", SCRATCH]
    _stale: Annotated[Ints, "R", KEPT]  # 1: the network inside has to be reset
    _turns: Annotated[Ints, "2 R", SCRATCH]  # rows that act, and those to reset

    model: Annotated[CoordinatorModel, READ]

    def __init__(
        self,
        model: CoordinatorModel,
        parent: BehaviourNetwork,
        host: Host,
        *,
        during: Sequence[str] = (),
        explained: bool = False,
    ) -> None:
        self.model = model
        self.parent = parent
        self.index = parent.model.behaviour_index[model.goal]
        make_arrays(self, O=len(model.options), R=parent.rows)
        self.contents = tuple(
            RunningConfiguration(configuration, host, f"goal {model.goal}: option {name}", explained=explained)
            for name, configuration in zip(model.options, model.configurations, strict=True)
        )
        for content in self.contents:
            sensors = content.network.model.sensors
            content.show_in(
                parent.readings,
                np.array([parent.model.sensor_index[sensor.name] for sensor in sensors], dtype=np.int64),
            )
        self.steers = np.array([spec.steers for spec in model.configurations], dtype=np.int64)
        self._some_steer = bool(self.steers.any())
        inside = [parent.model.behaviour_index[name] for name in during]
        self._turn_of = [
            np.array(inside if spec.steers else [self.index], dtype=np.int64) for spec in model.configurations
        ]
        self._poses = host.poses
        self._some_always = False
        self.always = np.full(parent.rows, -1, dtype=np.int64)
        usual = host.poses.radii.copy()
        self._radii = [own_radii(spec.pose, usual) for spec in model.configurations] if model.sets_pose else []
        self._all_columns = np.array([parent.model.sensor_index[sensor.name] for sensor in model.sensors], dtype=int)
        self._all = np.arange(parent.rows)
        self.reset(self._all)

    def reset(self, rows: Ints) -> None:
        """Clear the networks and memory inside `rows` (K,); each row keeps the option that it holds."""
        for content in self.contents:
            content.reset(rows)
        self._stale[rows] = 0
        self.parent.hold(rows, self.index, self.held[rows])
        self._let_compete(rows)
        self._group()

    def bind(self, rows: Ints, option: int) -> None:
        """Let `rows` (K,) hold an option from now on, whatever is given to them."""
        self.always[rows] = option
        self._some_always = True
        self.hold(rows, self.always[rows])

    def hold(self, rows: Ints, options: Ints) -> None:
        """Give `options` (K,) to `rows` (K,), but to those that `always` hold one; nothing else of them changes.

        A new option starts from its first state: no behaviour runs, and memory, decisions and activations are those of
        the start. Gradients that the old option spread or deposited stay in the world and evaporate.
        """
        if self._some_always:
            options = np.where(self.always[rows] >= 0, self.always[rows], options)
        changed = apply_options(
            rows, options, self.held, self._stale, self._new, self._new_counts, self._members, self._counts
        )
        if changed < 0:
            raise ValueError(f"goal {self.model.goal}: expected options 0..{len(self.contents) - 1}, got {options}")
        if not changed:
            return
        self.parent.hold(rows, self.index, options, self._all_columns)
        self._let_compete(rows)
        for k, count in enumerate(self._new_counts.tolist()):
            if count and self.contents[k].remembers:
                self.contents[k].forget(self._new[k, :count])
        self._note_groups()

    def _let_compete(self, rows: Ints) -> None:
        """Let the coordinator compete with the other behaviours of `rows` (K,) unless what they hold only steers."""
        if self._some_steer:
            competes = self.steers[self.held[rows]] == 0
            changed = self.parent.state.marks[rows, st.ENABLED, self.index] != competes
            for wanted in (False, True):  # only rows that change: to switch a behaviour makes a robot plan anew
                self.parent.enable(rows[changed & (competes == wanted)], self.index, wanted)

    def _group(self) -> None:
        """List the rows that hold each option."""
        group(self.held, self._members, self._counts)
        self._note_groups()

    def _note_groups(self) -> None:
        """Let robots spread the poses of the options that they hold, once these are listed."""
        self._ungrouped[0] = 0
        for option in self.used if self._radii else ():
            rows = self._members[option, : self._counts[option]]
            self._poses.radii[rows] = self._radii[option][rows]

    @property
    def used(self) -> tuple[int, ...]:
        """The options that any row holds."""
        return tuple(np.flatnonzero(self._counts).tolist())

    def serving(self, commands: Commands) -> list[Step]:
        """Return the steps of all options: sensors go into the parent's readings, movements into `commands`.

        They act where the parent runs the coordinator. Those that only steer do so everywhere, or while the behaviours
        run during which they steer.
        """
        steps = [Step(SENSE, lambda now, _: self._group(), Rows(self._all, self._ungrouped))]
        acting, renewed = self._turns
        for option, content in enumerate(self.contents):
            members = Rows(self._members[option], self._counts[option : option + 1])
            turning = Turning(
                self._turn_of[option], 0, *_NO_COLUMNS, self._stale, renewed, acting, np.zeros(1, dtype=np.int64)
            )
            steps += content.inside(self.parent, turning, members, commands)
        return steps


def hold_options(coordinators: Sequence[Coordinator], options: Ints, rows: Ints) -> None:
    """Give `options` (K, C), or (K,) for one coordinator, to `coordinators` (C,) in `rows` (K,)."""
    table = np.asarray(options)
    table = table[:, None] if table.ndim == 1 else table
    if table.shape != (len(rows), len(coordinators)):
        goals = ", ".join(coordinator.model.goal for coordinator in coordinators)
        raise ValueError(
            f"hold: expected for each of {len(rows)} rows one option for each of {goals}, got shape {options.shape}"
        )
    for coordinator, wanted in zip(coordinators, table.T, strict=True):
        coordinator.hold(rows, wanted)


def own_radii(pose: PoseSpec, usual: Floats) -> Floats:
    """Return diffusion and goal radius (R, 2) [m] of poses that robots spread; those that are `usual` unless given."""
    given = [np.nan if radius is None else radius for radius in (pose.diffusion, pose.goal_radius)]
    return np.where(np.isnan(given), usual, given)


@lean_kernel
def group(held: Ints, members: Ints, counts: Ints) -> None:
    """Fill `members` (O, R) and `counts` (O,) with the rows that hold each option; held (R,)."""
    counts[:] = 0
    for row in range(held.shape[0]):
        option = held[row]
        members[option, counts[option]] = row
        counts[option] += 1


@lean_kernel
def apply_options(
    rows: Ints, options: Ints, held: Ints, stale: Ints, new: Ints, new_counts: Ints, members: Ints, counts: Ints
) -> int:
    """Give `options` (K,) to `rows` (K,); list in `new` (O, R) and `new_counts` (O,) the rows of each new option.

    held, stale: (R,); `group` updates members (O, R) and counts (O,). Returns how many rows change, or -1, with
    nothing changed, for an option that does not exist.
    """
    new_counts[:] = 0
    for k in range(rows.shape[0]):
        if not 0 <= options[k] < counts.shape[0]:
            return -1
    changed = 0
    for k in range(rows.shape[0]):
        row, option = rows[k], options[k]
        if held[row] != option:
            held[row], stale[row] = option, 1
            new[option, new_counts[option]] = row
            new_counts[option] += 1
            changed += 1
    if changed:
        group(held, members, counts)
    return changed
