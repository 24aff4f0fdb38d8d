"""One sentence about what a robot does and because of whom, made of facts by rules.

`train/replay/page/why.js` makes the same sentence of a recording, by the same rules; tests compare them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan2, hypot, tau
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.world.explaining import RobotStep
from clean_swarm_env.world.parts.shown import AnyArray
from clean_swarm_env.world.task import Task
from clean_swarm_env.world.worlds import Worlds
from selector.documents.errors import within
from selforg.space import Torus

STRAIGHT: Final = 0.17
"""Angle up to which a robot goes straight on, ten degrees [rad]."""
SLOW: Final = 0.05
"""What a difference of speeds must have to count [m/s]."""
NAMED_FROM: Final = 0.25
"""Share from which a second neighbour is named."""


@dataclass(frozen=True)
class Facts:
    """What the sentence is made of."""

    state: str
    """As in `RobotStep`."""
    stands: float
    """How long a collision still stops it [s]."""
    running: tuple[str, ...]
    """Behaviours of its network."""
    wish: tuple[float, float]
    """What it wanted to drive [m/s]."""
    command: tuple[float, float]
    """What it was told to drive [m/s]."""
    heading: float
    """[rad]"""
    causes: tuple[tuple[int, float], ...]
    """Robots because of whom these differ, and how far away they are [m]; the one that counts most first."""
    share: float
    """How much the second one counts."""
    target: tuple[str, float] | None
    """Where it wants to go, and how far that is [m], -1 if it is not known."""
    unseen: float
    """Time since it last saw what it looks for [s]."""


def facts_of(worlds: Worlds, step: RobotStep, now: Mapping[str, AnyArray], unseen: float) -> Facts:
    """Return the facts about the robot of a step in the only world, which is as in a frame; `now`: its values."""
    robot, places = step.robot, np.stack([now["x"], now["y"]], axis=1)
    others = [int(who) for who in now["cause"][robot] if who >= 0]
    away = np.linalg.norm(Torus(*worlds.extent).offsets(places[robot], places[others]), axis=1)
    with within(f"task {worlds.task.name}: target"):
        target = worlds.task.target(robot, step.network.readings)
    return Facts(
        state=step.state,
        stands=step.stopped_s,
        running=tuple(account.name for account in step.network.behaviours if account.running),
        wish=(float(now["wish_x"][robot]), float(now["wish_y"][robot])),
        command=(float(now["command_x"][robot]), float(now["command_y"][robot])),
        heading=float(now["heading"][robot]),
        causes=tuple(zip(others, away.tolist(), strict=True)),
        share=float(now["cause_share"][robot, 1]),
        target=target,
        unseen=unseen,
    )


def sentence(facts: Facts, task: type[Task[Any, Any]]) -> str:
    """Return one sentence about what a robot does and because of whom, in the words of a task."""
    if facts.state != "at work":
        return "does nothing: it has failed" if facts.state == "failed" else "is not there"
    if facts.stands > 0.0:
        return f"stands after a collision, for {facts.stands:.1f} s more"
    to = ""
    if facts.target is not None:
        to = facts.target[0] + (f", {facts.target[1]:.1f} m" if facts.target[1] >= 0.0 else "")
    (wx, wy), (x, y) = facts.wish, facts.command
    held_up = AVOIDANCE in facts.running and hypot(x, y) < SLOW  # avoiding holds it where it is
    if facts.causes and (held_up or hypot(x - wx, y - wy) > SLOW):
        (first, away), *others = facts.causes
        who = f"robot {first}, {away:.1f} m away" + (
            f", and robot {others[0][0]}" if others and facts.share >= NAMED_FROM else ""
        )
        wanted = f"go to {to}" if to else next(iter(task.searching.values()), "go on")
        return f"{_avoiding(facts)} because of {who}; would {wanted}"
    done = [task.doing[name] for name in facts.running if name in task.doing]
    if done or to:
        return done[0] if done else f"goes to {to}"
    if searching := [task.searching[name] for name in facts.running if name in task.searching]:
        return f"{searching[0]}s: nothing seen for {facts.unseen:.0f} s"
    return f"runs {' and '.join(facts.running)}" if facts.running else "does nothing: no behaviour runs"


def _avoiding(facts: Facts) -> str:
    """Return what a robot does in place of what it wanted."""
    (wx, wy), (x, y) = facts.wish, facts.command
    wanted, told = hypot(wx, wy), hypot(x, y)
    before = atan2(wy, wx) if wanted > SLOW else facts.heading
    turn = atan2(y, x) - before
    turn -= tau * round(turn / tau)
    if told < SLOW:
        return "stops"
    if abs(turn) > STRAIGHT:
        return "turns left" if turn > 0.0 else "turns right"
    return "slows down" if told < wanted - SLOW else "keeps away"
