"""Several lobes whose D and G the colour channels share: the fit of Peng et al. 2017."""
