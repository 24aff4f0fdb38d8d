"""Races fixed choices, trains a selector and others, compares them, and writes a page such as docs/choosing.md.

`python -m docs.comparison.write_choosing [MANIFEST]`: MANIFEST is docs/comparison/choosing.yaml unless given. What
results/NAME holds already is kept. Tables of a manifest without a page are printed. What has to hold is checked.
"""

import sys
from collections.abc import Mapping
from pathlib import Path

from docs.comparison.frequencies import frequencies_table
from docs.comparison.manifest import Manifest
from docs.comparison.runs import make
from docs.comparison.tables import Results
from docs.figures.update_results import ROOT, put
from selector.documents.errors import validated
from selector.documents.reading import read_mapping

OWN = Path(__file__).resolve().with_name("choosing.yaml")
DOCS = ROOT / "docs"


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
        put_tables(manifest.name, {**tables, "frequencies": frequencies_table(manifest, folder), "broken": lost})
    else:
        print("\n\n".join(tables.values()))
    for line in wrong:
        print(line)
    return 1 if wrong else 0


def put_tables(name: str, tables: Mapping[str, str]) -> None:
    """Put tables between their marks on the page of a name."""
    page = DOCS / f"{name}.md"
    text = page.read_text(encoding="utf-8")
    for mark, table in tables.items():
        text = put(text, mark, table)
    page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
