"""Texts of strategies, taken apart without importing what they name."""

from typing import Final

from selector.documents.trust import FILED_KINDS

BY_MODEL: Final = "models"
"""Kind of a decider that follows one for each model of robots."""
FILED: Final = FILED_KINDS[1:]
"""Kinds of deciders that name a file."""


def label_and_members(text: str) -> tuple[str | None, tuple[str, ...]]:
    """Return the label of a strategy, None without one, and what decides.

    `LABEL=...` names it; + joins files of several seeds of one training.
    """
    label, equals, rest = text.partition("=")
    if not equals or ":" in label:
        label, rest = "", text
    kind, _, names = rest.partition(":")
    members = tuple(f"{kind}:{name}" for name in names.split("+")) if kind in FILED else (rest,)
    return (label if rest != text else None), members
