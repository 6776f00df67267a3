"""Chatter of a chain behind lags, delay or sampling: predicted by describing function and exactly, and measured."""
