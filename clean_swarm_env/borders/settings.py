"""Signatures that spell out the settings of borders."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, TypeVar, get_args, get_type_hints

Border = TypeVar("Border", bound=Callable[..., Any])


def spelled_out(function: Border) -> Border:
    """Make `help` show each of the settings of a function with `**settings: Unpack[...]`."""
    signature = inspect.signature(function)
    *parameters, last = signature.parameters.values()
    (settings,) = get_args(get_type_hints(function)[last.name])
    for name, hint in settings.__annotations__.items():
        text = hint.__forward_arg__
        default = None if text.endswith("None") else ...
        parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=text))
    vars(function)["__signature__"] = signature.replace(parameters=parameters)
    return function
