"""`clean-swarm machine warm`: compile everything before many commands start."""

import typer


def warm_command() -> None:
    """Compile everything once, into the cache that commands share; NUMBA_CACHE_DIR names another directory."""
    from train.cli.cluster.compiling import compile_everything  # imports Numba

    code = compile_everything()
    typer.echo(f"compiled code: {code.size / 1e6:.0f} MB in {code.directory}, {code.seconds:.1f} CPU s")
