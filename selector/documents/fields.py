"""Types of the fields of document models; they are strict: no type is converted to another."""

import os
import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    model_validator,
)

from selector.documents.errors import DocumentError, one_line, unknown_key
from selector.documents.plain import short

LARGEST_NUMBER = 1e9
"""Largest absolute value of any number; squares and products of such numbers are still exact to a millionth."""
SMALLEST = 1e-9
"""Smallest positive number; quotients of numbers within these bounds are finite."""
JOINT = "+"
"""What joins the names of several goals, and of their options."""
MOST_LETTERS = 100
"""Length of a name; names of files are made of several."""
MOST_STORED = 120
"""Length of a text in a knowledge store."""


def _not_tiny(number: float) -> float:
    if number < SMALLEST:
        raise ValueError(f"expected at least {SMALLEST:g}, got {number:g}")
    return number


Number = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LARGEST_NUMBER, le=LARGEST_NUMBER)]
NonNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=LARGEST_NUMBER)]
Positive = Annotated[
    float, Field(strict=True, allow_inf_nan=False, gt=0.0, le=LARGEST_NUMBER), AfterValidator(_not_tiny)
]
Share = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=1.0)]
Flag = Annotated[bool, Field(strict=True)]


def as_name(name: str) -> str:
    """Return a name; ValueError if it is none."""
    if not re.fullmatch(r"\w([\w\-. ]*\w)?", name) or len(name) > MOST_LETTERS:
        ends = "beginning and ending with a letter, a digit or _"
        raise ValueError(f"expected up to {MOST_LETTERS} letters, digits and -_. {ends}, got {short(name)}")
    return name


def _joint_name(text: str) -> str:
    return JOINT.join(as_name(name) for name in text.split(JOINT))


def _no_relative_path(text: str) -> str:
    return _no_controls(text) if os.path.isabs(text) else as_name(text)


def _no_controls(text: str) -> str:
    if not text.isprintable():
        raise ValueError(f"expected printable characters, got {short(text)}")
    return text


Name = Annotated[str, Field(strict=True, min_length=1), AfterValidator(as_name)]
"""Name of anything: letters, digits and `-_. `, so that it can stand in the name of a file, a table and a message."""
JointName = Annotated[str, Field(strict=True, min_length=1), AfterValidator(_joint_name)]
"""Names joined by `+`: of goals that are decided as one, or of their options."""
DocumentName = Annotated[str, Field(strict=True, min_length=1, max_length=1000), AfterValidator(_no_relative_path)]
"""Name of another document, or its absolute path; a relative path would depend on where the program was started."""
Label = Annotated[str, Field(strict=True, min_length=1, max_length=MOST_STORED), AfterValidator(_no_controls)]
"""Text that a knowledge store keeps: options and sources of programs other than ours."""
Context = Annotated[str, Field(strict=True, max_length=MOST_STORED), AfterValidator(_no_controls)]
"""Text under which a knowledge store keeps rewards; empty for none."""

_NAME: TypeAdapter[str] = TypeAdapter(Name)


def checked_name(given: object, where: str) -> str:
    """Return a name that no model checks; DocumentError, which begins with `where`, for anything else."""
    try:
        return _NAME.validate_python(given)
    except ValidationError as error:
        raise DocumentError(one_line(error, where)) from error


class Closed(BaseModel):
    """A frozen model that refuses unknown keys; the docstring below each field says what it is."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, given: Any) -> Any:  # noqa: ANN401  (whatever YAML holds)
        """Name the known keys beside an unknown one, which pydantic does not."""
        if isinstance(given, Mapping) and cls.model_config["extra"] == "forbid":
            for key in given:
                if key not in cls.model_fields:
                    raise unknown_key(str(key), cls.model_fields)
        return given
