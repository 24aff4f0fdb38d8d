"""The window, on the dummy display of SDL: it shows what it is given, can be closed, and says what it lacks."""

import sys

import numpy as np
import pytest

from clean_swarm_env.drawing.window import Window

pygame = pytest.importorskip("pygame")
pytestmark = pytest.mark.extra
PICTURE = np.arange(40 * 60 * 3, dtype=np.uint8).reshape(40, 60, 3)


@pytest.fixture(autouse=True)
def _dummy(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    yield
    pygame.display.quit()


def test_a_window_shows_the_pixels_that_it_is_given():
    window = Window()
    window.show(PICTURE)
    shown = pygame.surfarray.array3d(pygame.display.get_surface()).transpose(1, 0, 2)
    assert np.array_equal(shown, PICTURE)
    window.show(PICTURE[:20])
    assert pygame.display.get_surface().get_size() == (60, 20)
    window.close()
    assert not pygame.display.get_init()


def test_a_window_that_its_user_closed_stays_closed():
    window = Window()
    window.show(PICTURE)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    window.show(PICTURE)
    window.show(PICTURE)
    assert window.closed
    assert not pygame.display.get_init()


def test_no_display_and_no_pygame_are_errors_of_one_line(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "nothing-of-the-kind")
    with pytest.raises(RuntimeError, match=r"a window needs a display \(.*\); SDL_VIDEODRIVER=dummy runs without one"):
        Window().show(PICTURE)
    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install '\.\[view\]'"):
        Window()
