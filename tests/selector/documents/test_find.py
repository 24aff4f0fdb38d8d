"""Files of every kind are found alike: by name in the user's directories and the shipped one, or by path."""

import shutil

import pytest

from selector.documents.errors import DocumentError
from selector.documents.find import KINDS, SHIPPED, files_of, find_file

pytestmark = pytest.mark.parametrize("kind", list(KINDS))


def written(directory, kind, name="mine"):
    path = directory / kind / (name + KINDS[kind].ending)
    path.parent.mkdir(parents=True)
    path.write_text("a: 1")
    return path


def test_the_shipped_directory_holds_every_kind_but_learned_strategies(kind):
    assert {path.name for path in SHIPPED.iterdir() if path.is_dir()} - {"__pycache__"} == set(KINDS) - {"strategies"}
    assert bool(files_of(kind)) is (kind != "strategies")


def test_a_name_is_looked_for_in_every_directory_in_order(tmp_path, kind):
    first, second = tmp_path / "first", tmp_path / "second"
    theirs = written(second, kind)
    first.mkdir()
    assert find_file(kind, "mine", (first, second)) == theirs
    ours = written(first, kind)
    assert find_file(kind, "mine", (first, second)) == ours
    for shipped in files_of(kind):
        assert find_file(kind, shipped, (first, second)) == SHIPPED / kind / (shipped + KINDS[kind].ending)
    assert set(files_of(kind, (first, second))) == {"mine", *files_of(kind)}


def test_a_path_is_taken_as_it_is(tmp_path, kind):
    path = written(tmp_path, kind)
    name = str(path).removesuffix("/policy.json")
    assert find_file(kind, name) == path
    shutil.rmtree(tmp_path / kind)
    with pytest.raises(DocumentError, match=rf"^file: mission: {name}: no such file$"):
        find_file(kind, name, where="file: mission: ")
    if "/" not in KINDS[kind].ending:
        expected = rf"^k: {tmp_path}: expected a file, or a folder with {kind}\{KINDS[kind].ending}, got one without$"
        with pytest.raises(DocumentError, match=expected):
            find_file(kind, str(tmp_path), where="k: ")


def test_an_unknown_name_lists_what_all_directories_hold(tmp_path, kind):
    written(tmp_path, kind)
    with pytest.raises(DocumentError, match=rf"^here: unknown {KINDS[kind].called} 'mime' .*did you mean 'mine'"):
        find_file(kind, "mime", (tmp_path,), "here: ")
    with pytest.raises(DocumentError, match="nowhere: no such directory"):
        find_file(kind, "mine", (tmp_path / "nowhere",))
