"""What makes figures small keeps what they show: repeated strokes, rounded lengths, descriptions."""

import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from brunovsky.comparison import drawing
from brunovsky.comparison.drawing_once import drawn_once


def axes():
    figure = drawing.new_figure(4.0, 4.0, left=0.1)
    place = figure.subplots()
    place.set(xlim=(-1.0, 1.0), ylim=(-1.0, 1.0))
    return place


def test_a_repeated_cycle_is_drawn_once_and_keeps_its_extremes():
    angle = np.linspace(0.0, 2.0 * np.pi, 401)
    x, y = np.tile(np.cos(angle), 50), np.tile(np.sin(angle), 50)
    xs, ys = drawn_once(axes(), x, y)
    assert xs.size < 500
    assert np.nanmax(xs) == 1.0 and np.nanmin(ys) == y.min()


def swinging(steps: int = 12_000):
    """A relay that swings in an irregular way: long strokes that cover a region again and again."""
    rng = np.random.default_rng(1)
    size = 0.6 + 0.3 * np.sin(1e-3 * np.arange(steps)) * rng.random(steps)
    return 0.5 * np.cos(0.7 * np.arange(steps)) * size, np.where(np.arange(steps) % 5 < 2, size, -size)


def test_a_dense_chattering_trace_is_small_and_looks_the_same():
    x, y = swinging()
    pictures, texts = [], []
    for curve in ((x, y), drawn_once(axes(), x, y)):
        place = axes()
        place.plot(*curve, **drawing.style(0))
        canvas = FigureCanvasAgg(place.figure)
        canvas.draw()
        pictures.append(np.asarray(canvas.buffer_rgba())[..., :3].astype(int))
        texts.append(drawing.svg(place.figure, "key"))
    whole, once = map(len, texts)
    assert once < 80_000 and once < whole / 3
    darkness = [255 * 3 - one.sum(axis=2) for one in pictures]
    assert np.mean(darkness[0] > 300) > 0.1  # a region is covered
    assert np.mean(np.abs(darkness[0] - darkness[1]) > 150) < 1e-3


def test_strokes_that_leave_the_axes_cost_no_memory():
    x, y = np.array([0.0, 1e12, 0.0, -1e12, 0.5]), np.array([0.0, 1e12, -1e12, 0.5, 0.5])
    xs, _ = drawn_once(axes(), x, y)
    assert np.isfinite(xs).sum() >= 5


@pytest.mark.parametrize("count", [0, 1, 2])
def test_short_curves(count):
    xs, ys = drawn_once(axes(), np.zeros(count), np.linspace(0.0, 0.5, count))
    assert np.isfinite(xs).sum() >= count and xs.shape == ys.shape


def test_ids_are_those_that_are_referred_to():
    figure = drawing.new_figure(2.0, 2.0)
    figure.subplots().plot([0.0, 1.0], [0.0, 1.0], "o")
    text = drawing.svg(figure, "key")
    used = set(re.findall(r'(?:href="|url\()#([^")]*)', text))
    assert used and used == set(re.findall(r' id="([^"]*)"', text)) and all(one.startswith("key.") for one in used)


def test_a_curve_that_never_repeats_is_kept_whole():
    x = np.linspace(-1.0, 1.0, 50)
    xs, ys = drawn_once(axes(), x, x**3)
    kept = xs[~np.isnan(xs)]
    np.testing.assert_array_equal(np.unique(kept), x)
    assert np.nanmax(np.abs(ys - xs**3)) == 0.0


def test_lengths_are_rounded_and_the_picture_says_what_it_is():
    figure = drawing.new_figure(2.0, 2.0)
    figure.subplots().plot([0.0, 1.0 / 3.0], [0.0, 1.0 / 7.0])
    with drawing.settings():
        text = drawing.svg(figure, "key", 'a "title" & more')
    assert text.startswith('<svg role="img" aria-label="a &quot;title&quot; &amp; more"')
    assert drawing.described(text, "another") == text
    assert not any(len(part) > 2 for path in text.split(' d="')[1:] for part in _decimals(path[: path.index('"')]))


def _decimals(path):
    return re.findall(r"\.(\d*)", path)
