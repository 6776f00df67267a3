"""Gravity."""

import sympy as sp

GRAVITY = sp.Rational(981, 100)
"""Gravity (m/s2), exact."""
