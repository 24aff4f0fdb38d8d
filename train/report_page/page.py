"""The page of directories of results, as HTML without scripts; a policy in it forbids every request."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from html import escape
from importlib.resources import files
from typing import Final

import numpy as np
from markdown_it import MarkdownIt

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording.reader import RecordedMission
from train.report_page.charts import distributions, selection_over_time
from train.reports.charts import svg
from train.reports.curves import EXPLAINED as EXPLAINED_CURVES
from train.reports.curves import draw_curves, verdict_of
from train.reports.results import HeldResults
from train.reports.text_table import markdown_table
from train.running.finished_runs import cheapest_first, natural_order
from train.running.runs import RunRecord

FIGURES: Final[Mapping[str, Callable[[RunRecord], float]]] = {
    "cost [s]": lambda record: record.result.cost_s,
    "duration [s]": lambda record: record.result.duration_s,
    "collision events a second": lambda record: record.result.collision_events_per_s[0],
}
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{title}</title><style>{style}</style></head><body>
<h1>{title}</h1>
{body}
</body></html>
"""
MARKDOWN: Final = MarkdownIt("zero").enable(["heading", "table", "blockquote", "backticks"])
"""Reads Markdown; all else that it may hold, such as HTML, is text."""
NOT_CHECKED = (
    "The manifest of the directory. Whether the runs are of this configuration is not checked here; --resume checks it."
)
EXPLAINED = (
    "Dots: missions. Boxes: the middle half of the missions. Diamonds: means, with 95 % intervals (Student, by the "
    "number of scenarios)."
)


def report_of_results(results: Sequence[HeldResults]) -> str:
    """Return the page.

    Raises:
        ConfigurationError: two directories that cannot be compared.

    """
    names = list(dict.fromkeys(held.name for held in results))
    if len(results) > 2 and results[0].records:
        raise ConfigurationError(f"report: expected one or two evaluations, got {len(results)}")
    if len(results) > 1 and all(held.records for held in results) and len(names) > 1:
        raise ConfigurationError(f"{results[1].path}: expected results of {names[0]} to compare, got {names[1]}")
    if len({bool(held.records) for held in results}) > 1:
        raise ConfigurationError(f"{results[1].path}: expected evaluations or trainings, got both")
    body = list(_evaluation(results) if results[0].records else _training(results))
    for held in results:
        content = escape(json.dumps(held.manifest, indent=2))
        head = f"<summary>manifest of {escape(str(held.path))}</summary>"
        body.append(f"<details>{head}<p>{NOT_CHECKED}</p><pre>{content}</pre></details>")
    title = f"{'Evaluation' if results[0].records else 'Training'}: {', '.join(names)}"
    return PAGE.format(
        title=escape(title),
        style=(files("train.report_page") / "page.css").read_text(encoding="utf-8"),
        body="\n".join(body),
    )


def _evaluation(results: Sequence[HeldResults]) -> Iterator[str]:
    records = [  # those of two directories have the directory before their condition
        replace(record, condition=f"{held.path.name}: {record.condition}") if len(results) > 1 else record
        for held in results
        for record in held.records
    ]
    conditions = cheapest_first(records)
    scenarios = sorted({record.scenario for record in records}, key=natural_order)
    for held in results:
        yield f"<h2>{escape(str(held.path))}</h2>" if len(results) > 1 else ""
        first, *more = re.split(r"(?m)^## ", re.sub(r"\A# .*\n", "", held.tables))
        yield html_of_markdown(first + "".join(f"## {part}" for part in more[:1]))
        for part in more[1:]:
            head, _, rest = part.partition("\n")
            yield f"<details><summary>{escape(head)}</summary>{html_of_markdown(rest)}</details>"
    yield "<h2>Distributions</h2>"
    for figure, of in FIGURES.items():
        at = {record.key: of(record) for record in records}
        values = np.array([[at.get((scenario, name), np.nan) for scenario in scenarios] for name in conditions])
        yield f"<section><h3>{escape(figure)}</h3>{distributions(values, scenarios, conditions)}</section>"
    told = f"{len(records)} runs: {len(scenarios)} scenarios, {len(conditions)} conditions. {EXPLAINED}"
    yield f"<section><h3>How to read the charts</h3>{_note(told)}</section>"
    yield from _selection(results)


def _selection(results: Sequence[HeldResults]) -> Iterator[str]:
    yield "<h2>Selection</h2>"
    groups, alone = dict[tuple[str, str, tuple[str, ...]], list[RecordedMission]](), list[str]()
    for held in results:
        label = f"{held.path.name}: " if len(results) > 1 else ""
        for recording in held.recordings:
            for goal, options in recording.head["options"].items():
                if f"held/{goal}" in recording:
                    condition = f"{label}{recording.head['about'].get('condition', '')}"
                    groups.setdefault((condition, goal, tuple(options)), []).append(recording)
    if not groups:
        yield _note("No run was recorded: evaluate with --record, and make the report again.")
    for (condition, goal, options), own in groups.items():
        taken = {options[k] for one in own for k in np.unique(one[f"held/{goal}"][one["working"] == 1]).tolist()}
        if len(taken) == 1:  # a picture of it were a block of one colour
            alone.append(f"Under {condition} every robot held {taken.pop()} for {goal} all the time.")
            continue
        title = f"<h3>{escape(condition)}: {escape(goal)}, {len(own)} recorded runs</h3>"
        yield f"<section>{title}{selection_over_time(own, goal)}</section>"
    yield _note(" ".join(alone))


def _training(results: Sequence[HeldResults]) -> Iterator[str]:
    labels = [held.path.name if len(results) > 1 else held.name for held in results]
    for label, held in zip(labels, results, strict=True):
        said = verdict_of(held.validation) if held.validation is not None else []
        before = f"{label}: " if len(results) > 1 and said else ""
        yield f"<blockquote>{escape(before + ' '.join(said))}</blockquote>" if said else ""
    figure = draw_curves(results)
    drawn = svg(figure) + _note(EXPLAINED_CURVES) if figure is not None else _note("Nothing was validated.")
    yield f"<h2>Learning curves</h2>{drawn}"
    for label, held in zip(labels, results, strict=True):
        columns = list(dict.fromkeys(name for entry in held.history for name in entry))
        rows = [[_cell(entry.get(name)) for name in columns] for entry in held.history]
        yield f"<h2>Checkpoints of {escape(label)}</h2>" + html_of_markdown(markdown_table(columns, rows))


def html_of_markdown(text: str) -> str:
    """Return headings, tables and paragraphs of Markdown as HTML: what `table.md` has."""
    headings = re.sub(r"^#+ ", "### ", text, flags=re.MULTILINE)
    return f'<div class="wide note">{MARKDOWN.render(headings)}</div>'


def _note(text: str) -> str:
    return f'<p class="note">{escape(text)}</p>'


def _cell(value: object) -> str:
    return f"{value:,.5g}" if isinstance(value, float) and np.isfinite(value) else "" if value is None else str(value)
