"""Run folders: directories with the results of an evaluation or a training, and what their manifests say of the origin.

`identity` in `manifest.json` says which evaluation or training has the directory. A directory is used again only for
the same identity and only to resume. A directory with other files is refused and not changed.
"""

import hashlib
import json
import os
import platform
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from clean_swarm_env import __version__
from selector.documents.find import KINDS, all_files, files_of
from selector.documents.plain import DocumentError, short
from selector.documents.reading import read_json
from selector.documents.writing import remove_parts, write_whole

try:
    import fcntl
except ImportError:  # Windows: two commands on one directory are not noticed
    fcntl = None  # type: ignore[assignment]

MANIFEST = "manifest.json"
RESULTS_FORMAT = 1
"""Version of the files in a run folder, which the manifest has as `format`; one without it is taken as of this."""
MOST_STEM = 200
"""Length of the name of a directory; file systems allow 255, and a number may follow."""
RECORDINGS = "recordings"
"""Directory of the recordings below a run folder."""
LEARNED_BEFORE = "learned"
"""Key of the manifest for the knowledge at the beginning."""
COMMAND = "command"
"""Key of the manifest for the command as it was typed."""
CHOSEN_OPTIONS = "choices.jsonl"
"""File with the options that served each mission of an evaluation that learned."""
PACKAGES = ("numpy", "numba", "pymunk", "scipy", "pydantic")
"""Packages that every result depends on, beside ours."""
REMEDY = "give another --output, or remove the directory if nobody needs them"
"""What to do where a directory has the results of another command."""
GROWING = "conditions"
"""Key of the identity for a mapping that may get new entries each time; the manifest keeps all entries."""
FILES = "files"
"""Key of the identity for the fingerprints of files."""
FINGERPRINTED = ("knowledge", "mechanisms", "options", "robots")
"""Kinds of files on which a run depends, besides its configuration."""

Json = dict[str, Any]


class RunFolder:
    """A directory that belongs to one evaluation or one training.

    Args:
        path: the directory; a missing one is made.
        manifest: content of `manifest.json`, with the mapping `identity`.
        resume: whether to continue with the results in the directory, and with what their manifest says was known.

    Attributes:
        learned: goal -> option -> what was known of it from a knowledge store at the beginning.
        words: the command as it was typed at the beginning, for people.

    Raises:
        DocumentError: the directory has other files, or the same results without `resume`.

    """

    def __init__(self, path: Path, manifest: Mapping[str, Any], *, resume: bool) -> None:
        self.path = path
        plain: Json = json.loads(json.dumps(manifest, allow_nan=False))  # as it is read later, with lists for tuples
        content: Json = {"format": RESULTS_FORMAT, **plain}
        identity, self.learned = content["identity"], content.get(LEARNED_BEFORE, {})
        self.words: list[str] = content.get(COMMAND, [])
        if path.exists() and not path.is_dir():
            raise DocumentError(f"{path}: expected a directory for the results, got a file")
        if path.exists():
            remove_parts(path)
        if path.exists() and any(entry.name != RECORDINGS for entry in path.iterdir()):
            held = self._claimed(identity, resume=resume)
            self.learned, words = held.get(LEARNED_BEFORE, {}), held.get(COMMAND, [])
            self.words = list(map(str, words)) if isinstance(words, list) else []
            if GROWING not in identity:
                return
            identity[GROWING] = {**held["identity"][GROWING], **identity[GROWING]}
            content = {**held, **content, LEARNED_BEFORE: self.learned}
        self.write(MANIFEST, json.dumps(content, indent=2) + "\n")

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keep other commands from writing the directory; DocumentError if one does, but not for a killed one."""
        if fcntl is None:
            yield
            return
        number = os.open(self.path, os.O_RDONLY)
        try:
            try:
                fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise DocumentError(f"{self.path}: another command writes these results now") from error
            yield
        finally:
            os.close(number)

    def discard(self) -> None:
        """Remove the directory if it holds nothing but the manifest."""
        if [path.name for path in self.path.iterdir()] == [MANIFEST]:
            (self.path / MANIFEST).unlink()
            self.path.rmdir()

    def write(self, name: str, content: str | bytes) -> None:
        """Write a file of the directory whole: at any moment it has its old or its new content."""
        write_whole(self.path / name, content if isinstance(content, bytes) else content.encode())

    def _claimed(self, identity: Mapping[str, Any], *, resume: bool) -> Json:
        """Return the manifest there; DocumentError if its identity is not `identity`, or without `resume`."""
        try:
            held = read_manifest(self.path)
        except DocumentError as error:
            expected = "has other files; expected an empty or a new directory"
            raise DocumentError(f"{self.path}: {expected} ({error})") from error
        wanted = dict(identity)
        if GROWING in wanted and isinstance(kept := held["identity"].get(GROWING), dict):
            wanted[GROWING] = {name: wanted[GROWING].get(name, known) for name, known in kept.items()}
        if FILES in wanted:
            wanted[FILES] = held_files(held["identity"].get(FILES), wanted[FILES])
        different = _difference(held["identity"], wanted)
        if different:
            raise DocumentError(f"{self.path}: has other results: {different}; {REMEDY}")
        if not resume:
            raise DocumentError(f"{self.path}: has these results already; give --resume or another --output")
        return held


def default_directory(stem: str, *, resume: bool, root: Path = Path("results")) -> Path:
    """Return the first of root/<stem>, <stem>-2, <stem>-3, ... that is free; to resume, the last that exists."""
    stem = stem[:MOST_STEM]
    taken, number = None, 1
    while (candidate := root / (stem if number == 1 else f"{stem}-{number}")).exists():
        taken, number = candidate, number + 1
    return taken if resume and taken is not None else candidate


def read_manifest(directory: Path) -> Json:
    """Return the content of `manifest.json` in a directory.

    Raises:
        DocumentError: there is no such directory, no manifest in it, or one of another format.

    """
    if not directory.is_dir():
        found = "expected a directory of results, got a file" if directory.exists() else "no such directory"
        raise DocumentError(f"{directory}: {found}")
    path = directory / MANIFEST
    if not path.exists():
        raise DocumentError(f"{directory}: has no {MANIFEST}; expected the results of an evaluation")
    content: Json = read_json(path)
    if not isinstance(content.get("identity"), dict):
        raise DocumentError(f"{path}: expected the manifest of an evaluation")
    if (held := content.get("format", RESULTS_FORMAT)) != RESULTS_FORMAT:
        by = "use the Clean Swarm that wrote it"
        raise DocumentError(f"{path}: format: expected {RESULTS_FORMAT}, got {short(held)}; {by}")
    from selector.knowledge import learned_from  # imports pydantic and NumPy

    learned_from(content.get(LEARNED_BEFORE, {}), f"{path}: {LEARNED_BEFORE}")
    return content


def _difference(held: object, wanted: object, key: str = "") -> str:
    """Return the first difference as `key: expected wanted, got held`; empty without any."""
    if isinstance(held, dict) and isinstance(wanted, dict):
        for name in sorted(held.keys() | wanted.keys()):
            found = _difference(held.get(name), wanted.get(name), f"{key}.{name}" if key else name)
            if found:
                return found
        return ""
    if held == wanted:
        return ""
    lists = isinstance(held, list) or isinstance(wanted, list)
    return f"{key} differ" if lists else f"{key}: expected {wanted!r}, got {held!r}"


def versions(more: Sequence[str] = (), needed_by: str = "results need", extra: str = "") -> dict[str, str]:
    """Return the versions of Python, of our packages and those that every result depends on, and of `more` packages.

    Raises:
        DocumentError: a package is not installed, which the `extra` has if there is one; `needed_by` begins the text.

    """
    try:
        others = {name: version(name) for name in (*PACKAGES, *more)}
        return {"python": platform.python_version(), "clean-swarm": __version__, **others}
    except PackageNotFoundError as error:
        install = "pip install -c constraints.txt " + (f"'.[{extra}]'" if extra else ".")
        raise DocumentError(f"{needed_by} {error.name}, which is not installed: {install}") from error


def fingerprints(directories: Sequence[Path] = ()) -> dict[str, str]:
    """Return kind/name -> SHA-256 of the fingerprinted files: for each name of what is found by it."""
    found = {
        f"{kind}/{name}.yaml": all_files(kind, name, directories) if KINDS[kind].adds_up else [path]
        for kind in FINGERPRINTED
        for name, path in files_of(kind, directories).items()
    }
    contents = {name: b"".join(path.read_bytes() for path in paths) for name, paths in found.items()}
    return {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}


def held_files(held: object, now: Mapping[str, str]) -> dict[str, str]:
    """Return the fingerprints that a manifest holds, as they are now; a file that was added since decides nothing."""
    return {name: now[name] for name in held if name in now} if isinstance(held, dict) else dict(now)
