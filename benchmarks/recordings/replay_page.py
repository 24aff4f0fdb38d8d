"""The replay page in a headless Chromium with software rendering: time of a picture, time to load, size.

    python -m benchmarks.recordings.replay_page

All layers are on, who-sees-whom too. Two runs of 20 robots with minds, one under the policy `exploring-ppo`; a thousand
robots for a minute; and the longest mission of Table 1, with minds. Wall time, the least of some repeats. Needs
Chromium and Playwright.
"""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from playwright.sync_api import Browser

from benchmarks.shared.record import record
from benchmarks.shared.scenes import SEED, mission_of
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import mission_begun, run_out
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from docs.figures.draw_replay import chromium, opened
from docs.site.replays import record as record_pair
from train.evaluation.comparing import Comparing
from train.replay.page_file import write_page
from train.request import Request

MANY = 1000
REPEATS = 5
PICTURES = 60
ALL_LAYERS = "document.querySelectorAll('#layers input:not(:disabled)').forEach((box) => { box.checked = true; })"


def many(folder: Path) -> list[RecordedMission]:
    """Record a minute of a thousand robots."""
    mission = mission_of(MANY).model_copy(update={"time_limit": 60.0})
    record = RecordSettings(folder, name="many")
    run_out(mission_begun(mission, random_start(mission, SEED, 0), SEED, record=record))
    return [RecordedMission(folder / "many.swarm")]


def longest(folder: Path) -> list[RecordedMission]:
    """Record the missions of Table 1; return the longest."""
    for task in Comparing(Request("table1")).tasks({}):
        replace(task, record=RecordSettings(folder / "table1", minds=True)).run()
    return [max(map(RecordedMission, (folder / "table1").iterdir()), key=lambda run: run.frames)]


def measured(browser: Browser, recordings: list[RecordedMission], path: Path) -> dict[str, float]:
    """Write the page of some runs; return the milliseconds of a picture, the seconds to load it, and its size."""
    write_page(recordings, path)
    loads, pictures = [], []
    for _ in range(REPEATS):
        begin = perf_counter()
        page = opened(browser, path, "#t=20")
        loads.append(perf_counter() - begin)
        page.evaluate(ALL_LAYERS)
        pictures.append(page.evaluate(f"replay.page.measure({PICTURES})"))
        page.close()
    return {"ms a picture": min(pictures), "s to load": min(loads), "MB": path.stat().st_size / 1e6}


def main() -> None:
    """Measure, print and keep the figures."""
    with TemporaryDirectory() as name, chromium() as browser:
        folder = Path(name)
        figures = {
            "two runs of 20 robots": measured(browser, record_pair(folder), folder / "two.html"),
            f"{MANY} robots": measured(browser, many(folder), folder / "many.html"),
            "longest of Table 1": measured(browser, longest(folder), folder / "longest.html"),
        }
    for title, values in figures.items():
        print(title, {key: round(value, 2) for key, value in values.items()})
    record("replay page", figures)


if __name__ == "__main__":
    main()
