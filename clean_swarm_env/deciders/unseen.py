"""What a mission has that the training of a policy never had, and goals that a policy leaves alone, in a line each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.deciders.named import NamedDecider
from clean_swarm_env.world.task import task_class
from selector.coordination.model import CoordinatorModel
from selector.documents.fields import JOINT
from selector.documents.find import files_of


def remarks_of(
    label: str, named: NamedDecider, missions: Sequence[MissionConfig], directories: Sequence[Path] = ()
) -> list[str]:
    """Return what is to be said of a policy on missions before they are done."""
    new = untrained(label, named, missions, directories)
    return [f"{new}; what it does there was not measured"] if new else []


def untrained(
    label: str, named: NamedDecider, missions: Sequence[MissionConfig], directories: Sequence[Path] = ()
) -> str:
    """Return what of missions a policy was never trained with, in words; nothing if all is known to it."""
    new = unseen(named.training, missions, directories)
    return f"{label}: was never trained with {', '.join(new)}" if new else ""


def decided_and_held(
    label: str, named: NamedDecider, decided: Sequence[str], models: Sequence[CoordinatorModel]
) -> list[str]:
    """Return a line on what a decider that was made for some goals decides, and what robots hold of the others.

    None where there is one goal.

    Args:
        label: begins the line.
        named: the decider.
        decided: the goals that it decides.
        models: of all goals of the mission.

    """
    held = [f"{one.goal} held {one.options[int(one.scores.argmax())]}" for one in models if one.goal not in decided]
    told = f"{label}: decides {'; '.join([' and '.join(decided), *held])}"
    return [told] if named.goals and decided and len(models) > 1 else []


def undecided(
    named: NamedDecider, mission: MissionConfig, directories: Sequence[Path] = (), *, by_goal: bool = True
) -> str:
    """Return which goals a decider was made for that the mission does not let it decide, and the way out; or nothing.

    `by_goal`: whether its user can name goals, by the option --goal.

    Goals do not count that the robots could not coordinate by another document either, as Transport where there is one
    station of each kind.
    """
    kind, own = task_class(mission), named.goals
    wider, coordinated = kind.opened(mission), kind.goals(mission, directories)
    lacking = [goal for goal in kind.goals(wider, directories) if goal in own and goal not in coordinated]
    decided = JOINT.join(goal for goal in coordinated if goal in own)
    what = f"was made to decide {' and '.join(lacking)}, which these robots do not choose options for"
    alone = f"--goal {decided} lets it decide that alone; " if decided and by_goal else ""
    robot = f"network: {{robot: {wider.network.robot}}} in the mission, with knowledge of the goal"
    return f"{what}: {alone}{robot}" if lacking else ""


def unseen(
    training: Mapping[str, Any], missions: Sequence[MissionConfig], directories: Sequence[Path] = ()
) -> list[str]:
    """Return what of missions the training, as a policy's file records it, never had; nothing if it does not say."""
    names = [task.get("family") for task in training.get("configuration", {}).get("tasks", ())]
    families = [load_family(name, directories) for name in names if name in files_of("families", directories)]
    if not families:
        return []
    known = _features([mission for family in families for mission in family.missions])
    known |= {"lost messages"} if any("deliver" in family.changes.kinds for family in families) else set()
    robots = [float(count) for family in families for count in family.robots]
    areas = [width * height for family in families for width, height in family.tori]
    sizes = [(float(mission.robots.count), "robots", robots) for mission in missions]
    sizes += [(mission.world.width * mission.world.height, "m2 of ground", areas) for mission in missions]
    odd = [
        f"{own:g} {what} ({min(trained):g} to {max(trained):g})"
        for own, what, trained in sizes
        if not min(trained) <= own <= max(trained)
    ]
    return [*sorted(_features(missions) - known), *dict.fromkeys(odd)]


def _features(missions: Sequence[MissionConfig]) -> set[str]:
    """Return what of missions a policy may not know, in words."""
    return {
        name
        for mission in missions
        for name, there in {
            "walls": bool(mission.world.walls),
            "zones": bool(mission.world.zones),
            "lost messages": mission.delivery.loss > 0.0,
            "wrong poses": mission.robots.pose_noise + mission.robots.pose_drift > 0.0,
            "slipping wheels": mission.robots.slip > 0.0,
            "robots of several models": len(mission.robots.groups) > 1,
            f"{mission.world.ground} ground": True,
        }.items()
        if there
    }
