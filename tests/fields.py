"""The docstrings below the fields of a model, or below the parameters of a strategy.

Models do not read them: that would take a seventh of each start.
"""

import ast
import inspect
import textwrap
from itertools import pairwise
from typing import Any

LIBRARIES = ("pydantic.main", "abc", "builtins")


def descriptions(model: type[Any]) -> dict[str, str]:
    """Return what the docstring below each field says, empty without one."""
    found: dict[str, str] = {}
    for kind in reversed([kind for kind in model.__mro__ if kind.__module__ not in LIBRARIES]):  # the bases first
        (body,) = ast.parse(textwrap.dedent(inspect.getsource(kind))).body
        assert isinstance(body, ast.ClassDef)
        for field, text in pairwise(body.body):
            if isinstance(field, ast.AnnAssign) and isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
                found[ast.unparse(field.target)] = inspect.cleandoc(str(text.value.value))
    return {name: found.get(name, "") for name in getattr(model, "Parameters", model).model_fields}
