"""Tries what came before with our terms, and writes tables.md beside this file.

`python -m docs.comparison.prior.write [--judge]`: missions are kept in prior.jsonl beside prior.yaml, and what the file
holds already is not done again; with `--judge` no mission is done.
"""

import sys
from collections.abc import Mapping
from pathlib import Path

from docs.comparison.prior.manifest import PriorManifest
from docs.comparison.prior.missions import do_missions, read_missions
from docs.comparison.prior.tables import PriorTables
from docs.comparison.write_choosing import JUDGE
from selector.documents.errors import validated
from selector.documents.reading import read_mapping

OWN = Path(__file__).resolve().with_name("prior.yaml")
TABLES = OWN.with_name("tables.md")
TITLES = {
    "correlation": "Output against the cost of coordination",
    "effort": "Robots that adjust their effort",
    "learned": "Robots that learn at meetings",
    "ablated": "Learning without a part",
}


def main(arguments: list[str]) -> None:
    """Make the tables."""
    manifest, file = validated(PriorManifest, read_mapping(OWN), str(OWN)), OWN.with_suffix(".jsonl")
    if JUDGE not in arguments:
        do_missions(manifest, file)
    TABLES.write_text(as_text(PriorTables(manifest, read_missions(file)).tables()), encoding="utf-8")


def as_text(tables: Mapping[str, str]) -> str:
    """Return the tables with a title each."""
    parts = [f"## {TITLES[name]}\n\n{table.strip()}" for name, table in tables.items()]
    return "\n\n".join(["# What came before, tried with our terms", *parts]) + "\n"


if __name__ == "__main__":
    main(sys.argv[1:])
