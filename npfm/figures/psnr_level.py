"""PSNR of the same fits by foreground, resolution and turn of the light, beside the paper's."""

import argparse
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npfm.evaluation.psnr_level import ALL, read_levels
from npfm.figures import own_colors, style

HEIGHT, LEGEND = 2.6, 0.5  # inches; of a row of panels, and of what stands above them
COLUMNS = 3
PRINTED = "in the paper"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--levels", required=True, help="CSV made by npfm psnr-level table")
    own_colors.add_colors(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(read_levels(arguments.levels), own_colors.colors(arguments))


def draw(levels: pd.DataFrame, colors: Mapping[str, str] | None = None) -> Figure:
    """Draw a panel of all scenes together and one of each, with a mark a variant and setting.

    Parameters
    ----------
    levels : DataFrame
        As `npfm.evaluation.psnr_level.levels` makes it; what is not finite is left out.
    colors : mapping of str to str, optional
        Colours of variants, in place of the project's.
    """
    scenes = list(levels["scene"].unique())
    rows = -(-len(scenes) // COLUMNS)
    looks = style.looks(levels["variant"].unique(), colors)
    with style.context():
        size = style.PAGE_WIDTH, LEGEND + HEIGHT * rows
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(rows, COLUMNS, sharey=True, squeeze=False).ravel()
        for ax, scene in zip(axes, scenes, strict=False):
            _draw_panel(ax, levels[levels["scene"] == scene], looks)
            ax.set_title("all scenes" if scene == ALL else f"scene {scene}", loc="left", pad=2)
        for ax in axes[len(scenes) :]:
            ax.remove()
        for ax in axes[: len(scenes) : COLUMNS]:
            ax.set_ylabel("PSNR (dB), mean over the materials")
        handles = axes[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=6, frameon=False)
    return figure


def _draw_panel(ax: Axes, levels: pd.DataFrame, looks: Mapping[str, style.Look]) -> None:
    settings = list(levels["setting"].unique())
    table = levels.pivot(index="setting", columns="variant", values="psnr_db").reindex(settings)
    table = table.where(np.isfinite(table))
    printed = levels.groupby("variant")["paper_db"].first()
    for variant, look in looks.items():
        if variant in table:
            line = {"color": (look.color, 0.5), "linestyle": look.linestyle, **look.mark}
            ax.plot(range(len(settings)), table[variant], label=variant, **line)
            ax.plot(len(settings), printed[variant], color=look.color, **look.mark)
    if printed.notna().any():
        settings.append(PRINTED)
        ax.axvline(len(settings) - 1.5, color="0.6", linestyle=":")
    ax.set_xticks(range(len(settings)), settings, rotation=60, ha="right", rotation_mode="anchor")
    ax.grid(True, axis="y")
    ax.set_axisbelow(True)
