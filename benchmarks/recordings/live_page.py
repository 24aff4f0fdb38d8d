"""The lag of the live page: the time from the making of a frame until it is on the screen.

    python -m benchmarks.recordings.live_page

`clean-swarm play --strategy MaxScore`: twenty robots of the family `crowded` with minds, five times as fast as
real time, in a headless Chromium with software rendering on the same machine. Needs Chromium and Playwright.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.shared.record import record
from docs.figures.draw_replay import chromium, played

SPEED = 5.0
STRATEGY = "MaxScore"
"""The mission lasts long enough under it."""
FRAMES = 300
"""Frames whose lag is measured."""


def main() -> None:
    """Measure, print and keep the figures."""
    with (
        TemporaryDirectory() as folder,
        chromium() as browser,
        played(browser, Path(folder) / "live.swarm", SPEED, STRATEGY) as page,
    ):
        page.wait_for_function(f"() => replay.page.lags.length >= {FRAMES}", timeout=300_000)
        lags = page.evaluate("replay.page.lags")
    figures = {f"{share} % [ms]": float(np.percentile(lags, share)) for share in (50, 95, 99)}
    print({name: round(value, 1) for name, value in figures.items()})
    record("live page", {f"{FRAMES} frames of 20 robots": figures})


if __name__ == "__main__":
    main()
