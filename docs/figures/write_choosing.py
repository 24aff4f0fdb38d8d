"""Trains a selector, compares it with every fixed choice, and writes the tables of docs/choosing.md.

`python -m docs.figures.write_choosing [MANIFEST]`: MANIFEST is docs/figures/choosing.yaml unless given. What
results/NAME holds already is kept. The tables of another manifest are printed, and what has to hold is checked.
"""

import subprocess
import sys
from pathlib import Path

import yaml

from docs.figures.update_readme import put
from selector.documents.errors import validated
from selector.documents.fields import Closed, DocumentName, Name
from selector.documents.find import load_file
from selector.documents.reading import read_mapping
from train.analysis.claims import Claim
from train.analysis.family_report import excesses_of
from train.evaluation.claims import claims_over, family_runs
from train.learning.config import TrainingConfig

ROOT = Path(__file__).parents[2]
OWN, PAGE = Path(__file__).with_name("choosing.yaml"), ROOT / "docs" / "choosing.md"
SELECTOR, RULE, OFF, RANDOM = "selector", "fsm:finds", "fixed:Off", "Random"


class Manifest(Closed):
    """What is trained and compared."""

    name: Name
    """Directory of the results, below results/."""
    training: DocumentName
    """Name of the training."""
    checkpoints: int
    """Checkpoints of the training."""
    seeds: tuple[int, ...]
    """Seeds of the training."""
    trained: tuple[Name, ...]
    """Families of the training that are compared."""
    unseen: tuple[Name, ...] = ()
    """Families that no training saw."""
    scenarios: int
    """Test scenarios of each family."""
    headroom: tuple[Name, ...]
    """Families in which the selector has to be better than every fixed choice; in others not worse than `tolerance`."""
    tolerance: float = 1.02
    """Largest ratio on a control."""


def run(*words: object) -> None:
    """Run `clean-swarm` with `words`."""
    subprocess.run([sys.executable, "-c", "from train.cli import main; main()", *map(str, words)], cwd=ROOT, check=True)


def make(manifest: Manifest) -> Path:
    """Do what is missing of trainings and evaluations; return the directory of the results."""
    folder = ROOT / "results" / manifest.name
    folder.mkdir(parents=True, exist_ok=True)
    config = load_file("training", manifest.training, TrainingConfig)
    content = config.model_copy(update={"checkpoints": manifest.checkpoints}).model_dump(
        mode="json", exclude_unset=True
    )
    training = folder / f"{config.name}.yaml"
    training.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    for seed in manifest.seeds:
        output = folder / f"training-{seed}"
        run("train", config.learner, "--config", training, "--seed", seed, "--output", output, "--resume")
    policies = "+".join(str(folder / f"training-{seed}" / "policy") for seed in manifest.seeds)
    strategies = ("fixed", RULE, f"{SELECTOR}=policy:{policies}")
    words = [word for strategy in strategies for word in ("--strategy", strategy)]
    common = ("--goal", config.goal, *words, "--scenarios", manifest.scenarios, "--seed", 1, "--resume")
    for family in (*manifest.trained, *manifest.unseen):
        run("evaluate", "--family", family, *common, "--output", folder / family)
    return folder


def table_of(manifest: Manifest, folder: Path, claims: dict[str, Claim]) -> str:
    """Return the comparison as Markdown: a row for each family."""
    heads = ["family", "best of {} fixed choices", "excess s", "selector", "each training", "rule", "`Off`", "`Random`"]
    lines = []
    for family in (*manifest.trained, *manifest.unseen):
        runs = family_runs(folder / family)
        excesses = {label: values.mean(axis=(1, 2)) for label, values in excesses_of(runs).items()}
        claim = claims[family]
        best = float(excesses[claim.against].mean())
        each = ", ".join(f"{value / best:.3f}" for value in excesses[SELECTOR])
        others = [f"{excesses[label].mean() / best:.2f}" for label in (RULE, OFF, RANDOM)]
        low, high = claim.corrected
        own = f"**{claim.ratio:.3f}** [{low:.3f}, {high:.3f}]"
        cells = [f"`{family}`", claim.against.removeprefix("fixed:"), f"{best:.1f}", own, each, *others]
        lines.append("| " + " | ".join(cells) + " |")
        heads[1] = heads[1].format(len(runs.fixed))
    return "\n".join(["| " + " | ".join(heads) + " |", "|---|---|---:|---:|---:|---:|---:|---:|", *lines])


def broken(manifest: Manifest, claims: dict[str, Claim]) -> list[str]:
    """Return what does not hold."""
    bounds = {family: 1.0 if family in manifest.headroom else manifest.tolerance for family in claims}
    return [
        f"{family}: expected a ratio below {bounds[family]:g}, got {claim.ratio:.3f}"
        for family, claim in claims.items()
        if claim.ratio >= bounds[family]
    ]


def main(arguments: list[str]) -> int:
    """Make the tables; return 1 if something does not hold."""
    given = Path(arguments[0]) if arguments else OWN
    manifest = validated(Manifest, read_mapping(given), str(given))
    folder = make(manifest)
    families = [folder / family for family in (*manifest.trained, *manifest.unseen)]
    claims = {claim.family: claim for claim in claims_over(families, [SELECTOR], "")}
    table = table_of(manifest, folder, claims)
    print(table)
    if given == OWN:
        PAGE.write_text(put(PAGE.read_text(encoding="utf-8"), "choosing", table), encoding="utf-8")
    wrong = broken(manifest, claims)
    for line in wrong:
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
