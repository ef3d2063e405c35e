"""Fits in the formats of other programs."""
