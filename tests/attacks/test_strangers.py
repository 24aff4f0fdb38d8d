"""No command runs code because a file of a stranger asks for it; docs/own_plugins.md promises that."""

import re
import sys

import pytest
import typer

from tests.attacks.strangers import hostile_files
from tests.train.commands import command, run
from train.cli.app import app
from train.live.conductor import Conductor

DOCUMENTS = ("--config", "--starts", "--knowledge", "--store", "--configs")
"""Options that take a file."""
GIVEN = {
    "--robot": 0,
    "--time": 1,
    "--strategy": "fixed:Off",
    "--html": "new.html",
    "--source": "missions",
    "--output": "new.swarm",
    "output": "new.png",
}
"""What other arguments that commands need are given."""


def leaves(command, words=()):
    """Yield all commands with their words."""
    if not hasattr(command, "commands"):
        yield words, command
        return
    for name, below in command.commands.items():
        yield from leaves(below, (*words, name))


OPENING = ("evaluate", "explain", "play", "record", "replay", "train bandit")
"""Commands that the gate tries: those that run what a document, results or a recording name."""
COMMANDS = {" ".join(words): command for words, command in leaves(typer.main.get_command(app))}


def calls(words, command, path, folder):
    """Yield the words of the command with a file as each of its arguments, and as each option that takes a file."""
    options = {opt: p for p in command.params for opt in p.opts if opt.startswith("--")}
    needed = [word for opt, p in options.items() if p.required and opt not in DOCUMENTS for word in (opt, GIVEN[opt])]
    needed += ["--config", path] if "--config" in options else []
    needed += ["--missions", 100] if "--missions" in options else []
    arguments = [GIVEN.get(p.name, path) for p in command.params if not p.opts[0].startswith("-")]
    if arguments or needed:
        yield [*words, *arguments, *needed]
    for opt in DOCUMENTS:
        if opt in options and opt not in needed:
            yield [*words, *arguments, *needed, opt, folder if opt == "--configs" else path]


@pytest.fixture(scope="module")
def strange(tmp_path_factory):
    """The folder with hostile files, and the files."""
    folder = tmp_path_factory.mktemp("strange")
    return folder, hostile_files(folder)


@pytest.fixture
def run_silently(strange, monkeypatch, capsys, tmp_path):
    """Run a command in the folder with hostile files, none of which may have its code run."""
    folder, _ = strange
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setenv("CLEAN_SWARM_STORE", str(tmp_path / "own.sqlite"))
    (folder / "sang").unlink(missing_ok=True)
    monkeypatch.delitem(sys.modules, "canary", raising=False)
    monkeypatch.setattr(Conductor, "run", lambda self: None)  # a play goes on until Ctrl-C

    def run_words(*words):
        code, _, err = command(*words)
        assert not (folder / "sang").exists(), words
        assert code in (0, 2) or "Abort" in err, (words, err)
        assert "Traceback" not in err

    return run_words


@pytest.mark.parametrize("name", OPENING)
def test_a_hostile_file_of_each_kind_runs_nothing(strange, name, run_silently):
    folder, files = strange
    for path in files:
        run_silently(*next(calls(name.split(), COMMANDS[name], path, folder)))


@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_no_command_and_no_option_runs_what_a_hostile_file_asks_for(strange, name, run_silently):
    folder, files = strange
    for path in files:
        for words in calls(name.split(), COMMANDS[name], path, folder):
            run_silently(*words)


def test_trust_is_what_keeps_them_quiet(strange, monkeypatch, tmp_path, capsys):
    folder, _ = strange
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "path", [*sys.path])
    sang = folder / "sang"
    for words in (
        ["evaluate", "experiments/own.yaml", "--condition", "a", "--scenarios", "1", "--workers", "1"],
        ["explain", "results-model", "--robot", "0", "--time", "1"],
    ):
        monkeypatch.delitem(sys.modules, "canary", raising=False)
        assert run("--trust", *words) in (0, 2)
        assert sang.exists(), words
        said = re.findall(r"^trusted: (.+) asks to (.*)$", capsys.readouterr().err, re.MULTILINE)
        assert "import canary:Own" in [deed for _, deed in said]
        assert len(said) == len(set(said))
        sang.unlink()
