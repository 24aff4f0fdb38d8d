"""`clean-swarm machine slurm`: a script that does an evaluation in shares on a cluster."""

import shlex
import sys
from typing import Annotated

import typer

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import check_whole

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
