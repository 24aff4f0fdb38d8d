"""The redrawn figures of the paper show what the code holds, and no text covers another."""

from itertools import combinations

from docs.figures import draw_paper


def _texts(figure):
    return [text for axes in figure.axes for text in axes.texts]


def test_texts_of_the_diagram_lie_inside_and_apart():
    figure = draw_paper.draw_architecture()
    figure.canvas.draw()
    width, height = figure.canvas.get_width_height()
    frames = [(text.get_text(), text.get_window_extent()) for text in _texts(figure)]
    assert all(f.x0 >= 0 and f.y0 >= 0 and f.x1 <= width and f.y1 <= height for _, f in frames)
    covered = [(a, b) for (a, f), (b, g) in combinations(frames, 2) if f.padded(-1.0).overlaps(g.padded(-1.0))]
    assert covered == []
