"""Distant light: maps of it, probes on disk, and lights that the project makes."""
