"""The robot's loop cut at its actuators, and its chatter with lags there."""
