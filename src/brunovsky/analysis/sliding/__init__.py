"""The switching law of a chain: bounds, reaching, boundary layer, sampling, super-twisting, phase portraits."""
