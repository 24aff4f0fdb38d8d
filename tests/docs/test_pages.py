"""What the pages show works: code runs and prints what they say, documents are read, command lines name what there is.

Code runs block by block in an empty directory with the examples and the files of its page; a block below
`<!-- ci: part -->` is a part of something else and only compiled. Of the commands all are read and some run; the long
tests run README, commands and tutorials as they are.
"""

import json
import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import typer.main
import yaml

from clean_swarm_env.config.load import load_experiment, load_family, load_mission
from clean_swarm_env.learning.reward import RewardConfig
from clean_swarm_env.recording.reader import RecordedMission
from examples.read_recording import read
from selector.configurations.library import Library
from selector.coordination.robot_document import network_from, read_robot
from selector.documents.find import load_file
from selector.knowledge import load_knowledge
from selector.strategies.registry import StrategySpec, spec_from_text
from selforg import plugins
from selforg.registry import REGISTRIES
from tests.pages import blocks, text_of
from tests.paths import ROOT
from tests.train.commands import done, run, shipped
from tests.train.live.sessions import SMALL as OF_SIX
from tests.train.live.sessions import play_of, served
from train import memory
from train.cli import app as command_line
from train.cli.listing import names_of
from train.learning.config import TrainingConfig
from train.live.server import LiveServer
from train.live.session import Session

PAGES = [path.relative_to(ROOT).as_posix() for path in sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])]
TRAINS = re.compile("stable_baselines3|clean_swarm_env.sb3")
GOES_ON = {"docs/selector.md"}
"""Pages whose blocks of Python go on from those before."""
APART = {"docs/play.md", "docs/recordings.md"}
"""Pages whose code has a test of its own."""
SMALL = {"worlds=24": "worlds=2", "1_000_000": "2_000"}
"""What takes long in code -> what runs in its place."""
PRINTS = {
    "README.md": r"\d+ s, return -?\d+\.\d, options \{'AvoidCollision': \('RepulsionFernandez-view2.0', .*\)\}\n",
    "docs/families.md": "(30 items, spots: .*\n){3}",
    "docs/transport.md": re.escape("6 stations, kinds: (0, 1, 0, 0, 1, 1)\n"),
}
"""Page -> what its block prints, where the page does not say it."""


def at_the_goal(names):
    offsets = np.abs(names["positions"] - 6.0)
    return (np.hypot(*np.minimum(offsets, 12.0 - offsets).T) <= 2.5).all()  # goal radii, and the others around


LEAVES = {
    "docs/network.md": lambda names: (
        names["running"].shape == (320, 2)
        and [names["model"].behaviours[b].name for b in names["network"].state.plan[0, :2]] == ["GoHome", "Charge"]
    ),
    "docs/selector.md": lambda names: at_the_goal(names) if "positions" in names else names["vectors"].shape == (5, 2),
}
"""Page -> whether its block left what the page speaks of."""


def code_of_pages():
    """Return the blocks of Python; what two pages show is run once."""
    every = [block for page in reversed(PAGES) if page not in APART for block in reversed(blocks(page, "python"))]
    found = {without_remarks(block): block for block in every}
    extra = [pytest.mark.extra]
    return [
        pytest.param(block, id=f"{block.page}:{block.line}", marks=extra if TRAINS.search(block.text) else [])
        for block in reversed(found.values())
    ]


def without_remarks(block):
    return re.sub(" *#.*", "", block.text)


def write_files(page, folder):
    for block in blocks(page):
        if block.file:
            (folder / block.file).parent.mkdir(parents=True, exist_ok=True)
            (folder / block.file).write_text(block.text, encoding="utf-8")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty directory with the examples, in which the test runs; what is registered in it is forgotten."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(plugins.NAMED, "")
    monkeypatch.setenv(memory.VARIABLE, "user.sqlite")
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    for registry in REGISTRIES:
        registry.names()  # our own are there
        monkeypatch.setattr(registry, "_classes", shipped(registry))
    yield tmp_path
    for name in [name for name in sys.modules if name.startswith(plugins.OF_FILE)]:
        del sys.modules[name]


@pytest.mark.parametrize("block", code_of_pages())
def test_code_runs_and_prints_what_the_page_says(block, folder, capsys):
    if block.mark == "part":
        compile(block.text, block.page, "exec")
        return
    if TRAINS.search(block.text):
        pytest.importorskip("stable_baselines3", reason="needs the extra 'train'")
    write_files(block.page, folder)
    names = {}
    if block.page in GOES_ON:
        for before in blocks(block.page, "python"):
            if before.line < block.line:
                before.run(names)
        capsys.readouterr()
    for long, short in SMALL.items():
        block = block._replace(text=block.text.replace(long, short))
    block.run(names)
    printed = capsys.readouterr().out
    assert re.fullmatch(PRINTS.get(block.page, ".*") if "print(" in block.text else "", printed, re.DOTALL)
    said = re.findall(r"^print\(.*# (.*)$", block.text, re.MULTILINE)
    following = text_of(block.page).partition(block.text)[2].partition("```")[2].partition("```")[0]
    said += re.findall(r"It prints `(.*?)`", following)
    assert [line for line in said if line not in printed.splitlines()] == []
    assert LEAVES.get(block.page, bool)(names)


ALONE = "examples/read_recording.py"


def test_what_was_recorded_is_read_without_our_code(folder, capsys):
    program, explained = blocks("docs/recordings.md", "python")
    names = program.run()
    assert "traces of pheromone at 20 s" in capsys.readouterr().out
    explained.run(names)
    told = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in told[:100]] == [f"{round(k / 5, 1)}" for k in range(100)]
    assert told[100].startswith("{'AvoidCollision': ")
    assert not re.search(r"^(from|import) (?!json|struct|sys|zlib|pathlib|typing|numpy)", text_of(ALONE), re.MULTILINE)
    (_, channels), recording = read("recordings/run.swarm"), RecordedMission(folder / "recordings" / "run.swarm")
    assert set(channels) == set(recording)
    for name, values in recording.items():
        np.testing.assert_array_equal(channels[name], values, name)


def test_the_example_of_play_follows_a_session(folder):
    block, _ = blocks("docs/play.md", "python")  # the other one is a plug-in
    names = block.run()
    with served(Session(play_of(OF_SIX), folder / "run.swarm")) as server:
        frames = names["follow"](server.address)
        names["order"](server.address, do="put_robot", robot=2, x=1.0, y=3.0)
        names["order"](server.address, do="step")
        frame = next(frames)
        assert [frame["x"][2], frame["y"][2]] == pytest.approx([1.0, 3.0])


LOADERS = {
    "experiments": lambda name, directories: load_experiment(name, directories),
    "families": load_family,
    "knowledge": load_knowledge,
    "mechanisms": lambda name, directories: Library(directories).configuration(name),
    "missions": load_mission,
    "robots": lambda name, directories: read_robot(directories[0] / "robots" / f"{name}.yaml"),
    "training": lambda name, directories: load_file("training", name, TrainingConfig, directories),
}
"""Folder of a directory of configurations -> what reads a file of it."""
DOCUMENTS = {
    "docs/commands.md": ("missions/phases",),
    "docs/models.md": ("missions/two-sizes", "missions/groups", "", "families/mixed-teams"),
    "docs/own_plugins.md": ("training/parting",),
    "docs/own_task.md": ("missions/large-flock",),
    "docs/results.md": ("experiments/mine",),
    "docs/selector.md": ("mechanisms/Shy", "knowledge/mine", "mechanisms/Bend", "mechanisms/Sum"),
    "docs/walls.md": ("families/crowded-careful", "", "families/rooms"),
}
"""Page -> what its blocks of YAML are that have no file above them; "" for a part of a document."""
HOLDS = {
    "docs/own_plugins.md": lambda training: training.reward == RewardConfig(),
    "docs/own_task.md": lambda mission: mission.task.sheep == 30,
    "docs/results.md": lambda experiment: list(experiment.variants) == ["none", "messages lost 0.5"],
}
"""Page -> whether its document is what the page speaks of."""


@pytest.mark.parametrize("page", [page for page in PAGES if page in DOCUMENTS or any(b.file for b in blocks(page))])
def test_documents_are_read(page, folder):
    write_files(page, folder)
    own = [block.file for block in blocks(page, "python") if block.file]
    plugins.import_named(["examples/own_task.py"] if page == "docs/own_task.md" else own)
    unnamed = iter(DOCUMENTS.get(page, ()))
    files = [block._replace(file=block.file or f"my/{next(unnamed, '')}.yaml") for block in blocks(page, "yaml")]
    for block in files:
        (folder / block.file).parent.mkdir(parents=True, exist_ok=True)
        (folder / block.file).write_text(block.text)
    for place in (block.file.removesuffix(".yaml").split("/") for block in files if block.file != "my/.yaml"):
        found = LOADERS[place[1]](place[2], [folder / "my"])
        assert HOLDS.get(page, bool)(found)


def swallowed(text):
    """Return the lines that MyST takes for comments or breaks, so that the site does not show them."""
    prose = re.sub(r"(?ms)^ *```.*?^ *```$", "", text)
    return [line for line in prose.splitlines() if re.match(r" {0,3}(%|\+\+\+)", line)]


def test_the_site_shows_each_line_of_each_page():
    assert swallowed("It costs 16\n% [12, 19] less.\n\n```tex\n% code\n```") == ["% [12, 19] less."]
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "configs" / "policies").rglob("*.md")]
    assert {page.name: lines for page in pages if (lines := swallowed(page.read_text(encoding="utf-8")))} == {}


def test_a_part_of_a_document_is_read_by_what_reads_the_whole():
    spec, _ = blocks("docs/strategies.md", "yaml")  # the other one is a state machine
    (word,) = re.findall(r"or in one word, `(.*?)`", text_of("docs/strategies.md"))
    assert StrategySpec.model_validate(yaml.safe_load(spec.text)) == spec_from_text(word)
    (network,) = blocks("docs/network.md", "yaml")
    assert list(network_from(yaml.safe_load(network.text)).inner) == ["Approach"]


@pytest.mark.extra
def test_dask_knows_the_settings():
    dask = pytest.importorskip("dask", reason="needs the extra 'cluster'")
    pytest.importorskip("distributed", reason="needs the extra 'cluster'")

    def check(given, known):
        assert given.keys() <= known.keys()
        for name, value in given.items():
            if isinstance(value, dict) and name != "pre-spawn-environ":  # any variables
                check(value, known[name])

    (settings,) = [block for block in blocks("docs/clusters.md", "yaml") if block.text.startswith("distributed:")]
    check(yaml.safe_load(settings.text), dask.config.config)


COMMANDS = [page for page in PAGES if blocks(page, "sh")]
NAMED = {"evaluate": ("experiments", "families", "tasks", "missions"), "--config": ("training",)}
"""Command or option -> the kinds of names that it takes."""
OF_EXAMPLES = {"Shepherding", "KeepApart", "parting"}
"""Names that the files in `examples` bring."""


def lines_of(block):
    """Yield the words of each command of ours or of Python, without what the shell does with them."""
    for words in block.commands():
        while words:
            end = next((at for at, word in enumerate(words) if word in ("&&", ">", ";")), len(words))
            line = [word for at, word in enumerate(words[:end]) if at or "=" not in word]
            program = line[0].rpartition("/")[2]
            if program.startswith(("clean-swarm", "python")):
                yield [program, *line[1:]]
            words = words[end + 1 :]


def parse(words):
    """Read the words of a command as the program does, down to the innermost command, without running it."""
    words = [word for word in words if word != command_line.TRUST]
    while command_line.IMPORT_PLUGIN in words:
        at = words.index(command_line.IMPORT_PLUGIN)
        del words[at : at + 2]
    command, name, context = typer.main.get_command(command_line.app), "clean-swarm", None
    while hasattr(command, "commands"):
        context = command.make_context(name, words, parent=context)
        name, command, words = command.resolve_command(context, [*context._protected_args, *context.args])
    command.make_context(name, words, parent=context)


@pytest.mark.parametrize("page", COMMANDS)
def test_commands_are_such_as_the_program_takes(page):
    own = {Path(block.file).stem for block in blocks(page) if block.file} | OF_EXAMPLES
    for program, *words in (line for block in blocks(page, "sh") for line in lines_of(block)):
        if program == "clean-swarm" and words[0] not in own:  # a recipe may add a command
            parse(words)
            for option, value in pairwise(words):
                known = [name for kind in NAMED.get(option, ()) for name in names_of(kind, (), told=False)]
                assert not known or value in {*known, *own} or value.endswith(".yaml") or value[0] in "$-", value
        elif words[0] == "-m":
            assert words[1] == "twine" or find_spec(words[1]) is not None, words
        elif program.startswith("python"):
            assert (ROOT / words[0]).exists(), words


QUICK = {
    "list families": (),
    "look draw cleaning": (),
    "evaluate ReachGoal": ("--scenarios", "1"),
    "evaluate Shepherding": ("--scenarios", "1"),
    "play crowded": (),
}
"""Beginnings of the lines that take a second or two -> words behind them that make them short."""


@pytest.mark.parametrize("start", QUICK)
def test_quick_commands_run(start, folder, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(LiveServer, "start", interrupt)  # `play` goes on until Ctrl-C
    shown = [block for page in ("README.md", "docs/commands.md") for block in blocks(page, "sh")]
    words = next(words for block in shown for _, *words in lines_of(block) if " ".join(words).startswith(start))
    assert run(*words, *QUICK[start]) == (130 if words[0] == "play" else 0)


def test_the_commands_on_knowledge_run_in_their_order(folder):
    blocks("docs/knowledge.md", "python")[0].run()
    for words in blocks("docs/knowledge.md", "sh")[1].commands():
        out = done(*words[1:])
    assert re.match(r"knowledge\.sqlite: forgot \d+ entries", out)


STORY = ("README.md", "docs/commands.md", *(page for page in PAGES if page.startswith("docs/tutorials/")))
"""Pages that run one after the other in one directory; what ran there already does not run again."""
FEWER = {"docs/knowledge.md": r"30|20|10"}
"""Pages that run in a directory of their own -> numbers of missions in whose place are 2."""
IN_STORY = {"docs/commands.md": r"100|10"}
"""The same for pages of the story; the README and the tutorials run whole."""


@pytest.fixture(scope="module")
def story(tmp_path_factory):
    """A directory with the examples, and what ran in it."""
    folder = tmp_path_factory.mktemp("story")
    (folder / "examples").symlink_to(ROOT / "examples")
    return folder, set()


def run_page(page, folder, ran, many="never"):
    """Run code and commands of a page by the packages of this checkout, but for `play`, which ends with Ctrl-C."""
    write_files(page, folder)
    for block in blocks(page):
        lines = []
        if block.language == "python" and not block.file:
            lines = [["-c", without_remarks(block)]]
        elif block.language == "sh" and not block.mark:
            lines = [["-m", "clean_swarm_env", *words] if program == "clean-swarm" else words
                     for program, *words in lines_of(block)]  # fmt: skip
        for words in lines:
            words = [re.sub(rf"^({many})$", "2", word) for word in words]
            if "play" in words or tuple(words) in ran:
                continue
            own = os.environ | {"PYTHONPATH": str(ROOT), memory.VARIABLE: "user.sqlite"}
            done = subprocess.run([sys.executable, *words], cwd=folder, env=own, capture_output=True, text=True)
            assert done.returncode == 0, f"{shlex.join(words)}\n{done.stdout}{done.stderr}"
            ran.add(tuple(words))


@pytest.mark.long
@pytest.mark.extra
@pytest.mark.parametrize("page", STORY)
def test_a_page_runs_whole(page, story):
    pytest.importorskip("stable_baselines3", reason="needs the extra 'train'")
    run_page(page, *story, IN_STORY.get(page, "never"))


@pytest.mark.long
@pytest.mark.parametrize("page", FEWER)
def test_a_page_runs_with_fewer_missions(page, tmp_path):
    run_page(page, tmp_path, set(), FEWER[page])
    if page == "docs/knowledge.md":
        choices = map(json.loads, (tmp_path / "first" / "choices.jsonl").read_text().splitlines())
        taken = [one["options"]["AvoidCollision"] for one in choices]
        assert taken == ["RepulsionFernandez-view2.0", "RepulsionGradient-view1.5"]
        assert "known at the beginning in the context 'mission rooms'" in (tmp_path / "later" / "table.md").read_text()
