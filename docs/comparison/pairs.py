"""The table of strategies beside options of another goal: what they cost beside the best pair of two options."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from docs.comparison.manifest import Pairs
from docs.comparison.runs import pair_folder
from selector.documents.fields import JOINT
from selforg.arrays import Floats
from train.analysis.family_report import excesses_of
from train.deciders.named import FIXED
from train.evaluation.claims import Claim, claims_of, family_runs
from train.reports.text_table import markdown_table


def pairs_table(pairs: Pairs, folder: Path, shown: Callable[[Claim], str]) -> str:
    """Return a row for each family; `shown` writes a ratio."""
    excesses = {family: _excesses(pairs, folder, family) for family in pairs.best}
    labels = [option + JOINT + strategy for strategy, options in pairs.strategies.items() for option in options]
    claims = [{claim.family: claim for claim in claims_of(excesses, [label], pairs.best)} for label in labels]
    rows = [
        [f"`{family}`", best.replace(JOINT, ", "), f"{excesses[family][best].mean():.1f}"]
        + [shown(by_family[family]) for by_family in claims]
        for family, best in pairs.best.items()
    ]
    parts = [label.split(JOINT) for label in labels]
    columns = (f"`{strategy}`, {option} / best pair" for option, strategy in parts)
    return markdown_table(["family", "best pair", "its excess s", *columns], rows)


def _excesses(pairs: Pairs, folder: Path, family: str) -> dict[str, Floats]:
    """Return the excess costs (1, K, 1) of the best pair, and of each strategy with each option, of all seeds."""
    found: dict[str, list[Floats]] = {}
    for option in pairs.beside(family):
        for seed in pairs.seeds:
            for label, own in excesses_of(family_runs(pair_folder(folder, family, option, seed))).items():
                found.setdefault(option + JOINT + label.removeprefix(f"{FIXED}:"), []).append(own)
    return {label: np.concatenate(own, axis=1) for label, own in found.items()}
