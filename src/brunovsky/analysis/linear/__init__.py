"""The linear loop of a chain: plants, gains and surfaces, margins, responses."""
