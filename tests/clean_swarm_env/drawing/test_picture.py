"""Pictures: options, cargo, items, stations, headings and numbers, also across a seam; files are the same each time."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from clean_swarm_env.drawing.canvas import NOTHING, Canvas, SignedThings
from clean_swarm_env.drawing.look import LOOK, OPTION_COLOURS, SIGN_OF, legend
from clean_swarm_env.drawing.picture import MARGIN, TITLE, pixels_of, write_picture

SIDE = 400
STATIONS = tuple(SignedThings(name, np.array([[x, 8.5]]), 0.5) for name, x in (("recycling", 2.75), ("dump", 8.25)))


def canvas(**changes):
    given = {
        "positions": np.array([[5.0, 5.0], [0.0, 3.0]]),
        "headings": np.array([0.0, np.pi / 2]),
        "signs": STATIONS,
        "options": ("first", "second <&> $x"),
        "held": np.array([0, 1]),
    }
    return Canvas(**(given | changes))


def colour_at(drawn, x, y):
    """Return the colour #rrggbb at a place [m]."""
    scale = (SIDE - 2 * MARGIN) / drawn.width
    pixel = pixels_of(drawn, SIDE)[round(TITLE + (drawn.height - y) * scale), round(MARGIN + x * scale)]
    return "#" + bytes(pixel.tolist()).hex().upper()


def test_a_robot_has_the_colour_of_its_option_and_a_bright_front_also_across_the_seam():
    drawn = canvas()
    assert colour_at(drawn, 4.9, 5.0) == OPTION_COLOURS[0]
    assert colour_at(drawn, 5.15, 5.0) == "#FFFFFF"
    assert colour_at(drawn, 0.1, 2.95) == OPTION_COLOURS[1]
    assert colour_at(drawn, 10.9, 2.95) == OPTION_COLOURS[1]
    assert colour_at(drawn, 7.0, 5.0) == LOOK.paper.upper()


def test_cargo_items_stations_and_robots_that_failed_can_be_seen():
    signs = (*STATIONS, SignedThings("item", np.array([[7.0, 7.0]])))
    load = {"loads": ("item",), "load": np.array([0, NOTHING])}
    drawn = canvas(**load, signs=signs, working=np.array([True, False]))
    assert colour_at(drawn, 4.9, 5.0) == colour_at(drawn, 7.0, 7.0) == LOOK.item.colour
    assert colour_at(drawn, 0.1, 2.95) == LOOK.failed.colour.upper()
    assert colour_at(drawn, 2.62, 8.4) == "#009E73"
    assert colour_at(drawn, 8.12, 8.4) == "#8C6BB1"


def test_pheromones_are_darker_in_their_middle_and_reach_across_the_seam():
    drawn = canvas(pheromones=np.array([[0.05, 10.0]]), pheromone_diffusions=np.array([1.0]))
    near, far, nothing = (int(colour_at(drawn, x, 10.0)[1:3], 16) for x in (0.2, 10.4, 6.0))
    assert near < far < nothing == 0xFB


def test_numbers_are_those_of_the_robots_and_left_out_where_there_is_no_room():
    plain, many = canvas(), np.zeros((LOOK.most_numbered + 1, 2))
    beside = np.s_[218:230, 192:210]  # right of and above the first robot
    shown = [pixels_of(drawn, SIDE)[beside] for drawn in (plain, canvas(numbers=np.array([8, 1])))]
    assert not np.array_equal(*shown)
    crowd = replace(plain, positions=many + 5.0, headings=many[:, 0], held=None)
    unnumbered = replace(crowd, numbers=np.arange(len(many)) + 100)
    assert np.array_equal(pixels_of(crowd), pixels_of(unnumbered))


def test_numbers_can_be_left_out():
    beside = np.s_[218:230, 192:210]
    numbered, plain = (pixels_of(canvas(), SIDE, numbers=wanted)[beside] for wanted in (True, False))
    assert not np.array_equal(numbered, plain)
    assert len(np.unique(plain.reshape(-1, 3), axis=0)) == 1


def test_no_option_has_the_colour_of_anything_else():
    others = [LOOK.item.colour, LOOK.leftovers.colour, LOOK.failed.colour, LOOK.contact, LOOK.paper, LOOK.ink]
    colours = [np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) for colour in (*OPTION_COLOURS, *others)]
    for k, own in enumerate(colours[: len(OPTION_COLOURS)]):
        assert min(np.abs(own - other).sum() for other in (*colours[:k], *colours[k + 1 :])) > 45


def test_the_legend_names_all_that_is_drawn():
    cleaning, other = ({sign.word for sign in legend(("a",), signs)} for signs in (SIGN_OF, ()))
    assert cleaning >= {"a", "item", "leftovers of an item", "recycling station", "dump station", "pheromones"}
    assert other >= {"a", "attracts robots", "repels robots", "pheromones"}


@pytest.mark.parametrize("size", [(11.0, 11.0), (30.0, 10.0), (7.0, 23.0)])
@pytest.mark.parametrize("side", [200, 501, 700])
def test_height_and_width_are_even_whatever_the_world(size, side):
    height, width, colours = pixels_of(canvas(width=size[0], height=size[1]), side).shape
    assert (height % 2, width % 2, colours) == (0, 0, 3)
    assert abs(max(size) / min(size) - 1.0) > 0.1 or width in (side, side + 1, side - 1)


@pytest.mark.parametrize(
    ("state", "drawn"),
    [
        ("distance 0.4, obstacles hit by all robots in each minute 1.25", "distance 0.4"),
        (
            "distance of all robots to the middle of the goal area 0.434, hit 1.2",
            "distance of all robots to the middle of ... 0.434",
        ),
    ],
)
def test_a_line_that_is_too_long_loses_figures_or_words_but_no_number_its_name(state, drawn):
    pixels = pixels_of(canvas(state=state), 320)
    assert (pixels == pixels_of(canvas(state=drawn), 320)).all()
    dark = np.flatnonzero(pixels[:TITLE].min(axis=(0, 2)) < 200)
    assert dark.max() <= 320 - MARGIN


@pytest.mark.parametrize("suffix", ["svg", "png", "webp"])
def test_a_file_is_the_same_each_time_and_needs_nothing_else(tmp_path, suffix):
    drawn = canvas(pheromones=np.array([[0.05, 10.0]]), pheromone_diffusions=np.array([1.0]), state="\u6e05\u6383 $")
    for name in ("a", "b"):
        write_picture(drawn, tmp_path / f"{name}.{suffix}", SIDE)
    content = (tmp_path / f"a.{suffix}").read_bytes()
    assert content == (tmp_path / f"b.{suffix}").read_bytes()
    if suffix == "svg":
        colours = set(re.findall("#[0-9a-f]{6}", content.decode()))
        assert {LOOK.ink, LOOK.failed.colour, OPTION_COLOURS[1].lower()} <= colours
        named = [item for part in ElementTree.fromstring(content).iter() for item in part.items()]
        assert all(value.startswith(("data:", "#")) for name, value in named if "href" in name)
