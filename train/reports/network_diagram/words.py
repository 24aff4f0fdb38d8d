"""Text of conditions, effects and actions in a diagram."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from selforg.network.model.activators import Activator, Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, Optional, Tree

MINUS = "\N{MINUS SIGN}"


def condition_in_words(tree: Tree | Optional) -> str:
    """Return a condition as text, such as `not carrying` or `dist_dump: none at 0, full at 1`."""
    match tree:
        case Optional(of=of):
            return f"optional: {condition_in_words(of)}"
        case Condition(sensor=sensor, activator=activator):
            return _reading_in_words(sensor, activator)
        case Negation(of=Condition(sensor=sensor, activator=Boolean(desired=desired, low=0.0, high=1.0))):
            return _reading_in_words(sensor, Boolean(not desired))
        case Negation(of=of):
            return f"not ({condition_in_words(of)})"
        case Conjunction(of=parts):
            return " and ".join(_part_in_words(part) for part in parts)
        case Disjunction(of=parts):
            return " or ".join(_part_in_words(part) for part in parts)


def change_in_words(sensor: str, change: float) -> str:
    """Return an effect: the sensor and the signed change, such as `carrying +1`."""
    return f"{sensor} {'+' if change >= 0.0 else MINUS}{abs(change):g}"


def component_in_words(declared: Mapping[str, Any]) -> str:
    """Return the type of a component and the names to which it refers, such as `Move: avoidance`."""
    referred = [f"{value}" for key, value in declared.items() if key in ("mechanism", "target", "name", "call")]
    if "value" in declared:
        referred.append(f"= {_plain(declared['value'])}")
    kind = str(declared.get("type", ""))
    return f"{kind}: {' '.join(referred)}" if referred else kind


def option_in_words(name: str, score: float, parameters: Mapping[str, Any]) -> str:
    """Return an option of a coordinator with its score and parameters."""
    laid = ", ".join(f"{key} {_plain(value)}" for key, value in parameters.items())
    return f"{name}, score {score:g}" + (f": {laid}" if laid else "")


def _part_in_words(tree: Tree) -> str:
    text = condition_in_words(tree)
    return f"({text})" if isinstance(tree, Conjunction | Disjunction) and len(tree.of) > 1 else text


def _reading_in_words(sensor: str, activator: Activator) -> str:
    match activator:
        case Boolean(desired=desired):
            text = sensor if desired else f"not {sensor}"
        case Threshold(threshold=threshold, minimum=minimum):
            text = f"{sensor} \N{GREATER-THAN OR EQUAL TO} {threshold:g}"
            if not minimum:
                text = f"{sensor} \N{LESS-THAN OR EQUAL TO} {threshold:g}"
        case Linear(zero=zero, full=full):
            text = f"{sensor}: none at {zero:g}, full at {full:g}"
        case Greedy(maximise=maximise):
            text = f"{sensor} ever {'more' if maximise else 'less'}"
        case Equal(value=value):
            text = f"{sensor} = {value:g}"
        case _:  # an activator of a user's own class
            given = ", ".join(f"{f.name} {getattr(activator, f.name)}" for f in fields(activator))
            text = f"{sensor}: {type(activator).__name__}({given})"
    if (activator.low, activator.high) != (0.0, 1.0):
        text += f" ({activator.low:g} to {activator.high:g})"
    return text


def _plain(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value}"
