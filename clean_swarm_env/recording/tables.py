"""Recordings as tables: one row for each frame and each robot, item, behaviour or what else a channel is about."""

import numpy as np

from clean_swarm_env.recording.channels import AnyArray
from clean_swarm_env.recording.reader import RecordedStretch

TableColumns = dict[str, AnyArray]
"""The columns of a table by their names, all of one length."""


def tables_of(recording: RecordedStretch) -> dict[str, TableColumns]:
    """Return the tables of a recording, or of a stretch of it.

    Channels with the same axes are columns of one table: `robot` has the poses, `item` the items, `robot-behaviour` the
    marks of the robots' networks, `AvoidCollision.RepulsionGradient-behaviour` those inside an option. Every table
    begins with `frame`, `time` [s] and a number for each axis.
    """
    tables: dict[str, TableColumns] = {}
    for name, channel in recording.channels.items():
        prefix, _, column = name.rpartition("/")
        if prefix in ("held", "opinion"):  # of goals, about robots
            prefix, column = "", name.replace("/", "_")
        own = channel.axes[1:] if prefix else channel.axes
        title = "-".join(filter(None, (prefix.replace("/", "."), *own)))
        if title not in tables:
            places = np.indices((recording.frames, *channel.shape), dtype=np.int32).reshape(1 + len(channel.shape), -1)
            tables[title] = {"frame": places[0] + np.int32(recording.first), "time": recording.times[places[0]]}
            tables[title] |= dict(zip(channel.axes, places[1:], strict=True))
        tables[title][column] = recording[name].reshape(-1)
    return tables
