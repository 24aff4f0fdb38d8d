"""What all checks share: a promise that is not kept becomes one line."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from selforg.plugins import broken
from selforg.registry import Registry


def expect(holds: object, owner: Any, part: str, what: str) -> None:  # noqa: ANN401  (a class or an object)
    """Raise PluginError, which names a part of a class, unless it keeps a promise."""
    if not holds:
        raise broken(owner, part, f"expected {what}")


def expect_same(one: Sequence[Any], other: Sequence[Any], owner: Any, part: str, what: str) -> None:  # noqa: ANN401
    """Raise PluginError unless arrays have the same bits as others."""
    for first, second in zip(one, other, strict=True):
        expect(np.array_equal(first, second), owner, part, f"{what}, got others")


def expect_registered(cls: Any, registry: Registry[Any]) -> None:  # noqa: ANN401  (anything may be given)
    """Raise PluginError unless a class is registered, which is how files find it."""
    expect(isinstance(cls, type), cls, "", f"a class of a {registry.kind}")
    expect(cls in list(registry), cls, "", f"to be registered as a {registry.kind}")
