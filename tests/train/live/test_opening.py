"""`clean-swarm play` opens the browser by a page that only its user can read, because command lines are public."""

import stat
import webbrowser
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

import pytest

from tests.train.commands import done, run
from train.cli import play
from train.live.conductor import Conductor


@pytest.fixture
def opened(monkeypatch):
    """What the browser is asked to open, with the modes of file and folder, and the content."""
    found = []

    def note(address):
        path = Path(url2pathname(urlsplit(address).path))
        found.extend([address, *(stat.S_IMODE(each.stat().st_mode) for each in (path, path.parent)), path.read_text()])

    monkeypatch.setattr(webbrowser, "open", note)
    monkeypatch.setattr(play, "_has_screen", lambda: True)
    monkeypatch.setattr(Conductor, "run", lambda self: self._end())
    return found


def test_the_token_is_in_a_file_of_the_user_and_not_in_the_command_line(tmp_path, monkeypatch, opened):
    monkeypatch.chdir(tmp_path)
    printed = done("play", "ReachGoal").splitlines()[0]
    address, of_file, of_folder, content = opened
    assert address.startswith("file:///")
    assert printed.partition("token=")[2] not in address
    assert (of_file, of_folder) == (0o600, 0o700)
    assert f'content="0; url={printed}"' in content
    assert [path.name for path in (tmp_path / "results").iterdir()] == ["play-ReachGoal-1.swarm"]


def test_a_folder_with_a_space_and_an_end_by_ctrl_c(tmp_path, monkeypatch, opened):
    (tmp_path / "my runs").mkdir()
    monkeypatch.chdir(tmp_path / "my runs")

    def interrupted(self):
        self._end()
        raise KeyboardInterrupt

    monkeypatch.setattr(Conductor, "run", interrupted)
    assert run("play", "ReachGoal", "--output", "a.swarm") == 130
    assert opened[1:3] == [0o600, 0o700]
    assert [path.name for path in Path().iterdir()] == ["a.swarm"]
