"""Estimators of several strategies against the renderer's, at equal samples and equal seconds."""

import argparse

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from npfm.evaluation.importance import SOBOL
from npfm.figures import style, ways

HEIGHT = 2.0  # inches, of a row of panels
#: The renderer's own, by strategy, and what the variance is multiplied with.
OURS = "light + half-vector"
PANELS = ("at equal samples", "at equal seconds")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm importance table")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(ways.read_labelled(arguments.table))


def draw(table: pd.DataFrame) -> Figure:
    """Draw the gain of each estimator of several strategies by material, a row each light.

    Parameters
    ----------
    table : DataFrame
        As `npfm.figures.ways.read_labelled` reads it.
    """
    gained = gains(table)
    lights = list(gained["light"].unique())
    looks = style.looks(gained["way"].unique())
    with style.context():
        size = (style.PAGE_WIDTH, HEIGHT * len(lights) + 0.5)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(len(lights), len(PANELS), squeeze=False, sharex=True, sharey="row")
        for light, row in zip(lights, axes, strict=True):
            rows = gained[gained["light"] == light]
            for what, ax in zip(PANELS, row, strict=True):
                for name, line in rows.groupby("way", sort=False):
                    mean = np.exp(np.log(line[what]).mean())
                    look = looks[str(name)]
                    label = f"{name}: {mean:.2f}"
                    ax.plot(
                        line["material"],
                        line[what],
                        color=look.color,
                        ls="",
                        **look.mark,
                        label=label,
                    )
                ax.axhline(1, color="0.5", linewidth=0.5)
                style.plain_logarithmic(ax.yaxis)
                ax.set_title(f"{light}, {what}")
                ax.tick_params(axis="x", rotation=90)
                ax.grid(True)
                ax.legend(fontsize=5, title="geometric mean", title_fontsize=5)
            row[0].set_ylabel(f"variance of {OURS}\nover that of the estimator")
    return figure


def gains(table: pd.DataFrame) -> pd.DataFrame:
    """How many times less variance estimators of several strategies have than the renderer's.

    Returns
    -------
    DataFrame
        Columns light, material, way, and a column for each of `PANELS`.
    """
    rows = ways.most_samples(table, SOBOL)
    rows = rows[rows["strategy"].str.contains("+", regex=False)]
    ours = rows[rows["way"] == OURS].set_index(["light", "material"])[["n_var", "seconds"]]
    both = rows[rows["way"] != OURS].join(ours.add_suffix("_ours"), on=["light", "material"])
    gain = both["n_var_ours"] / both["n_var"]
    faster = both["seconds_ours"] / both["seconds"]
    return both.assign(**dict(zip(PANELS, (gain, gain * faster), strict=True)))
