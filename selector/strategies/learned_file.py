"""What a strategy learned, in a file: saved, checked against the strategy that takes it over, and taken over."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from selector.documents.arrays import Arrays, load_arrays, names_differ, save_arrays
from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import Closed, Name
from selector.documents.find import find_file
from selector.strategies.registry import StrategySpec
from selector.strategies.strategy import ROW_STATE, DecisionStrategy

VERSION = 1


class _Description(Closed):
    """What stands beside the arrays."""

    kind: Literal["clean-swarm strategy"] = "clean-swarm strategy"
    """Says what the file is."""
    version: int = VERSION
    """Version of this form."""
    strategy: Name
    """Name of the registered strategy."""
    parameters: dict[str, Any]
    """All its parameters."""
    goal: str
    """Name of the goal."""
    options: tuple[str, ...]
    """(O,) names of the options."""
    features: tuple[str, ...]
    """(F,) names of the features of a context."""


def save_strategy(path: Path, strategy: DecisionStrategy, *, whole: bool = False) -> None:
    """Write what a strategy learned; with `whole` also where its rows' randomness stands, to go on exactly.

    Raises:
        DocumentError: a place that cannot be written to.

    """
    problem = strategy.problem
    description = _Description(
        strategy=type(strategy).__name__,
        parameters=strategy.parameters.model_dump(mode="json"),
        goal=problem.goal,
        options=problem.options,
        features=problem.features,
    )
    arrays = strategy.state_dict() if whole else strategy.learned()
    save_arrays(path, arrays, description.model_dump(mode="json"))


def load_strategy(path: Path, strategy: DecisionStrategy, *, whole: bool = False) -> None:
    """Let a strategy take over what a file holds, all that `save_strategy` wrote with `whole`, else what was learned.

    Raises:
        DocumentError: not such a file, or one of another strategy, parameters, options or features; it says which.

    """
    arrays, description = _read(path)
    problem, where = strategy.problem, shown(path)
    own = {
        "strategy": type(strategy).__name__,
        "goal": problem.goal,
        "parameters": strategy.parameters.model_dump(mode="json"),
    }
    for what, expected in own.items():
        got = getattr(description, what)
        if got != expected:
            raise DocumentError(f"{where}: {what}: expected {expected}, got {got}")
    sides = (("options", problem.options, description.options), ("features", problem.features, description.features))
    for what, wanted, held in sides:
        line = names_differ(what, wanted, held)
        if line is None and wanted != held:
            line = f"{what}: expected the order {', '.join(wanted)}, got {', '.join(held)}"
        if line is not None:
            raise DocumentError(f"{where}: {line}")
    try:
        if whole:
            strategy.load_state(arrays)
        else:
            strategy.load_learned({name: array for name, array in arrays.items() if name not in ROW_STATE})
    except ValueError as error:
        raise DocumentError(f"{where}: {error}") from error


def find_strategy(name: str, directories: Sequence[Path] = ()) -> Path:
    """Return the file of what a strategy learned: a path, or the name of one in `directories` or of one that ships.

    Raises:
        DocumentError: no such file.

    """
    return find_file("strategies", name, directories)


def spec_of(path: Path) -> StrategySpec:
    """Return the strategy, with its parameters, that wrote a file."""
    _, description = _read(path)
    return StrategySpec(name=description.strategy, parameters=description.parameters)


def features_of(path: Path) -> tuple[str, ...]:
    """Return the names of the features of a context that the strategy in a file was told of."""
    _, description = _read(path)
    return description.features


def _read(path: Path) -> tuple[Arrays, _Description]:
    arrays, content = load_arrays(path)
    version = content.get("version")
    if isinstance(version, int) and version > VERSION:
        raise DocumentError(f"{shown(path)}: version: expected at most {VERSION}, got {version} from a newer release")
    return arrays, validated(_Description, content, shown(path))
