"""The page of all keys of missions, families and experiments, which only the site has: `python -m docs.site.keys`.

What a key means is the text below its field in the code, and its values and default are those that the code checks.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.robots import RobotConfig, RobotModel
from clean_swarm_env.config.task_names import task_names
from clean_swarm_env.config.tasks import TaskSettings, find_task
from selector.documents.fields import LARGEST_NUMBER

HEAD = """# Keys of missions, families and experiments

All keys of the files that `clean-swarm evaluate`, `play` and `advise` read, with the values that they may have. Any key
may be left out unless it is *needed*; an unknown key is an error. The `mission` of a family or an experiment is a name,
keys of its own, or a name and what changes: `{base: three-rooms, time_limit: 6000.0}`. `clean-swarm list missions` and
`clean-swarm list families` name those that ship.
"""

MORE = {
    RobotConfig: " All robots alike have the keys of a group here: `robots: {count: 6, max_speed: 0.5}`. A list is "
    "that of groups: `[{model: scout, count: 2}, {model: carrier}]`.",
}
"""Model -> what the page says of it beside its docstring."""


def page() -> str:
    """Return the page."""
    done: set[str] = set()
    parts = [HEAD, "## Missions\n", *tables(MissionConfig, "", done)]
    for name in task_names():
        settings = find_task(name).Settings
        if settings is not TaskSettings and settings.__name__ not in done:
            parts += [f"## Settings of the task {name}\n", *tables(settings, "task", done)]
    parts += ["## Families\n", *tables(FamilyConfig, "", done)]
    parts += ["## Experiments with conditions\n", *tables(ExperimentConfig, "", done)]
    return "\n".join(parts)


def tables(model: type[BaseModel], where: str, done: set[str], besides: type[BaseModel] | None = None) -> Iterator[str]:
    """Yield the table of a model whose keys stand below `where`, then those of its parts.

    Args:
        model: the model.
        where: key of the file below which the keys stand, empty for those of the file itself.
        done: names of the models that have a table already; those of this call are added.
        besides: a model whose keys are left out.

    """
    done.add(model.__name__)
    schema = model.model_json_schema()
    besides = RobotModel if model is RobotConfig else TaskSettings if issubclass(model, TaskSettings) else besides
    left_out = set(besides.model_fields) if besides else set()
    texts = meanings(model)
    rows, parts = [], []
    for key, held in schema["properties"].items():
        if key in left_out:
            continue
        full = f"{where}.{key}" if where else key
        needed = key in schema.get("required", ())
        otherwise = "*needed*" if needed else "" if "unless given" in texts[key] else default(held)
        rows.append(f"| `{key}` | {values(held)} | {otherwise} | {texts[key]} |")
        parts += [(full, part) for part in models_in(model.model_fields[key].annotation)]
    yield f"| key{f' of `{where}`' if where else ''} | values | unless given | |\n|---|---|---|---|"
    yield "\n".join(rows) + "\n"
    for full, part in parts:
        if part.__name__ not in done and part is not TaskSettings:
            yield f"### {full}: {shown_name(part.__name__)}\n"
            first = " ".join((inspect.getdoc(part) or "").split("\n\n")[0].split())
            yield textwrap.fill(f"{first}{MORE.get(part, '')}", 120) + "\n"
            yield from tables(part, full, done)


def models_in(annotation: Any) -> list[type[BaseModel]]:  # noqa: ANN401  (an annotation of any form)
    """Return the models that an annotation names, in order."""
    if inspect.isclass(annotation) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in getattr(annotation, "__args__", ()) for model in models_in(part)]


def meanings(model: type[BaseModel]) -> dict[str, str]:
    """Return key -> the text below its field, in one line, of a model and of what it is derived from."""
    found: dict[str, str] = {}
    for each in reversed(model.__mro__):
        if issubclass(each, BaseModel) and each is not BaseModel:
            body = ast.parse(textwrap.dedent(inspect.getsource(each))).body[0]
            assert isinstance(body, ast.ClassDef)
            for field, text in zip(body.body, body.body[1:], strict=False):
                if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                    told = text.value if isinstance(text, ast.Expr) else None
                    if isinstance(told, ast.Constant) and isinstance(told.value, str):
                        found[field.target.id] = " ".join(told.value.split()).replace("|", "\\|")
    return found


def values(held: dict[str, Any]) -> str:
    """Return what the value of a key may be, in words, from its JSON schema."""
    if "$ref" in held:
        return f"keys ({shown_name(held['$ref'])})"
    if "enum" in held or "const" in held:
        return " or ".join(f"`{value}`" for value in held.get("enum", [held.get("const")])) or "empty"
    if "anyOf" in held:
        return next(values(one) for one in held["anyOf"] if one.get("type") != "null" and one.get("const") != "")
    if "oneOf" in held:
        return " or ".join(shown_name(one["$ref"]) for one in held["oneOf"])
    kind = held.get("type")
    if kind in ("number", "integer"):
        return ("whole number" if kind == "integer" else "number") + bounds(held)
    if "prefixItems" in held:
        return f"[{', '.join(values(one) for one in held['prefixItems'])}]"
    if kind == "array":
        return f"list of {values(held['items'])}"
    if kind == "object":
        inner = held.get("additionalProperties")
        return f"name: {values(inner)}" if isinstance(inner, dict) else "keys"
    return {"boolean": "`true` or `false`", "string": "text"}.get(kind, "any")


def shown_name(model: str) -> str:
    """Return how the page calls a model, from its name or from where a JSON schema refers to it."""
    return model.rpartition("/")[2].removesuffix("Config").removesuffix("Spec")


def bounds(held: dict[str, Any]) -> str:
    """Return the bounds of a number; those that only keep it finite are left out."""
    least, most, above = held.get("minimum"), held.get("maximum"), held.get("exclusiveMinimum")
    parts = [f"above {above:g}"] if above is not None else []
    parts += [f"from {least:g}"] if least is not None and least > -LARGEST_NUMBER else []
    parts += [f"to {most:g}"] if most is not None and most < LARGEST_NUMBER else []
    return " " + " ".join(parts) if parts else ""


def default(held: dict[str, Any]) -> str:
    """Return the default of a key, empty where that is nothing or what the parts say."""
    value = held.get("default")
    if value in (None, "", [], {}) or isinstance(value, dict):
        return ""
    if value == LARGEST_NUMBER:
        return "no bound"
    plain = f"{value:g}" if isinstance(value, float) else str(value)
    return f"`{plain.lower() if isinstance(value, bool) else plain}`"


if __name__ == "__main__":
    print(page())
