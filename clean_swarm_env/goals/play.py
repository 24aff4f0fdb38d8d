"""One episode of a goal in all worlds: a scene, its robots, and the learner's actions on them."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.actions import Mode, OptionActions, checked_vectors, parted, turn_to_world
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.recording.scene_recording import SceneRecorder
from clean_swarm_env.scenes.scene import Scene
from clean_swarm_env.scenes.served import Expertise, ServedTeam
from selforg.arrays import Floats
from selforg.commands import Commands

LEARNER: Final = "learner"
"""Who serves the goal, in the names of recordings, unless their settings have a name."""


class Play:
    """A scene whose robots are commanded by the mechanism of an option, by a learner's vectors, or by both.

    In mode "velocity" a vector takes the place of the mechanism's. In mode "both" it is added; a zero vector changes
    nothing. All else that mechanisms do goes on: they take and bring food, leave pheromones, tell and decide. Vectors
    are ahead and left in the robot's frame, in shares of the largest speed, and keep their direction in the world for
    a decision period.

    Attributes:
        scene, team: the scene, and its robots with the mechanisms.
        asked: (R, 2) [m/s] what the mechanisms, with the errand of the scene, asked for last; 0 for nothing.
        facts: names of the facts that robots know.

    """

    def __init__(self, scene: Scene, expert: Expertise, mode: Mode, *, explained: bool = False) -> None:
        self.scene, self._mode = scene, mode
        self.team = ServedTeam(scene, expert, explained=explained)
        scene.start(lambda _: self.team)
        self.asked: Floats = np.zeros((scene.arena.rows, 2))
        self._vectors: Floats = np.zeros((scene.arena.rows, 2))
        self._recorder: SceneRecorder | None = None
        self.facts = tuple(name for name, kind in self.team.memory.kinds.items() if kind == "fact")

    def record(self, settings: RecordSettings, seeds: Sequence[int]) -> None:
        """Record the episode from here on, if it is not recorded yet; `seeds` are those of the worlds."""
        if self._recorder is None:
            name = settings.name or LEARNER
            self._recorder = SceneRecorder(self.scene, name, settings.directory, seeds, settings.about)

    def close(self) -> None:
        """End the recording, if there is one."""
        if self._recorder is not None:
            self._recorder.close()
            self._recorder = None

    def unrecorded(self) -> Play:
        """Return the episode without its recording, for a state."""
        play = copy(self)
        play._recorder = None
        return play

    def act(self, actions: NDArray[Any], choices: OptionActions) -> None:
        """Take the actions of a period: options (R,), vectors (R, 2), or both (R, 3), the option first."""
        given, rows, arena = np.asarray(actions), len(self.asked), self.scene.arena
        vectors = given
        if self._mode == "both":
            given, vectors = parted(given, rows, 1)
        if self._mode != "velocity":
            self.team.hold(choices.check(given, rows)[:, 0])
        if self._mode != "option":
            turn_to_world(checked_vectors(vectors, rows), arena.headings, arena.body.max_speed, self._vectors)

    def tick(self) -> None:
        """Run one control period."""
        self.scene.advance(self._change)
        if self._recorder is not None:
            self._recorder.record()

    def _change(self, commands: Commands) -> None:
        """Note what the mechanisms ask for, and write what the learner makes of it."""
        self.asked[:] = np.where(commands.commanded[:, None], commands.vectors, 0.0)
        if self._mode == "velocity":
            commands.vectors[:] = self._vectors
            commands.commanded[:], commands.in_place[:] = True, False
        elif self._mode == "both":
            commands.add(self._vectors)
