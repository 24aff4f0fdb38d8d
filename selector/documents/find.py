"""Find files of every kind, by name or by path, in the user's directories and in the shipped one.

A directory of configurations holds one folder for each kind of file, `KINDS`. The given directories are searched in
order, the shipped one and the folders of plug-ins last: a file in an earlier directory hides one of the same name in a
later one. No file of a plug-in has the name of one that ships. Files of a kind that `adds_up` hide nothing.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from selector.documents.plain import DocumentError, shown
from selector.documents.reading import read_mapping
from selforg.plugins import folders
from selforg.registry import unknown

if TYPE_CHECKING:
    from selector.documents.errors import M

SHIPPED = Path(__file__).resolve().parents[2] / "configs"
"""The directory of the shipped files, beside this package in a checkout and in an installed wheel."""


@dataclass(frozen=True)
class FileKind:
    """A kind of file in a directory of configurations.

    Attributes:
        called: how errors call a file of this kind.
        ending: text that follows the name of each file.
        adds_up: whether files of one name in several directories count together.

    """

    called: str
    ending: str = ".yaml"
    adds_up: bool = False


KINDS = {
    "experiments": FileKind("experiment"),
    "families": FileKind("family"),
    "knowledge": FileKind("expert knowledge"),
    "machines": FileKind("machine"),
    "mechanisms": FileKind("configuration"),
    "missions": FileKind("mission"),
    "options": FileKind("set of options", adds_up=True),
    "policies": FileKind("policy", "/policy.json"),
    "robots": FileKind("robot"),
    "starts": FileKind("set of start configurations"),
    "strategies": FileKind("learned strategy", ".safetensors"),
    "training": FileKind("training"),
}
"""Folder of a directory of configurations -> the kind of file that it holds."""


def find_file(kind: str, name: str, directories: Sequence[Path] = (), where: str = "") -> Path:
    """Return the file of a kind by its name, or by its path.

    Args:
        kind: one of `KINDS`.
        name: name of the file in its folder, without ending; or a path, which has a separator or the ending. A policy's
            path is that of its directory.
        directories: searched before the shipped directory.
        where: first words of the text of an error.

    Raises:
        DocumentError: there is no such file or directory.

    """
    given = _path(kind, name)
    if given is not None:
        folder = os.path.isdir(given)  # as of an advice; it is quiet about paths that no file can have
        file = given / f"{kind}{KINDS[kind].ending}" if folder else given
        if not os.path.isfile(file):
            told = f"expected a file, or a folder with {file.name}, got one without" if folder else "no such file"
            raise DocumentError(f"{where}{name}: {told}")
        return file
    found = files_of(kind, directories)
    if name not in found:
        ending = KINDS[kind].ending
        besides = f", and no directory with a {ending[1:]}" if ending.startswith("/") else ""
        raise DocumentError(where + unknown(KINDS[kind].called, name, tuple(found)) + besides)
    return found[name]


def files_of(kind: str, directories: Sequence[Path] = ()) -> dict[str, Path]:
    """Return name -> file for all files of a kind, in the order of their names."""
    for root in directories:
        if not root.is_dir():
            raise DocumentError(f"{root}: no such directory")
    found = _files_in(SHIPPED, kind)
    for folder, origin in folders().items():
        own = _files_in(folder, kind)
        for name in () if KINDS[kind].adds_up else found.keys() & own.keys():
            taken = f"the {KINDS[kind].called} {name!r} exists already: {found[name]}"
            raise DocumentError(f"{origin}: {own[name]}: {taken}")
        found |= own
    for root in reversed(directories):
        found |= _files_in(root, kind)
    return dict(sorted(found.items()))


def all_files(kind: str, name: str, directories: Sequence[Path] = ()) -> list[Path]:
    """Return the files of a kind and a name in all directories: the shipped one, those of plug-ins, the user's."""
    roots = (SHIPPED, *folders(), *reversed(directories))
    return [path for root in roots if (path := root / kind / (name + KINDS[kind].ending)).is_file()]


def file_origins(kind: str) -> dict[str, str]:
    """Return the names of the files of a kind that plug-ins have brought, each with its origin."""
    return {name: origin for folder, origin in folders().items() for name in _files_in(folder, kind)}


def _files_in(root: Path, kind: str) -> dict[str, Path]:
    """Return name -> file for the files of a kind in one directory of configurations."""
    folder, ending = root / kind, KINDS[kind].ending
    return {path.relative_to(folder).as_posix().removesuffix(ending): path for path in folder.glob(f"*{ending}")}


def load_file(kind: str, name: str, model: "type[M]", directories: Sequence[Path] = (), where: str = "") -> "M":
    """Return the content of a YAML file as a model; the arguments are those of `find_file`.

    Raises:
        DocumentError: there is no such file, or it has a mistake.

    """
    from selector.documents.errors import validated  # imports pydantic

    path = find_file(kind, name, directories, where)
    return validated(model, read_mapping(path), shown(path))


def is_path(kind: str, name: str) -> bool:
    """Return whether `name` is the path of a file of a kind, rather than its name."""
    return _path(kind, name) is not None


def _path(kind: str, name: str) -> Path | None:
    """Return `name` as a path; None if `name` is not a path but the name of a file in the folder of its kind."""
    ending = KINDS[kind].ending
    if ending.startswith("/"):
        path = Path(name + ending)
        return path if os.sep in name or os.path.isfile(path) else None
    endings = (".yaml", ".yml") if ending == ".yaml" else (ending,)
    return Path(name) if os.sep in name or name.endswith(endings) else None
