"""The redrawn figures of the paper show what the code holds, and no text covers another."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from clean_swarm_env.drawing.canvas import GARBAGE, LEFTOVERS, SEARCHING
from docs.figures import draw_paper, draw_scores, draw_trajectories
from docs.figures.draw_patterns import FRAMES, draw_patterns, placed_blocks
from selforg.mechanisms.purposes import PATTERNS
from tests.pages import text_of

DIAGRAMS = {
    "patterns": draw_patterns,
    "architecture": draw_paper.draw_architecture,
    "coordination": draw_paper.draw_coordination,
    "selector": draw_paper.draw_selector,
}


def _texts(figure):
    return [text for axes in figure.axes for text in axes.texts]


@pytest.mark.parametrize("name", DIAGRAMS)
def test_texts_of_the_diagrams_lie_inside_and_apart(name):
    figure = DIAGRAMS[name]()
    figure.canvas.draw()
    width, height = figure.canvas.get_width_height()
    frames = [(text.get_text(), text.get_window_extent()) for text in _texts(figure)]
    assert all(f.x0 >= 0 and f.y0 >= 0 and f.x1 <= width and f.y1 <= height for _, f in frames)
    covered = [(a, b) for (a, f), (b, g) in combinations(frames, 2) if f.padded(-1.0).overlaps(g.padded(-1.0))]
    assert covered == []


def test_fig_1_shows_every_pattern_with_its_mechanisms_in_the_frame_of_its_purpose():
    shown = [text.get_text() for text in _texts(draw_patterns())]
    blocks = placed_blocks()
    for pattern in PATTERNS:
        assert {pattern.name, *pattern.mechanisms} <= set(shown)
        block, frame = blocks[pattern.name], FRAMES[pattern.purpose]
        assert frame.x <= block.x
        assert block.x + block.width <= frame.x + frame.width
        assert frame.y <= block.y
        assert block.y + block.height <= frame.y + frame.height
    for a, b in combinations(blocks.values(), 2):
        assert a.x + a.width <= b.x or b.x + b.width <= a.x or a.y + a.height <= b.y or b.y + b.height <= a.y


def test_fig_5_colours_ways_by_cargo(monkeypatch):
    monkeypatch.setattr(draw_trajectories, "SECONDS", 20.0)
    scenes = list(draw_trajectories.courses())
    assert len(scenes) == 100
    monkeypatch.setattr(draw_trajectories, "courses", lambda: iter(scenes))
    (axes,) = draw_trajectories.draw_trajectories().axes
    drawn = {tuple(c.get_colors()[0]): len(c.get_segments()) for c in axes.collections if hasattr(c, "get_segments")}
    carried = np.stack([scene.cargo for scene in scenes])[1:]
    for load, colour in ((SEARCHING, "#8a8a8a"), (GARBAGE, "#7B4B94"), (LEFTOVERS, "#E69F00")):
        count = int((carried == load).sum())
        across = count - drawn[to_rgba(colour)] if count else 0  # steps across a seam are left out
        assert 0 <= across <= 0.05 * carried.size


def test_the_figure_of_scores_runs_what_its_page_shows(tmp_path):
    assert "AvoidCollision" in draw_scores.write_files(tmp_path).goals
    assert f"clean-swarm {draw_scores.LEARN} --scenarios 30 --output first" in text_of("docs/scores.md")
