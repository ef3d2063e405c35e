"""npfm: non-parametric factor microfacet models, fitted, rendered and compared."""
