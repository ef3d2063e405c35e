"""Models, one file each; a file that declares a NAME is a model (docs/adding-a-model.md).

Every model has three functions:

``fit(table, objective, solve, seed, **settings) -> Fit``
    Fits a `Table` of measured BRDF in 1/sr. The `Objective` says which samples count and how much,
    the `Solver` comes with its settings, the seed is that of random starts; a model takes all of
    them and uses what it needs. Settings of its own are keywords. Raises an `NpfmError` if a
    setting is out of its range, or a channel has no sample that counts.
``tabulate(fit) -> Table``
    Values at every cell of the grid of the fit, in 1/sr.
``parameter_count(grid) -> int``
    Number of values stored for a material.
"""
