"""Margins at one actuator are those of its transfer function; at both, and with sampling, those of poles."""

import numpy as np
import pytest

from brunovsky.analysis import (
    SteadyMotion,
    actuator_loop_transfer,
    actuator_margins,
    boundary_layer_gain,
    longest_robot_sampling,
    loop_margins,
    margins,
    sampled_sliding_gain,
    sliding_gain,
)
from brunovsky.errors import ParameterError

SURFACE = [500.0, 10.0, 1.0]
GAINS = [sliding_gain(SURFACE, 5.0), boundary_layer_gain(SURFACE, 5.0, 2.5, 0.05)]
CIRCLE = SteadyMotion(0.7071, 0.5)


@pytest.mark.parametrize("gain", GAINS, ids=["linear", "layer"])
@pytest.mark.parametrize("actuator", [1, 2])
def test_at_one_actuator_they_are_those_of_its_transfer_function(gain, actuator):
    found = actuator_margins(gain, CIRCLE, (actuator,))
    expected = loop_margins(actuator_loop_transfer(gain, CIRCLE, actuator))
    for name in ("gain_lower", "gain_upper", "delay", "lag", "two_lags"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-6), name


def test_on_a_line_both_at_once_are_the_lesser_of_the_two():
    line = SteadyMotion(0.5)
    both, first, second = (actuator_margins(GAINS[0], line, one) for one in ((1, 2), (1,), (2,)))
    assert both.delay == pytest.approx(min(first.delay, second.delay), rel=1e-6)
    assert both.delay == pytest.approx(margins(GAINS[0]).delay, rel=1e-6)
    assert both.two_lags == pytest.approx(min(first.two_lags, second.two_lags), rel=1e-6)


def test_a_circle_couples_the_actuators():
    both = actuator_margins(GAINS[0], SteadyMotion(1.0, 5.0))
    single = [actuator_margins(GAINS[0], SteadyMotion(1.0, 5.0), (k,)) for k in (1, 2)]
    assert both.delay < 0.99 * min(one.delay for one in single)


@pytest.mark.slow
def test_the_longest_sampling_period_is_shorter_than_that_of_a_held_chain():
    found = longest_robot_sampling(GAINS[0], CIRCLE)
    assert found == pytest.approx(longest_robot_sampling(lambda _: GAINS[0], SteadyMotion(2.0, 0.5)))  # no speed in it
    assert 0.5 * margins(GAINS[0]).delay < found < 2.0 * margins(GAINS[0]).delay
    implicit = longest_robot_sampling(lambda h: sampled_sliding_gain(SURFACE, h), CIRCLE)
    assert found < implicit < 0.0572


def test_what_has_no_margins_is_refused():
    with pytest.raises(ParameterError, match="not stable"):
        actuator_margins([1.0, 1.0, 0.1], CIRCLE)
    with pytest.raises(ParameterError, match="not stable"):
        longest_robot_sampling([1.0, 1.0, 0.1], CIRCLE)
    for wrong in ((), (3,), (1, 1)):
        with pytest.raises(ParameterError, match="actuators"):
            actuator_margins(GAINS[0], CIRCLE, wrong)


def test_gains_of_sampled_laws():
    assert np.allclose(sampled_sliding_gain(SURFACE, 0.01, reaching_rate=5.0), GAINS[0])
    assert np.allclose(sampled_sliding_gain(SURFACE, 0.01), sliding_gain(SURFACE, 100.0))
