"""Nothing of a figure is cut off or lies over something else, whatever the number and titles of the laws."""

import itertools

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from brunovsky.comparison import drawing, load_study, run_study
from brunovsky.comparison.figures import inputs_figure, linear_parts, paths_figure, phase_figure, sliding_figure
from brunovsky.comparison.figures.traces import add_legend
from brunovsky.comparison.study import Law

LAWS = [(k, Law(name=f"law{k}", title="sliding mode in polar coordinates", kind="linear")) for k in range(13)]


def drawn(figure):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return canvas.get_renderer()


def inside(figure, box):
    frame = figure.bbox
    return frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1


@pytest.mark.parametrize("width", [6.6, 9.4])
def test_a_legend_of_many_laws_is_not_cut_off(width):
    with drawing.settings():
        figure = drawing.new_figure(width, 3.0, left=0.1, right=0.95, bottom=0.15, top=0.9)
        figure.subplots().set_title("title", loc="left")
        add_legend(figure, LAWS)
        renderer = drawn(figure)
        legend = figure.legends[0].get_window_extent(renderer)
        assert inside(figure, legend)
        assert legend.y0 >= figure.axes[0].get_tightbbox(renderer).y1 - 1.0


def test_paths_side_by_side_have_room_for_titles_labels_and_legend(small):
    found = run_study(load_study(small))
    with drawing.settings():
        figure = paths_figure(found, [found.study.scenarios[0]] * 3)
        renderer = drawn(figure)
        legend = figure.legends[0].get_window_extent(renderer)
        boxes = [axes.get_tightbbox(renderer) for axes in figure.axes]
        assert all(inside(figure, one) for one in (legend, *boxes))
        assert all(one.y1 <= legend.y0 + 1.0 for one in boxes)
        assert all(one.x1 <= other.x0 + 1.0 for one, other in itertools.pairwise(boxes))


def test_numbers_along_the_axes_of_a_phase_portrait_do_not_overlap(small):
    found = run_study(load_study(small))
    with drawing.settings():
        figure = phase_figure(found, found.study.scenarios[0])
        renderer = drawn(figure)
        for axes in figure.axes:
            low, high = axes.get_xlim()
            ticks = [one for one in axes.xaxis.get_major_ticks() if low <= one.get_loc() <= high]
            boxes = [one.label1.get_window_extent(renderer) for one in ticks]
            assert all(one.x1 < other.x0 for one, other in itertools.pairwise(boxes))


def test_laws_beyond_the_styles_are_told_apart_by_markers():
    looks = [(str(drawing.style(k)), str(drawing.marks(k, 600).get("marker"))) for k in range(13)]
    assert len(set(looks)) == 13 and all(marker != "None" for _, marker in looks[len(drawing.STYLES) :])
    start, apart = drawing.marks(12, 600)["markevery"]
    assert 0 <= start < apart == 100
    assert all(drawing.style(k)["color"] != "#c3cbd1" for k in range(6, 13))


def test_a_caption_says_up_to_where_an_axis_is_linear_and_the_layer_has_its_value(small):
    text = small.read_text(encoding="utf-8").replace("x_start_m = 1.0", "x_start_m = 2.5")
    layer = '[[laws]]\nname = "layer"\nkind = "saturation"\nparameters = { phi_m_per_s2 = 0.07 }\n'
    small.write_text(text.replace("[[scenarios]]", f"{layer}[[scenarios]]"), encoding="utf-8")
    found = run_study(load_study(small))
    scenario = found.study.scenarios[0]
    with drawing.settings():
        inputs, sliding, phase = (draw(found, scenario) for draw in (inputs_figure, sliding_figure, phase_figure))
    assert "±1\u00a0rad/s² (yaw acceleration u₂)" in linear_parts(inputs)
    assert (
        linear_parts(sliding)
        == "Linear up to ±0.01\u00a0m/s² (sliding variable S₁ and sliding variable S₂), logarithmic beyond."
    )
    for figure in (sliding, phase):
        assert [one.get_text() for axes in figure.axes for one in axes.texts] == ["φ = 0.07"] * 2
    assert linear_parts(drawing.new_figure(1.0, 1.0)) == ""
