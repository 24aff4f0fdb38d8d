"""`clean-swarm list`: what there is, by kind: names in columns, with a line on what each is.

Sources and files are read, not run: importing what registers names takes seconds.
"""

import re
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Annotated

import typer

from clean_swarm_env.config.task_names import named_file, task_stories
from clean_swarm_env.deciders.labelled import BY_MODEL, FILED, label_and_members
from selector.documents.find import KINDS, SHIPPED, files_of, find_file, is_path, plugin_names
from selector.documents.plain import DocumentError, plain
from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.reading import read_mapping
from selector.documents.trust import BASELINE, FILED_KINDS, FOREIGN_ENDINGS, is_import
from selforg.plugins import installed, named_plugins
from selforg.registry import unknown
from train.cli.options import Configs, check_there, wide_console

MEMBER_FILES = {"policy": "policies", "learned": "strategies", "fsm": "machines"}
"""Kind of a strategy -> kind of its file."""
CLASS = r"(?s)@{}\.register\n(?:@[^\n]*\n)?class (?P<name>\w+).*?\"\"\"(?P<line>.*?)\"\"\""
SENTENCE_END = re.compile(r"(?<=[A-Za-z0-9)`])(?<!\bFig)(?<!\bEq)(?<!\bal)(?<!\bvs)(?<!e\.g)(?<!i\.e)[.:](?: |$)")
DECLARED = {
    "action-classes": ("selforg/components/**/*.py", CLASS.format("ACTIONS")),
    "activator-classes": ("selforg/network/model/**/*.py", CLASS.format("ACTIVATORS")),
    "sensor-classes": ("selforg/components/**/*.py", CLASS.format("SENSORS")),
    "strategy-classes": ("selector/strategies/**/*.py", CLASS.format("STRATEGIES")),
    "mechanism-classes": (
        "selforg/mechanisms/**/*.py",
        CLASS.format("MECHANISMS"),
        r"(?sm)^\w+ = \w+\.variant\(\s*\"(?P<name>\w+)\"(?P<line>)",
    ),
    "reward-terms": (
        "clean_swarm_env/learning/reward.py",
        r"(?sm)^    (?P<name>\w+): (?:Number|Share) = -?[\d.]+\n    \"\"\"(?P<line>.*?)\"\"\"",
    ),
    "terms": (
        "clean_swarm_env/**/*terms.py",
        r"(?sm)@\w+\.term\(\s*\"(?P<name>\w+)\"(?:(?!\ndef ).)*\ndef [^\n]*:\n    \"\"\"(?P<line>.*?)\"\"\"",
        r"(?sm)^class \w+\([^\n]*\):\n    \"\"\"(?P<line>.*?)\"\"\"(?:(?!^class ).)*?"
        r"^    name = \"(?P<name>\w+)\"",
    ),
}
"""Part of a kind -> places and patterns of the sources that declare it, with a name and a line."""
REGISTERED = {"reward-terms": "reward term", "terms": "observation term", "tasks": "task"}
"""Part of a kind -> what the registry of it calls a class, where that is not the beginning of its name."""
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


def check_named(configs: Sequence[Path] | None, strategies: Sequence[str] | None = None, **given: str | None) -> None:
    """Raise the error of a name that nothing has, before libraries are imported that take seconds; kind -> name."""
    directories = tuple(configs or ())
    for kind, name in given.items():
        if name is not None:
            _ = named_file(name, directories) if kind == "name" else find_file(kind, name, directories)
    # those of the user may have more options
    theirs = is_import(given.get("name") or "") or any(is_path("knowledge", name or "") for name in given.values())
    ours = not (directories or named_plugins() or installed() or theirs)
    for text in strategies or ():
        for member in label_and_members(text)[1]:
            _check_member(member, f"--strategy {text}: ", directories, ours=ours)


def _check_member(member: str, where: str, directories: Sequence[Path], *, ours: bool) -> None:
    """Raise the error of a strategy that there is not; of options only if all are `ours`."""
    kind, _, name = member.partition(":")
    if kind == BY_MODEL:
        for own in filter(None, (pair.partition("=")[2] for pair in name.split(";"))):
            _check_member(own, where, directories, ours=ours)
    elif kind == FILED_KINDS[0] and ours:
        _check_options(where, name)
    elif kind in FILED and name.endswith(FOREIGN_ENDINGS):
        check_there(Path(name), where=where)
    elif kind in MEMBER_FILES:
        find_file(MEMBER_FILES[kind], name, directories, where)
    elif not name and kind not in (*FILED_KINDS, BASELINE, *(known := names_of("strategy-classes", ()))):
        raise ConfigurationError(where + unknown("strategy", kind, tuple(known)))


def _check_options(where: str, names: str) -> None:
    """Raise the error of an option that no expert knowledge of ours has."""
    goals = chain(*(read_mapping(path)["goals"].values() for path in files_of("knowledge").values()))
    known = {option.get("name", option.get("configuration")) for own in goals for option in own}
    for name in filter(None, names.split("+")):
        if name not in known:
            raise ConfigurationError(where + unknown("option", name, sorted(known)))


def names_of(kind: str, directories: Sequence[Path], *, told: bool = True) -> dict[str, str]:
    """Return name -> a line on it, of everything of a part of a kind; that of a plug-in ends with where it comes from.

    Lines of files are empty unless they are to be `told`: reading a hundred files takes half a second.
    """
    if kind == "tasks":
        found = task_stories()  # those of plug-ins that are imported, too
    elif kind in KINDS:
        line = _conditions if kind == "experiments" else _line
        found = {name: line(path) if told else "" for name, path in files_of(kind, directories).items()}
    else:
        places, *patterns = DECLARED[kind]
        texts = [path.read_text(encoding="utf-8") for path in SHIPPED.parent.glob(places)]
        matches = (match for text in texts for pattern in patterns for match in re.finditer(pattern, text))
        found = {match["name"]: _first_sentence(match["line"]) for match in matches}
    brought = plugin_names() if named_plugins() or installed() else {}  # their code runs, if there are any
    for name, origin in brought.get(REGISTERED.get(kind, kind.removesuffix("-classes")), {}).items():
        found[name] = f"{found.get(name, '')} (from {origin})".strip()
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


def conditions_in(path: Path) -> list[str]:
    """Return the names of the conditions in the file of an experiment; none where it takes them from another file."""
    held = read_mapping(path).get("conditions")
    return [str(part.get("name")) for part in held if isinstance(part, dict)] if isinstance(held, list) else []


def _conditions(path: Path) -> str:
    """Return what an experiment is, and its conditions."""
    names = conditions_in(path)
    return _line(path) + (f" [{', '.join(names)}]" if names else "")
