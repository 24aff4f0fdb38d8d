"""Strategies by name: the register, and how YAML and the command line name one with its parameters."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, model_validator

from selector.documents.errors import DocumentError, validated
from selector.documents.fields import Closed, Name
from selector.documents.reading import read_value
from selector.strategies.problem import Ints, Problem
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import Keys
from selforg.registry import unknown

S = TypeVar("S", bound=type[DecisionStrategy])

_registered: dict[str, type[DecisionStrategy]] = {}


class StrategySpec(Closed):
    """A strategy with its parameters, as YAML and the command line name it; both have to exist."""

    name: Name
    """Name of a registered strategy."""
    parameters: dict[Name, Any] = Field(default_factory=dict)
    """Values for what the strategy lets one set."""
    sharing: Literal["all", "team", "robot"] = "all"
    """Who learns together: all robots of all worlds, the robots of each world, or each robot for itself."""

    @model_validator(mode="after")
    def _exists(self) -> Self:
        known = registered()
        if self.name not in known:
            raise ValueError(unknown("strategy", self.name, tuple(known)))
        validated(known[self.name].Parameters, self.parameters, self.name)  # a DocumentError is a ValueError
        return self

    def build(self, problem: Problem, keys: Keys, teams: Ints, directories: Sequence[Path] = ()) -> DecisionStrategy:
        """Return the strategy for rows of the given `keys` (R,) and numbers 0..W-1 of their `teams` (R,).

        Files that parameters name are looked for in `directories` before the shipped one.
        """
        groups = {"all": np.zeros_like(teams), "team": teams, "robot": np.arange(len(teams))}
        return create(self.name, problem, keys, self.parameters, groups=groups[self.sharing], directories=directories)


def spec_from_text(text: str) -> StrategySpec:
    """Return the strategy that `NAME` or `NAME:parameter=value,...` names; `sharing=...` may be among the values.

    >>> spec_from_text("UCB1:prior=2,sharing=team")
    StrategySpec(name='UCB1', parameters={'prior': 2}, sharing='team')

    Raises:
        DocumentError: an unknown strategy or parameter, or a value that does not fit.

    """
    name, _, rest = text.partition(":")
    values: dict[str, Any] = {}
    for part in rest.split(",") if rest else ():
        key, equals, value = part.partition("=")
        if not equals or not key or key in values:
            raise DocumentError(f"strategy {text!r}: expected NAME:parameter=value,..., each once, got {part!r}")
        values[key] = read_value(value)
    content = {"name": name, **({"sharing": values.pop("sharing")} if "sharing" in values else {})}
    return validated(StrategySpec, content | {"parameters": values}, f"strategy {text!r}")


def register(strategy: S) -> S:
    """Make a strategy known by the name of its class."""
    name = strategy.__name__
    if name in _registered:
        raise ValueError(f"strategy '{name}' is registered twice")
    _registered[name] = strategy
    return strategy


def registered() -> dict[str, type[DecisionStrategy]]:
    """Return all registered strategies by name, those that ship among them."""
    import_module("selector.strategies")  # they register as they are imported, and need this module to do so
    return dict(sorted(_registered.items()))


def create(
    name: str,
    problem: Problem,
    keys: Keys,
    parameters: Mapping[str, Any] | None = None,
    *,
    groups: Ints | None = None,
    directories: Sequence[Path] = (),
) -> DecisionStrategy:
    """Return a new strategy of a registered name; the other arguments are those of `DecisionStrategy`.

    Raises:
        DocumentError: an unknown name, or parameters that do not fit.

    """
    known = registered()
    if name not in known:
        raise DocumentError(unknown("strategy", name, tuple(known)))
    return known[name](problem, keys, parameters, groups=groups, directories=directories)
