"""Trains a selector and others, compares them with every fixed choice, and writes docs/choosing.md.

`python -m docs.comparison.write_choosing [MANIFEST]`: MANIFEST is docs/comparison/choosing.yaml unless given. What
results/NAME holds already is kept. Tables of another manifest are printed. What has to hold is checked.
"""

import sys
from pathlib import Path

from docs.comparison.manifest import Manifest
from docs.comparison.runs import make
from docs.comparison.tables import Results
from docs.figures.update_readme import README, ROOT, put
from selector.documents.errors import validated
from selector.documents.reading import read_mapping

OWN = Path(__file__).with_name("choosing.yaml")
PAGE, CURVES = ROOT / "docs" / "choosing.md", ROOT / "docs" / "pictures" / "choosing.png"


def main(arguments: list[str]) -> int:
    """Make the page; return 1 if something does not hold."""
    given = Path(arguments[0]) if arguments else OWN
    manifest = validated(Manifest, read_mapping(given), str(given))
    folder = ROOT / "results" / manifest.name
    make(manifest, folder)
    results = Results(manifest, folder)
    wrong = results.broken()
    if given == OWN:
        text = PAGE.read_text(encoding="utf-8")
        for name, table in results.tables().items():
            text = put(text, name, table)
        text = put(text, "broken", "\n".join(f"- {line}." for line in wrong) or "Nothing.")
        PAGE.write_text(text, encoding="utf-8")
        README.write_text(put(README.read_text(encoding="utf-8"), "choosing", results.summary()), encoding="utf-8")
        results.draw_curves(CURVES)
    else:
        print("\n\n".join(results.tables().values()))
    for line in wrong:
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
