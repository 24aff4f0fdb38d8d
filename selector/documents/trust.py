"""Names of code: what a user names may run, what only a file names may not.

Files come from strangers. Whoever imports code by its name or loads a model of another library asks `check_trust`
first. A command may run what stands on its command line, a Python program what it names itself; names in files are
refused, unless the user trusts the files (`--trust`, `trust=True`): then each is said in one line
(docs/decisions/0206-files-are-data.md).
"""

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace

from selector.documents.plain import DocumentError

FILED_KINDS = ("fixed", "policy", "learned", "fsm", "velocity")
"""Kinds of strategies whose names follow a colon; such a text is no `module:Class`."""

BASELINE = "baseline"
"""Kind of decider that has no name: the baseline of the task."""
FOREIGN_ENDINGS = (".zip", ".pt", ".onnx")
"""Endings of models of other libraries."""


@dataclass(frozen=True)
class Permission:
    """What a process may run; plain data, which worker processes get."""

    names: frozenset[str] | None = None
    """Names of code on the command line; None in a Python program, which may run all that no file names."""
    trusted: bool = False
    """Whether files may name code."""
    said: frozenset[str] = frozenset()
    """Names in trusted files that the user was informed of."""


_of_process = Permission()
_in_file: ContextVar[tuple[str, bool] | None] = ContextVar("_in_file", default=None)
"""The file that names come from, and whether it is trusted; None: from no file."""


def is_import(text: str) -> bool:
    """Return whether a text has the form of a name of the user's own code."""
    module, colon, name = text.rpartition(":")
    return bool(colon) and name.isidentifier() and (module.endswith(".py") or module.replace(".", "_").isidentifier())


def check_trust(name: str, deed: str, where: str = "", hint: str = "") -> str:
    """Return a name; DocumentError, which begins with `where`, if only a file asks for the `deed` it stands for.

    `hint`: what would allow this deed alone.
    """
    global _of_process
    in_file, named = _in_file.get(), _of_process.names
    if in_file is None if named is None else os.path.normpath(name) in named:
        return name
    file, trusted = in_file or ("", False)
    if not trusted and not _of_process.trusted:
        allows = f"{hint}--trust (trust=True in Python) allows what files ask for"
        raise DocumentError(f"{where}only a file asks to {deed}; {allows}")
    if name not in _of_process.said:
        sys.stderr.write(f"trusted: {file or 'a file'} asks to {deed}\n")
        _of_process = replace(_of_process, said=_of_process.said | {name})
    return name


@contextmanager
def reading_files(file: str = "", *, trust: bool = False) -> Iterator[None]:
    """Take what is read in this block as from files, which may name code only with `trust`, or within such a block."""
    outer, trusted = _in_file.get() or ("", False)
    token = _in_file.set((outer or file, trust or trusted))
    try:
        yield
    finally:
        _in_file.reset(token)


@contextmanager
def permitting(permission: Permission) -> Iterator[None]:
    """Let this process run what a permission allows, and nothing else, until the block ends."""
    global _of_process
    before, _of_process = _of_process, permission
    try:
        yield
    finally:
        _of_process = before


def current_permission() -> Permission:
    """Return the permission of this process, for its workers."""
    return replace(_of_process, trusted=_of_process.trusted or (_in_file.get() or ("", False))[1])


def permission_of(words: Sequence[str], *, trusted: bool) -> Permission:
    """Return the permission of a command with the given words.

    >>> sorted(permission_of(["mine=policy:a.zip+b.zip"], trusted=False).names & {"a.zip", "b.zip", "c.zip"})
    ['a.zip', 'b.zip']
    """
    texts = [word.split("=", k)[k] for word in words for k in range(word.count("=") + 1)]  # --option=LABEL=text
    pieces = [piece.split(":") for text in texts for piece in text.split("+")]
    heads = (piece if piece[0] not in FILED_KINDS else [":".join(piece[1:])] for piece in pieces)
    names = [":".join(head[: k + 1]) for head in heads for k in range(len(head))]
    names.extend(text for text in texts if "://" in text)
    return Permission(frozenset(map(os.path.normpath, filter(None, names))), trusted)
