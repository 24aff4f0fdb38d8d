"""The store of all results, docs/figures.json, and the blocks of pages that are written from it.

A result is a block of a page between the marks `begin` and `end`, or sentences of its prose. Its id is the page and the
name of the block: `choosing/main`. What makes a result calls `record`.
"""

import hashlib
import json
import re
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from decimal import Decimal
from pathlib import Path
from typing import Any

from docs.figures.printed import NUMBER, Figure, parsed, shown
from selector.documents.reading import as_yaml, read_mapping
from selector.knowledge import load_knowledge

ROOT = Path(__file__).parents[2]
STORE = "docs/figures.json"
PLACES = {
    "mission": ("missions/{}.yaml",),
    "base": ("missions/{}.yaml", "robots/{}.yaml"),
    "knowledge": ("knowledge/{}.yaml",),
    "robot": ("robots/{}.yaml",),
    "document": ("robots/{}.yaml",),
    "configuration": ("mechanisms/{}.yaml",),
    "starts": ("starts/{}.yaml",),
    "family": ("families/{}.yaml",),
    "training": ("training/{}.yaml",),
    "fsm": ("machines/{}.yaml",),
    "policy": ("policies/{}/policy.json", "policies/{}/policy.safetensors"),
}
"""Key in a YAML file -> where in configs the file may lie that it names."""
NAMED = re.compile(rf"\b({'|'.join(PLACES)}): ?([\w.\-]+)")


@dataclass(frozen=True)
class Result:
    """One block of a page, or sentences of its prose.

    Attributes:
        command: makes it again; empty if all its figures are those of other results.
        commit: the commit at which it was made.
        inputs: paths and patterns of the repository's files that decide it; none if only code and machine do.
        fingerprint: of the contents of the inputs.
        layout: lines of the block, or sentences, with `{}` for each number.
        figures: in the order of their places.
        prose: whether it is sentences, which are looked for on the page, and not a block, which is written.
        of: ids of the results that have its figures; README quotes tables in this way.
        kept: why the figures stayed when inputs changed.

    """

    command: str = ""
    commit: str = ""
    inputs: tuple[str, ...] = ()
    fingerprint: str = ""
    layout: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    prose: bool = False
    of: tuple[str, ...] = ()
    kept: str = ""

    @property
    def text(self) -> str:
        """The block, or the sentences, as the page has it."""
        return shown(self.layout, self.figures)


Results = dict[str, Result]


def page_of(result_id: str) -> str:
    """Return the page of a result, relative to the root."""
    page = result_id.rpartition("/")[0] or result_id
    return "README.md" if page == "README" else f"docs/{page}.md"


def mark_of(result_id: str) -> str:
    """Return the name of a result's block; empty if a command of the packages writes the whole page."""
    return result_id.rpartition("/")[2] if "/" in result_id else ""


def put(text: str, name: str, block: str) -> str:
    """Return `text` with `block` between the marks of `name`; without a name the block is all of it."""
    before, _, after = parts(text, name)
    return before + block + after


def parts(text: str, name: str) -> tuple[str, str, str]:
    """Return a page up to a block, the block, and the rest."""
    if not name:
        return "", text.removesuffix("\n"), "\n"
    begin, end = f"<!-- begin: {name} -->\n", f"\n<!-- end: {name} -->"
    before, found, rest = text.partition(begin)
    block, ended, after = rest.partition(end)
    if not found or not ended:
        raise ValueError(f"expected the marks {begin.strip()} and {end.strip()}")
    return before + begin, block, end + after


def load(root: Path = ROOT) -> Results:
    """Return all results by id; numbers keep their digits."""
    text = (root / STORE).read_text(encoding="utf-8")
    read = json.loads(text, parse_float=Decimal, parse_int=Decimal, parse_constant=Decimal)
    return {result_id: _result(members) for result_id, members in read.items()}


def _result(members: Mapping[str, Any]) -> Result:
    lists = {name: tuple(members[name]) for name in ("inputs", "layout", "of") if name in members}
    return Result(**{**members, **lists, "figures": tuple(Figure.of(one) for one in members["figures"])})


def save(results: Mapping[str, Result], root: Path = ROOT) -> None:
    """Write all results, sorted by id, a line for each line of a page and for each figure."""
    written = []
    for result_id in sorted(results):
        members = {name: value for name, value in asdict(results[result_id]).items() if value and name != "figures"}
        lines = [f'  "{name}": {_json(value)},' for name, value in members.items()]
        figures = ",\n".join(f"    {figure.line()}" for figure in results[result_id].figures)
        written.append("\n".join([f" {json.dumps(result_id)}: {{", *lines, f'  "figures": [\n{figures}\n  ]', " }"]))
    (root / STORE).write_text("{\n" + ",\n".join(written) + "\n}\n", encoding="utf-8")


def _json(value: object) -> str:
    """Return a member of a result as JSON, several lines if it is a list of several."""
    if isinstance(value, tuple) and len(value) > 1:
        return "[\n" + ",\n".join(f"    {json.dumps(one, ensure_ascii=False)}" for one in value) + "\n  ]"
    return json.dumps(value, ensure_ascii=False)


def fingerprint(inputs: Iterable[str], root: Path = ROOT) -> str:
    """Return a digest of the files that patterns name, and of those that these name; empty if there are none."""
    digest, files = hashlib.sha256(), input_files(inputs, root)
    for path in files:
        content = content_of(path, root)
        digest.update(f"{path.relative_to(root).as_posix()} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:16] if files else ""


def input_files(inputs: Iterable[str], root: Path) -> list[Path]:
    """Return the files of patterns and, of YAML files, the missions, mechanisms and so on that they name.

    Pages (.md) decide nothing.
    """
    known, waiting = set[Path](), list[Path]()
    for pattern in inputs:
        matched = [path for path in root.glob(pattern) if path.is_file() and path.suffix != ".md"]
        if not matched:
            raise ValueError(f"expected a file or a pattern of files among the inputs, got {pattern}")
        waiting += matched
    while waiting:
        path = waiting.pop()
        if path in known:
            continue
        known.add(path)
        named = set(NAMED.findall(content_of(path, root).decode())) if path.suffix == ".yaml" else set()
        places = (place.format(name) for key, name in named for place in PLACES[key])
        waiting += [file for file in (root / "configs" / place for place in places) if file.is_file()]
    return sorted(known)


def content_of(path: Path, root: Path) -> bytes:
    """Return what a file decides: what YAML says, and of expert knowledge what the library says of its options."""
    if path.suffix != ".yaml":
        return path.read_bytes()
    if path.parent != root / "configs" / "knowledge":
        return as_yaml(read_mapping(path)).encode()
    known = load_knowledge(str(path), [root / "configs"])
    return as_yaml({goal: [one.model_dump() for one in known.options(goal)] for goal in known.goals}).encode()


def head_commit(root: Path = ROOT) -> str:
    """Return the commit that is checked out."""
    command = ["git", "rev-parse", "--short=12", "HEAD"]
    return subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout.strip()


def record(result_id: str, block: str, command: str = "", inputs: Sequence[str] = (), *, root: Path = ROOT) -> None:
    """Store a result that was just made, and write it into its page: what every command of a result calls.

    Args:
        result_id: page and name of the block, as `choosing/main`.
        block: the table, or other Markdown, with its numbers.
        command: what makes it; the stored one unless given.
        inputs: files that decide it; the stored ones unless given. They also count the files of configs that they name.
        root: directory of the checkout.

    """
    results = load(root)
    old = results.get(result_id, Result())
    layout, figures = parsed(block, every=old.prose)
    made = replace(old, layout=layout, figures=figures, kept="")
    if not old.of:
        command, inputs = command or old.command, tuple(inputs) or old.inputs
        if not command:
            raise ValueError(f"{result_id}: expected the command of a new result, got none")
        found = fingerprint(inputs, root)
        made = replace(made, command=command, commit=head_commit(root), inputs=inputs, fingerprint=found)
    if not made.prose:
        write_block(result_id, made, root)
    save({**results, result_id: made}, root)


def write_block(result_id: str, result: Result, root: Path = ROOT) -> None:
    """Write a block into its page."""
    page = root / page_of(result_id)
    text = page.read_text(encoding="utf-8")
    page.write_text(put(text, mark_of(result_id), result.text), encoding="utf-8")


def take(result_id: str, command: str = "", inputs: Sequence[str] = (), *, root: Path = ROOT) -> None:
    """Record what a page says: a block, or the numbers in the sentences of a result, that somebody changed by hand."""
    text = (root / page_of(result_id)).read_text(encoding="utf-8")
    old = load(root).get(result_id, Result())
    block = sentences(old.layout, text) if old.prose else parts(text, mark_of(result_id))[1]
    record(result_id, block, command, inputs, root=root)


def sentences(layout: Iterable[str], text: str) -> str:
    """Return the sentences of a layout as a page has them, with other numbers."""
    found, words = [], " ".join(text.split())
    for sentence in layout:
        pattern = re.sub(r"\\{:?,?\\}", lambda _: NUMBER, re.escape(" ".join(sentence.split())))
        places = [match[0] for match in re.finditer(pattern, words)]
        if len(places) != 1:
            raise ValueError(f"expected once in the prose, with any numbers, got {len(places)} times: {sentence}")
        found += places
    return "\n".join(found)


def keep(result_id: str, because: str, *, root: Path = ROOT) -> None:
    """Note why changed inputs do not change a result."""
    results = load(root)
    kept = results[result_id]
    save({**results, result_id: replace(kept, fingerprint=fingerprint(kept.inputs, root), kept=because)}, root)
