"""A page for each name that `clean-swarm list` shows, from the registries and the files."""

import json
from collections.abc import Callable, Iterator

from docs.site.spaces import started, worlds
from docs.site.stage import ORPHAN, ROOT, Stage
from docs.site.texts import cell, code, described, table
from selector.documents.find import KINDS, files_of
from selector.knowledge import Option, load_knowledge
from train.cli.listing import LINES, LISTED_KINDS, names_of

CALLED = {
    "tasks": ("Tasks", "task"),
    "missions": ("Missions", "mission"),
    "families": ("Families", "family"),
    "experiments": ("Experiments", "experiment"),
    "knowledge": ("Expert knowledge", "expert knowledge"),
    "options": ("Options", "set of options"),
    "mechanisms": ("Configurations of mechanisms", "configuration of a mechanism"),
    "mechanism-classes": ("Mechanisms in code", "mechanism in code"),
    "strategy-classes": ("Strategies in code", "strategy in code"),
    "machines": ("State machines", "state machine"),
    "policies": ("Trained policies", "trained policy"),
    "strategies": ("Learned strategies", "learned strategy"),
    "robots": ("Robots", "robot"),
    "terms": ("Observation terms", "observation term"),
    "reward-terms": ("Reward terms", "reward term"),
    "sensor-classes": ("Sensors in code", "sensor in code"),
    "action-classes": ("Actions in code", "action in code"),
    "activator-classes": ("Activators in code", "activator in code"),
    "training": ("Trainings", "training"),
    "starts": ("Start configurations", "start configurations"),
}
"""Kind -> title of the page that lists its names, and what one of them is, in the order of the menu."""
COMMANDS = {
    "experiments": "clean-swarm evaluate {name} --scenarios 2",
    "knowledge": "clean-swarm evaluate table1 --knowledge {name} --strategy MaxScore --scenarios 2",
    "machines": "clean-swarm evaluate clustered --strategy fsm:{name} --scenarios 2",
    "mechanisms": "clean-swarm look draw {name}",
    "policies": "clean-swarm play crowded-exploring --strategy policy:{name}",
    "robots": "clean-swarm look draw {name}",
    "strategy-classes": "clean-swarm evaluate table1 --strategy {name} --scenarios 2",
}
"""Kind -> the line that starts or shows a name of it."""
KINDS_SHOWN = tuple(kind for kind in CALLED if kind in LINES)
CATALOGUE = tuple(f"names/{kind}/index" for kind in KINDS_SHOWN)


def write_catalogue(stage: Stage) -> None:
    """Write the list of each kind, and a page for each of its names."""
    for kind in KINDS_SHOWN:
        title, _ = CALLED[kind]
        names = names_of(kind, ())
        rows = [(f"[{name}]({name}.md)", cell(line)) for name, line in names.items()]
        text = f"# {title}\n\n{sentence(LINES[kind])}\n\n"
        text += table(("name", "what it is"), rows) if rows else "None ships; a training writes them."
        shown = next(whole for whole, parts in LISTED_KINDS.items() if kind in parts)
        stage.write(f"names/{kind}/index.md", f"{text}\n\nThe same list: `clean-swarm list {shown}`.\n")
        for name, line in names.items():
            stage.write(f"names/{kind}/{name}.md", ORPHAN + page(stage, kind, name, line))


def page(stage: Stage, kind: str, name: str, line: str) -> str:
    """Return the page of a name."""
    title, one = CALLED[kind]
    parts = [f"# {name}", f"*{one[0].upper()}{one[1:]}; [all {title.lower()}](index.md).*"]
    parts += SECTIONS.get(kind, by_file)(stage, kind, name, line)
    parts += file_of(stage, kind, name) if kind in KINDS else []
    return "\n\n".join(parts) + "\n"


def by_file(_stage: Stage, kind: str, name: str, line: str) -> Iterator[str]:
    """Yield what a file says of itself, and the line that starts it."""
    yield sentence(line) if line else ""
    if kind in COMMANDS:
        yield "## Start it"
        yield code("sh", COMMANDS[kind].format(name=name))


def by_world(stage: Stage, kind: str, name: str, line: str) -> Iterator[str]:
    """Yield story, picture, ways to start, spaces, rewards and measures of what is a world."""
    yield sentence(line)
    loop = ROOT / "docs" / "pictures" / "loops" / f"{name}.webp"
    if kind != "families" and loop.exists():
        yield stage.linked(f"![{name}: {cell(line)}]({loop.as_posix()})", ROOT / "x.md", f"names/{kind}/{name}.md")
    yield from started(kind, name)
    yield from worlds(kind, name)


def by_class(_stage: Stage, kind: str, name: str, line: str) -> Iterator[str]:
    """Yield what a class says of itself, and the line that uses it."""
    yield described(kind, name)
    yield from list(by_file(_stage, kind, name, ""))[1:]


def by_options(_stage: Stage, kind: str, name: str, line: str) -> Iterator[str]:
    """Yield the options of each goal of expert knowledge, with their scores."""
    yield from by_file(_stage, kind, name, line)
    yield "## Goals and their options"
    rows = [
        (f"[{goal}](../options/{goal}.md)", f"`{option.name}`", configuration_of(option), str(option.score))
        for goal, option in options_of(name)
    ]
    yield table(("goal", "option", "configuration", "score"), rows)


def by_configuration(_stage: Stage, kind: str, name: str, line: str) -> Iterator[str]:
    """Yield what a configuration is, and which goals it serves where."""
    yield from by_file(_stage, kind, name, line)
    rows = [
        (goal, f"[{knowledge}](../knowledge/{knowledge}.md)", f"`{option.name}`", str(option.score))
        for knowledge in files_of("knowledge")
        for goal, option in options_of(knowledge)
        if option.configuration == name
    ]
    if rows:
        yield "## Goals that it serves"
        yield table(("goal", "in the knowledge", "as the option", "score"), rows)


def options_of(knowledge: str) -> Iterator[tuple[str, Option]]:
    """Yield each goal of expert knowledge with each of its options."""
    known = load_knowledge(knowledge)
    return ((goal, option) for goal in known.goals for option in known.options(goal))


def configuration_of(option: Option) -> str:
    """Return the configuration of an option, with a link where it is one that ships."""
    name = option.configuration
    return f"[{name}](../mechanisms/{name}.md)" if name in files_of("mechanisms") else f"`{name}`"


def by_policy(_stage: Stage, kind: str, name: str, line: str) -> Iterator[str]:
    """Yield what a policy decides by what, and how it was trained: its model card."""
    yield from by_file(_stage, kind, name, line)
    held = json.loads((files_of("policies")[name]).read_text(encoding="utf-8"))
    yield "## What it decides"
    yield table(
        ("goal", "options", "kept for [periods]"),
        [
            (goal, ", ".join(f"`{option}`" for option in options), str(held.get("holds", {}).get(goal, 1)))
            for goal, options in held["goals"].items()
        ],
    )
    terms = held.get("terms") or []
    named = ", ".join(f"[{term}](../terms/{term}.md)" for term in terms if isinstance(term, str))
    yield f"It sees {len(held['observations'])} numbers" + (f", of the terms {named}." if named else ".")
    yield f"Its network has layers of {held['hidden']} and sha256 `{held['weights_sha256']}`."
    training = held["training"]
    yield "## How it was trained"
    yield code("sh", str(training.get("command", "")))
    yield "The same command with the same versions makes the same bits."
    card = files_of("policies")[name].with_name("README.md")
    if card.exists():  # one that ships has a card
        yield "## Results" + card.read_text(encoding="utf-8").partition("## Results")[2]


def by_term(_stage: Stage, kind: str, name: str, line: str) -> Iterator[str]:
    """Yield what a term means and how to ask for it."""
    yield described(kind, name)
    yield "## Use it"
    yield code("python", f'env = clean_swarm_v0.parallel_env(observation={{"terms": ["{name}"]}})')


SECTIONS: dict[str, Callable[[Stage, str, str, str], Iterator[str]]] = {
    "tasks": by_world, "missions": by_world, "families": by_world,
    "strategy-classes": by_class, "mechanism-classes": by_class, "terms": by_term,
    "knowledge": by_options, "mechanisms": by_configuration, "policies": by_policy,
}  # fmt: skip


def file_of(stage: Stage, kind: str, name: str) -> Iterator[str]:
    """Yield the file of a name, shortened where it is made of numbers."""
    path = files_of(kind)[name]
    yield "## Its file"
    yield stage.linked(
        f"[{path.relative_to(ROOT).as_posix()}]({path.as_posix()})", ROOT / "x.md", f"names/{kind}/{name}.md"
    )
    if path.suffix == ".yaml":
        yield code("yaml", path.read_text(encoding="utf-8").rstrip())


def sentence(text: str) -> str:
    """Return a text as a sentence."""
    text = text.strip()
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "?")) else ".")
