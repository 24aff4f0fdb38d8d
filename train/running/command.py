"""The words of a command, from which people see how results came about and how to go on."""

from __future__ import annotations

from pathlib import Path

from clean_swarm_env.config.tasks import own_files

WordValue = str | int | Path | bool | None


def command_words(*first: str, **options: WordValue | tuple[WordValue, ...]) -> list[str]:
    """Return the words of a `clean-swarm` command; a tuple repeats its option, None and False leave it out.

    >>> command_words("evaluate", "table1", seed=0, starts=None, force=True, condition=("a", "b"))[3:]
    ['--seed', '0', '--force', '--condition', 'a', '--condition', 'b']
    """
    words = ["clean-swarm", *(word for file in own_files() for word in ("--import", file)), *first]
    for name, given in options.items():
        for one in given if isinstance(given, tuple) else (given,):
            if one is not None and one is not False:
                words += [f"--{name.replace('_', '-')}", *([] if one is True else [str(one)])]
    return words
