"""Exported and imported again, a store is the same; a document that no store wrote is refused with its key."""

import json
import re
from datetime import UTC, datetime

import pytest
from hypothesis import example, given

from selector.documents.errors import DocumentError
from selector.store import Key, Moments, StoredKnowledge, contents
from selector.store.contents import FORMAT, Entry
from tests.selector.refusing import refusal
from tests.selector.store import strategies as some

TRAPS = ["1e-9", "1.5e3", "no", "~", "null", "0x1F", "12:30:45", "2026-11-21", "=", "<<", "a: b", "- a", "é"]
NOW = datetime(2026, 11, 21, 10, 40, 49, 499_841, tzinfo=UTC)
EXPERT = Entry(
    goal="G",
    option="a",
    expert={"position": 0, "configuration": "C", "score": 1.0, "parameters": {"view": 2.0}},
    updated=NOW,
)
LEARNED = some.entry_of(Key("G", "a", "", "run"), Moments(2, -(2**24), 2**48), NOW)
TRAPPED = [some.entry_of(Key(name, name, name, name), Moments(1, 0, 0), NOW) for name in TRAPS]


def holding(*entries):
    return StoredKnowledge({entry.key: entry for entry in entries})


@given(some.contents)
@example(holding(*TRAPPED))
def test_a_document_holds_a_store_to_the_last_bit(tmp_path_factory, held):
    directory = tmp_path_factory.mktemp("documents")
    for name in ("store.yaml", "store.json"):
        path = directory / name
        path.write_text(contents.document_text(held, as_json=name.endswith("json")), encoding="utf-8")
        assert contents.read(path) == held


def test_equal_contents_give_equal_text():
    entries = [EXPERT, LEARNED, *TRAPPED]
    texts = {contents.document_text(holding(*some), as_json=False) for some in (entries, entries[::-1])}
    assert len(texts) == 1


def changed(entry=LEARNED, **changes):
    return FORMAT | {"entries": [entry.model_dump(mode="json") | changes]}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (changed(total=-(2**24)), r"s\.yaml: entries\.0\.total: expected a valid string, got -16777216"),
        (changed(total="1.5"), r"entries\.0\.total: .* got '1\.5'"),
        (changed(total="-40000000000000000000"), r"entries\.0: expected a sum of at most"),
        (changed(squares="-1"), r"entries\.0: sum -16777216 and squares -1 do not belong to 2 rewards"),
        (changed(count=0), r"entries\.0: expected a count from 1 to 68719476736, got 0"),
        (changed(count=True), r"entries\.0\.count: expected a valid integer, got True"),
        (changed(updated="2026-11-21T10:00:00"), r"entries\.0\.updated: .*timezone"),
        (changed(mean=1.0), r"entries\.0\.mean: unknown key"),
        (changed(source=""), r"entries\.0: source: expected one for rewards, and none for what an expert says"),
        (changed(EXPERT, source="run"), r"entries\.0: source: expected one for rewards, and none"),
        (changed(EXPERT, context="far"), r"entries\.0: expert: expected neither context nor rewards"),
        (changed(EXPERT, count=1), r"entries\.0: expert: expected neither context nor rewards"),
        (changed() | {"entries": changed()["entries"] * 2}, r"entries\.1: the entry of G, a, , run is given twice"),
        (changed() | {"version": 2}, r"version: expected 1, got 2"),
        (changed() | {"format": "something"}, r"format: expected 'clean-swarm knowledge store', got"),
        (FORMAT, "entries: missing key"),
    ],
)
def test_mistakes_name_file_and_key_in_one_line(content, message):
    assert re.search(message, refusal(contents.from_document, content, "s.yaml"))


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("s.json", '{"format": ', r"s\.json: line 1: expected JSON, got the end"),
        ("s.json", "[]", r"s\.json: expected a mapping of keys, got list"),
        ("s.json", '{"a": 1, "a": 2}', r"s\.json: key 'a' twice"),
        ("s.yaml", "format: [1]]", r"s\.yaml: line 1"),
        ("s.yaml", "goals: {G: []}", r"s\.yaml: goals\.G: .*at least 1 item"),
        ("none.json", None, r"none\.json: cannot be read"),
    ],
)
def test_files_that_are_no_documents_are_refused(tmp_path, name, text, message):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(DocumentError, match=message):
        contents.read(tmp_path / name)


def test_expert_knowledge_is_read_as_well(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({"goals": {"G": [{"configuration": "A", "score": 1}]}}))
    ((key, expert),) = contents.read(path).expert.items()
    assert (key, expert.score, expert.parameters) == (("G", "A"), 1.0, {})
