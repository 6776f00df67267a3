"""Keys of studies in texts: symbols, and units that are those of the model."""

import pytest

from brunovsky.comparison.study.keys import parameter_keys
from brunovsky.comparison.symbols import key_unit, setting, symbol, with_key_unit


@pytest.mark.parametrize("key", parameter_keys())
def test_every_key_has_a_symbol_and_the_unit_of_the_model(key):
    unit = parameter_keys()[key].variable.unit
    assert key_unit(key) == ("" if unit == "1" else unit.replace("2", "²").replace("3", "³"))
    assert symbol(key) and "_per_" not in symbol(key) and "start" not in symbol(key)


def test_a_setting_has_symbol_value_and_unit():
    assert setting("P_m_per_s3", 2.5) == "P = 2.5\u00a0m/s³"
    assert setting("theta_start_rad", -1.0) == "θ(0) = −1\u00a0rad"
    assert setting("rho_2", 0.8) == "ρ₂ = 0.8"
    assert with_key_unit("C_1_per_s2") == "c₁, 1/s²"
    assert with_key_unit("sampling_period_s") == "sampling period, s"


@pytest.mark.parametrize("name", ["bandwidth", "speed_up", "gain"])
def test_a_name_without_a_symbol_stays_as_it_is(name):
    assert with_key_unit(name) == name
