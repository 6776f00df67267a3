"""Actuators that stand between an inner loop and its plant."""

from brunovsky.blocks.library.actuators.delay import actuator_delays
from brunovsky.blocks.library.actuators.hold import actuator_holds
from brunovsky.blocks.library.actuators.lag import actuator_lags
from brunovsky.blocks.library.actuators.limit import actuator_limits
from brunovsky.blocks.library.actuators.series import actuator_series

__all__ = ["actuator_delays", "actuator_holds", "actuator_lags", "actuator_limits", "actuator_series"]
