"""Draws the page of two runs in Chromium: `python -m docs.figures.draw_replay [DIR]` (default docs/pictures).

Needs Chromium (`apt-get install chromium`) and Playwright (`pip install playwright`).
"""

import shutil
import sys
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from playwright.sync_api import sync_playwright

from clean_swarm_env.config.load import load_family
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from train.evaluation.family import TrialTask
from train.replay.page_file import write_page

PICTURES = Path(__file__).parents[1] / "pictures"
CONDITIONS = ("fixed:RepulsionGradient-from0.25", "policy:general")
MOMENT = "#t=64&robot=7&run=1"
SIZE = (1500, 900)


def record(folder: Path) -> list[RecordedMission]:
    """Record one scenario of the family `crowded` under both conditions."""
    family = load_family("crowded")
    for condition in CONDITIONS:
        task = TrialTask(family, 0, (0,), condition, condition, "AvoidCollision", ())
        task.recorded(RecordSettings(folder, minds=True, name=condition.partition(":")[0])).run()
    return [RecordedMission(folder / f"{condition.partition(':')[0]}.swarm") for condition in CONDITIONS]


def main(folder: Path) -> None:
    """Write the picture."""
    with TemporaryDirectory() as place, sync_playwright() as playwright:
        page_file = Path(place) / "page.html"
        write_page(record(Path(place)), page_file)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
        page.goto(page_file.as_uri() + MOMENT)
        page.wait_for_selector("body[data-ready]")
        picture = Image.open(BytesIO(page.screenshot())).convert("RGB").quantize(256)
        picture.save(folder / "replay.png", optimize=True)
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURES)
