"""What environments of one world have in common: its pictures, in a file or in a window, its state and its end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from clean_swarm_env.drawing.canvas import Pixels
from clean_swarm_env.drawing.canvases import canvas_of
from clean_swarm_env.drawing.window import Window
from clean_swarm_env.learning.batch import Batch

PICTURE: Final = "rgb_array"
WINDOW: Final = "human"


def world_picture(batch: Batch, world: int = 0) -> Pixels:
    """Return the picture of a world as it is now."""
    from clean_swarm_env.drawing.picture import pixels_of  # imports Matplotlib

    return pixels_of(canvas_of(batch.worlds, world), batch.picture.side, numbers=batch.picture.numbers)


def checked_mode(mode: str | None, known: Sequence[str]) -> str | None:
    """Return a render mode, or raise ValueError for another than None and those `known`."""
    if mode is not None and mode not in known:
        raise ValueError(f"render_mode: expected None or {' or '.join(map(repr, known))}, got {mode!r}")
    return mode


class OneWorld:
    """An environment of one world, which a window shows in each control period if that is its render mode.

    Attributes:
        batch: the world.

    """

    metadata: dict[str, Any] = {"render_modes": [WINDOW, PICTURE], "render_fps": 1}  # noqa: RUF012

    def _show(self, batch: Batch, render_mode: str | None) -> None:
        """Take the world, and open a window if it is wanted."""
        self.batch, self.render_mode = batch, checked_mode(render_mode, self.metadata["render_modes"])
        self._window = Window() if render_mode == WINDOW else None
        batch.watch = self.render if self._window else None
        shown_each = batch.period if self._window else batch.decision_period
        self.metadata = {**self.metadata, "render_fps": 1.0 / shown_each}  # a second of the mission in a second

    def get_state(self) -> bytes:
        """Return the state of the mission, from which this or another environment goes on; see `Batch.get_state`."""
        return self.batch.get_state()

    def render(self) -> Pixels | None:
        """Return the world as a picture (height, width, 3), or show it in a window; None without a render mode."""
        if self._window is None:
            return world_picture(self.batch) if self.render_mode else None
        self._window.show(world_picture(self.batch))
        return None

    def close(self) -> None:
        """Close the window, and end the recording of a mission that is still going on."""
        if self._window is not None:
            self._window.close()
        self.batch.close()
