"""One try for a family that no rule names: `python -m docs.comparison.hidden [--judge]` judges hidden.yaml.

What collisions do and cost is hidden there. The table stands in docs/families.md. Missions are kept in hidden.jsonl;
only those that it lacks are done, with `--judge` none. The machines of `train design` are kept in
docs/comparison/machines, with the command in hidden.yaml.
"""

import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from clean_swarm_env.deciders.named import FIXED
from docs.comparison.manifest import BEST, TOLD
from docs.comparison.write_choosing import asked_missions, inputs_of, put_tables
from docs.figures.stored import ROOT
from selforg.arrays import Floats
from train.analysis.intervals import Ratio
from train.analysis.strategy_comparison import BestFixed
from train.reports.text_table import interval_cell, markdown_table

OWN = Path(__file__).with_name("hidden.yaml")
FAMILY = "hidden"
DRAWN = OWN.with_name("families") / OWN.name


def main(arguments: list[str]) -> None:
    """Do the missions that are missing, and record the table."""
    _, manifest, file, found = asked_missions(arguments, OWN)
    labels = manifest.run_on(FAMILY)
    excesses = {label: np.array(found[FAMILY, label].excess_s)[None, :, None] for label in labels}
    best = BestFixed.of(excesses, [f"{FIXED}:{options}" for options in manifest.families[FAMILY].fixed])
    excesses[BEST] = best.judged(excesses)
    left = {label: len(found[FAMILY, label].unfinished or []) for label in labels}
    inputs = inputs_of(OWN, ()) + [path.resolve().relative_to(ROOT).as_posix() for path in (DRAWN, file)]
    put_tables("families", {FAMILY: against_told(excesses, left)}, "python -m docs.comparison.hidden", inputs)


def against_told(excesses: Mapping[str, Floats], left: Mapping[str, int]) -> str:
    """Return the table of mean excesses (1, K, 1) by label, beside the best pair and the told team, cheapest first."""
    rows = []
    for label, own in sorted(excesses.items(), key=lambda each: float(each[1].mean())):
        ratios = [Ratio.of(own, excesses[other]) for other in (BEST, TOLD)]
        cells = [f"{ratio.ratio:.3f} {interval_cell(ratio.ci95)}" for ratio in ratios]
        rows.append([f"`{label}`", f"{own.mean():.1f}", str(left.get(label, "")), *cells])
    return markdown_table(["strategy", "excess s", "unfinished", "/ best pair", "/ told"], rows)


if __name__ == "__main__":
    main(sys.argv[1:])
