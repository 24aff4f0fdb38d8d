"""Exported and imported again, a store is the same; a document that no store wrote is refused with its key."""

import json

import pytest
from hypothesis import example, given

from selector.documents.errors import DocumentError
from selector.knowledge import Option
from selector.store import Key, Moments, StoredKnowledge, document
from selector.store.stored_knowledge import LearnedEntry, Rated
from tests.selector.store import strategies as some

TRAPS = ["1e-9", "1.5e3", "no", "~", "null", "0x1F", "12:30:45", "2026-11-21", "=", "<<", "a: b", "- a", "é"]
SMALL = StoredKnowledge(
    {("G", "a"): Rated(Option(configuration="C", score=1.0, name="a", parameters={"view": 2.0}), 0, "expert", 7)},
    {Key("G", "a", "", "run"): LearnedEntry(Moments(2, -(2**24), 2**48), 1_795_257_649_499_841)},
)


@given(some.contents())
@example(StoredKnowledge({}, {Key(name, name, name, name): LearnedEntry(Moments(1, 0, 0), 0) for name in TRAPS}))
@example(StoredKnowledge({(n, n): Rated(Option(configuration=n, score=1e-9, name=n), 0, n, 10**15) for n in TRAPS}))
def test_a_document_holds_a_store_to_the_last_bit(tmp_path_factory, contents):
    directory = tmp_path_factory.mktemp("documents")
    for name in ("store.yaml", "store.json"):
        path = directory / name
        path.write_text(document.document_text(contents, as_json=name.endswith("json")), encoding="utf-8")
        assert document.read(path, "unused") == contents


def test_equal_contents_give_equal_text(tmp_path):
    backwards = StoredKnowledge(
        SMALL.expert,
        dict(reversed([(Key("A", "b", "c", "d"), LearnedEntry(Moments(1, 0, 0), 0)), *SMALL.learned.items()])),
    )
    forwards = StoredKnowledge(SMALL.expert, dict(reversed(backwards.learned.items())))
    assert document.document_text(backwards, as_json=False) == document.document_text(forwards, as_json=False)


def changed(**changes):
    content = document.as_document(SMALL)
    content["learned"][0] |= changes
    return content


def twice(part):
    content = document.as_document(SMALL)
    entries = content["learned"] if part == "learned" else content["expert"]["G"]
    entries.append(entries[0])
    return content


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (changed(total=-(2**24)), r"s\.yaml: learned\.0\.total: expected a valid string, got -16777216"),
        (changed(total="1.5"), r"learned\.0\.total: .* got '1\.5'"),
        (changed(total="-40000000000000000000"), r"learned\.0: expected a sum of at most"),
        (changed(squares="-1"), r"learned\.0: sum -16777216 and squares -1 do not belong to 2 rewards"),
        (changed(count=0), r"learned\.0: expected a count from 1 to 68719476736, got 0"),
        (changed(count=True), r"learned\.0\.count: expected a valid integer, got True"),
        (changed(updated="2026-11-21T10:00:00"), r"learned\.0\.updated: .*timezone"),
        (changed(mean=1.0), r"learned\.0\.mean: unknown key"),
        (twice("learned"), r"learned\.1: the entry of G, a, , run is given twice"),
        (twice("expert"), r"expert\.G: option 'a' is given twice"),
        (document.as_document(SMALL) | {"version": 2}, r"version: expected 1, got 2"),
        (document.as_document(SMALL) | {"format": "something"}, r"format: expected 'clean-swarm knowledge store', got"),
        ({"format": "clean-swarm knowledge store", "version": 1, "expert": {}}, "learned: missing key"),
    ],
)
def test_mistakes_name_file_and_key_in_one_line(content, message):
    with pytest.raises(DocumentError, match=message) as error:
        document.from_document(content, "s.yaml")
    assert "\n" not in str(error.value)


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
        document.read(tmp_path / name, "expert")


def test_expert_knowledge_is_read_as_well(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({"goals": {"G": [{"configuration": "A", "score": 1}]}}))
    (rated,) = document.read(path, "me").expert.values()
    assert (rated.option.name, rated.option.score, rated.source) == ("A", 1.0, "me")
