"""The picture: its marks, their places at a seam, and the errors for wrong arrays."""

import numpy as np
import pytest

from clean_swarm_env.drawing.picture import GARBAGE, LEFTOVERS, Canvas, appearances, draw_world, trail_strength

STATIONS = {"recycling": (2.75, 5.5), "dump": (8.25, 5.5)}


def canvas(**changes):
    return Canvas(**(STATIONS | {"positions": np.array([[5.0, 5.0], [0.1, 3.0]]), "headings": np.zeros(2)} | changes))


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((5.0, 5.0), {(5.0, 5.0)}),
        ((0.1, 5.0), {(0.1, 5.0), (11.1, 5.0)}),
        ((5.0, 10.9), {(5.0, 10.9), (5.0, -0.1)}),
        ((0.1, 10.9), {(0.1, 10.9), (11.1, 10.9), (0.1, -0.1), (11.1, -0.1)}),
        ((0.3, 5.0), {(0.3, 5.0)}),
    ],
)
def test_what_lies_on_a_seam_shows_on_both_sides(place, expected):
    found = {(round(x, 9), round(y, 9)) for x, y in appearances(canvas(), np.array(place), 0.25)}
    assert found == expected


def test_the_trail_is_the_strongest_pheromone_at_the_shorter_way():
    rng = np.random.default_rng(1)
    drawn = canvas(
        pheromones=rng.uniform(0, (11, 7), (30, 2)), pheromone_diffusions=rng.uniform(0.2, 1.5, 30), height=7.0
    )
    raster = trail_strength(drawn)
    assert raster.shape == (70, 110)
    for line, column in rng.integers(0, raster.shape, (200, 2)):
        offsets = np.abs(np.array([column + 0.5, line + 0.5]) * 0.1 - drawn.pheromones)
        distances = np.hypot(*np.minimum(offsets, (11.0, 7.0) - offsets).T)
        strongest = max(0.0, float((1.0 - distances / drawn.pheromone_diffusions).max()))
        assert raster[line, column] == pytest.approx(strongest, abs=1e-9)


def test_a_pheromone_wider_than_the_world_still_has_its_centre():
    raster = trail_strength(
        canvas(width=2.0, height=2.0, pheromones=np.array([[0.55, 1.05]]), pheromone_diffusions=np.array([9.0]))
    )
    assert np.unravel_index(raster.argmax(), raster.shape) == (10, 5)
    assert raster.max() == pytest.approx(1.0)


def test_a_full_scene_is_drawn_and_saved(tmp_path):
    drawn = canvas(
        cargo=np.array([GARBAGE, LEFTOVERS]),
        garbage=np.array([[1.0, 1.0]]),
        pheromones=np.array([[10.9, 3.0]]),
        pheromone_diffusions=np.array([1.0]),
    )
    figure = draw_world(drawn, title="two robots")
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"carrying garbage", "carrying leftovers", "garbage", "pheromones"} <= set(labels)
    figure.savefig(tmp_path / "world.png")
    assert (tmp_path / "world.png").stat().st_size > 10_000
    assert figure.axes[0].get_xlim() == (0.0, 11.0)


def test_the_legend_names_only_what_the_scene_has():
    labels = [text.get_text() for text in draw_world(canvas()).legends[0].get_texts()]
    assert "pheromones" not in labels
    assert "carrying garbage" not in labels


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"headings": np.zeros(3)}, r"headings: expected shape \(2,\), got \(3,\)"),
        ({"positions": np.zeros((2, 3))}, r"positions: expected shape \(2, 2\), got \(2, 3\)"),
        ({"cargo": np.zeros(1, np.int64)}, r"cargo: expected shape \(2,\), got \(1,\)"),
        ({"pheromones": np.zeros((4, 2))}, r"pheromone_diffusions: expected shape \(4,\), got \(0,\)"),
    ],
)
def test_an_array_of_another_shape_is_named(change, message):
    with pytest.raises(ValueError, match=message):
        canvas(**change)
