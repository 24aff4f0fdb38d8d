"""Whatever stands in a document, it is read, or refused in one line that names it, at once and in little memory."""

from contextlib import suppress

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from selector.documents.errors import DocumentError
from selector.documents.reading import read_value
from selector.strategies.registry import spec_from_text
from tests.attacks import hostile
from tests.attacks.readers import READERS, refused_in_one_line

KINDS = ["experiments", "families", "knowledge", "mechanisms", "missions", "robots", "studies", "training"]
STARTS = {
    "torus_m": [11, 11],
    "recycling": [2, 1],
    "dump": [1, 1],
    "cases": [{"id": "1", "robots": [[1, 1, 0], [3, 3, 0]], "items": [[2, 2]], "measured": {"a": {"duration_s": 1.5}}}],
}
STORE = {
    "format": "clean-swarm knowledge store",
    "version": 1,
    "expert": {
        "G": [
            {"configuration": "C", "score": 1.0, "name": "a", "parameters": {"view": 2.0}, "position": 0}
            | {"source": "expert", "updated": "2026-11-21T00:00:00.000000+00:00"}
        ]
    },
    "learned": [
        {"goal": "G", "option": "a", "context": "", "source": "run", "updated": "2026-11-21T00:00:00.000000+00:00"}
        | {"count": 1, "total": "5", "squares": "25"}
    ],
}
often = settings(
    max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture]
)


@pytest.mark.parametrize("kind", KINDS)
def test_a_hostile_value_anywhere_is_refused_in_one_line_or_read(kind, tmp_path):
    @often
    @given(hostile.documents(kind))
    def attack(text):
        refused_in_one_line(READERS[kind], hostile.write(tmp_path, "attack.yaml", text))

    attack()


@pytest.mark.parametrize(("kind", "content"), [("given starts", STARTS), ("exported store", STORE)])
def test_hostile_json_is_refused_in_one_line_or_read(kind, content, tmp_path):
    @often
    @given(hostile.json_documents(content))
    def attack(text):
        refused_in_one_line(READERS[kind], hostile.write(tmp_path, "attack.json", text))

    attack()


@often
@given(st.text() | hostile.texts | hostile.plain_values.map(str))
def test_values_of_the_command_line_are_read_or_refused_in_one_line(text):
    for read in (read_value, lambda value: spec_from_text(f"UCB1:prior={value}"), spec_from_text):
        with suppress(DocumentError):
            read(text)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_not_text_is_refused(kind, tmp_path):
    for content in (b"\xff\xfe\x00", b"\x80abc", b"", b"\n", b"- 1", b"7", bytes(range(256))):
        path = tmp_path / "attack.yaml"
        path.write_bytes(content)
        assert refused_in_one_line(READERS[kind], path)
    assert refused_in_one_line(READERS[kind], tmp_path / "nothing.yaml")
    (tmp_path / "folder.yaml").mkdir()
    assert refused_in_one_line(READERS[kind], tmp_path / "folder.yaml")
