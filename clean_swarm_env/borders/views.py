"""How environments show their worlds: as pictures, or in a window."""

from __future__ import annotations

from typing import Any, Final

from numpy.typing import NDArray

from clean_swarm_env.drawing.canvas import Pixels
from clean_swarm_env.drawing.canvases import canvas_of
from clean_swarm_env.drawing.window import Window
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.interface import BatchStep

PICTURE: Final = "rgb_array"
WINDOW: Final = "human"


class View:
    """What an environment shows of the worlds of its batch.

    Args:
        batch: the worlds.
        mode: None; PICTURE; or WINDOW, which shows every control period of the first world.

    """

    def __init__(self, batch: Batch, mode: str | None) -> None:
        self._batch, self._mode = batch, mode
        self._window = Window() if mode == WINDOW else None

    @property
    def fps(self) -> float:
        """Pictures that are one second of the mission."""
        return 1.0 / (self._batch.period if self._mode == WINDOW else self._batch.decision_period)

    def reset(self) -> None:
        """Show the beginning of an episode."""
        if self._window is not None:
            self._window.show(self.picture())

    def step(self, actions: NDArray[Any]) -> BatchStep:
        """Run one decision period, and show it."""
        if self._window is None:
            return self._batch.step(actions)
        for _ in self._batch.ticks(actions):
            self._window.show(self.picture())
        return self._batch.end_period()

    def picture(self, world: int = 0) -> Pixels:
        """Return the picture of a world as it is now."""
        from clean_swarm_env.drawing.picture import pixels_of  # imports Matplotlib

        wanted = self._batch.picture
        return pixels_of(canvas_of(self._batch.worlds, world), wanted.side, numbers=wanted.numbers)

    def render(self) -> Pixels | None:
        """Return a picture (height, width, 3) or nothing, as the mode says; show it in the window."""
        if self._mode == PICTURE:
            return self.picture()
        if self._window is not None:
            self._window.show(self.picture())
        return None

    def close(self) -> None:
        """Close the window."""
        if self._window is not None:
            self._window.close()
