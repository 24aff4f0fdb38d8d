"""What a policy loses that writes what it thinks as a knowledge file, which `MaxScore` uses."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

from pydantic import Field

from clean_swarm_env.config.types import Scenarios
from docs.comparison.running import run
from selector.documents.fields import Closed, Name
from selector.knowledge import load_knowledge
from train.analysis.family_report import excesses_of
from train.analysis.intervals import Ratio
from train.deciders.named import FIXED
from train.evaluation.claims import family_runs
from train.evaluation.entrants import RANDOM
from train.reports.text_table import interval_cell, markdown_table

BY_SCORE = "MaxScore"
"""The strategy that uses the file."""


class Thoughts(Closed):
    """A policy that writes what it thinks, and where the file is judged beside it."""

    policy: str
    """The policy, as `--strategy` takes it."""
    goal: Name
    """Its goal."""
    family: Name
    """Family on whose training missions it decides."""
    training: Scenarios
    """Number of these missions."""
    situations: tuple[Name, ...]
    """Components of the observation; the largest tells a robot's situation."""
    families: Annotated[tuple[Name, ...], Field(min_length=1)]
    """Families on which it is judged."""
    judged: Scenarios
    """Number of test scenarios of each."""
    seed: int
    """Seed of all missions."""


def make_thoughts(thoughts: Thoughts, folder: Path) -> dict[str, str]:
    """Do what is missing in the directory of the results; return name -> table."""
    file = folder / "thoughts.yaml"
    if not file.exists():
        asked = ("--family", thoughts.family, "--scenarios", thoughts.training, "--seed", thoughts.seed)
        words = ("--situations", ",".join(thoughts.situations), *asked)
        run("learn", "knowledge", "from-policy", thoughts.policy, file, *words)
    known = load_knowledge(str(file))
    options = known.options(thoughts.goal)
    highest = max(options, key=lambda option: option.score).name
    excesses = {}
    for family in thoughts.families:
        strategies = [thoughts.policy, BY_SCORE, f"{FIXED}:{highest}"]
        words = [word for strategy in strategies for word in ("--strategy", strategy)]
        output, asked = folder / f"{family}-thoughts", ("--scenarios", thoughts.judged, "--seed", thoughts.seed)
        kept = ("--knowledge", file, "--output", output, "--resume")
        run("evaluate", "--family", family, "--goal", thoughts.goal, *words, *asked, *kept)
        found = excesses_of(family_runs(output))
        excesses[family] = {
            name: Ratio.of(own[0, :, 0], found[thoughts.policy][0, :, 0]) for name, own in found.items()
        }
    heads = ["excess / that of the policy", *(f"`{family}`" for family in thoughts.families)]
    shown = {
        f"`{BY_SCORE}` with its scores by situation": BY_SCORE,
        f"its highest score over all, {highest}": f"{FIXED}:{highest}",
        f"`{RANDOM}`": RANDOM,
    }
    rows = [[text, *(_cell(own[name]) for own in excesses.values())] for text, name in shown.items()]
    return {"thoughts": _scores_table(known.situations[thoughts.goal]), "lost": markdown_table(heads, rows)}


def _scores_table(situations: Mapping[str, Mapping[str, float]]) -> str:
    """Return the scores of the options in each situation, the highest bold."""
    rows = []
    for situation, scores in situations.items():
        best = max(scores, key=lambda name: scores[name])
        rows.append([f"`{situation}`", *(f"**{x:.2f}**" if name == best else f"{x:.2f}" for name, x in scores.items())])
    return markdown_table(["largest component", *next(iter(situations.values()))], rows)


def _cell(ratio: Ratio) -> str:
    return f"{ratio.ratio:.3f} {interval_cell(ratio.ci95)}"
