"""Parameters of classes: read from their constructors for documents and contract tests, and checked by these."""

import inspect
import math
from collections.abc import Collection
from functools import cache
from inspect import Parameter
from typing import Annotated, TypeAlias, get_args, get_type_hints

from selforg.plugins import broken

Finite: TypeAlias = Annotated[float, "finite"]
AtLeastZero: TypeAlias = Annotated[float, "finite", "at least 0"]
UpToOne: TypeAlias = Annotated[float, "from 0 to 1"]

REQUIRED = Parameter.empty
"""Default of a parameter that has none."""


@cache
def parameters_of(cls: type) -> dict[str, Parameter]:
    """Return the parameters of a constructor by name, including those of unpacked options (a TypedDict)."""
    found: dict[str, Parameter] = {}
    if cls.__init__ is object.__init__:  # type: ignore[misc]
        return found  # of a class without a constructor
    fields = "__dataclass_fields__" in vars(cls)  # of a dataclass: those of a base are named in the module of the base
    hints = get_type_hints(cls, include_extras=True) if fields else {}
    for name, parameter in inspect.signature(cls.__init__, eval_str=not fields).parameters.items():  # type: ignore[misc]
        if parameter.kind is Parameter.VAR_KEYWORD:
            if not (options := get_args(parameter.annotation)):
                expected = f"expected parameters by name, or **{name}: Unpack[...] of a TypedDict, got **{name} alone"
                raise broken(cls, "__init__", expected)
            found |= {
                option: Parameter(option, Parameter.KEYWORD_ONLY, default=None, annotation=hint)
                for option, hint in get_type_hints(options[0]).items()
                if option not in found
            }
        elif name != "self":
            found[name] = parameter.replace(annotation=hints.get(name, parameter.annotation))
    return found


def at_least(owner: object, name: str, value: float, lowest: float) -> float:
    """Return `value` if it is at least `lowest`; raises ValueError with its class and parameter otherwise (NaN too)."""
    if not value >= lowest:
        raise ValueError(f"{type(owner).__name__}: {name} must be at least {lowest}, got {value!r}")
    return float(value)


def positive(owner: object, name: str, value: float) -> float:
    """Return `value` if it is positive and finite; raises ValueError with its class and parameter otherwise."""
    if not 0.0 < value < math.inf:
        raise ValueError(f"{type(owner).__name__}: {name} must be positive and finite, got {value!r}")
    return float(value)


def check_choice(what: str, given: object, known: Collection[object]) -> None:
    """Raise ValueError, which begins with `what`, for something given that is not one of the `known`."""
    if given not in known:
        raise ValueError(f"{what} must be one of {', '.join(map(str, known))}, got {given!r}")
