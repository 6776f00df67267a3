"""What makes figures small keeps what they show: repeated strokes, rounded lengths, descriptions."""

import re

import numpy as np

from brunovsky.comparison import drawing


def axes():
    figure = drawing.new_figure(4.0, 4.0, left=0.1)
    place = figure.subplots()
    place.set(xlim=(-1.0, 1.0), ylim=(-1.0, 1.0))
    return place


def test_a_repeated_cycle_is_drawn_once_and_keeps_its_extremes():
    angle = np.linspace(0.0, 2.0 * np.pi, 401)
    x, y = np.tile(np.cos(angle), 50), np.tile(np.sin(angle), 50)
    xs, ys = drawing.drawn_once(axes(), x, y)
    assert xs.size < 500
    assert np.nanmax(xs) == 1.0 and np.nanmin(ys) == y.min()


def test_a_curve_that_never_repeats_is_kept_whole():
    x = np.linspace(-1.0, 1.0, 50)
    xs, ys = drawing.drawn_once(axes(), x, x**3)
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
