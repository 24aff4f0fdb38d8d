"""Whatever stands in a document, it is read, or refused in one line that names it, at once and in little memory."""

import pytest

from tests.attacks.readers import KINDS, READERS, refused_in_one_line


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_not_text_is_refused(kind, tmp_path):
    for content in (b"\xff\xfe\x00", b"\x80abc", b"", b"\n", b"- 1", b"7", bytes(range(256))):
        path = tmp_path / "attack.yaml"
        path.write_bytes(content)
        assert refused_in_one_line(READERS[kind], path)
    assert refused_in_one_line(READERS[kind], tmp_path / "nothing.yaml")
    (tmp_path / "folder.yaml").mkdir()
    assert refused_in_one_line(READERS[kind], tmp_path / "folder.yaml")
