"""Named conditions of a robot document, which are put where their names stand."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from selector.documents.building import MOST_DEPTH
from selector.documents.errors import DocumentError
from selector.documents.parameters import Content
from selector.documents.plain import short
from selforg.registry import unknown

MOST_CONDITIONS = 2_000
"""Conditions of a network after names were replaced; the cleaning robot has 20."""


def known_conditions(content: Content, outside: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return the conditions that a network knows by name, its own and those of the networks around it."""
    own = content.get("conditions", {})
    if not isinstance(own, dict):
        raise DocumentError(f"{where}.conditions: expected a mapping, got {short(own)}")
    for name, condition in own.items():
        if name in outside and outside[name] != condition:
            raise DocumentError(f"{where}.conditions.{name}: means something else in a network around this one")
    return {**outside, **own}


@dataclass
class InPlace:
    """Replaces names of conditions in one network, up to a number of conditions.

    Attributes:
        named: the conditions by name.
        number: of conditions so far.

    """

    named: Mapping[str, Any]
    number: int = 0

    def content(self, content: Content, where: str) -> Content:
        """Return the content of a network with every name of a condition replaced by the condition."""
        filled = dict(content)
        for section, key in (("behaviours", "preconditions"), ("goals", "conditions")):
            parts = content.get(section)
            if isinstance(parts, dict):
                filled[section] = {
                    name: self._part(part, key, f"{where}.{section}.{name}.{key}") for name, part in parts.items()
                }
        own = content.get("conditions")
        if isinstance(own, dict):
            filled["conditions"] = {
                name: self._resolved(condition, f"{where}.conditions.{name}", (name,))
                for name, condition in own.items()
            }
        return filled

    def _part(self, part: Any, key: str, where: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
        if not (isinstance(part, dict) and isinstance(part.get(key), list)):
            return part
        return {**part, key: [self._resolved(condition, where) for condition in part[key]]}

    def _resolved(self, condition: Any, where: str, path: tuple[str, ...] = (), depth: int = 0) -> Any:  # noqa: ANN401
        """Return a condition with the names in it replaced; `path` are the named conditions around it."""
        self.number += 1
        if self.number > MOST_CONDITIONS:
            raise DocumentError(f"{where}: expected at most {MOST_CONDITIONS} conditions in all, got more")
        if depth > MOST_DEPTH:
            raise DocumentError(f"{where}: expected conditions in at most {MOST_DEPTH} others, got more")
        if isinstance(condition, str):
            if condition not in self.named:
                raise DocumentError(f"{where}: {unknown('condition', condition, sorted(self.named))}")
            if condition in path:
                circle = " > ".join((*path, condition))
                raise DocumentError(f"{where}: conditions must not contain each other: {circle}")
            return self._resolved(self.named[condition], where, (*path, condition), depth + 1)
        if isinstance(condition, dict) and "of" in condition:
            below = condition["of"]
            if isinstance(below, list):
                return {**condition, "of": [self._resolved(part, where, path, depth + 1) for part in below]}
            return {**condition, "of": self._resolved(below, where, path, depth + 1)}
        return condition
