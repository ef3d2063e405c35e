"""Fits as functions of GLSL: the pieces that files for others and the demo of the gallery share."""
