"""`clean-swarm list`: what there is, by kind: names in columns, with a line on what each is."""

import re
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from clean_swarm_env.config.task_names import named_file
from selector.documents.find import KINDS, file_origins, files_of, find_file
from selector.documents.plain import DocumentError, plain
from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.reading import read_mapping
from selforg.registry import Registry, unknown
from train.cli.options import Configs, wide_console

SENTENCE_END = re.compile(r"(?<=[A-Za-z0-9)`])(?<!\bFig)(?<!\bEq)(?<!\bal)(?<!\bvs)(?<!e\.g)(?<!i\.e)[.:](?: |$)")
REGISTERED = {
    "action-classes": ("selforg.components.actions", "ACTIONS"),
    "activator-classes": ("selforg.network.model.activators", "ACTIVATORS"),
    "mechanism-classes": ("selforg.mechanisms", "MECHANISMS"),
    "reward-terms": ("clean_swarm_env.learning.reward", "REWARD_TERMS"),
    "sensor-classes": ("selforg.components.sensors", "SENSORS"),
    "strategy-classes": ("selector.strategies.registry", "STRATEGIES"),
    "tasks": ("clean_swarm_env.tasks", "TASKS"),
    "terms": ("clean_swarm_env.learning.observation.term", "TERMS"),
}
"""Part of a kind -> the module that registers it, and its registry."""
LINES = {
    "action-classes": "actions in code: `type:` of an action of a behaviour",
    "activator-classes": "activators in code: `type:` of an activator of a condition",
    "experiments": "one mission under several conditions: evaluate NAME",
    "families": "scenarios drawn at random, to compare strategies on: evaluate NAME",
    "knowledge": "options of each goal, with the scores of experts: --knowledge NAME",
    "machines": "finite state machines that choose options: --strategy fsm:NAME",
    "mechanism-classes": "mechanisms in code: `type:` of a configuration",
    "mechanisms": "configurations of mechanisms: look draw NAME",
    "missions": "one world with its robots and its task: play NAME",
    "options": "the options that a goal may be served by, each under one name: knowledge documents choose of them",
    "policies": "trained networks that choose or drive: --strategy policy:NAME",
    "reward-terms": "what robots can be paid for: keys of a reward, beside what the task counts, such as own_dumped",
    "robots": "sensors, behaviours and goals of a robot: look draw NAME",
    "sensor-classes": "sensors in code: `type:` of a sensor of a configuration",
    "starts": "start configurations of experiments",
    "strategies": "strategies that have learned: --strategy learned:NAME",
    "strategy-classes": "ways to choose and to learn: --strategy NAME",
    "tasks": "what robots do, also a mission and a family each: evaluate NAME",
    "terms": "what robots can observe: terms of an observation",
    "training": "trainings: train ppo|bandit|es|design --config NAME",
}
"""Part of a kind -> what it is, and where a name of it goes."""
LISTED_KINDS = {
    "classes": ("action-classes", "activator-classes", "mechanism-classes", "sensor-classes"),
    "knowledge": ("knowledge", "options"),
    "strategies": ("strategy-classes", "machines", "policies", "strategies"),
    "terms": ("terms", "reward-terms"),
    **{kind: (kind,) for kind in ("experiments", "families", "mechanisms", "missions", "robots", "starts", "tasks")},
    "training": ("training",),
}
"""Kind that `list` shows -> its parts."""


def list_command(
    kind: Annotated[str | None, typer.Argument(help="One of the kinds that `list` shows.", metavar="[KIND]")] = None,
    configs: Configs = None,
) -> None:
    """List the kinds of what there is with their numbers, or the names of one kind with a line on each."""
    if kind is not None and kind not in LISTED_KINDS:
        raise ConfigurationError(f"list: {unknown('kind', kind, sorted(LISTED_KINDS))}")
    directories, console, rows = tuple(configs or ()), wide_console(), list[tuple[str, ...]]()
    for each, parts in sorted(LISTED_KINDS.items()) if kind is None else ():
        count = sum(len(names_of(part, directories, told=False)) for part in parts)
        told = "; ".join(LINES[part].partition(":")[0] for part in parts) if len(parts) > 1 else LINES[each]
        rows.append((each, str(count), told))
    parts = LISTED_KINDS[kind] if kind else ()
    for part in parts:
        beside = (part,) if len(parts) > 1 else ()
        rows += [(name, *beside, line) for name, line in names_of(part, directories).items()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        padded = [plain(cell).ljust(width) for cell, width in zip(row, widths, strict=True)]
        console.print("  ".join(padded).rstrip(), soft_wrap=True)
    told = "".join(f"\n{part}: {LINES[part]}" if len(parts) > 1 else f"\n{LINES[part]}" for part in parts)
    console.print(told or "\nclean-swarm list KIND shows the names of one kind, and where they go")


def check_named(directories: Sequence[Path], **given: str | None) -> None:
    """Raise the error of a name of a file that nothing has, before libraries are imported; kind -> name."""
    for kind, name in given.items():
        if name is not None:
            _ = named_file(name, directories) if kind == "name" else find_file(kind, name, directories)


def names_of(kind: str, directories: Sequence[Path], *, told: bool = True) -> dict[str, str]:
    """Return name -> a line on it, of everything of a part of a kind; that of a plug-in ends with where it comes from.

    Lines of files are empty unless they are to be `told`: reading a hundred files takes half a second.
    """
    if kind in KINDS:
        line, origins = _conditions if kind == "experiments" else _line, file_origins(kind)
        found = {name: line(path) if told else "" for name, path in files_of(kind, directories).items()}
    else:
        module, name = REGISTERED[kind]
        registry: Registry[Any] = getattr(import_module(module), name)
        texts = {one: registry.find(one) for one in registry.names()}
        found = {one: getattr(cls, "story", "") or _first_sentence(cls.__doc__ or "") for one, cls in texts.items()}
        origins = registry.origins()
    if kind == "reward-terms":  # ours are the fields of a reward
        from clean_swarm_env.learning.reward import RewardConfig

        found |= {name: _first_sentence(one.description or "") for name, one in RewardConfig.model_fields.items()}
    for name, origin in origins.items():
        found[name] = f"{found[name]} (from {origin})".strip()
    return dict(sorted(found.items()))


def _line(path: Path) -> str:
    """Return the first sentence of a file's description, or of the comment above it; empty for arrays."""
    if path.suffix not in (".yaml", ".yml", ".json"):
        return ""
    try:
        content = read_mapping(path)
    except DocumentError as error:
        return f"cannot be read: {error}"
    training = content.get("training")  # a policy says what its training was for
    configuration = training.get("configuration") if isinstance(training, dict) else None
    told = content.get("description") or (configuration.get("description") if isinstance(configuration, dict) else "")
    if told:
        return _first_sentence(str(told))
    comment = re.match(r"(?:#.*\n)+", path.read_text(encoding="utf-8"))
    return _first_sentence(re.sub(r"\n?# ?", " ", comment[0]) if comment else "")


def _first_sentence(text: str) -> str:
    """Return the first sentence of a text, which may be of several lines.

    >>> _first_sentence("As in Fig. 3, robots turn. Then they go.")
    'As in Fig. 3, robots turn'

    """
    return re.split(SENTENCE_END, " ".join(text.split()))[0]


def _conditions(path: Path) -> str:
    """Return what an experiment is, and its conditions; none where it takes them from another file."""
    held = read_mapping(path).get("conditions")
    names = [str(part.get("name")) for part in held if isinstance(part, dict)] if isinstance(held, list) else []
    return _line(path) + (f" [{', '.join(names)}]" if names else "")
