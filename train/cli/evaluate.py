"""`clean-swarm evaluate`: an experiment under all its conditions, or strategies on a family of scenarios."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import (
    MOST_SCENARIOS,
    MOST_SEED,
    MOST_WORKERS,
    MOST_WORLD_SEEDS,
    AnyBits,
    Configs,
    Force,
    Learn,
    OnPlace,
    Output,
    Resume,
    RunStore,
    Seed,
    ShareText,
    Workers,
    check_named,
    check_share,
    check_whole,
    error_console,
    wide_console,
)
from train.running.run_folder import RECORDINGS


def evaluate_command(
    experiment: Annotated[str, typer.Argument(help="Name of an experiment, or path to its YAML file.")] = "table1",
    scenarios: Annotated[
        int | None, typer.Option(help="Run on this number of random start configurations drawn from the seed.")
    ] = None,
    seed: Seed = 0,
    workers: Workers = None,
    output: Output = None,
    resume: Resume = False,
    starts: Annotated[Path | None, typer.Option(help="JSON file of start configurations to run on.")] = None,
    condition: Annotated[list[str] | None, typer.Option(help="Run this condition only; can be repeated.")] = None,
    family: Annotated[
        str | None, typer.Option(help="Compare strategies on scenarios of this family, by name or path.")
    ] = None,
    strategy: Annotated[
        list[str] | None,
        typer.Option(
            help="With --family: fixed (every option; the default), fixed:OPTION, fsm:NAME, policy:NAME, policy:FILE "
            "(a directory, .zip of Stable-Baselines3, .pt of TorchScript or .onnx), velocity:FILE (a model that "
            "drives), learned:NAME, learned:FILE, STRATEGY, STRATEGY:parameter=value or module:Class of your own; + "
            "joins what several training seeds gave, LABEL=... names it; can be repeated; Off and Random come beside.",
        ),
    ] = None,
    world_seeds: Annotated[
        int, typer.Option(help="With --family: world seeds of each scenario; the oracle needs two or more.")
    ] = 1,
    knowledge: Annotated[
        str | None, typer.Option(help="With --family: expert knowledge in place of the family's own.")
    ] = None,
    goal: Annotated[
        str | None,
        typer.Option(
            help="With --family: goal to decide on, or several joined by +; else AvoidCollision or the only one."
        ),
    ] = None,
    store: RunStore = None,
    learn: Learn = False,
    configs: Configs = None,
    force: Force = False,
    record: Annotated[bool, typer.Option("--record", help="Record every run, for `clean-swarm replay`.")] = False,
    minds: Annotated[bool, typer.Option("--minds", help="Record what the robots' networks decide, too.")] = False,
    share: ShareText = None,
    on: OnPlace = None,
    any_bits: AnyBits = False,
) -> None:
    """Run an experiment under all its conditions, or strategies on a family; the default is the paper's Table 1."""
    check_whole({"--scenarios": (scenarios, 1, MOST_SCENARIOS), "--workers": (workers, 1, MOST_WORKERS)})
    check_whole({"--seed": (seed, 0, MOST_SEED), "--world-seeds": (world_seeds, 1, MOST_WORLD_SEEDS)})
    check_share(share, output, learn=learn)
    if learn and workers not in (None, 1):
        raise ConfigurationError(f"--workers: expected 1 with --learn, where missions learn in turn, got {workers}")
    if learn and on is not None:
        raise ConfigurationError("--on: expected no --learn, where missions learn in turn")
    if family is None:
        check_named(configs, experiments=experiment)
        _check_absent(
            "with --family",
            {"--strategy": strategy, "--knowledge": knowledge, "--goal": goal, "--world-seeds": world_seeds > 1},
        )
    else:
        _check_absent("without --family", {"--starts": starts, "--condition": condition})
        check_named(configs, strategy, families=family, knowledge=knowledge)
    from clean_swarm_env.config.load import load_robustness
    from clean_swarm_env.recording.recorder import RecordSettings
    from train.cluster.bits import WorkerBits
    from train.cluster.chosen import chosen_engine
    from train.evaluation import pipeline  # imports SciPy, Numba and Matplotlib
    from train.evaluation.base import Evaluation
    from train.evaluation.entrants import never_taken, unlearned
    from train.evaluation.experiment import ExperimentEvaluation, ExperimentRequest
    from train.evaluation.family import FamilyEvaluation, FamilyRequest
    from train.evaluation.gathering import RunShare
    from train.evaluation.robustness import RobustnessEvaluation
    from train.knowledge_store import StoreRequest
    from train.running.needs import Machine
    from train.running.runs import usable_cpus

    directories, kept = tuple(configs or ()), StoreRequest(store, learn)
    untaught: list[str] = []
    machine = Machine(workers or usable_cpus(), force, on)
    robustness = load_robustness(experiment, directories) if family is None else None
    if robustness is not None:
        unused = {"--starts": starts, "--condition": condition, "--store": store, "--learn": learn}
        _check_absent("with experiments without disturbances", unused)
        asked = FamilyRequest(
            experiment, robustness.strategies, seed, scenarios, directories=directories, machine=machine
        )
        evaluation: Evaluation = RobustnessEvaluation(asked, robustness)
    elif family is None:
        conditions = tuple(condition or ())
        request = ExperimentRequest(experiment, seed, scenarios, starts, conditions, directories, kept, machine=machine)
        evaluation = ExperimentEvaluation(request)
        untaught = evaluation.unlearned
    else:
        strategies = tuple(strategy or ("fixed",))
        family_request = FamilyRequest(
            family, strategies, seed, scenarios, knowledge, goal, directories, kept, machine=machine, worlds=world_seeds
        )
        evaluation = FamilyEvaluation(family_request)
        untaught = unlearned(evaluation.entrants, directories)
        for label, missing in never_taken(evaluation.entrants, evaluation.options, directories).items():
            words = f"never takes {', '.join(missing)}, which it was trained without"
            error_console().print(f"{label}: {words}", markup=False)
    for label in () if learn or store else untaught:
        words = "has learned nothing and learns nothing; --learn or `clean-swarm train bandit` teach it"
        error_console().print(f"{label}: {words}", markup=False)
    recorded = RecordSettings(Path(RECORDINGS), minds) if record or minds else None
    part, bits = RunShare.of_text(share) if share is not None else None, WorkerBits(mixed=any_bits)
    engine = chosen_engine(machine, bits)
    execution = pipeline.Execution(engine, output, resume, wide_console(), recorded, part, bits)
    raise typer.Exit(pipeline.evaluate(evaluation, execution))


def _check_absent(where: str, given: Mapping[str, object]) -> None:
    for name, value in given.items():
        if value:
            raise ConfigurationError(f"{name}: expected {where} only")
