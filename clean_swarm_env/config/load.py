"""Read missions, families and experiments from YAML files, by name or by path; see `selector.documents.find`.

A task's name is the name of its own mission, unless a file has it, and of the random starts of that mission.
Every mistake raises ConfigurationError: one line with file, key, expected and given. Files may ask for code and
databases only with `trust` (docs/own_plugins.md). Knowledge that a file names by its path is looked for beside it.
"""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.task_names import COMPARED, OF_ROBUSTNESS, named_file
from clean_swarm_env.config.tasks import find_task, with_changes
from selector.documents.errors import shown, validated
from selector.documents.fields import checked_name
from selector.documents.find import find_file, is_path
from selector.documents.reading import read_mapping
from selector.documents.trust import reading_files


def load_experiment(
    name_or_path: str, directories: Sequence[Path] = (), *, trust: bool = False
) -> ExperimentConfig | FamilyConfig:
    """Return the experiment of a name or of a path to a YAML file, its mission and start configurations resolved.

    It has conditions, or it is a family with strategies, and maybe with disturbances, each of which has its mission.
    Where no experiment has the name it is that of a family; see `load_family`.
    """
    path = named_file(name_or_path, directories, kinds=COMPARED)
    with reading_files(trust=trust):
        found = own_mission(name_or_path) if path is None else _document(read_mapping(path), path, directories)
    return random_starts(found) if isinstance(found, MissionConfig) else found


def load_family(name_or_path: str, directories: Sequence[Path] = (), *, trust: bool = False) -> FamilyConfig:
    """Return the family of a name or of a path to a YAML file, its mission and start configurations resolved.

    The name of a mission, a task or an experiment is that of its family, too: its random starts.
    """
    found = load_named(name_or_path, directories, trust=trust)
    return found if isinstance(found, FamilyConfig) else random_starts(found)


def load_named(
    name_or_path: str, directories: Sequence[Path] = (), *, trust: bool = False
) -> FamilyConfig | MissionConfig:
    """Return the mission or the family of a name or of a path to a YAML file.

    The name of a task is that of its own mission, that of an experiment the mission on which it compares; with start
    configurations of its own, or disturbances, an experiment is a family.
    """
    path = named_file(name_or_path, directories)
    if path is None:
        return own_mission(name_or_path)
    with reading_files(trust=trust):
        found = _document(read_mapping(path), path, directories)
        if not isinstance(found, ExperimentConfig):
            return found
        given = {"name": found.name, "description": found.description, "mission": found.mission}
        starts = {"starts": found.starts}
        return validated(FamilyConfig, given | starts, shown(path)) if found.starts else found.mission


def random_starts(mission: MissionConfig) -> FamilyConfig:
    """Return a mission from random starts as a family of its name."""
    content = {"name": mission.name, "description": "The mission from random starts.", "mission": mission}
    return validated(FamilyConfig, content, mission.name)


def load_mission(
    name_or_path: str, directories: Sequence[Path] = (), where: str = "", *, trust: bool = False
) -> MissionConfig:
    """Return the mission of a name or of a path to a YAML file; `where` starts the line of an unknown one."""
    if (path := named_file(name_or_path, directories, where, ("missions",))) is None:
        return own_mission(name_or_path)
    with reading_files(trust=trust):
        return validated(MissionConfig, _with_own_knowledge(read_mapping(path), path), shown(path))


def own_mission(task: str) -> MissionConfig:
    """Return the mission that a task has of its own."""
    name = find_task(task).name
    return validated(MissionConfig, {"name": name, "task": name}, f"task {name}")


def _document(
    content: dict[str, Any], path: Path, directories: Sequence[Path]
) -> ExperimentConfig | FamilyConfig | MissionConfig:
    """Return what a file holds, by its keys."""
    keys = content.keys()
    if "conditions" in keys and not OF_ROBUSTNESS & keys:
        return validated(ExperimentConfig, _resolved(content, path, directories), shown(path))
    if keys & {"mission", "description", *OF_ROBUSTNESS}:
        return validated(FamilyConfig, _resolved(content, path, directories), shown(path))
    return validated(MissionConfig, _with_own_knowledge(content, path), shown(path))


def _resolved(content: dict[str, Any], path: Path, directories: Sequence[Path]) -> dict[str, Any]:
    """Return the content of an experiment or a family, with the named mission and starts read into it."""
    content["mission"] = _mission_of(_with_own_knowledge(content.get("mission", {}), path), path, directories)
    if isinstance(given := content.get("starts"), str):
        name = checked_name(given, f"{shown(path)}: starts")
        starts = read_mapping(find_file("starts", name, directories, f"{shown(path)}: starts: "))
        content["starts"] = starts.get("starts")
    disturbances = content.get("disturbances")
    for each in disturbances if isinstance(disturbances, list) else ():
        if isinstance(each, dict) and isinstance(content["mission"], dict):
            changes = each.get("mission", {})
            each["mission"] = with_changes(content["mission"], changes) if isinstance(changes, dict) else changes
    return content


def _mission_of(given: object, path: Path, directories: Sequence[Path]) -> object:
    """Return the content of an experiment's mission: a name, or changes laid over the mission named `base`."""
    if isinstance(given, str):
        name = checked_name(given, f"{shown(path)}: mission")
        return load_mission(name, directories, f"{shown(path)}: mission: ").model_dump()
    if isinstance(given, dict) and "base" in given:
        base = checked_name(given["base"], f"{shown(path)}: mission.base")
        changes = {key: value for key, value in given.items() if key != "base"}
        return with_changes(load_mission(base, directories, f"{shown(path)}: mission.base: ").model_dump(), changes)
    return given


def _with_own_knowledge(mission: Any, path: Path) -> Any:  # noqa: ANN401  (whatever a file holds)
    """Return the content of a mission in a file, with the whole path of knowledge that lies beside the file."""
    name = mission.get("knowledge") if isinstance(mission, dict) else None
    if isinstance(name, str) and is_path("knowledge", name) and os.path.exists(path.parent / name):
        return {**mission, "knowledge": str(path.parent.resolve() / name)}
    return mission
