"""Tables and pictures of `results.json` for the docs: `python -m benchmarks.document` (the end of `make bench`)."""

import json
from pathlib import Path
from textwrap import wrap
from typing import Any

import matplotlib

from benchmarks.required import REQUIREMENTS, value_at
from benchmarks.shared.parts import PARTS
from benchmarks.shared.record import RESULTS
from docs.figures.stored import record

DOCS = Path(__file__).parents[1] / "docs"
PICTURES = DOCS / "pictures"
COLOURS = ("#4c72b0", "#dd8452", "#55a868", "#c44e52", "#8172b3", "#937860")


def required(results: Any) -> list[str]:
    """Return the table of requirements."""
    lines = ["| | measured | required |", "|---|---|---|"]
    for one in REQUIREMENTS:
        value = value_at(results, one.path)
        told = "not measured" if value is None else f"{value:.2f}{'' if one.reached(value) else ' **missed**'}"
        lines.append(f"| {one.what} | {told} | {'<=' if one.most else '>='} {one.limit:g} |")
    return lines


def sizes(results: Any) -> list[str]:
    """Return the table of ticks by size."""
    tick = results["tick"]
    lines = [
        "| worlds x robots | tick per world [us] | pymunk alone [us] | ratio | world-ticks/s |",
        "|---|---|---|---|---|",
    ]
    for size, cost in sorted(tick["tick [us]"].items(), key=lambda item: _order(item[0])):
        floor, ratio = tick["floor [us]"][size], tick["tick / floor"][size]
        lines.append(f"| {size} | {cost:.1f} | {floor:.1f} | {ratio:.2f} | {1e6 / cost:.0f} |")
    growth = tick["growth"]
    lines += [
        "",
        f"From 50 to 10,000 robots at constant density the tick grows with exponent {growth['exponent']:.2f} "
        f"(R2 {growth['R2']:.3f}),",
        f"pymunk alone with {growth['exponent of the floor']:.2f}; "
        f"from 1,000 to 10,000 robots the tick with {growth['exponent from 1,000 robots']:.2f}.",
    ]
    return lines


OURS = {
    "tick": "ours, `Worlds.tick`",
    "Batch": "ours, `Batch.step`, a decision every five ticks",
    "Batch, each tick": "ours, `Batch.step`, a decision each tick",
}


def peers(results: Any) -> list[str]:
    """Return the table of world-ticks beside peers, with the versions and the load of that run."""
    found = results["peers"]
    keys = [key.rpartition(" x ") for key in found["median"]]
    names = [*OURS, *sorted({name for name, _, _ in keys} - set(OURS), key=str.lower)]
    worlds = sorted({int(count) for _, _, count in keys})
    titles = ("1 world", *(f"{count}" for count in worlds[1:]))
    lines = [f"| | {' | '.join(titles)} |", "|---" * (len(worlds) + 1) + "|"]
    for name in names:
        cells = [_cell(found, f"{name} x {count}") for count in worlds]
        lines.append(f"| {OURS.get(name, name)} | {' | '.join(cells)} |")
    told = ", ".join(f"{package} {number}" for package, number in sorted(found["versions"].items()))
    load, machine = found["load"], found["machine"]
    about = f"{machine['cpu']}, {machine['cores']} cores; load {load['before']:.1f} before the run and"
    return [*lines, "", *wrap(f"{about} {load['after']:.1f} after it; {told}.", 120)]


def _cell(found: Any, key: str) -> str:
    """Return median and range of a contestant, or nothing where it was not measured."""
    if key not in found["median"]:
        return ""
    median, least, most = (f"{found[what][key]:,.0f}" for what in ("median", "least", "most"))
    return f"{median} ({least} to {most})"


def _order(size: str) -> tuple[int, int]:
    worlds, robots = (int(number) for number in size.split(" x "))
    return robots, worlds


def draw_parts(results: Any) -> None:
    """Draw the time of the parts of a tick, by size."""
    import matplotlib.pyplot as plt

    parts = {size: figures for size, figures in results["parts [us]"].items() if " x " in size}
    names = sorted(parts, key=_order)
    shown = [name.replace(" x ", " x\n") for name in names]
    figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
    below = [0.0] * len(names)
    for part, colour in zip(PARTS, COLOURS, strict=True):
        heights = [parts[name][part] / _order(name)[0] for name in names]
        axes.bar(shown, heights, bottom=below, color=colour, label=part)
        below = [low + height for low, height in zip(below, heights, strict=True)]
    floors = [results["tick"]["floor [us]"][name] / _order(name)[0] for name in names]
    axes.plot(shown, floors, "k_", markersize=18, label="pymunk alone")
    axes.set(ylabel="a tick, per robot [us]", xlabel="worlds x robots")
    axes.legend(fontsize=8, markerscale=0.7)
    figure.savefig(PICTURES / "benchmark_parts.png", dpi=150)


def draw_growth(results: Any) -> None:
    """Draw tick and floor of one world by the number of its robots."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
    for what, name, mark in (("tick [us]", "tick", "o-"), ("floor [us]", "pymunk alone", "s--")):
        costs = {_order(size)[0]: cost for size, cost in results["tick"][what].items() if size.startswith("1 x ")}
        axes.loglog(sorted(costs), [costs[robots] for robots in sorted(costs)], mark, label=name)
    axes.set(xlabel="robots in one world, constant density", ylabel="CPU time of a tick [us]")
    axes.legend()
    axes.grid(alpha=0.3)
    figure.savefig(PICTURES / "benchmark_growth.png", dpi=150)


def main() -> None:
    """Record the results for the document, and draw its pictures."""
    matplotlib.use("Agg")
    results = json.loads(RESULTS.read_text(encoding="utf-8"))
    draw_parts(results)
    draw_growth(results)
    machine, versions = results["tick"]["machine"], results["tick"]["versions"]
    told = ", ".join(f"{name} {number}" for name, number in versions.items())
    lines = [f"{machine['cpu']}, {machine['cores']} cores, {machine['platform']};", f"{told}.", "", "## Required", ""]
    lines += [*required(results), "", "## The tick by size", "", *sizes(results), ""]
    lines += ["![tick and floor by robots](pictures/benchmark_growth.png)", ""]
    lines += ["![parts of a tick by size](pictures/benchmark_parts.png)", ""]
    if "peers" in results:
        lines += ["", "## Beside peers: world-ticks per CPU second", "", *peers(results)]
    record("benchmarks/measured", "\n".join(lines))


if __name__ == "__main__":
    main()
