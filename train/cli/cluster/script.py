"""`clean-swarm script`: scripts that do an evaluation in shares on a cluster."""

import shlex
import sys
from typing import Annotated

import typer

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import check_whole

MOST_SHARES = 10_000
SLURM = """\
#!/bin/sh
#SBATCH --job-name=clean-swarm
#SBATCH --array=1-{shares}
#SBATCH --requeue
{more}exec {program} {words} --workers "${{SLURM_CPUS_PER_TASK:-1}}" --share "$SLURM_ARRAY_TASK_ID/{shares}" --resume
"""
SHARED = ("evaluate", "score")
"""Commands that can be done in shares."""

app = typer.Typer(help="Print scripts that do an evaluation in shares on a cluster.", no_args_is_help=True)


@app.callback()
def _scripts() -> None:
    """Print scripts that do an evaluation in shares on a cluster."""


@app.command("slurm", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
def slurm_command(
    command: Annotated[
        list[str], typer.Argument(help="evaluate or score with its options, among them --output.", metavar="COMMAND...")
    ],
    shares: Annotated[int, typer.Option(help="Number of jobs of the array.")] = 10,
    sbatch: Annotated[
        list[str] | None,
        typer.Option(help="An option of sbatch, as --sbatch=--partition=short; can be repeated."),
    ] = None,
) -> None:
    """Print a job array for SLURM: each job does a share; one that is killed goes on when it is run again."""
    check_whole({"--shares": (shares, 1, MOST_SHARES)})
    if command[0] not in SHARED:
        raise ConfigurationError(f"script: expected {' or '.join(SHARED)}, got {command[0]}")
    if not any(word.partition("=")[0] == "--output" for word in command):
        raise ConfigurationError("script: expected a command with --output, the directory of all shares")
    more = "".join(f"#SBATCH {option}\n" for option in sbatch or ())
    program = f"{shlex.quote(sys.executable)} -m clean_swarm_env"
    typer.echo(SLURM.format(shares=shares, more=more, program=program, words=shlex.join(command)), nl=False)
