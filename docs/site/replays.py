"""Pages on which a mission plays, made for the site: `python -m docs.site.replays FOLDER`, which `make docs` runs."""

import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from clean_swarm_env.config.load import load_family
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from train.replay.page_file import write_page
from train.running.trial_task import TrialTask

GRADIENT = "fixed:RepulsionGradient-view1.5"
MISSIONS = {"scouts": "fixed:ORCA", "silent-zone": GRADIENT, "three-rooms": GRADIENT}
"""Mission -> the condition under which its page plays."""


def record(folder: Path, family: str, condition: str, goal: str = "") -> RecordedMission:
    """Record the first test scenario of a family or mission under a condition."""
    scenario, name = load_family(family).scenario(0, 0, "test"), f"{family}, {condition.partition(':')[0]}"
    task = TrialTask(family, 0, (scenario,), condition, condition, goal)
    replace(task, record=RecordSettings(folder, minds=True, name=name)).run()
    return RecordedMission(folder / f"{name}.swarm")


def main(folder: Path) -> None:
    """Write the pages."""
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as place:
        for mission, condition in MISSIONS.items():
            write_page([record(Path(place), mission, condition)], folder / f"{mission}.html")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
