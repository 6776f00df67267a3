"""Actuators that stand between an inner loop and its plant."""

from brunovsky.blocks.library.actuators.lag import actuator_lags

__all__ = ["actuator_lags"]
