"""Factorisations of reflectance that can be sampled (Lawrence et al. 2004)."""
