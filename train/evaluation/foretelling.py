"""What is foretold of a run that is repeated: for each robot, the next seconds under each option, every so often."""

from __future__ import annotations

from typing import Any

import numpy as np

from clean_swarm_env.config.types import ConfigurationError
from train.deciders.what_if import WhatIf
from train.evaluation.repeat import Deciding, Repeated, steps_of
from train.evaluation.trial_task import TrialTask

MOST_ANSWERS = 5000
"""Most robots and times of a page; more take minutes and tens of megabytes."""
Answer = dict[str, Any]
"""`robot`, `time` [s] from which on, and `options`: what happens under each, see `WhatIf.options`."""


def asking(task: Repeated, deciding: list[Deciding]) -> WhatIf:
    """Return what foretells a run that is being repeated, whose decider has decided; ConfigurationError without one."""
    if not deciding or not isinstance(task, TrialTask):
        raise ConfigurationError("--what-if: expected a run of a family, or of a decider that decides in each period")
    return WhatIf(deciding[0].batch, deciding[0].decided, task.settings.observation, task.directories)


def foretold_along(task: Repeated, every: float) -> list[Answer]:
    """Repeat a run; return what is foretold of all robots at its first step and after every `every` seconds."""
    latest: list[Deciding] = []

    def note(deciding: Deciding) -> None:
        latest[:] = [deciding]

    answers: list[Answer] = []
    what_if: WhatIf | None = None
    for worlds in steps_of(task, note):
        ticks, per = int(worlds.ticks[0]), max(round(every / worlds.period), 1)
        if ticks > 1 and ticks % per:
            continue
        what_if = what_if or asking(task, latest)
        nobody = np.full(worlds.robots, -1)
        for robot in np.flatnonzero(worlds.team.working).tolist():
            if len(answers) == MOST_ANSWERS:
                raise ConfigurationError(f"--what-if: expected more than {every:g} s, which is too often for this run")
            (one,) = latest
            options = what_if.options(robot, one.decider, one.observations, nobody)
            for option in options:
                option["path"] = np.round(option["path"], 3).tolist()
            answers.append({"robot": robot, "time": round(ticks * worlds.period, 9), "options": options})
    return answers
