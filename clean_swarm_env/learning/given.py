"""Arguments of Python callers as models: names, paths, dictionaries or the models themselves.

A mistake is an error of one line that names the argument and the key, as in a YAML file.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral
from pathlib import Path
from reprlib import repr as brief
from typing import Any

import numpy as np
from pydantic import BaseModel

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family, load_mission
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import with_changes
from selector.documents.errors import M, validated
from selector.documents.plain import must_fit

Named = str | os.PathLike[str]
"""A name of a shipped file, or a path."""
GivenMission = MissionConfig | Mapping[str, Any] | Named
"""A mission: its name, its path, its keys (with `base` changes of another one), or the model."""
GivenFamily = FamilyConfig | Mapping[str, Any] | Named
"""A family of scenarios, as a mission is given."""


def directories_from(given: Named | Iterable[Named] | None) -> tuple[Path, ...]:
    """Return one directory or several as paths."""
    if given is None:
        return ()
    return (Path(given),) if isinstance(given, str | os.PathLike) else tuple(Path(one) for one in given)


def mission_from(given: GivenMission, directories: tuple[Path, ...] = ()) -> MissionConfig:
    """Return the mission; DocumentError or TypeError if there is no such one."""
    if isinstance(given, str | os.PathLike):
        return load_mission(os.fspath(given), directories)
    if isinstance(given, Mapping) and "base" in given:
        changes = dict(given)
        given = with_changes(mission_from(changes.pop("base"), directories).model_dump(), changes)
    return config_from(MissionConfig, given, "mission", "a name, a path, ")


def family_from(given: GivenFamily, directories: tuple[Path, ...] = ()) -> FamilyConfig:
    """Return the family of scenarios; DocumentError or TypeError if there is no such one.

    Worlds of one batch have the same robots: a family that draws how many there are of a model is refused.
    """
    if isinstance(given, str | os.PathLike):
        family = load_family(os.fspath(given), directories)
    else:
        if isinstance(given, Mapping):
            mission = mission_from(given["mission"], directories) if "mission" in given else MissionConfig()
            given = {**given, "mission": mission}
        family = config_from(FamilyConfig, given, "family", "a name, a path, ")
    for name, (least, most) in family.groups.items():
        one = "one number of robots of each model for worlds that learners share"
        must_fit(least == most, f"family {family.name}: groups.{name}", one, f"{least} to {most}")
    return family


def config_from(model: type[M], given: M | Mapping[str, Any] | None, where: str, other: str = "") -> M:
    """Return a model from its keys, or as it is; without anything given, the model of the defaults.

    `other` names what else could have been given.
    """
    if isinstance(given, model):
        return checked(given, where)
    if given is not None and not isinstance(given, Mapping):
        raise TypeError(f"{where}: expected {other}a dictionary or a {model.__name__}, got {brief(given)}")
    return validated(model, dict(given or {}), where, own=True)


def checked(given: M, where: str) -> M:
    """Return the model, or raise DocumentError: `model_copy` takes any keys and values."""
    validated(type(given), _content(given), where, own=True)
    return given


def _content(value: object) -> Any:  # noqa: ANN401  (what a file could hold)
    """Return the content of models, at any depth, without their types."""
    if isinstance(value, BaseModel):
        parts = vars(value) | (value.model_extra or {})
        return {name: _content(part) for name, part in parts.items() if not name.startswith("__")}
    return tuple(_content(part) for part in value) if isinstance(value, tuple) else value


def whole_number(given: object, where: str, least: int = 0) -> int:
    """Return a whole number of at least `least`, or raise ValueError; truth values are none."""
    if isinstance(given, bool) or not isinstance(given, Integral) or given < least:
        raise ValueError(f"{where}: expected a whole number of at least {least}, got {brief(given)}")
    return int(given)


def world_seeds(seed: object, worlds: int) -> list[int]:
    """Return the seeds of W worlds: children of one seed, so that other seeds have other worlds.

    A world has the same seed among any number of worlds (docs/environment.md#seeds). Seeds are below 2^63: arrays of
    larger numbers would be of floats.

    >>> world_seeds(1, 2)
    [4215923173971654960, 2021340933837429789]

    """
    children = np.random.SeedSequence(whole_number(seed, "seed")).spawn(worlds)
    return [int(child.generate_state(1, np.uint64)[0]) >> 1 for child in children]


def seeds_from(given: object, firsts: Sequence[int], rows: int) -> list[int | None]:
    """Return the seeds of worlds whose first rows among `rows` are `firsts` (W,), None for a world without one.

    Seeds are the children of one number, or those of a list, of worlds or of rows.
    """
    if isinstance(given, Iterable) and not isinstance(given, str):
        each = list(given)
        by_world = of_each([each[row] for row in firsts] if len(each) == rows else each, len(firsts), "seeds")
        return [None if seed is None else whole_number(seed, "seed") for seed in by_world]
    return [None] * len(firsts) if given is None else [*world_seeds(given, len(firsts))]


def of_each(given: Sequence[Any] | None, count: int, what: str) -> Sequence[Any]:
    """Return what is given for each of `count` worlds, None for each if nothing is; ValueError for another number."""
    if given is not None and len(given) != count:
        raise ValueError(f"{what}: expected one for each of {count} worlds, got {len(given)}")
    return [None] * count if given is None else given
