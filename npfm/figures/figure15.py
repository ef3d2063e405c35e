"""Figure 15 of Bagher et al. 2016: compressive weighting with the full and a restricted range.

It is Figure 7 with ranges of theta_i and theta_o in place of models.
"""

from npfm.figures.figure07 import add_arguments, draw, make

__all__ = ["add_arguments", "draw", "make"]
