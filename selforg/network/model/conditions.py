"""Conditions: a sensor with an activator, and compositions of conditions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from selforg.network.model.activators import Activator


@dataclass(frozen=True)
class Condition:
    """One sensor's reading, seen through an activator."""

    sensor: str
    activator: Activator


@dataclass(frozen=True)
class Negation:
    """Satisfaction 1 - s of a condition with satisfaction s, and its wishes reversed."""

    of: Tree


@dataclass(frozen=True, init=False)
class Conjunction:
    """The product of the satisfactions, and all wishes."""

    of: tuple[Tree, ...]

    def __init__(self, *of: Tree) -> None:
        object.__setattr__(self, "of", _at_least_one(of, "Conjunction"))


@dataclass(frozen=True, init=False)
class Disjunction:
    """The largest of the satisfactions, and all wishes."""

    of: tuple[Tree, ...]

    def __init__(self, *of: Tree) -> None:
        object.__setattr__(self, "of", _at_least_one(of, "Disjunction"))


@dataclass(frozen=True)
class Optional:
    """A precondition that adds its wishes, but counts neither for readiness nor for activation."""

    of: Tree


Tree: TypeAlias = Condition | Negation | Conjunction | Disjunction


@dataclass(frozen=True)
class Leaf:
    """One condition of a tree, with the direction its wish takes at every negation above it when nothing is wished."""

    condition: Condition
    directions: tuple[float, ...] = ()  # innermost negation first


def leaves(tree: Tree) -> list[Leaf]:
    """Return the conditions of `tree`, depth first, with the directions at the negations above them.

    A negation turns a zero wish into its reversed direction; where it stands above several conditions on one sensor,
    the direction of the last one counts for all of them (Q25 of the original, matched).
    """
    return [leaf for leaf, _ in _walk(tree)]


def _walk(tree: Tree) -> Iterator[tuple[Leaf, float]]:
    """Yield leaves with the directions so far, and the direction seen from here."""
    if isinstance(tree, Condition):
        yield Leaf(tree), tree.activator.direction
    elif isinstance(tree, Negation):
        below = list(_walk(tree.of))
        last = {leaf.condition.sensor: direction for leaf, direction in below}
        for leaf, _ in below:
            turned = -last[leaf.condition.sensor]
            yield Leaf(leaf.condition, (*leaf.directions, turned)), turned
    else:
        for branch in tree.of:
            yield from _walk(branch)


def _at_least_one(of: tuple[Tree, ...], what: str) -> tuple[Tree, ...]:
    if not of:
        raise ValueError(f"{what}: expected at least one condition, got none")
    return of
