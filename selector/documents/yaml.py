"""Read the YAML files of this package: by name from directories, checked by closed models, errors of one line.

A directory of configurations holds `knowledge/` and `mechanisms/`; the given directories are searched in order, the
shipped one last. Whatever is wrong raises `DocumentError`: file, key, what was expected and what was given.
"""

import difflib
import os
import re
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

import configs

M = TypeVar("M", bound=BaseModel)
MAX_SHOWN = 60
"""Characters of a given value that an error shows."""

KINDS = {"knowledge": "expert knowledge", "mechanisms": "configuration", "robots": "robot"}
"""Directory of a kind of file -> what one of them is called."""

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0.0)]
Share = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=1.0)]
Name = Annotated[str, Field(strict=True, min_length=1)]
Flag = Annotated[bool, Field(strict=True)]


class DocumentError(ValueError):
    """A file, a key or a name that cannot be used; its message is one line for the user."""


class Closed(BaseModel):
    """A frozen model without unknown keys; the text below each field is its description."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


class _Loader(yaml.SafeLoader):
    """YAML 1.1 without two of its traps: `1e-9` is a number, and a key given twice is an error."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        """Return the mapping of `node`; a key given twice raises ConstructorError."""
        seen = set()
        for key_node, _ in node.value:
            if key_node.value in seen:
                mark = key_node.start_mark
                raise yaml.constructor.ConstructorError(None, None, f"key {key_node.value!r} twice", mark)
            seen.add(key_node.value)
        return super().construct_mapping(node, deep)


class _Dumper(yaml.SafeDumper):
    """Writes what `_Loader` reads back as it was: a text that looks like `1e-9` is quoted."""


for _resolves in (_Loader, _Dumper):
    _resolves.add_implicit_resolver(
        "tag:yaml.org,2002:float", re.compile(r"^[-+]?[0-9]+[eE][-+]?[0-9]+$"), list("-+0123456789")
    )


def roots(directories: Sequence[Path]) -> list[Path]:
    """Return the directories in the order in which they are searched, the shipped one last."""
    for directory in directories:
        if not directory.is_dir():
            raise DocumentError(f"{directory}: no such directory")
    return [*directories, configs.directory()]


def find_file(kind: str, name: str, directories: Sequence[Path] = ()) -> Path:
    """Return the file `kind/NAME.yaml` of the first directory that holds it; an unknown one is a DocumentError."""
    searched = roots(directories)
    for root in searched:
        path = root / kind / f"{name}.yaml"
        if path.is_file():
            return path
    known = sorted({path.stem for root in searched for path in (root / kind).glob("*.yaml")})
    raise DocumentError(unknown(KINDS.get(kind, kind), name, known))


def read_mapping(path: Path) -> dict[str, Any]:
    """Return the mapping that a YAML file holds."""
    try:
        content = yaml.load(path.read_text(encoding="utf-8"), Loader=_Loader)
    except (OSError, UnicodeDecodeError) as error:
        raise DocumentError(f"{shown(path)}: cannot be read ({error})") from error
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise DocumentError(f"{shown(path)}: line {line}: {error.problem}") from error
    except yaml.YAMLError as error:
        raise DocumentError(f"{shown(path)}: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict) or not all(isinstance(key, str) for key in content):
        raise DocumentError(f"{shown(path)}: expected a mapping of keys, got {type(content).__name__}")
    return content


def as_yaml(content: object) -> str:
    """Return what `read_mapping` reads back from a file that holds it."""
    return yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)


def read_value(text: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return the value that a piece of YAML on the command line holds; raises DocumentError."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.YAMLError as error:
        raise DocumentError(f"expected a value, got {text!r}") from error


def validated(model: type[M], content: object, where: str) -> M:
    """Return `content` as a model; the first mistake becomes one line `where: key: what is wrong`."""
    try:
        return model.model_validate(content)
    except ValidationError as error:
        # An unknown key often makes another one missing: it is the one to name.
        found = error.errors(include_url=False)
        first = next((details for details in found if details["type"] == "extra_forbidden"), found[0])
        key = ".".join(str(part) for part in first["loc"])
        raise DocumentError(f"{where}: {f'{key}: ' if key else ''}{_what(first['type'], first)}") from error


def unknown(what: str, name: str, known: Sequence[str]) -> str:
    """Return the line for an unknown `name`: what there is, and the nearest of it."""
    near = difflib.get_close_matches(name, known, n=1)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    return f"unknown {what} {name!r} (known: {', '.join(known) or 'none'}{hint})"


def shown(path: Path) -> str:
    """Return `path` as a user in the working directory would write it."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith("..") else relative


def _what(kind: str, details: Any) -> str:  # noqa: ANN401  (pydantic's details hold the given value as it is)
    if kind == "extra_forbidden":
        return "unknown key"
    if kind == "missing":
        return "missing key"
    if kind == "value_error":
        return str(details["ctx"]["error"])
    given = repr(details["input"])
    message = re.sub(r"^(Input should be|\w+ should have)", "expected", details["msg"])
    return f"{message}, got {given if len(given) <= MAX_SHOWN else given[:MAX_SHOWN] + '...'}"
