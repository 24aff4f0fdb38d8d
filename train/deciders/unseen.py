"""What a mission has that the training of a policy never had, and goals that a policy leaves alone, in a line each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from selector.documents.errors import DocumentError
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
    families = _families(training, directories)
    if not families:
        return []
    known = _features([family.mission for family in families])
    if any("deliver" in family.changes.kinds for family in families):
        known.add("lost messages")
    found = sorted(_features(missions) - known)
    robots = [least_or_most for family in families for least_or_most in family.robots]
    areas = [width * height for family in families for width, height in family.tori]
    for mission in missions:
        world = mission.world
        for what, own, trained in (
            ("robots", mission.robots.count, robots),
            ("m2 of ground", world.width * world.height, areas),
        ):
            if not min(trained) <= own <= max(trained):
                found.append(f"{own:g} {what} ({min(trained):g} to {max(trained):g})")
    return list(dict.fromkeys(found))


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


def _families(training: Mapping[str, Any], directories: Sequence[Path]) -> list[FamilyConfig]:
    """Return the families of a training that there are still."""
    found = []
    for task in training.get("configuration", {}).get("tasks", ()):
        try:
            found.append(load_family(str(task.get("family")), directories))
        except DocumentError:
            continue
    return found
