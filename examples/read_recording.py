"""Reads a recording with NumPy and the standard library alone: `python examples/read_recording.py FILE.swarm`.

All numbers are little-endian. A file begins with 8 bytes, `93 53 57 41 52 4D 0D 0A`, and the version, uint32: 1. Blocks
follow: 4 bytes of kind (`HEAD`, `DATA` or `DONE`), uint32 length of the content, uint32 CRC-32 of the content, and the
content, compressed by zlib.

`HEAD` comes first: a JSON object. `channels` lists name, axes, shape, scale, order, unit and meaning of each channel.
Beside it are `period` [s], `width` and `height` [m], `robots`, `items`, `counted_distances` [m] below which pairs of
robots count as colliding, `options` by goal, `views` [m] of the options, `about` and the whole `mission`; with minds
also `networks` (names of behaviours, sensors and goals, and what each behaviour needs), `terms` and `reasons` (words,
by number), `task_words` and `destinations`; with a task that has events of its own also `events`: the channel `of`
numbers that go up, the `event` that this is, and what it is `about`. `DONE` comes last: a JSON object with the figures
of a mission that ended. A mission that was stopped has none.

`DATA` contains some frames. It begins with uint32 J and a JSON object of J bytes: `first` (number of the first frame),
`frames` (T), `sizes` (for each channel: C, the number of columns that change, and w, the width of a number: 1, 2 or 4
bytes), `deposits` (kinds of gradients left so far) and `by_hand` (changes by a person before these frames were decided,
each with its `tick`, the number of the frame). For each channel of K columns, one after the other, follow:

1. the first frame: K numbers int32;
2. a bit for each column, the lowest of a byte first, 1 where the column changes: ceil(K / 8) bytes;
3. the differences in time of the C columns that change, column by column, T - 1 signed numbers of w bytes each: first
   the lowest byte of all, then the next one of all, and so on.

With order 1 a number is the one before plus the difference. With order 2 the differences are of the differences, the
first of them of 0. Values are numbers divided by the scale; positions are whole millimetres. Values beyond +-(2^30 - 1)
steps are stored as that bound.
"""

import json
import struct
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


def read(path: str) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]:
    """Return the head of a recording, and its channels: name -> values (T, ...)."""
    data, head, at = Path(path).read_bytes(), dict[str, Any](), 12
    parts: dict[str, list[NDArray[np.float64]]] = {}
    while at + 12 <= len(data):
        kind, length, checksum = struct.unpack_from("<4sII", data, at)
        block, at = data[at + 12 : at + 12 + length], at + 12 + length
        if len(block) < length or zlib.crc32(block) != checksum:
            break  # the run was killed here
        content = zlib.decompress(block)
        if kind == b"HEAD":
            head = json.loads(content)
            parts = {channel["name"]: [] for channel in head["channels"]}
        elif kind == b"DATA":
            (size,) = struct.unpack_from("<I", content)
            directory, content = json.loads(content[4 : 4 + size]), content[4 + size :]
            frames = directory["frames"]
            for channel, (changing, width) in zip(head["channels"], directory["sizes"], strict=True):
                columns = int(np.prod(channel["shape"], dtype=int))
                bits, begin = -(-columns // 8), 4 * columns
                first = np.frombuffer(content, "<i4", columns)
                moves = np.unpackbits(np.frombuffer(content, np.uint8, bits, begin), count=columns, bitorder="little")
                planes = np.frombuffer(content, np.uint8, changing * (frames - 1) * width, begin + bits)
                steps = np.ascontiguousarray(planes.reshape(width, -1).T).view(f"<i{width}")
                steps = steps.reshape(changing, frames - 1).T.astype(np.int64)
                for _ in range(channel["order"]):
                    steps = steps.cumsum(axis=0)
                numbers = np.tile(first.astype(np.int64), (frames, 1))
                numbers[1:, moves == 1] += steps
                parts[channel["name"]].append(numbers.reshape(frames, *channel["shape"]) / channel["scale"])
                content = content[begin + bits + len(planes) :]
    return head, {name: np.concatenate(values) for name, values in parts.items()}


if __name__ == "__main__":
    for name, values in read(sys.argv[1])[1].items():
        print(name, values.shape)
