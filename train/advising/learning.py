"""A selector trained for the mission of an advice, which begins at what the advice says, and is judged as that was.

Trainings with several seeds run side by side. Validation chooses one of them; fresh starts judge it beside the best
that is held. It ships in the folder of the advice only if it is shown to be better.
"""

from __future__ import annotations

import shutil
from dataclasses import replace
from typing import Any

import numpy as np
from rich.console import Console

from clean_swarm_env.deciders.named import POLICY
from clean_swarm_env.world.task import task_class
from selector.documents.fields import JOINT
from selector.documents.reading import as_yaml
from selector.documents.writing import write_whole
from train.advising.evaluation import FAMILY, AdviceEvaluation
from train.advising.findings import shown_cheaper
from train.advising.report import Advice, times
from train.advising.rounds import seconds_of
from train.advising.scores import options_known
from train.analysis.family_report import ratio_of
from train.analysis.flips import ALPHA
from train.evaluation import pipeline
from train.evaluation.comparing import Comparing
from train.learning.config import TrainingConfig, load_training
from train.learning.ppo.training import POLICY_FOLDER
from train.learning.seeds import trained
from train.learning.session import check_installed
from train.learning.yardstick import mean_excess, validation_in
from train.request import Request
from train.running.commands import FINISHED
from train.running.engine import WorkerLost
from train.running.finished_runs import JOURNAL, runs_of

TRAINING, TRAININGS, JUDGED = "training.yaml", "training-{}", "judged"
TRAINING_SEEDS = (1, 2, 3)
TEMPLATE = "one"
"""Training that ships for all goals of cleaning, whose settings trainings of such missions have."""
OF_PPO = 0.4
"""Decisions of a training in the time in which missions without learning make one [-]."""
LEAST_DECISIONS, MOST_DECISIONS = 20_000, 5_000_000
"""Bounds of the decisions of a training."""
CHECKPOINTS = 4
LEAST_JUDGED = 40
"""Least number of starts that judge the selector."""
FRESH = 1
"""What is added to the seed of the advice for the starts that judge the selector."""


def train_selector(evaluation: AdviceEvaluation, minutes: float, console: Console) -> int:
    """Train a selector, judge it, print what came out, and return the exit code.

    Args:
        evaluation: the advice, which is published.
        minutes: time of processors for all trainings [min].
        console: shows what came out.

    """
    check_installed("ppo")
    folder, advice = evaluation.folder, evaluation.advice
    write_whole(folder / TRAINING, as_yaml(training_of(advice, minutes).model_dump(mode="json")).encode())
    words = ("clean-swarm", "train", "ppo", "--config", str(folder / TRAINING))
    training = Request(words[-1], directories=evaluation.directories, machine=evaluation.request.machine, words=words)
    folders = {seed: folder / TRAININGS.format(seed) for seed in TRAINING_SEEDS}
    try:
        seeds = trained(training, folders)
        done = {seed: found for seed in seeds if (found := validation_in(folders[seed])) is not None}
    except (KeyboardInterrupt, WorkerLost) as end:
        return evaluation.request.ended(end, folder, ": advice and trainings are kept")
    return _judge(advice, min(sorted(done), key=lambda seed: mean_excess(done[seed].learned)), console)


def training_of(advice: Advice, minutes: float) -> TrainingConfig:
    """Return the training of a selector that begins with the options of an advice."""
    evaluation, held = advice.evaluation, advice.held
    content: dict[str, Any] = {"ppo": {"learning_rate": 1e-3, "minibatch": 2048, "discount": 0.99, "entropy": 0.005}}
    if not task_class(evaluation.mission).measures:
        shared = load_training(TEMPLATE, "ppo").model_dump(mode="json", exclude_unset=True)
        content = {name: shared[name] for name in ("observation", "reward", "ppo")}
        content["ppo"]["running"] = [goal for goal in content["ppo"]["running"] if goal in held]
    several = [goal for goal, options in options_known(advice).items() if len(options) > 1]
    content["ppo"] |= {"start": {goal: held[goal] for goal in several}, "holds": dict.fromkeys(several, 8)}
    done, mission = advice.search.done.values(), evaluation.mission
    seconds, ticks = sum(map(seconds_of, done)), sum(one.result.ticks * one.result.robots for one in done)
    rate = OF_PPO * ticks / (mission.decision_period * mission.world.control_rate) / max(seconds, 1e-3)
    wanted = int(np.clip(60.0 * minutes * rate / len(TRAINING_SEEDS), LEAST_DECISIONS, MOST_DECISIONS))
    return TrainingConfig.model_validate(
        {
            "name": f"{evaluation.family.name}-selector",
            "description": f"A selector for {evaluation.family.name}, which begins with {' and '.join(held.values())}.",
            "tasks": [{"family": str((evaluation.folder / FAMILY).resolve()), "worlds": 16}],
            "goal": JOINT.join(several),
            "checkpoints": CHECKPOINTS,
            "decisions": wanted // CHECKPOINTS,
            "validation": {"scenarios": 16},
            **content,
        }
    )


def _judge(advice: Advice, seed: int, console: Console) -> int:
    """Judge the policy of a seed beside the best that is held; ship it if it is shown to be better."""
    evaluation, folder = advice.evaluation, advice.evaluation.folder
    policy = folder / TRAININGS.format(seed) / POLICY_FOLDER
    held, learned = advice.found.winner, f"{POLICY}:{policy.resolve()}"
    again = replace(
        evaluation.request,
        name=str(folder / FAMILY),
        strategies=(held, f"selector={learned}"),
        goal=evaluation.goal,
        seed=evaluation.request.seed + FRESH,
        scenarios=max(advice.found.starts, LEAST_JUDGED),
        knowledge=None,
        output=folder / JUDGED,
        resume=(folder / JUDGED).exists(),
    )
    judge = Comparing(again)
    if (code := pipeline.evaluate(judge, Console(quiet=True))) != FINISHED:
        return code
    runs = judge.runs(runs_of(folder / JUDGED / JOURNAL), {held: (held,), "selector": ("selector",)})
    left, ratio = runs.unfinished, ratio_of(runs, "selector", held)
    cost = f"The selector that was trained for it costs {times(ratio)} of that on {runs.scenarios} further starts"
    if left:
        cost += f", with {int(left['selector'].sum())} unfinished beside {int(left[held].sum())}"
    worse = ratio.p is not None and ratio.p < ALPHA and ratio.sign > 0.0
    told = f"it is {'worse' if worse else 'not shown to be worth it'}, and does not ship"
    if shown_cheaper(ratio, ratio.p):
        shutil.copytree(policy, folder / POLICY_FOLDER, dirs_exist_ok=True)
        told = f"it is worth it, and ships in {folder / POLICY_FOLDER}"
    console.print(f"{cost}: {told}.", soft_wrap=True)
    return FINISHED
