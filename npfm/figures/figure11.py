"""Figure 11 of Bagher et al. 2016: the microfacet model against the bivariate one."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from npfm.figures import renderings, style

#: Rows where the bivariate model gains most, and then where it loses most, as in the paper.
BETTER, WORSE = 3, 2


def draw(run: str | Path, psnr: pd.DataFrame, variants: Sequence[str]) -> Figure:
    """Draw both models beside the measurement, for the materials where they differ most.

    Each in the scene where the worse one is wrong most visibly.

    Parameters
    ----------
    run, psnr
        As `renderings.draw` takes them.
    variants : sequence of str
        The microfacet model and the bivariate one.

    Raises
    ------
    NpfmError
        If a picture is missing, or there is none to compare.
    """
    table, remark = renderings.common(psnr, variants)
    ours, bivariate = variants
    better, worse = extremes(table[bivariate] - table[ours])
    rows = [
        *renderings.most_telling(run, table, better, [ours]),
        *renderings.most_telling(run, table, worse, [bivariate]),
    ]
    with style.context():
        figure, _ = renderings.draw(run, psnr, rows, variants, remark)
    return figure


add_arguments = renderings.add_arguments
make = renderings.made_by(draw)


def extremes(gain: pd.Series) -> tuple[list[str], list[str]]:
    """Return the materials of the largest mean gain, and those of the largest mean loss.

    Parameters
    ----------
    gain : Series
        dB by (material, scene).
    """
    mean = gain.groupby("material", sort=True).mean().sort_values(kind="stable")
    gains = [name for name in mean.index[::-1] if mean[name] > 0][:BETTER]
    losses = [name for name in mean.index if mean[name] < 0][:WORSE]
    return gains, losses
