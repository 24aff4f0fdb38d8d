"""Read missions and experiments from YAML files, by name or by path.

A directory of configurations holds `experiments/`, `families/`, `missions/` and `starts/`; the given directories are
searched in order, the shipped one last. Whatever is wrong raises ConfigurationError: one line with file, key, expected
and given.
"""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from clean_swarm_env.config.errors import ConfigurationError, one_line
from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.mission import MissionConfig
from selector.documents.errors import shown
from selector.documents.files import roots
from selector.documents.reading import read_mapping
from selforg.registry import unknown

Content = dict[str, Any]
M = TypeVar("M", bound=BaseModel)
SINGULAR = {
    "experiments": "experiment",
    "families": "family",
    "missions": "mission",
    "starts": "set of start configurations",
}
SUFFIXES = (".yaml", ".yml")


def load_experiment(name_or_path: str, directories: Sequence[Path] = ()) -> ExperimentConfig:
    """Return the experiment of a name or of a path to a YAML file, its mission and start configurations resolved."""
    path = _find("experiments", name_or_path, directories)
    return _validated(ExperimentConfig, _resolved(path, directories), path)


def load_family(name_or_path: str, directories: Sequence[Path] = ()) -> FamilyConfig:
    """Return the family of a name or of a path to a YAML file, its mission and start configurations resolved."""
    path = _find("families", name_or_path, directories)
    return _validated(FamilyConfig, _resolved(path, directories), path)


def load_mission(name_or_path: str, directories: Sequence[Path] = (), where: str = "") -> MissionConfig:
    """Return the mission of a name or of a path to a YAML file; `where` starts the line of an unknown one."""
    path = _find("missions", name_or_path, directories, where)
    return _validated(MissionConfig, read_mapping(path), path)


def names(kind: str, directories: Sequence[Path] = ()) -> list[str]:
    """Return the sorted names of all files of a kind: "experiments", "families", "missions" or "starts"."""
    return sorted({path.stem for root in roots(directories) for path in (root / kind).glob("*.yaml")})


def laid_over(base: Mapping[str, Any], changes: Mapping[str, Any]) -> Content:
    """Return `base` with `changes` in its place, mapping by mapping."""
    merged = dict(base)
    for key, value in changes.items():
        below = merged.get(key)
        merged[key] = laid_over(below, value) if isinstance(below, Mapping) and isinstance(value, Mapping) else value
    return merged


def _resolved(path: Path, directories: Sequence[Path]) -> Content:
    """Return the content of an experiment or a family, what it names as its mission and its starts in their places."""
    content = read_mapping(path)
    content["mission"] = _mission_of(content.get("mission", {}), path, directories)
    if isinstance(content.get("starts"), str):
        starts = read_mapping(_find("starts", content["starts"], directories, f"{shown(path)}: starts: "))
        content["starts"] = starts.get("starts")
    return content


def _mission_of(given: object, path: Path, directories: Sequence[Path]) -> object:
    """Return the content of an experiment's mission: a name, or changes laid over the mission named `base`."""
    if isinstance(given, str):
        return load_mission(given, directories, f"{shown(path)}: mission: ").model_dump()
    if isinstance(given, dict) and "base" in given:
        base = given["base"]
        if not isinstance(base, str):
            raise ConfigurationError(f"{shown(path)}: mission.base: expected the name of a mission, got {base!r}")
        changes = {key: value for key, value in given.items() if key != "base"}
        return laid_over(load_mission(base, directories, f"{shown(path)}: mission.base: ").model_dump(), changes)
    return given


def _find(kind: str, name: str, directories: Sequence[Path], where: str = "") -> Path:
    """Return the file of a name, or the path itself where `name` is one."""
    if name.endswith(SUFFIXES) or os.sep in name:
        path = Path(name)
        if not path.is_file():
            raise ConfigurationError(f"{where}{name}: no such file")
        return path
    found = [path for root in roots(directories) if (path := root / kind / f"{name}.yaml").is_file()]
    if not found:
        raise ConfigurationError(where + unknown(SINGULAR[kind], name, names(kind, directories)))
    return found[0]


def _validated(model: type[M], content: Content, path: Path) -> M:
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise ConfigurationError(one_line(error, shown(path), model)) from error
