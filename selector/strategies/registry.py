"""The registry of strategies, and how YAML and the command line name a strategy with its parameters."""

from collections.abc import Mapping
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from selector.documents.errors import DocumentError, validated
from selector.documents.fields import Closed, Name
from selector.documents.imported import NameOrImport, imported
from selector.documents.plain import short
from selector.documents.reading import read_value
from selector.documents.trust import is_import
from selector.strategies.problem import Problem
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import Keys
from selforg.arrays import Ints
from selforg.plugins import guard
from selforg.registry import Registry, UnknownNameError

STRATEGIES: Registry[DecisionStrategy] = Registry("strategy", base=DecisionStrategy)
BY_SCORE = "MaxScore"
"""The strategy of the paper: the highest score of the expert."""


class StrategySpec(Closed):
    """A registered strategy with valid parameters, as YAML and the command line name it."""

    name: NameOrImport
    """Name of a registered strategy, or `module:class` of one's own."""
    parameters: dict[Name, Any] = Field(default_factory=dict)
    """Values for parameters of the strategy."""
    sharing: Literal["all", "team", "robot"] = "all"
    """Which robots share estimates: all robots of all worlds, the robots of one world, or none."""

    @model_validator(mode="after")
    def _exists(self) -> Self:
        validated(named(self.name).Parameters, self.parameters, self.name)  # a DocumentError is a ValueError
        return self

    def build(self, problem: Problem, keys: Keys, teams: Ints) -> DecisionStrategy:
        """Return the strategy for rows of the given `keys` (R,) and numbers 0..W-1 of their `teams` (R,)."""
        groups = {"all": np.zeros_like(teams), "team": teams, "robot": np.arange(len(teams))}
        return create(self.name, problem, keys, self.parameters, groups=groups[self.sharing])


def spec_from_text(text: str) -> StrategySpec:
    """Return the strategy that `NAME` or `NAME:parameter=value,...` describes; `sharing=...` is allowed too.

    A class of one's own is `module:Class`, with parameters `module:Class:parameter=value,...`.

    >>> spec_from_text("UCB1:prior=2,sharing=team")
    StrategySpec(name='UCB1', parameters={'prior': 2}, sharing='team')

    Raises:
        DocumentError: a strategy or parameter is unknown, or a value does not fit.

    """
    name, rest = named_in(text)
    values: dict[str, Any] = {}
    for part in rest.split(",") if rest else ():
        key, equals, value = part.partition("=")
        if not equals or not key or key in values:
            raise DocumentError(
                f"strategy {short(text)}: expected NAME:parameter=value,..., each once, got {short(part)}"
            )
        values[key] = read_value(value)
    content = {"name": name, **({"sharing": values.pop("sharing")} if "sharing" in values else {})}
    return validated(StrategySpec, content | {"parameters": values}, f"strategy {short(text)}", own=True)


def named_in(text: str) -> tuple[str, str]:
    """Return the name of a strategy, or of a class of one's own, in a text, and what follows its colon."""
    first, _, rest = text.partition(":")
    second, _, after = rest.partition(":")
    own = f"{first}:{second}"
    return (own, after) if first not in STRATEGIES and is_import(own) else (first, rest)


def create(
    name: str,
    problem: Problem,
    keys: Keys,
    parameters: Mapping[str, Any] | None = None,
    *,
    groups: Ints | None = None,
) -> DecisionStrategy:
    """Return a new strategy of the class registered under a name; the other arguments are those of the class.

    Raises:
        DocumentError: the name is unknown, or a parameter does not fit.

    """
    return named(name)(problem, keys, parameters, groups=groups)


def named(name: str) -> type[DecisionStrategy]:
    """Return the class registered under a name, or one's own `module:class`; DocumentError lists the known names."""
    if is_import(name):
        found = imported(name, "strategy")
        if not (isinstance(found, type) and issubclass(found, DecisionStrategy)):
            raise DocumentError(f"strategy {name}: expected a subclass of DecisionStrategy, got {found!r}")
        guard(found)
        return found
    try:
        return STRATEGIES.find(name)
    except UnknownNameError as error:
        raise DocumentError(str(error)) from error
