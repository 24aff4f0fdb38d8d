"""Replays decisions.json: single decisions, and rounds of decisions on a graph."""

from typing import Any

import numpy as np

from selforg import mechanisms
from selforg.gradients.gradient import Gradient
from selforg.gradients.queries import Filter, Queries
from selforg.mechanisms import Carried
from tests.golden.case import Case, difference
from tests.golden.scene import Scene, channel_of

# Quorum would overwrite the own pose (Q13); it is replayed spreading the same gradient on a channel of its own
QUORUM_CHANNEL = "quorum"
DEFAULTS = {
    "MorphogenesisBarycenter": {"attraction": -1, "diffusion": np.inf, "goal_radius": 0.5},
    "GossipMax": {"attraction": 0, "diffusion": np.inf, "goal_radius": 0.0},
    "Quorum": {"attraction": 0, "diffusion": 20.0, "goal_radius": 0.0},
}


def replay(case: Case) -> str | None:
    """Return how the replay differs from the original, None if it agrees."""
    return replay_rounds(case) if case.group.startswith("rounds.") else replay_single(case)


def replay_single(case: Case) -> str | None:
    """Replay one decision and its spreading."""
    inputs, expected, now = case.inputs, case.expected, case.inputs["time"]
    scene = Scene(inputs["buffer"])
    for message in inputs["messages"]:
        scene.store(message, message["stamp"])
    mechanism = create(scene, inputs["mechanism"], inputs["params"])
    decision = mechanism.decide(now)
    decided = written(mechanism, decision.values[0], decision.states[0]) if decision.decided[0] else None
    if wrong := difference(named(expected["calc_value"]), decided, "calc_value"):
        return wrong
    mechanism.spread(now)
    after = written(mechanism, mechanism.values[0], mechanism.state_codes[0])
    if wrong := difference(named(expected["after_spread"]), after, "after_spread"):
        return wrong
    return difference([message_of(m) for m in expected["messages"]], spread_by(scene, now), "messages")


def replay_rounds(case: Case) -> str | None:
    """Replay rounds: all spread in list order, then all messages are delivered along the edges."""
    inputs, agents = case.inputs, case.inputs["agents"]
    scenes, deciders = [], []
    for agent in agents:
        scene = Scene({"id": agent["id"], "view_distance": inputs["view_distance"]})
        own = inputs["own_pose"]
        pose = {"diffusion": own["diffusion"], "goal_radius": own["goal_radius"], "stamp": own["stamp"]}
        scene.poses.set_gradient(
            0, Gradient("robot", tuple(agent["p"]), heading=(1.0, 0.0, 0.0), attraction=-1, **pose)
        )
        scenes.append(scene)
        deciders.append(create(scene, inputs["mechanism"], {**inputs["params"], **agent.get("params", {})}))
    for index, expected in enumerate(case.expected["rounds"]):
        now = inputs["first_round_time"] + index * inputs["round_period"]
        for decider in deciders:
            decider.spread(now)
        states = [written(d, d.values[0], d.state_codes[0]) for d in deciders]
        if wrong := difference([named(entry) for entry in expected], states, f"round {index}"):
            return wrong
        deliver(scenes, inputs["edges"], now)
    return None


def deliver(scenes: list[Scene], edges: list[list[int]] | None, now: float) -> None:
    """Bring what each robot spread at `now` to its neighbours in the graph, or to all others."""
    spread = [own_gradients(scene, now) for scene in scenes]
    for i, sent in enumerate(spread):
        for j, receiver in enumerate(scenes):
            if i != j and (edges is None or [i, j] in edges or [j, i] in edges):
                for gradient in sent:
                    receiver.buffer.receive(gradient, now, row=0)


def create(scene: Scene, name: str, given: dict[str, Any]) -> Any:
    """Return our mechanism for the original's parameters."""
    if name == "ForagingDecision":
        return mechanisms.MECHANISMS.find(name)(scene.buffer, probability=given["probability"])
    quorum = name == "Quorum"
    channel = channel_of(given.get("frame", "robot" if quorum else ""))
    fields = {k: given.get(k, default) for k, default in DEFAULTS[name].items()}
    evaporation = {"evaporation_factor": given.get("ev_factor", 1.0), "evaporation_period": given.get("ev_time", 0.0)}
    key = "null" if quorum else given["key"]
    carried = Carried(QUORUM_CHANNEL if quorum else channel, key, **fields, **evaporation)
    keywords = {k: given[k] for k in ("threshold", "value") if given.get(k) is not None}
    if given.get("state") is not None:
        keywords["state"] = str(given["state"])  # ours are names, also those of a quorum
    if not quorum:
        keywords["key"] = key
    if name == "MorphogenesisBarycenter":
        keywords["center"] = Carried(
            given.get("center_frame", "Center"), attraction=given.get("attraction_center", 1),
            goal_radius=given.get("goal_center", 2.0), moving=given.get("moving_center", False),
        )  # fmt: skip
    return mechanisms.MECHANISMS.find(name)(scene.buffer, channel=channel, carried=carried, **keywords)


def written(mechanism: Any, value: float, state: int) -> list[Any]:
    """Return value and state in the form of the golden files."""
    return [float(value), mechanism.states[state]]


def named(entry: list[Any] | None) -> list[Any] | None:
    """Return an expected [value, state] with the state as a name."""
    return None if entry is None else [entry[0], str(entry[1])]


def own_gradients(scene: Scene, now: float) -> list[Any]:
    """Return what the robot of a scene spread at `now`."""
    found = Queries(scene.buffer).gradients(0, now, Filter(view_distance=np.inf))
    return [g for g in found if g.source == scene.id and g.stamp == now]


def spread_by(scene: Scene, now: float) -> list[dict[str, Any]]:
    """Return what was spread, in the form of `message_of`."""
    entries = [
        {
            "attraction": g.attraction, "diffusion": g.diffusion, "ev_factor": g.evaporation_factor,
            "ev_time": g.evaporation_period, "frame": g.channel, "goal_radius": g.goal_radius, "moving": g.moving,
            "p": list(g.position), "payload": dict(g.payload), "stamp": g.stamp,
        }
        for g in own_gradients(scene, now)
    ]  # fmt: skip
    return sorted(entries, key=lambda entry: not entry["payload"])


def message_of(message: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of an expected message that we spread too: without heading, and without the sender's name,
    which the original leaves out for a Center."""
    keys = ("attraction", "diffusion", "ev_factor", "ev_time", "frame", "goal_radius", "moving", "p", "stamp")
    entry = {key: message[key] for key in keys} | {"payload": message["payload"] or {}}
    if "null" in entry["payload"]:
        entry["frame"] = QUORUM_CHANNEL
    return entry
