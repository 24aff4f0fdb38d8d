"""Lets strategies learn scores from mission after mission, and writes the tables and the picture of docs/scores.md.

`python -m docs.comparison.write_scores [MANIFEST]`: MANIFEST is docs/comparison/scores.yaml unless given. What
results/NAME holds already is kept.
"""

import sys
from pathlib import Path

from docs.comparison.loop import LoopManifest
from docs.comparison.loop_runs import make_loop
from docs.comparison.loop_tables import LoopResults
from docs.comparison.write_choosing import DOCS, inputs_of, put_tables
from docs.figures.stored import ROOT
from selector.documents.errors import validated
from selector.documents.reading import read_mapping

OWN = Path(__file__).resolve().with_name("scores.yaml")


def main(arguments: list[str]) -> None:
    """Make tables and picture."""
    given = Path(arguments[0]) if arguments else OWN
    manifest = validated(LoopManifest, read_mapping(given), str(given))
    folder = ROOT / "results" / manifest.name
    folder.mkdir(parents=True, exist_ok=True)
    results = LoopResults(manifest, {label: make_loop(manifest, label, folder) for label in manifest.families})
    inputs = [*inputs_of(given, manifest.families), *(one.file for one in manifest.families.values() if one.file)]
    put_tables(manifest.name, results.tables(), "python -m docs.comparison.write_scores", inputs)
    results.draw(DOCS / "pictures" / f"{manifest.name}-loop.png")


if __name__ == "__main__":
    main(sys.argv[1:])
