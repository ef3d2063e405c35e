"""A still life by paths, as their directions are chosen (Lawrence et al. 2004, Figure 10)."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.evaluation import bounces, tables
from npfm.figures import style
from npfm.storage.names import distinct
from npfm.storage.pictures import tone_map

CELL = 2.0  # inches
GAMMA = 2.2
#: Part of the largest display value that the mean of the reference takes.
KEY = 0.25


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm bounces table")
    parser.add_argument("--reference", required=True, help="EXR of npfm bounces render --reference")
    parser.add_argument("--pictures", nargs="+", required=True, help="EXR of each sampler")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures that the arguments name."""
    numbers = [name for name in bounces.COLUMNS if name != "sampler"]
    table = tables.read(arguments.table, ["sampler"], numbers)
    n_var = dict(zip(table["sampler"], table["n_var"], strict=True))
    names = distinct(Path(path).stem for path in arguments.pictures)
    found = [bounces.read(path)[0] for path in arguments.pictures]
    reference = bounces.read(arguments.reference)[0]["samples"]
    return draw(reference, dict(zip(names, found, strict=True)), n_var)


def draw(
    reference: NDArray, samplers: Mapping[str, Mapping[str, NDArray]], n_var: Mapping[str, float]
) -> Figure:
    """Draw a column for each sampler: at equal samples, the variance, and at equal seconds.

    Parameters
    ----------
    reference : ndarray, shape (h, w, 3)
    samplers : mapping of str to mapping of str to ndarray
        Parts of the picture of each, as `npfm.evaluation.bounces.read` gives them.
    n_var : mapping of str to float
        Variance of one path over the squared mean, of each.
    """
    rows = ("samples", "variance", "seconds")
    exposure = -np.log2(1 - KEY**GAMMA) / reference.mean()
    columns = 1 + len(samplers)
    size = style.PAGE_WIDTH, style.PAGE_WIDTH / columns * len(rows) + 0.6
    with style.context():
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.subplots(len(rows), columns, squeeze=False)
        grid[0, 0].imshow(tone_map(reference, exposure, GAMMA), interpolation="nearest")
        grid[0, 0].set_title("reference")
        norm = _norm(reference, [parts["variance"] for parts in samplers.values()])
        for column, (name, parts) in zip(grid.T[1:], samplers.items(), strict=True):
            column[0].set_title(f"{name}\nN Var {n_var[name]:.3g}")
            for ax, row in zip(column, rows, strict=True):
                if row == "variance":
                    variance = parts[row].mean(axis=-1) / reference.mean() ** 2
                    image = ax.imshow(variance, norm=norm, cmap="inferno", interpolation="nearest")
                elif row in parts:
                    ax.imshow(tone_map(parts[row], exposure, GAMMA), interpolation="nearest")
        labels = ("equal samples", "variance of a path", "equal seconds")
        for ax, label in zip(grid[:, 1], labels, strict=True):
            ax.set_ylabel(label)
        for ax in grid.flat:
            ax.set(xticks=[], yticks=[])
            ax.spines[:].set_visible(False)
        figure.colorbar(image, ax=grid[1], shrink=0.9)
    return figure


def _norm(reference: NDArray, variances: Sequence[NDArray]) -> LogNorm:
    relative = np.stack(variances).mean(axis=-1) / reference.mean() ** 2
    seen = relative[relative > 0]
    return LogNorm(*np.quantile(seen, [0.02, 0.995])) if seen.size else LogNorm(0.1, 1)
