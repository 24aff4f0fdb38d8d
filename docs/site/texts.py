"""Pieces of Markdown: tables, code, and the docstring of a class."""

import inspect
import sys
from collections.abc import Iterable, Sequence

from sphinx.ext.napoleon import Config, GoogleDocstring

from clean_swarm_env.learning.observation.term import TERMS
from clean_swarm_env.world.worlds import Worlds as Worlds  # imports all terms and mechanisms
from docs.site.docstrings import converted
from selector.strategies.registry import STRATEGIES
from selforg.mechanisms import MECHANISMS
from selforg.registry import Registry

REGISTRIES: dict[str, Registry] = {
    "strategy-classes": STRATEGIES,
    "mechanism-classes": MECHANISMS,
    "terms": TERMS,
}


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def cell(text: str) -> str:
    """Return a text for a cell of a table, or for the words of a picture."""
    return text.replace("|", "\\|").replace("\n", " ").replace("[", "\\[")


def code(language: str, text: str) -> str:
    """Return a block of code."""
    return f"```{language}\n{text}\n```"


def described(kind: str, name: str) -> str:
    """Return what a registered class says of itself, its parameters and where it is."""
    cls = REGISTRIES[kind].find(name)
    lines = converted(inspect.getdoc(cls).splitlines())
    text = str(GoogleDocstring(lines, Config(napoleon_use_ivar=True), what="class", obj=cls))
    parts = [f"```{{eval-rst}}\n{text.strip()}\n```"]
    parameters = [f"`{parameter}`" + ("" if given is None else f" {given}") for parameter, given in parameters_of(cls)]
    if parameters:
        parts.append(f"Parameters and their defaults: {', '.join(parameters)}.")
    components = getattr(cls, "components", ())
    if components:
        parts.append(f"Components: {', '.join(f'`{component}`' for component in components)}.")
    module = sys.modules[cls.__module__]
    parts.append(f"In code: `{module.__name__}.{cls.__name__}`.")
    return "\n\n".join(parts)


def parameters_of(cls: type) -> list[tuple[str, object]]:
    """Return the names of the parameters of a class, each with its default."""
    fields = getattr(cls, "Parameters", None)
    if fields is not None:
        return [(name, field.default) for name, field in fields.model_fields.items()]
    parameters = inspect.signature(cls).parameters.values()
    return [(p.name, None if p.default is p.empty else p.default) for p in parameters if p.kind is p.KEYWORD_ONLY]
