"""The scene of a golden case: one robot, its buffer, and messages stored through the public interface."""

from typing import Any

import numpy as np

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.space import Euclidean


class Scene:
    """A buffer with the original's evaporation by whole seconds, and the robot that owns it as row 0."""

    def __init__(self, options: dict[str, Any]) -> None:
        self.id = options.get("id", "")
        history = options.get("moving_storage_size", 2)
        aggregation = {
            k: "average" if v == "avg" else v for k, v in options.get("aggregation", {"DEFAULT": "max"}).items()
        }
        settings = BufferSettings(
            view_distance=options.get("view_distance", 1.5),
            aggregation=aggregation,
            aggregation_distance=options.get("aggregation_distance", 1.0),
            min_diffusion=options.get("min_diffusion", 0.1),
            moving_storage_size=history,
            store_all=options.get("store_all", True),
            channels=tuple(channel_of(c) for c in options.get("framestorage", ())),
            whole_seconds=True,
        )
        self.poses = OwnPoses(
            Euclidean(3), 1, channel=options.get("pose_frame", "robot"), history=history, names=(self.id,)
        )
        self.buffer = SoBuffer(settings, self.poses.space, self.poses)

    def store(self, message: dict[str, Any], now: float) -> None:
        """Deliver one golden message at `now` [s]."""
        self.buffer.receive(gradient_of(message), now, row=0)


def channel_of(frame: str) -> str:
    """Return the channel of a golden frame; the original stores an empty one as "None"."""
    return frame or "None"


def gradient_of(message: dict[str, Any]) -> Gradient:
    """Return a golden message as a gradient; its label travels in the payload."""
    return Gradient(
        channel=channel_of(message["frame"]),
        position=tuple(message["p"]),
        source=message.get("parent") or "None",
        heading=heading_of(message),
        attraction=message["attraction"],
        diffusion=message["diffusion"],
        goal_radius=message["goal_radius"],
        evaporation_factor=message.get("ev_factor", 1.0),
        evaporation_period=message.get("ev_time", 0.0),
        stamp=message["stamp"],
        clock=message.get("ev_stamp"),
        moving=message["moving"],
        payload={"id": message.get("id", ""), **(message.get("payload") or {})},
    )


def heading_of(message: dict[str, Any]) -> tuple[float, ...]:
    """Return the heading: the quaternion q (zero counts as identity) applied to the direction in the own frame."""
    x, y, z, w = message.get("q", (0.0, 0.0, 0.0, 1.0))
    direction = np.array(message.get("direction", (1.0, 0.0, 0.0)), dtype=float)
    norm = np.sqrt(x * x + y * y + z * z + w * w)
    if norm == 0.0:
        return tuple(direction)
    axis, w = np.array([x, y, z]) / norm, w / norm
    twist = 2.0 * np.cross(axis, direction)
    return tuple(direction + w * twist + np.cross(axis, twist))
