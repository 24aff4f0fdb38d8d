"""`clean-swarm look draw` as a user meets it."""

import pytest
from matplotlib.patches import FancyArrowPatch

from selector.strategies.machine_file import load_machine
from tests.train.commands import command, done, refused
from train.reports.machine_picture import draw_machine

STARTS = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}


@pytest.fixture(autouse=True)
def here(monkeypatch, tmp_path):
    """Be in an empty directory."""
    monkeypatch.chdir(tmp_path)


def test_the_default_is_a_file_of_the_robots_name(tmp_path):
    assert command("look", "draw", "cleaning") == (0, "1 network in cleaning.svg\n", "")
    assert (tmp_path / "cleaning.svg").read_bytes().startswith(STARTS[".svg"])


def test_the_ending_chooses_the_format_and_equal_networks_give_equal_files(tmp_path):
    for suffix, beginning in STARTS.items():
        done("look", "draw", "Spacing", "--output", f"a{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes().startswith(beginning)
    done("look", "draw", "Spacing", "--output", "b.pdf")
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()


def test_a_machine_is_drawn_with_its_states_options_and_ways(tmp_path):
    assert done("look", "draw", "rule") == "4 states in rule.svg\n"
    figure = draw_machine(load_machine("rule"))
    texts = {text.get_text() for text in figure.axes[0].texts}
    assert {"free far", "RepulsionFernandez-\nview1.5", "3: carrying_near > 0.5", "4: free_far > 0.5\nstays"} <= texts
    arrows = [patch for patch in figure.axes[0].patches if isinstance(patch, FancyArrowPatch)]
    assert len(arrows) == 4 * 3


def test_a_path_and_a_directory_of_ones_own_are_found(tmp_path):
    (tmp_path / "my" / "mechanisms").mkdir(parents=True)
    shy = tmp_path / "my" / "mechanisms" / "Shy.yaml"
    shy.write_text("mechanisms: {shy: {type: AvoidAll}}\nbehaviours: {Flee: {action: {type: Move, mechanism: shy}}}\n")
    done("look", "draw", "Shy", "--configs", "my", "--output", "made/shy.png")
    assert done("look", "draw", shy) == "1 network in Shy.svg\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["cleanin"], "unknown robot, configuration or machine 'cleanin'"),
        (["none.yaml"], "none.yaml: "),
        (["cleaning", "--output", "x.gif"], "x.gif: expected a name that ends with .svg, .png, .pdf"),
        (["Spacing", "--knowledge", "cleaning"], "--knowledge: expected a robot"),
        (["rule", "--knowledge", "cleaning"], "--knowledge: expected a robot"),
        (["cleaning", "--knowledge", "nix"], "unknown expert knowledge 'nix'"),
        (["cleaning", "--knowledge", "library"], "unknown goal 'AvoidCollision'"),
        (["cleaning", "--configs", "none"], "none: no such directory"),
    ],
)
def test_bad_input_is_one_line_and_code_2(tmp_path, words, said):
    assert said in refused("look", "draw", *words)
    assert not list(tmp_path.iterdir())
