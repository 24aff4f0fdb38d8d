"""How environments show their worlds: as pictures, as all pictures of a step for a video, or in a window."""

from __future__ import annotations

from typing import Any, Final

from numpy.typing import NDArray

from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND, Canvas, Pixels, between
from clean_swarm_env.drawing.canvases import canvas_of
from clean_swarm_env.drawing.window import Window
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.interface import BatchStep

PICTURE: Final = "rgb_array"
PICTURES: Final = "rgb_array_list"
WINDOW: Final = "human"


class View:
    """What an environment shows of the worlds of its batch.

    Args:
        batch: the worlds.
        mode: None; PICTURE, one at a time; PICTURES of the first world, those since the last call; or WINDOW, which
            shows every control period of the first world.

    """

    def __init__(self, batch: Batch, mode: str | None) -> None:
        self._batch, self._mode = batch, mode
        self._window = Window() if mode == WINDOW else None
        self._pictures: list[Pixels] = []
        self._last: Canvas | None = None
        self._between = max(round(FRAMES_PER_SECOND * batch.period), 1)  # pictures of a control period

    @property
    def fps(self) -> float:
        """Pictures that are one second of the mission."""
        if self._mode == PICTURE:
            return 1.0 / self._batch.decision_period
        return self._between / self._batch.period

    def reset(self) -> None:
        """Show the beginning of an episode."""
        self._last, self._pictures = None, []
        self._look()

    def step(self, actions: NDArray[Any]) -> BatchStep:
        """Run one decision period, and show it."""
        if self._mode not in (PICTURES, WINDOW):
            return self._batch.step(actions)
        for _ in self._batch.ticks(actions):
            self._look()
        return self._batch.end_period()

    def picture(self, world: int = 0) -> Pixels:
        """Return the picture of a world as it is now."""
        return self._drawn(canvas_of(self._batch.worlds, world))

    def render(self) -> Pixels | list[Pixels] | None:
        """Return the output of the mode: a picture (height, width, 3), pictures, or nothing."""
        if self._mode == PICTURE:
            return self.picture()
        if self._window is not None:
            self._window.show(self.picture())
        taken, self._pictures = self._pictures, []
        return taken if self._mode == PICTURES else None

    def close(self) -> None:
        """Close the window."""
        if self._window is not None:
            self._window.close()

    def _drawn(self, canvas: Canvas) -> Pixels:
        from clean_swarm_env.drawing.picture import pixels_of  # imports Matplotlib

        wanted = self._batch.picture
        return pixels_of(canvas, wanted.side, numbers=wanted.numbers)

    def _look(self) -> None:
        """Show the world as it is now, or keep the pictures since the last look."""
        if self._window is not None:
            self._window.show(self.picture())
        if self._mode != PICTURES:
            return
        now = canvas_of(self._batch.worlds, 0)
        shares = [k / self._between for k in range(1, self._between)] if self._last is not None else []
        before = self._last or now
        self._pictures += [self._drawn(between(before, now, share)) for share in shares] + [self._drawn(now)]
        self._last = now
