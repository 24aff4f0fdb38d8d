"""A window that shows pictures, by pygame-ce, which comes with the extra `view`."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from clean_swarm_env.drawing.canvas import FRAMES_PER_SECOND, Pixels


class Window:
    """A window; it opens with the first picture. After its user has closed it, further pictures are not shown.

    Raises:
        ModuleNotFoundError: pygame-ce is not installed.

    """

    def __init__(self) -> None:
        os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
        try:
            import pygame
        except ImportError as error:
            expected = "a window needs pygame-ce, which is not installed: pip install '.[view]'"
            raise ModuleNotFoundError(expected) from error
        self._pygame, self._clock = pygame, pygame.time.Clock()
        self._screen: Any = None
        self.closed = False

    def __reduce__(self) -> tuple[type[Window], tuple[()]]:
        """Copy as a window that has not been opened yet."""
        return Window, ()

    def show(self, pixels: Pixels) -> None:
        """Show a picture (height, width, 3), and wait so that it is seen for a twentieth of a second.

        Raises:
            RuntimeError: there is no display.

        """
        if self.closed:
            return
        pygame, (height, width, _) = self._pygame, pixels.shape
        if self._screen is None or self._screen.get_size() != (width, height):
            self._open(width, height)
        if any(event.type == pygame.QUIT for event in pygame.event.get()):
            self.close()
            return
        self._screen.blit(pygame.image.frombuffer(np.ascontiguousarray(pixels), (width, height), "RGB"), (0, 0))
        pygame.display.flip()
        self._clock.tick(FRAMES_PER_SECOND)

    def close(self) -> None:
        """Close the window."""
        if self._screen is not None:
            self._pygame.display.quit()
        self._screen, self.closed = None, True

    def _open(self, width: int, height: int) -> None:
        pygame = self._pygame
        try:
            pygame.display.init()
            self._screen = pygame.display.set_mode((width, height))
        except pygame.error as error:
            expected = f"a window needs a display ({error}); SDL_VIDEODRIVER=dummy runs without one"
            raise RuntimeError(expected) from error
        pygame.display.set_caption("Clean Swarm")
