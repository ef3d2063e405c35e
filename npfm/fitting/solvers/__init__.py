"""Solvers: they minimise what a model lays out, and know nothing of models."""
