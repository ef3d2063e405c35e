"""Microfacet models whose distribution is read off backscattered light (Dupuy et al. 2015)."""
