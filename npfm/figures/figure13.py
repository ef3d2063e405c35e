"""Figure 13 of Bagher et al. 2016: our fit against the factorisation of Bilgili et al. 2011."""

from npfm.figures import figure12, renderings
from npfm.papers.captions import CAPTIONS

add_arguments = figure12.add_arguments
draw = figure12.draw
make = renderings.made_by(draw, CAPTIONS[13])
