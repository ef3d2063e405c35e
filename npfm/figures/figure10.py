"""Figure 10 of Bagher et al. 2016: the non-parametric fits with the greatest error."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from npfm.figures import renderings, style
from npfm.figures.renderings import Row

MATERIALS = 4  # shown


def draw(run: str | Path, psnr: pd.DataFrame, variants: Sequence[str]) -> Figure:
    """Draw the worst fits beside the measurement, worst first.

    Parameters
    ----------
    run, psnr
        As `renderings.draw` takes them.
    variants : sequence of str
        Columns; the first decides which materials are worst.

    Raises
    ------
    NpfmError
        If a picture is missing, or there is none to compare.
    """
    table, remark = renderings.common(psnr, variants)
    rows = worst(run, [Row(*row) for row in table.index], variants[0])[:MATERIALS]
    with style.context():
        figure, _ = renderings.draw(run, psnr, rows, variants, remark)
    return figure


add_arguments = renderings.add_arguments
make = renderings.made_by(draw)


def worst(run: str | Path, rows: Sequence[Row], variant: str) -> list[Row]:
    """Return a row for each material, in its worst scene; those most visibly wrong first.

    "Visual error" is that of `renderings.window`: the paper does not say how it was judged.

    Parameters
    ----------
    run : str or Path
        Folder of the run, with the tone-mapped pictures.
    rows : sequence of Row
        Pictures to choose from.
    variant : str
        The fit.
    """
    error = {row: renderings.telling_window(run, row, [variant]).difference for row in rows}
    worst_of: dict[str, Row] = {}
    for row in sorted(rows, key=lambda row: error[row], reverse=True):
        worst_of.setdefault(row.material, row)
    return list(worst_of.values())
