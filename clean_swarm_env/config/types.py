"""Types that all models of the configuration share, and the error for what only its context makes impossible."""

from typing import Annotated

from pydantic import Field
from pydantic_core import PydanticCustomError

from selector.documents.fields import Number

Count = Annotated[int, Field(strict=True, ge=1)]
Index = Annotated[int, Field(strict=True, ge=0)]
Point = tuple[Number, Number]
Pose = tuple[Number, Number, Number]


def impossible(key: str, expected: str, given: object) -> PydanticCustomError:
    """Return the error for a value that only its context makes impossible, at the dotted `key` below the model."""
    message = "expected {expected}, got {given}"
    return PydanticCustomError("impossible", message, {"key": key, "expected": expected, "given": str(given)})
