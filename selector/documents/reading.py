"""Reading of YAML with errors of one line, and writing of YAML that is read back unchanged."""

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from selector.documents.errors import DocumentError, shown


class _Loader(yaml.SafeLoader):
    """A loader of YAML 1.1 with two changes: `1e-9` is a number, and a key given twice is an error."""

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
    """A writer of YAML that `_Loader` reads back unchanged: a text that looks like `1e-9` is quoted."""


for _resolves in (_Loader, _Dumper):
    _resolves.add_implicit_resolver(
        "tag:yaml.org,2002:float", re.compile(r"^[-+]?[0-9]+[eE][-+]?[0-9]+$"), list("-+0123456789")
    )


def read_mapping(path: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file; raises DocumentError."""
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
    """Return plain data as YAML text, which `read_mapping` reads back unchanged."""
    return yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)


def read_value(text: str) -> Any:  # noqa: ANN401  (whatever YAML holds)
    """Return the value of a piece of YAML from the command line; raises DocumentError."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.YAMLError as error:
        raise DocumentError(f"expected a value, got {text!r}") from error
