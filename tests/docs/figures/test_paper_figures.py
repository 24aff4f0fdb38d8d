"""The redrawn figures of the paper show what the code holds, and no text covers another."""

from itertools import combinations

import pytest

from docs.figures import draw_paper
from docs.figures.draw_patterns import draw_patterns

DIAGRAMS = {
    "patterns": draw_patterns,
    "architecture": draw_paper.draw_architecture,
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
