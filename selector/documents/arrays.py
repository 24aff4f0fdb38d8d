"""Files of named arrays with a description (safetensors): reading them runs no code, unlike pickled files."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import safetensors
import safetensors.numpy

from selector.documents.errors import DocumentError, shown
from selector.documents.reading import json_value
from selector.documents.writing import write_whole

Arrays = dict[str, npt.NDArray[Any]]
DESCRIPTION = "description"
"""Key of the file's metadata under which the description stands, as JSON."""


def save_arrays(path: Path, arrays: Mapping[str, npt.NDArray[Any]], description: Mapping[str, Any]) -> None:
    """Write arrays and a description, which JSON must be able to hold; the file is written whole or not at all."""
    contiguous = {name: np.ascontiguousarray(array) for name, array in arrays.items()}
    write_whole(path, safetensors.numpy.save(contiguous, {DESCRIPTION: json.dumps(description)}))


def load_arrays(path: Path) -> tuple[Arrays, dict[str, Any]]:
    """Return the arrays and the description in a file.

    Raises:
        DocumentError: no such file, or not one that `save_arrays` wrote.

    """
    try:
        with safetensors.safe_open(path, framework="numpy") as file:
            arrays = {name: np.array(file.get_tensor(name)) for name in file.keys()}  # noqa: SIM118  (not a mapping)
            text = (file.metadata() or {}).get(DESCRIPTION, "null")
    except (OSError, safetensors.SafetensorError, TypeError, ValueError, KeyError) as error:  # depends on the damage
        raise DocumentError(f"{shown(path)}: cannot be read ({error})") from error
    description = json_value(text, shown(path))
    if not isinstance(description, dict):
        raise DocumentError(f"{shown(path)}: expected a description of the file, got none")
    return arrays, description


def check_known(where: str, what: str, known: tuple[str, ...], used: tuple[str, ...]) -> None:
    """Raise DocumentError, which begins with `where`, for names of `what` that are `used` and not `known`."""
    extra = [name for name in used if name not in known]
    if extra:
        raise DocumentError(f"{where}: {what}: knows {', '.join(extra)}, which does not exist here")


def check_same_names(where: str, what: str, wanted: tuple[str, ...], held: tuple[str, ...]) -> None:
    """Raise DocumentError, which begins with `where`, for names of `what` that only one side has."""
    missing, extra = [name for name in wanted if name not in held], [name for name in held if name not in wanted]
    parts = [f"does not know {', '.join(missing)}"] if missing else []
    parts += [f"knows {', '.join(extra)}, which does not exist here"] if extra else []
    if parts:
        raise DocumentError(f"{where}: {what}: {'; '.join(parts)}")
