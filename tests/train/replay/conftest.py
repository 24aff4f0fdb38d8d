"""Two recorded runs and the page of both, for all tests of the replay page; it must log nothing, and ask for itself."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from clean_swarm_env.recording.reader import RecordedMission
from tests.paths import TRAINED
from tests.train.commands import done

FAMILY = {
    "name": "small",
    "description": "Eight robots and eight items, messages lost, robots that fail and join.",
    "mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 90.0, "delivery": {"loss": 0.2}},
    "robots": [8, 8],
    "items": [8, 8],
    "changes": {"number": [5, 5], "kinds": ["join", "fail"]},
}
CONDITIONS = ("policy:general", "fixed:RepulsionGradient-view0.5")


@pytest.fixture(scope="session")
def results(tmp_path_factory) -> Path:
    """Results of two strategies with recordings, and the page of both."""
    directory = tmp_path_factory.mktemp("page")
    (directory / "small.yaml").write_text(yaml.safe_dump(FAMILY))
    settings = ("--scenarios", 1, "--workers", 1, "--minds", "--configs", TRAINED, "--output", directory / "run")
    strategies = (word for name in CONDITIONS for word in ("--strategy", name))
    done("evaluate", directory / "small.yaml", *strategies, *settings)
    conditions = (word for name in CONDITIONS for word in ("--condition", name))
    done("replay", directory / "run", *conditions, "--html", directory / "both.html")
    return directory


@pytest.fixture(scope="session")
def recordings(results) -> list[RecordedMission]:
    folder = results / "run" / "recordings"
    return [RecordedMission(folder / f"test-1-{name.replace(':', '_')}.swarm") for name in CONDITIONS]


@pytest.fixture
def opened(watched, results):
    """Open a page at a link, that of both runs unless another file is named."""
    pages = []

    def open_page(link: str = "", file: Path = results / "both.html", **settings):
        page, *told = watched(**{"viewport": {"width": 1500, "height": 900}, **settings})
        pages.append((file.as_uri(), *told))
        page.goto(file.as_uri() + link)
        page.wait_for_selector("body[data-ready]")
        return page

    yield open_page
    for address, said, asked in pages:
        # reading pixels is remarked upon
        assert [words for words in said if "willReadFrequently" not in words] == []
        assert [url.partition("#")[0] for url in asked] == [address]


@pytest.fixture
def explained(results, recordings):
    """Show some robots at some times on a page; with run, frame and robot comes what the command tells of them."""

    def draw(page, count: int, seed: int):
        rng = np.random.default_rng(seed)
        for _ in range(count):
            k = int(rng.integers(2))
            frame = int(rng.integers(1, recordings[k].frames))
            there = recordings[k]["present"][: frame + 1].any(axis=0)
            robot = int(rng.choice(np.flatnonzero(there)))  # also one that has joined
            page.evaluate(f"replay.page.go({frame * 0.2}); replay.page.choose({k}, {robot})")
            words = ("--condition", CONDITIONS[k], "--robot", robot, "--time", frame * 0.2, "--json")
            yield k, frame, robot, json.loads(done("explain", results / "run", *words))

    return draw
