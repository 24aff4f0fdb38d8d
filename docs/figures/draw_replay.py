"""Draws the replay page in Chromium: `python -m docs.figures.draw_replay [DIR]` (default docs).

Writes the picture of two runs side by side, `pictures/replay.png`; the animation of one, `pictures/mission.webp`; the
picture of a mission that is played, `pictures/play.png`; and that of a report, `pictures/report.png`. Needs Chromium
(`apt-get install chromium`) and Playwright (`pip install playwright`).
"""

import shutil
import sys
from base64 import b64decode
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

from clean_swarm_env.recording.recorder import RecordSettings
from docs.site.replays import record
from train.cli.options import wide_console
from train.evaluation.comparing import Comparing
from train.evaluation.pipeline import evaluate
from train.live.chosen import chosen, playable
from train.live.conductor import Conductor
from train.live.server import LiveServer
from train.live.session import Session
from train.replay.page_file import live_page, write_page
from train.report_page.page import report_of_results
from train.reports.results import results_in
from train.request import Request
from train.running.run_folder import RECORDINGS

DOCS = Path(__file__).parents[1]
FAMILY, GOAL = "crowded-exploring", "ExplorationPatrol"
CONDITIONS = ("fixed:Patrol", "policy:exploring-ppo")
MOMENT = "#t=64&robot=7&run=1"
SIZE = (1100, 800)
FAST, PLAYED = 10.0, 10.4
"""Speed of the mission that is played, and the moment of its picture [s]."""
REPORT = (1000, 1000)
"""Width and height of the picture of a report [pixels]."""
SCENARIOS = 6
SIDE = 400
"""Side of the animation [pixels]."""
STEP = 4
"""Control periods from picture to picture of the animation."""
SHOWN = 100
"""Time that a picture is shown [ms]: eight times as fast as the mission."""


def opened(browser: Browser, path: Path, link: str = "") -> Page:
    """Open a page and wait until it is ready."""
    page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
    page.goto(path.as_uri() + link)
    page.wait_for_selector("body[data-ready]", timeout=60_000)
    return page


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start a headless Chromium, that of the system; give it."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        yield browser
        browser.close()


@contextmanager
def played(browser: Browser, output: Path, speed: float, strategy: str | None = None) -> Iterator[Page]:
    """Play the mission of `clean-swarm play` at a speed before a page, and record it; give the page."""
    session = Session(chosen("crowded", 1, 0, strategy, ()), output)
    conductor = Conductor(dict.fromkeys(("", *playable(())), lambda: session), speed)
    runner = Thread(target=conductor.run)
    with LiveServer() as server:
        server.start(conductor, live_page())
        runner.start()
        try:
            page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
            page.goto(server.address)
            page.wait_for_selector("body[data-ready]", timeout=60_000)
            yield page
        finally:
            conductor.close()
            runner.join()
            server.shutdown()


def save(page: Page, path: Path) -> None:
    """Write a picture of what a page shows."""
    Image.open(BytesIO(page.screenshot())).convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2).save(
        path, optimize=True
    )


def pictures(page: Page, frames: int) -> Iterator[Image.Image]:
    """Yield pictures of the world from the first to the last frame."""
    for frame in range(0, frames, STEP):
        page.evaluate(f"replay.page.go({frame} * replay.page.period)")
        data = page.evaluate("document.querySelector('.world').toDataURL('image/png')")
        picture = Image.open(BytesIO(b64decode(data.partition(",")[2]))).convert("RGB")
        yield picture.resize((SIDE, SIDE), Image.Resampling.LANCZOS)


def write_report(folder: Path) -> Path:
    """Evaluate both conditions on some scenarios and write the report; return it."""
    kept = {"output": folder, "record": RecordSettings(Path(RECORDINGS))}
    evaluate(Comparing(Request(FAMILY, CONDITIONS, 0, SCENARIOS, goal=GOAL, **kept)), wide_console())
    page = folder / "report.html"
    page.write_text(report_of_results([results_in(folder)]), encoding="utf-8")
    return page


def main(folder: Path) -> None:
    """Write pictures and animation."""
    with TemporaryDirectory() as place, chromium() as browser:
        recordings = [record(Path(place), FAMILY, condition, GOAL) for condition in CONDITIONS]
        both, one = Path(place) / "both.html", Path(place) / "one.html"
        write_page(recordings, both)
        write_page(recordings[1:], one)
        save(opened(browser, both, MOMENT), folder / "pictures" / "replay.png")
        with played(browser, Path(place) / "play.swarm", FAST) as live:
            live.wait_for_function(f"() => replay.page.run.frames * replay.page.period > {PLAYED}")
            live.evaluate(f"replay.page.go({PLAYED}); replay.page.choose(0, 3)")
            save(live, folder / "pictures" / "play.png")
        report = browser.new_page(viewport={"width": REPORT[0], "height": REPORT[1]})
        report.goto(write_report(Path(place) / "results").as_uri())
        save(report, folder / "pictures" / "report.png")
        first, *others = pictures(opened(browser, one), recordings[1].frames)
        animation = folder / "pictures" / "mission.webp"
        first.save(animation, save_all=True, append_images=others, duration=SHOWN, loop=0, quality=40, method=4)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else DOCS)
