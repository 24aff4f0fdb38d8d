"""Recordings in formats of other tools: tables in Parquet, messages in MCAP."""

import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.tables import tables_of

MCAP = ".mcap"


def export(recording: RecordedMission, output: Path) -> int:
    """Write a recording to a file that ends with .mcap, else as Parquet into a new directory; return how many tables.

    Raises:
        ConfigurationError: the output exists or cannot be written, or the package of the format is not installed.

    """
    if output.exists():
        raise ConfigurationError(f"{output}: exists already; expected a new file or directory")
    write: Callable[[RecordedMission, Path], int] = _to_mcap if output.suffix == MCAP else _to_parquet
    try:
        return write(recording, output)
    except OSError as error:
        raise ConfigurationError(f"{output}: cannot be written ({error.strerror})") from error


def _to_parquet(recording: RecordedMission, output: Path) -> int:
    """Write a file for each table; the head is in the metadata of each."""
    arrow, parquet = _package("pyarrow"), _package("pyarrow.parquet")
    output.mkdir(parents=True)
    head = json.dumps(recording.head)
    tables = tables_of(recording)
    for title, columns in tables.items():
        table = arrow.table(columns).replace_schema_metadata({"clean_swarm": head})
        parquet.write_table(table, output / f"{title}.parquet", compression="zstd")
    return len(tables)


def _to_mcap(recording: RecordedMission, output: Path) -> int:
    """Write a JSON message for each table and frame; the head is metadata."""
    tables = tables_of(recording)
    with output.open("wb") as file:
        writer = _package("mcap.writer").Writer(file)
        writer.start(profile="", library="clean-swarm")
        writer.add_metadata("clean_swarm", {name: json.dumps(value) for name, value in recording.head.items()})
        channels = {title: _channel(writer, title, list(columns)) for title, columns in tables.items()}
        parts = {
            title: {name: np.array_split(values, recording.frames) for name, values in columns.items()}
            for title, columns in tables.items()
        }
        for frame, time in enumerate(recording.times):
            stamp = round(time * 1e9)
            for title, columns in parts.items():
                data = json.dumps({name: values[frame].tolist() for name, values in columns.items()}).encode()
                writer.add_message(channels[title], log_time=stamp, publish_time=stamp, sequence=frame, data=data)
        writer.finish()
    return len(tables)


def _channel(writer: Any, title: str, columns: list[str]) -> int:  # noqa: ANN401  (mcap has no types)
    numbers = {"type": "array", "items": {"type": "number"}}
    schema = {"type": "object", "properties": dict.fromkeys(columns, numbers)}
    number = writer.register_schema(name=title, encoding="jsonschema", data=json.dumps(schema).encode())
    return int(writer.register_channel(topic=f"/{title}", message_encoding="json", schema_id=number))


def _package(name: str) -> Any:  # noqa: ANN401  (a module)
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        raise ConfigurationError(f"export: {error.name} is not installed: pip install '.[export]'") from error
