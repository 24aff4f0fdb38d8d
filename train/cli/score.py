"""`clean-swarm score`: run the options of goals, and keep what they cost in a knowledge store."""

from typing import Annotated

import typer

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import (
    MOST_SCENARIOS,
    MOST_SEED,
    MOST_WORKERS,
    AnyBits,
    Configs,
    Force,
    OnPlace,
    Output,
    Resume,
    Seed,
    ShareText,
    Workers,
    check_share,
    check_whole,
    wide_console,
)
from train.running.exit_codes import FINISHED

Names = Annotated[
    list[str],
    typer.Argument(
        help="Families, experiments or tasks; a name is looked for in this order, a path is that of a family or an "
        "experiment.",
        metavar="FAMILY|EXPERIMENT|TASK...",
    ),
]


def score_command(
    names: Names,
    store: Annotated[
        str | None, typer.Option(help="URL or file of the knowledge store; the one of `knowledge` unless given.")
    ] = None,
    scenarios: Annotated[int | None, typer.Option(help="Missions of each option; as in the file unless given.")] = None,
    seed: Seed = 0,
    knowledge: Annotated[
        str | None, typer.Option(help="Expert knowledge of a family or a task, in place of its own.")
    ] = None,
    workers: Workers = None,
    output: Output = None,
    resume: Resume = False,
    share: ShareText = None,
    on: OnPlace = None,
    any_bits: AnyBits = False,
    force: Force = False,
    configs: Configs = None,
) -> None:
    """Run every option of each goal on the same scenarios and keep its scores, with their counts and spreads."""
    check_whole({"--scenarios": (scenarios, 1, MOST_SCENARIOS)})
    check_whole({"--workers": (workers, 1, MOST_WORKERS), "--seed": (seed, 0, MOST_SEED)})
    check_share(share, output)
    if output is not None and len(names) > 1:
        raise ConfigurationError(f"--output: expected one name, got {len(names)}")
    from train.cluster.bits import WorkerBits
    from train.cluster.chosen import chosen_engine
    from train.evaluation import pipeline  # imports SciPy, Numba and Matplotlib
    from train.evaluation.gathering import RunShare
    from train.evaluation.scoring import ScoreRequest, scored_missions
    from train.running.needs import Machine
    from train.running.runs import usable_cpus

    machine = Machine(workers or usable_cpus(), force, on)
    part, bits = RunShare.of_text(share) if share is not None else None, WorkerBits(mixed=any_bits)
    engine = chosen_engine(machine, bits)
    execution = pipeline.Execution(engine, output, resume, wide_console(), share=part, bits=bits)
    for name in names:
        request = ScoreRequest(name, store, scenarios, seed, knowledge, tuple(configs or ()), machine)
        for evaluation in scored_missions(request):
            code = pipeline.evaluate(evaluation, execution)
            if code != FINISHED:
                raise typer.Exit(code)
