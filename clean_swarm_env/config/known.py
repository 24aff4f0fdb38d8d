"""Knowledge of a mission: that of the experts, and rewards from missions of its name."""

from collections.abc import Sequence
from pathlib import Path

from clean_swarm_env.config.mission import MissionConfig
from selector.documents.errors import within
from selector.documents.find import find_file, is_path
from selector.knowledge import Knowledge, load_knowledge
from selector.store import KnowledgeStore


def knowledge_of(mission: MissionConfig, directories: Sequence[Path] = ()) -> Knowledge:
    """Return the expert knowledge that a mission names, with its learned rewards, those of its store, and its scores.

    Raises:
        DocumentError: there is no such knowledge or store, or they do not fit.

    """
    with within("mission.knowledge"):
        known = load_knowledge(mission.knowledge, directories).with_learned(mission.learned)
    if mission.store:
        held = KnowledgeStore(mission.store, create=False).contents()
        known = known.with_learned(held.scores(known, mission_context(mission.name)))
    with within("mission.scores"):
        return known.with_scores(mission.scores)


def knowing(mission: MissionConfig, name: str | None, directories: Sequence[Path] = ()) -> MissionConfig:
    """Return the mission with the expert knowledge of a name, and with the robots that it is for; None: with its own.

    Raises:
        DocumentError: there is no such knowledge.

    """
    if name is None:
        return mission
    with within("knowledge"):
        robot = load_knowledge(name, directories).robot
        if is_path("knowledge", name):
            name = str(find_file("knowledge", name).resolve())
    network = mission.network.model_copy(update={"robot": robot}) if robot else mission.network
    return mission.model_copy(update={"knowledge": name, "network": network})


def mission_context(name: str) -> str:
    """Return the context under which a store keeps the scores of missions of a name."""
    return f"mission {name}"
