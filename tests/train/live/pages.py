"""What a person does on the live page, for the tests: read what it shows, drag a thing, find a place that is free."""

import numpy as np

FRAMES = "() => replay.page.run.frames"


def until(page, condition: str, *words: object) -> None:
    """Wait until a condition of the page holds, a minute at most: the machine may be busy."""
    page.wait_for_function(condition, arg=list(words) or None)


def shows(page, selector: str, words: str, how: str = "startsWith") -> None:
    """Wait until the text of an element begins so; `how` may also be "endsWith" or "includes"."""
    until(page, f"([one, words]) => document.querySelector(one)?.textContent.{how}(words)", selector, words)


def step(page) -> None:
    """Let one step be done, and wait until its frame is drawn."""
    frames = page.evaluate(FRAMES)
    page.click("#step")
    until(page, "([frames]) => replay.page.run.frames > frames && !replay.page.waiting", frames)


def place_of(page, robot: int) -> list[float]:
    """Return where a robot is drawn [m]."""
    return [page.evaluate(f"replay.page.shown[0].view.{axis}[{robot}]") for axis in "xy"]


def picture(page) -> str:
    """Return the pixels of the world."""
    return page.evaluate("document.querySelector('.world').toDataURL()")


def on_screen(page, x: float, y: float) -> tuple[float, float]:
    """Return where a point of the world [m] is on the screen."""
    box = page.locator(".world").bounding_box()
    return box["x"] + x / 11.0 * box["width"], box["y"] + (1.0 - y / 11.0) * box["height"]


def drag(page, begin: tuple[float, float], end: tuple[float, float]) -> None:
    page.mouse.move(*on_screen(page, *begin))
    page.mouse.down()
    for share in (0.3, 0.6, 1.0):
        page.mouse.move(*on_screen(page, *(np.array(begin) + share * (np.array(end) - begin))))
    page.mouse.up()


def free_place(session) -> tuple[float, float]:
    """A place far from all robots and items."""
    things = np.concatenate(
        [session.worlds.physics.positions[session.worlds.physics.present], session.worlds.task.garbage.positions[0]]
    )
    places = [(x + 0.5, y + 0.5) for x in range(1, 10) for y in range(1, 10)]
    return max(places, key=lambda place: np.hypot(*(things - place).T).min())
