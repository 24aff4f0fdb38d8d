"""Recording of a whole run: every step of every robot's behaviour network and of the networks inside it.

The file has the arrays of `recording.stacked` for the robots' network; `held` (T, R, C), the option of each
coordinator; and, for every option that was ever held, the same arrays for the network inside, under names that begin
with `GOAL/OPTION/`. For the networks inside other behaviours, which `network_names` lists, the names of the arrays
begin with that of the network. A network inside decides and changes only in steps in which its holder runs.
"""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.world.worlds import Worlds
from selector.coordination.inner_network import at_any_depth
from selector.documents.arrays import Arrays
from selector.documents.writing import write_whole
from selforg.arrays import Ints
from selforg.network.explain.recording import Recorder, stacked
from selforg.network.model.model import NetworkModel
from train.evaluation.repeat import steps_of
from train.running.runs import RunTask


class Tape:
    """The recorded steps of a run."""

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds
        self._outer = Recorder(worlds.network)
        self._inner = [[Recorder(content.network) for content in c.contents] for c in worlds.coordinators]
        self._nested = {one.name: Recorder(one.network) for one in at_any_depth(worlds.minds.nested)}
        self._held: list[Ints] = []

    def take(self) -> None:
        """Record the last step of the worlds."""
        self._outer.take()
        for recorders in (*self._inner, self._nested.values()):
            for recorder in recorders:
                recorder.take()
        self._held.append(np.stack([coordinator.held for coordinator in self._worlds.coordinators], axis=1))

    def arrays(self) -> Arrays:
        """Return all steps as arrays by name."""
        held = np.stack(self._held)
        found: Arrays = stacked(self._outer.steps) | _names(self._worlds.network.model) | {"held": held}
        found["coordinator_names"] = np.array([c.model.goal for c in self._worlds.coordinators])
        for c, coordinator in enumerate(self._worlds.coordinators):
            model = coordinator.model
            found[f"{model.goal}/option_names"] = np.array(model.options)
            for k in np.unique(held[:, :, c]).tolist():
                arrays = stacked(self._inner[c][k].steps) | _names(coordinator.contents[k].network.model)
                found |= {f"{model.goal}/{model.options[k]}/{name}": array for name, array in arrays.items()}
        found["network_names"] = np.array(list(self._nested), dtype=np.str_)
        for one in at_any_depth(self._worlds.minds.nested):
            arrays = stacked(self._nested[one.name].steps) | _names(one.network.model)
            found |= {f"{one.name}/{name}": array for name, array in arrays.items()}
        return found

    def __len__(self) -> int:
        """Return the number of recorded steps, T."""
        return len(self._held)


def record_run(task: RunTask, output: Path) -> int:
    """Repeat a whole run and write every step of every robot to an NPZ file; return the number of steps, T."""
    if output.exists():
        raise ConfigurationError(f"{output}: exists already; expected a new file")
    if not output.parent.is_dir():
        raise ConfigurationError(f"{output}: cannot be written (no such directory)")
    tape = None
    for worlds in steps_of(task):
        tape = tape or Tape(worlds)
        tape.take()
    if tape is None:
        raise ConfigurationError("the mission has nothing to do and is over at once")
    run = {"experiment": task.experiment, "scenario": task.scenario, "condition": task.condition, "seed": task.seed}
    file = io.BytesIO()
    arrays: Any = tape.arrays()
    np.savez_compressed(file, run=np.array(json.dumps(run | {"period_s": worlds.period})), **arrays)
    write_whole(output, file.getvalue())
    return len(tape)


def _names(model: NetworkModel) -> Arrays:
    """Return the names along the axes of a network's arrays."""
    return {
        "behaviour_names": np.array([behaviour.name for behaviour in model.behaviours]),
        "sensor_names": np.array([sensor.name for sensor in model.sensors]),
        "goal_names": np.array([goal.name for goal in model.goals]),
    }
