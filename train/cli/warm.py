"""`clean-swarm warm`: compile everything before missions need it."""

from itertools import chain
from time import process_time

import typer

from selector.documents.plain import DocumentError as ConfigurationError

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
        raise ConfigurationError("warm: no directory can be written or has room; NUMBA_CACHE_DIR names another one")
    with one_process():
        _compile_everything()
    size = sum(path.stat().st_size for path in directory.rglob("*") if path.is_file())
    typer.echo(f"compiled code: {size / 1e6:.0f} MB in {directory}, {process_time() - began:.1f} CPU s")


def _compile_everything() -> None:
    """Run the beginnings of missions under every option, and of all tasks: whatever they call is compiled and kept."""
    from clean_swarm_env.config.task_names import task_names
    from train.evaluation.comparing import Comparing
    from train.request import Request

    batches = Comparing(Request(FAMILY, ("fixed", "fsm:rule"), scenarios=1)).tasks({})
    single = Comparing(Request(EXPERIMENT, scenarios=1)).tasks({})
    tasks = [Comparing(Request(name, ("MaxScore",), scenarios=2)).tasks({}) for name in task_names()]
    for mission in (*batches, *single):
        mission.beginning().run()
    for mission in chain(*tasks):
        mission.beginning(TASK_SECONDS).run()
