"""Replays buffer.json: sequences of stores and queries."""

from typing import Any

import numpy as np

from selforg.gradients.gradient import Gradient
from selforg.gradients.queries import ATTRACTIVE, EVERYTHING, REPULSIVE, Filter, Queries
from tests.golden.case import Case, SetAside, difference
from tests.golden.scene import Scene, channel_of
from tests.golden.ties import equally_good
from tests.selforg.gradients.objects import chosen, histories, neighbours, static_ahead

SIGNS = {"gradients": EVERYTHING, "attractive_gradients": ATTRACTIVE, "repulsive_gradients": REPULSIVE}
CHOICES = {
    "max_attractive_gradient": "nearest_attractive",
    "min_attractive_gradient": "farthest_attractive",
    "max_reach_attractive_gradient": "most_reach_attractive",
    "min_reach_attractive_gradient": "least_reach_attractive",
    "strongest_gradient": "strongest",
}


def replay(case: Case) -> str | None:
    """Return the first query whose answer differs from the original's, None if there is none."""
    if case.group == "double_counting":
        raise SetAside("Q29")
    if case.group == "upstream_crash":
        raise SetAside("Q8")
    scene, results = Scene(case.inputs["buffer"]), iter(case.expected["results"])
    first = None  # deviation; the other queries still have to agree
    for index, op in enumerate(case.inputs["ops"]):
        if op["op"] == "store":
            scene.store(op["msg"], op["time"])
            continue
        expected = next(results)["result"]
        if op["call"] == "own_pose" and expected is not None:
            expected = {**expected, "id": ""}  # poses carry no labels
        answer = query(scene, op["call"], op["time"], op.get("args", {}))
        wrong = difference(expected, answer, f"op {index} {op['call']}")
        if wrong:
            aside = deviation(scene, op["call"], op["time"], op.get("args", {}), expected)
            if aside is None:
                return wrong
            first = first or aside
    if first:
        raise SetAside(first)
    return None


def deviation(scene: Scene, call: str, now: float, args: dict[str, Any], expected: Any) -> str | None:
    """Return the number of the deviation that explains why an answer differs from the `expected` one."""
    if "view_angle_xy" in args and args["view_angle_xy"] is None:
        return "Q4"
    if isinstance(expected, list) and any(np.isnan(entry["diffusion"]) for entry in expected):
        return "B3"
    if call in CHOICES and expected is not None:
        tied = equally_good(scene, CHOICES[call], now, filter_of(args))
        return "B9" if any(difference(expected, written(gradient)) is None for gradient in tied) else None
    return None


def filter_of(args: dict[str, Any], view_distance: float | None = None) -> Filter:
    """Return what a query of the original looks at."""
    channels = tuple(channel_of(c) for c in args.get("frames") or ())
    return Filter(channels, args.get("static", True), args.get("moving", True), view_distance)


def query(scene: Scene, call: str, now: float, args: dict[str, Any]) -> Any:
    """Return the answer to one of the original's queries, in its form."""
    look = filter_of(args, np.inf if call == "all_gradients" else None)
    if call == "own_pose":
        return written(scene.poses.gradient(0)) if scene.poses.known[0] else None
    if call in CHOICES:
        found = chosen(scene.buffer, CHOICES[call], now, look)
        return written(found[0]) if found else None
    if call == "agent_list":
        answer = neighbours(scene.buffer, now, look)
    elif call == "agent_set":
        answer = histories(scene.buffer, now, look, own=args.get("include_own", True))
    elif call == "static_list_angle":
        xy, yz = args.get("view_angle_xy"), args.get("view_angle_yz")
        answer = static_ahead(scene.buffer, now, np.inf if xy is None else xy, np.inf if yz is None else yz, look)
    else:
        answer = Queries(scene.buffer).gradients(0, now, look, signs=SIGNS.get(call, EVERYTHING))
    return sorted((written(gradient) for gradient in answer), key=lambda entry: entry["id"])


def written(gradient: Gradient) -> dict[str, Any]:
    """Return a gradient in the form of the golden files."""
    return {
        "id": gradient.payload.get("id", ""),
        "frame": gradient.channel,
        "parent": gradient.source,
        "p": list(gradient.position),
        "attraction": gradient.attraction,
        "diffusion": gradient.diffusion,
        "goal_radius": gradient.goal_radius,
        "ev_stamp": gradient.stamp if gradient.clock is None else gradient.clock,
        "moving": gradient.moving,
    }
