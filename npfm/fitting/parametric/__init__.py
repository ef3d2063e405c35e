"""Lobes of a few parameters, fitted by the metrics of their authors."""
