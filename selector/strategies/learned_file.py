"""Files of learned strategies: saved, checked against another strategy, and loaded into it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from selector.documents.arrays import check_same_names, load_arrays, save_arrays
from selector.documents.errors import DocumentError, shown, validated, within
from selector.documents.fields import Closed, Name
from selector.knowledge import Definition, check_same
from selector.strategies.registry import StrategySpec
from selector.strategies.strategy import DecisionStrategy

VERSION = 1


class LearnedDescription(Closed):
    """The strategy that wrote a file; stands beside the arrays."""

    kind: Literal["clean-swarm strategy"] = "clean-swarm strategy"
    """Kind of the file."""
    version: int = VERSION
    """Version of this description."""
    strategy: Name
    """Name of the registered strategy."""
    parameters: dict[str, Any]
    """All parameters of the strategy."""
    goal: str
    """Name of the goal."""
    options: tuple[str, ...]
    """(O,) names of the options."""
    definitions: Mapping[Name, Mapping[Name, Definition]] = Field(default_factory=dict)
    """Goal -> option -> what the names stand for; none if nobody knows."""
    features: tuple[str, ...]
    """(F,) names of the features of a context."""

    @property
    def spec(self) -> StrategySpec:
        """The strategy with its parameters."""
        return validated(StrategySpec, {"name": self.strategy, "parameters": self.parameters}, "strategy")


def save_strategy(path: Path, strategy: DecisionStrategy) -> None:
    """Write what a strategy has learned.

    Raises:
        DocumentError: the file cannot be written.

    """
    problem = strategy.problem
    description = LearnedDescription(
        strategy=type(strategy).__name__,
        parameters=strategy.parameters,
        goal=problem.goal,
        options=problem.options,
        definitions=problem.definitions,
        features=problem.features,
    )
    save_arrays(path, strategy.learned(), description.model_dump(mode="json"))


def load_strategy(path: Path, strategy: DecisionStrategy) -> None:
    """Load what `save_strategy` wrote into a strategy.

    Raises:
        DocumentError: not such a file, or one of another strategy, parameters, options or features.

    """
    arrays, content = load_arrays(path)
    description = _described(content, shown(path))
    problem, where = strategy.problem, shown(path)
    own = {
        "strategy": type(strategy).__name__,
        "goal": problem.goal,
        "parameters": strategy.parameters,
    }
    for what, expected in own.items():
        got = getattr(description, what)
        if got != expected:
            raise DocumentError(f"{where}: {what}: expected {expected}, got {got}")
    sides = (("options", problem.options, description.options), ("features", problem.features, description.features))
    for what, wanted, held in sides:
        check_same_names(where, what, wanted, held)
        if wanted != held:
            expected = f"expected the order {', '.join(wanted)}"
            raise DocumentError(f"{where}: {what}: {expected}, got {', '.join(held)}")
    check_same(where, description.definitions, problem.definitions)
    with within(where):
        strategy.load_learned(arrays)


def description_of(path: Path) -> LearnedDescription:
    """Return which strategy wrote a file; DocumentError if it is not such a file, or a newer release wrote it."""
    return _described(load_arrays(path)[1], shown(path))


def _described(content: dict[str, Any], where: str) -> LearnedDescription:
    version = content.get("version")
    if isinstance(version, int) and version > VERSION:
        raise DocumentError(f"{where}: version: expected at most {VERSION}, got {version} from a newer release")
    description = validated(LearnedDescription, content, where)
    try:
        description.spec  # noqa: B018  (raises)
    except DocumentError as error:
        raise DocumentError(f"{where}: {error}; a newer release may have written it") from error
    return description
