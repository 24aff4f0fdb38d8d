"""What a mission has that the training of a policy never had, and goals that a policy leaves alone, in a line each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from selector.documents.find import files_of
from train.deciders.named import NamedDecider


def remarks_of(
    label: str,
    named: NamedDecider,
    goals: Mapping[str, Sequence[str]],
    missions: Sequence[MissionConfig],
    directories: Sequence[Path] = (),
) -> list[str]:
    """Return what is to be said of a policy on missions that coordinate `goals`: goal -> options."""
    new = unseen(named.training, missions, directories)
    told = [f"{label}: was never trained with {', '.join(new)}; what it does there was not measured"] if new else []
    own = named.meant_for or ()
    kept = [goal for goal, options in goals.items() if own and goal not in own and len(options) > 1]
    decided = " and ".join(goal for goal in goals if goal in own)
    if named.training and kept and decided:
        told.append(f"{label}: decides {decided} only; of {' and '.join(kept)} robots hold the option of highest score")
    return told


def unseen(
    training: Mapping[str, Any], missions: Sequence[MissionConfig], directories: Sequence[Path] = ()
) -> list[str]:
    """Return what of missions the training, as a policy's file records it, never had; nothing if it does not say."""
    names = [task.get("family") for task in training.get("configuration", {}).get("tasks", ())]
    families = [load_family(name, directories) for name in names if name in files_of("families", directories)]
    if not families:
        return []
    known = _features([family.mission for family in families])
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
            "wrong poses": mission.robots.pose_noise > 0.0,
            "robots of several models": len(mission.robots.groups) > 1,
            f"{mission.world.ground} ground": True,
        }.items()
        if there
    }
