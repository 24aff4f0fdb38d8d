"""Recordings in formats of other tools: tables in Parquet, messages in MCAP."""

import json
import math
from collections.abc import Iterable
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording.reader import RecordedMission, RecordedStretch, tables_of
from train.running.needs import check_file

MCAP = ".mcap"


def export(recording: RecordedMission, stretches: Iterable[RecordedStretch], output: Path) -> int:
    """Write a recording to a file that ends with .mcap, else as Parquet into a new directory; return how many tables.

    The output appears whole at the end. `stretches` are those of the recording, of which no channel need be kept.

    Raises:
        ConfigurationError: the output exists or cannot be written, needs more room or time than there is, or the
            package of the format is not installed.

    """
    if output.exists():
        raise ConfigurationError(f"{output}: exists already; expected a new file or directory")
    numbers = sum(math.prod(channel["shape"]) for channel in recording.head["channels"]) * recording.frames
    check_file(output, numbers, f"{numbers:,} numbers", "Parquet needs less than MCAP")
    write = _to_mcap if output.suffix == MCAP else _to_parquet
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=output.parent, prefix=f".{output.stem}-") as folder:
            count = write(recording, stretches, Path(folder) / output.name)
            (Path(folder) / output.name).rename(output)
        return count
    except OSError as error:
        raise ConfigurationError(f"{output}: cannot be written ({error.strerror})") from error


def _to_parquet(recording: RecordedMission, stretches: Iterable[RecordedStretch], output: Path) -> int:
    """Write a file for each table; the head is in the metadata of each."""
    arrow, parquet = _package("pyarrow"), _package("pyarrow.parquet")
    output.mkdir()
    files: dict[str, Any] = {}
    with ExitStack() as opened:
        for stretch in stretches:
            for title, columns in tables_of(stretch).items():
                table = arrow.table(columns).replace_schema_metadata({"clean_swarm": json.dumps(recording.head)})
                if title not in files:
                    file = parquet.ParquetWriter(output / f"{title}.parquet", table.schema, compression="zstd")
                    files[title] = opened.enter_context(file)
                files[title].write_table(table)
    return len(files)


def _to_mcap(recording: RecordedMission, stretches: Iterable[RecordedStretch], output: Path) -> int:
    """Write a JSON message for each table and frame; the head is metadata."""
    channels: dict[str, int] = {}
    with output.open("wb") as file:
        writer = _package("mcap.writer").Writer(file)
        writer.start(profile="", library="clean-swarm")
        writer.add_metadata("clean_swarm", {name: json.dumps(value) for name, value in recording.head.items()})
        for stretch in stretches:
            tables = {
                title: {name: values.reshape(stretch.frames, -1) for name, values in columns.items()}
                for title, columns in tables_of(stretch).items()
            }
            channels = channels or {title: _channel(writer, title, list(columns)) for title, columns in tables.items()}
            for frame, time in enumerate(stretch.times):
                at, number = round(time * 1e9), stretch.first + frame
                for title, columns in tables.items():
                    data = json.dumps({name: values[frame].tolist() for name, values in columns.items()}).encode()
                    writer.add_message(channels[title], log_time=at, publish_time=at, sequence=number, data=data)
        writer.finish()
    return len(channels)


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
