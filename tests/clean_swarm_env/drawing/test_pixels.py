"""Pictures: options, cargo, items, stations and headings are in the pixels and in the SVG, across the seam too."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from clean_swarm_env.drawing.canvas import GARBAGE, ITEM_COLOUR, OPTION_COLOURS, Canvas
from clean_swarm_env.drawing.layout import Caption, Disc, Layout, Polygon, layout_of
from clean_swarm_env.drawing.pixels import laid_out, pixels_of
from clean_swarm_env.drawing.svg import svg_of

SIDE = 400


def canvas(**changes):
    given = {
        "positions": np.array([[5.0, 5.0], [0.0, 3.0]]),
        "headings": np.array([0.0, np.pi / 2]),
        "stations": np.array([[2.75, 8.5], [8.25, 8.5]]),
        "options": ("first", "second <&>"),
        "held": np.array([0, 1]),
    }
    return Canvas(**(given | changes))


def colour_at(drawn, x, y):
    """Return the colour #rrggbb at a place [m]."""
    layout = layout_of(drawn, SIDE)
    left, top, width, height = layout.world
    scale = width / drawn.width
    pixel = laid_out(layout)[round(top + height - y * scale), min(round(left + x * scale), left + width - 2)]
    return "#" + bytes(pixel.tolist()).hex().upper()


def test_a_robot_has_the_colour_of_its_option_and_a_bright_front_also_across_the_seam():
    drawn = canvas()
    assert colour_at(drawn, 4.9, 5.0) == OPTION_COLOURS[0]
    assert colour_at(drawn, 5.15, 5.0) == "#FFFFFF"
    assert colour_at(drawn, 0.1, 2.95) == OPTION_COLOURS[1]
    assert colour_at(drawn, 10.9, 2.95) == OPTION_COLOURS[1]
    assert colour_at(drawn, 7.0, 5.0) == "#FBFAF7"


def test_cargo_items_stations_and_robots_that_failed_can_be_seen():
    drawn = canvas(cargo=np.array([GARBAGE, 0]), garbage=np.array([[7.0, 7.0]]), working=np.array([True, False]))
    assert colour_at(drawn, 5.0, 5.0) == colour_at(drawn, 7.0, 7.0) == ITEM_COLOUR
    assert colour_at(drawn, 0.1, 2.95) not in OPTION_COLOURS
    assert colour_at(drawn, 2.6, 8.4) == "#009E73"
    assert colour_at(drawn, 8.1, 8.4) == "#8C6BB1"


def test_pheromones_are_darker_in_their_middle_and_reach_across_the_seam():
    drawn = canvas(pheromones=np.array([[0.05, 10.0]]), pheromone_diffusions=np.array([1.0]))
    near, far, nothing = (int(colour_at(drawn, x, 10.0)[1:3], 16) for x in (0.2, 10.4, 6.0))
    assert near < far < nothing == 0xFB


@pytest.mark.parametrize("size", [(11.0, 11.0), (30.0, 10.0), (7.0, 23.0)])
@pytest.mark.parametrize("side", [200, 501, 700])
def test_height_and_width_are_even_whatever_the_world(size, side):
    height, width, colours = pixels_of(canvas(width=size[0], height=size[1]), side).shape
    assert (height % 2, width % 2, colours) == (0, 0, 3)
    assert abs(max(size) / min(size) - 1.0) > 0.1 or width in (side, side + 1, side - 1)


def test_the_size_does_not_depend_on_the_moment():
    later = canvas(time=99.0, garbage=np.array([[1.0, 1.0]]), state="3 of 4 items dumped")
    assert pixels_of(canvas()).shape == pixels_of(later).shape


def test_shapes_cover_pixels_by_the_share_of_their_area():
    disc, half = (
        Disc(20.3, 20.7, 7.4, "#000000"),
        Polygon(((40.5, 5.0), (50.0, 5.0), (50.0, 9.0), (40.5, 9.0)), "#000000"),
    )
    layout = Layout(60, 40, (disc, half), (0, 0, 2, 2), np.zeros((1, 1)), ())
    dark = 1.0 - laid_out(layout)[:, :, 0] / 255.0
    assert dark[5:35, 5:35].sum() == pytest.approx(np.pi * 7.4**2, rel=0.01)
    assert dark[6, 40] == pytest.approx(0.5, abs=0.01)
    assert dark[:, 38:].sum() == pytest.approx(38.0, rel=0.01)


def test_words_at_the_edge_of_a_picture_are_cut():
    words = (Caption(-5.0, 1.0, "left"), Caption(35.0, 39.0, "right"), Caption(99.0, 99.0, "nowhere"))
    assert laid_out(Layout(40, 40, words, (0, 0, 2, 2), np.zeros((1, 1)), ())).shape == (40, 40, 3)


def test_the_svg_has_the_same_shapes_and_needs_nothing_else():
    drawn = canvas(pheromones=np.array([[0.05, 10.0]]), pheromone_diffusions=np.array([1.0]), time=64.0)
    layout = layout_of(drawn)
    text = svg_of(layout)
    tags = [element.tag.rpartition("}")[2] for element in ElementTree.fromstring(text).iter()]
    shapes = [*layout.inside, *layout.shapes]
    assert tags.count("circle") == sum(isinstance(shape, Disc) for shape in shapes)
    assert tags.count("polygon") == sum(isinstance(shape, Polygon) for shape in shapes)
    assert "64.0 s" in text
    assert "second &lt;&amp;&gt;" in text
    assert not re.search(r"https?://(?!www.w3.org/2000/svg)", text)
