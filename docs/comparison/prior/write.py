"""Tries what came before with our terms, and writes the tables of docs/compared.md.

`python -m docs.comparison.prior.write [--judge]`: missions are kept in prior.jsonl beside prior.yaml, and what the file
holds already is not done again; with `--judge` no mission is done.
"""

import sys
from pathlib import Path

from docs.comparison.prior.manifest import PriorManifest
from docs.comparison.prior.missions import do_missions, read_missions
from docs.comparison.prior.tables import PriorTables
from docs.comparison.write_choosing import JUDGE, put_tables
from docs.figures.stored import ROOT
from selector.documents.errors import validated
from selector.documents.reading import read_mapping

OWN = Path(__file__).resolve().with_name("prior.yaml")
PAGE = "compared"
COMMAND = "python -m docs.comparison.prior.write"


def main(arguments: list[str]) -> None:
    """Make the tables."""
    manifest, file = validated(PriorManifest, read_mapping(OWN), str(OWN)), OWN.with_suffix(".jsonl")
    if JUDGE not in arguments:
        do_missions(manifest, file)
    tables = PriorTables(manifest, read_missions(file))
    families = ["configs/families/random-bumpers.yaml", "configs/families/crowded.yaml"]
    own = [path.relative_to(ROOT).as_posix() for path in (OWN, file)]
    inputs = [*own, "docs/comparison/families/nest*.yaml", *families, "examples/conflicts.py"]
    put_tables(PAGE, tables.tables(), COMMAND, inputs)


if __name__ == "__main__":
    main(sys.argv[1:])
