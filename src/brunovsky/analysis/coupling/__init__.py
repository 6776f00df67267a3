"""Co-simulation of a diagram step by step: what exchanging values at communication points costs."""
