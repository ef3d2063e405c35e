"""Figure 12 of Bagher et al. 2016: our fit against the microfacet model of Loew et al. 2012."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from npfm.figures import renderings, scores, style
from npfm.papers.captions import CAPTIONS


def draw(
    run: str | Path, psnr: pd.DataFrame, variants: Sequence[str], materials: Sequence[str]
) -> Figure:
    """Draw the fits beside the measurement, and below how often ours is the better one.

    Parameters
    ----------
    run, psnr
        As `renderings.draw` takes them.
    variants : sequence of str
        Columns; our model is the first, and all renderings are counted against each other one.
    materials : sequence of str
        Rows, each in its most telling scene; for those that are not there, others.

    Raises
    ------
    NpfmError
        If a picture is missing, or there is none to compare.
    """
    ours, *others = variants
    table, _ = renderings.common(psnr, variants)
    counted = scores.count(psnr, ours, others)
    with style.context():
        rows = renderings.most_telling(run, table, materials, variants)
        figure, _ = renderings.draw(run, psnr, rows, variants, below=scores.height(counted))
        scores.draw(figure, counted, ours)
    return figure


add_arguments = renderings.add_arguments
make = renderings.made_by(draw, CAPTIONS[12])
