"""Races fixed choices, trains a selector and others, compares them, and writes a page such as docs/choosing.md.

`python -m docs.comparison.write_choosing [MANIFEST]`: MANIFEST is docs/comparison/choosing.yaml unless given. What
results/NAME holds already is kept. Tables of a manifest without a page are printed. What has to hold is checked.
"""

import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from docs.comparison.frequencies import frequencies_table
from docs.comparison.manifest import Manifest
from docs.comparison.runs import make
from docs.comparison.tables import Results
from docs.figures.stored import ROOT, record
from selector.documents.errors import validated
from selector.documents.reading import read_mapping

OWN = Path(__file__).resolve().with_name("choosing.yaml")
DOCS = ROOT / "docs"
COMMAND = "python -m docs.comparison.write_choosing"


def main(arguments: list[str]) -> int:
    """Make the page; return 1 if something does not hold."""
    given = Path(arguments[0]) if arguments else OWN
    manifest = validated(Manifest, read_mapping(given), str(given))
    folder = ROOT / "results" / manifest.name
    make(manifest, folder)
    results = Results(manifest, folder)
    wrong, tables = results.broken(), results.tables()
    if manifest.page:
        lost = "\n".join(f"- {line}." for line in wrong) or "Nothing."
        found = {**tables, "frequencies": frequencies_table(manifest, folder), "broken": lost}
        put_tables(manifest.name, found, COMMAND, inputs_of(given, manifest.families))
    else:
        print("\n\n".join(tables.values()))
    for line in wrong:
        print(line)
    return 1 if wrong else 0


def put_tables(name: str, tables: Mapping[str, str], command: str, inputs: Sequence[str]) -> None:
    """Record tables, each for its marks on the page of a name."""
    for mark, table in tables.items():
        record(f"{name}/{mark}", table, command, inputs)


def inputs_of(manifest: Path, families: Iterable[str]) -> list[str]:
    """Return the files that decide a comparison; they name all others."""
    shipped = [f"configs/families/{name}.yaml" for name in families]
    files = ["configs/robots/cleaning.yaml", *(name for name in shipped if (ROOT / name).exists())]
    return [manifest.resolve().relative_to(ROOT).as_posix(), *files]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
