"""`clean-swarm machine` and `gather`: compile everything before, scripts of job arrays, results of their shares."""

import shlex
import sys
from pathlib import Path
from time import process_time
from typing import Annotated

import typer

from selector.documents.plain import DocumentError as ConfigurationError
from train.cli.options import (
    MAY_NAME_CODE,
    AnyBits,
    EveryTable,
    FigureFile,
    check_figure,
    check_there,
    check_whole,
    error_console,
    wide_console,
)

EXPERIMENT, FAMILY = "table1", "crowded"
"""What is run: the experiment without batches, and the family with all options."""
TASK_SECONDS = 5.0
"""Simulated time of each task that is no cleaning [s]."""


def warm_command() -> None:
    """Compile everything once, into the cache that commands share; NUMBA_CACHE_DIR names another directory."""
    from clean_swarm_env.learning.warm_up import one_process  # imports Numba
    from selforg.compiler.cache import cache_directory

    directory, began = cache_directory(), process_time()
    if directory is None:
        expected = "no directory can be written or has room; NUMBA_CACHE_DIR names another one"
        raise ConfigurationError(f"machine warm: {expected}")
    with one_process():
        _compile_everything()
    size = sum(path.stat().st_size for path in directory.rglob("*") if path.is_file())
    typer.echo(f"compiled code: {size / 1e6:.0f} MB in {directory}, {process_time() - began:.1f} CPU s")


def _compile_everything() -> None:
    """Run the beginnings of missions under every option, and of all tasks: whatever they call is compiled and kept."""
    from train.evaluation.experiment import ExperimentEvaluation
    from train.evaluation.family import FamilyEvaluation
    from train.evaluation.task_run import TaskRun, run_task, tasks_to_run
    from train.request import Request

    batches = FamilyEvaluation(Request(FAMILY, ("fixed", "fsm:rule"), scenarios=1)).tasks({})
    single = ExperimentEvaluation(Request(EXPERIMENT, scenarios=1)).tasks({})
    for mission in (*batches, *single):
        mission.beginning().run()
    for task in tasks_to_run():
        run_task(TaskRun(task, scenarios=2, seconds=TASK_SECONDS))


MOST_SHARES = 10_000
SLURM = """\
#!/bin/sh
#SBATCH --job-name=clean-swarm
#SBATCH --array=1-{shares}
#SBATCH --requeue
{more}exec {program} {words} --workers "${{SLURM_CPUS_PER_TASK:-1}}" --share "$SLURM_ARRAY_TASK_ID/{shares}" --resume
"""
SHARED = (("evaluate",), ("study", "score"), ("study", "look-ahead"), ("study", "periods"))
"""Commands that can be done in shares."""

PASSED_ON = {"ignore_unknown_options": True, "allow_interspersed_args": False}
"""How click reads the words of the command in the script: not at all."""


def slurm_command(
    command: Annotated[
        list[str],
        typer.Argument(
            help="evaluate, study score, study look-ahead or study periods with its options, among them --output.",
            metavar="COMMAND...",
        ),
    ],
    shares: Annotated[int, typer.Option(help="Number of jobs of the array.")] = 10,
    sbatch: Annotated[
        list[str] | None,
        typer.Option(help="An option of sbatch, as --sbatch=--partition=short; can be repeated."),
    ] = None,
) -> None:
    """Print a job array for SLURM: each job does a share; one that is killed goes on when it is run again."""
    check_whole({"--shares": (shares, 1, MOST_SHARES)})
    if not any(tuple(command[: len(words)]) == words for words in SHARED):
        known = " or ".join(" ".join(words) for words in SHARED)
        raise ConfigurationError(f"machine slurm: expected {known}, got {' '.join(command[:2])}")
    if not any(word.partition("=")[0] == "--output" for word in command):
        raise ConfigurationError("machine slurm: expected a command with --output, the directory of all shares")
    more = "".join(f"#SBATCH {option}\n" for option in sbatch or ())
    program = f"{shlex.quote(sys.executable)} -m clean_swarm_env"
    typer.echo(SLURM.format(shares=shares, more=more, program=program, words=shlex.join(command)), nl=False)


def gather_command(
    directory: Annotated[Path, typer.Argument(help=f"The --output of the shares; {MAY_NAME_CODE}.", metavar="DIR")],
    store: Annotated[
        str | None, typer.Option(help="Knowledge store, by URL or path, that gets the scores of shares of `score`.")
    ] = None,
    any_bits: AnyBits = False,
    every_table: EveryTable = False,
    figure: FigureFile = None,
) -> None:
    """Merge the results of all shares, as if one command had done all runs: runs, tables, figure."""
    check_there(directory)
    from train.evaluation import pipeline  # imports SciPy, Numba and Matplotlib
    from train.evaluation.gathering import first_share, held_evaluation
    from train.memory import StoreRequest
    from train.request import Request
    from train.running.bits import WorkerBits
    from train.running.needs import Machine

    check_figure("--figure", figure)
    share, folder = first_share(directory)
    request = Request(
        str(directory),
        output=directory,
        resume=True,
        share=share,
        store=StoreRequest(store),
        machine=Machine(forced=True),
        bits=WorkerBits(mixed=any_bits),
        every_table=every_table,
        figure=figure,
    )
    evaluation = held_evaluation(request, folder)
    if evaluation.scored and store is None:
        error_console().print("the scores reach no store; `gather --store FILE` gives them to one", markup=False)
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))
