"""Figures of the chatter prediction show what the predictions say."""

import control
import matplotlib
import pytest

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from brunovsky.analysis import (
    SwitchingLoop,
    describing_function_plot,
    predicted_cycles,
    relay_cycles,
    relay_locus,
    relay_locus_plot,
)
from brunovsky.errors import ParameterError

LOOP = SwitchingLoop((500.0, 10.0, 1.0), 5.0, 2.5, lags=[0.012, 0.012])


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def markers(ax):
    return [(float(line.get_xdata()[0]), line.get_fillstyle()) for line in ax.lines if line.get_marker() == "o"]


@pytest.mark.parametrize("own", [True, False])
def test_describing_function_figure(own):
    ax = plt.figure().add_subplot() if own else None
    drawn = describing_function_plot(LOOP, ax)
    assert isinstance(drawn, control.ControlPlot)
    place = drawn.axes[0, 0]
    assert ax is None or place is ax
    expected = [
        (float(LOOP.frequency_response(one.frequency).real), "full" if one.stable else "none")
        for one in predicted_cycles(LOOP)
    ]
    found = [one for one in markers(place) if one[1] == "none" or one[0] < 0]
    assert [one[0] for one in found] == pytest.approx([one[0] for one in expected])
    assert [one[1] for one in found] == ["full", "none"]


def test_relay_locus_figure():
    ax = plt.figure().add_subplot()
    drawn = relay_locus_plot(LOOP, ax)
    assert isinstance(drawn, control.ControlPlot)
    assert drawn.axes[0, 0] is ax
    expected = [relay_locus(LOOP, [one.frequency])[0].real for one in relay_cycles(LOOP)]
    assert [one[0] for one in markers(ax)] == pytest.approx(expected)
    assert [one[1] for one in markers(ax)] == ["full", "none"]
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert any(label.startswith("stable: 0.032 @ 64.63") for label in labels)


def test_figures_of_loops_with_a_delay_and_without_cycles():
    describing_function_plot(SwitchingLoop((1.0,), 0.0, 1.0, delay=0.1))
    relay_locus_plot(SwitchingLoop((1.0,), 0.0, 1.0, delay=0.1))
    describing_function_plot(SwitchingLoop((500.0, 10.0, 1.0), 5.0, 2.5, lags=[0.01]))
    with pytest.raises(ParameterError, match="predicted_cycles"):
        relay_locus_plot(SwitchingLoop((1.0,), 0.0, 1.0, boundary_layer=0.1, lags=[0.1]))
