"""What each effect costs in each scene, and where it changes the picture."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage, imread
from numpy.typing import NDArray

from npfm.evaluation.effects_cost import read
from npfm.figures import style
from npfm.storage.names import distinct
from npfm.storage.pictures import read_exr_parts

ROW, CELL, MARGIN = 0.17, 1.5, 1.0  # inches: a row of a panel, a picture, axes and titles
#: Column, title, and unit of each panel.
PANELS = (
    ("build_seconds", "seconds to build", 1.0),
    ("rays", "million shadow rays", 1e6),
    ("nonzeros", "million entries of T", 1e6),
    ("picture_seconds", "seconds a picture", 1.0),
    ("psnr_change_db", "PSNR of fits (dB)", 1.0),
)
#: Changes below this are black, in dB of the peak of the picture (Bagher et al. 2016, section 5).
DARKEST_DB = -80.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm effects table")
    parser.add_argument(
        "--changed", nargs="+", required=True, help="<scene>.exr made by npfm effects compare"
    )
    parser.add_argument(
        "--shown", nargs="+", required=True, help="tone-mapped PNG of each, as the scene has it"
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table and the pictures that the arguments name."""
    names = distinct(Path(path).stem for path in arguments.changed)
    changed = dict(zip(names, map(read_exr_parts, arguments.changed), strict=True))
    return draw(read([arguments.table]), changed, [imread(path) for path in arguments.shown])


def draw(
    table: pd.DataFrame,
    changed: Mapping[str, Mapping[str, NDArray]],
    shown: Sequence[NDArray],
) -> Figure:
    """Draw costs and changes, off and on, above pictures of where the changes are.

    Parameters
    ----------
    table : DataFrame
        As `npfm.evaluation.effects_cost.compare` makes it, of all scenes.
    changed : mapping of str to mapping of str to ndarray
        For each scene, linear radiance and coverage as ``scene`` and with each effect switched.
    shown : sequence of ndarray
        The tone-mapped picture of each of these scenes.
    """
    effects = list(table["effect"].unique())
    heights = MARGIN + ROW * len(table) / 2, CELL * (1 + len(effects)) + MARGIN / 2
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, sum(heights)), layout="constrained")
        (above,), (below,) = figure.subfigures(2, squeeze=False, height_ratios=heights)
        axes = above.subplots(1, len(PANELS), sharey=True)
        for ax, panel in zip(axes, PANELS, strict=True):
            _draw_panel(ax, table, *panel, style.looks(effects))
        axes[0].invert_yaxis()
        above.legend(
            *axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4, frameon=False
        )
        grid = below.subplots(1 + len(effects), len(changed), squeeze=False)
        for column, picture, (scene, parts) in zip(grid.T, shown, changed.items(), strict=True):
            column[0].set_title(f"scene {scene}")
            column[0].imshow(picture, interpolation="nearest")
            for ax, effect in zip(column[1:], effects, strict=True):
                image = _draw_change(ax, parts, effect)
        for ax, label in zip(grid[:, 0], ["the picture", *effects], strict=True):
            ax.set_ylabel(label)
        for ax in grid.flat:
            ax.set(xticks=[], yticks=[])
            ax.spines[:].set_visible(False)
        label = "difference, off and on (dB, peak of the picture = 0)"
        below.colorbar(image, ax=grid[1:], label=label, shrink=0.6)
    return figure


def change_db(parts: Mapping[str, NDArray], effect: str) -> NDArray[np.float64]:
    """Difference of a picture with an effect switched, in dB of the picture's peak.

    Returns
    -------
    ndarray, shape (h, w)
        Root mean square over the colour components; minus infinity where nothing changes, which
        is everywhere for an effect that cannot be switched and for a black material, and where no
        object is to be seen.
    """
    scene = parts["scene"].astype(float)
    other = parts.get(effect, parts["scene"])[..., :3]
    error = np.sqrt(np.mean((scene[..., :3] - other) ** 2, axis=-1)) * (scene[..., 3] > 0)
    with np.errstate(divide="ignore"):
        return 20 * np.log10(error / (scene[scene[..., 3] == 1, :3].max() or 1.0))


def _draw_panel(
    ax: Axes,
    table: pd.DataFrame,
    column: str,
    title: str,
    unit: float,
    looks: Mapping[str, style.Look],
) -> None:
    pairs = table.groupby(["scene", "effect"], sort=False)
    labels = []
    for y, ((scene, effect), pair) in enumerate(pairs):
        labels.append(f"{scene} {effect}")
        look, values = looks[str(effect)], pair.sort_values("on")[column] / unit
        ax.plot(values, [y, y], color=look.color)
        for value, face, state in zip(values, ("white", look.color), ("off", "on"), strict=True):
            label = f"{effect} {state}" if y < len(looks) else None
            mark: dict[str, Any] = {"marker": look.marker, "markerfacecolor": face}
            ax.plot(value, y, color=look.color, markersize=4, linestyle="none", label=label, **mark)
    ax.set_yticks(range(len(labels)), labels)
    ax.set_title(title)
    ax.grid(True)
    ax.set_axisbelow(True)


def _draw_change(ax: Axes, parts: Mapping[str, NDArray], effect: str) -> AxesImage:
    change = change_db(parts, effect)
    if np.isneginf(change).all():
        ax.set_xlabel("no change", labelpad=2)
    else:
        share = np.isfinite(change[parts["scene"][..., 3] == 1]).mean()
        ax.set_xlabel(f"{share:.0%} of the pixels", labelpad=2)
    return ax.imshow(change, norm=Normalize(DARKEST_DB, 0), cmap="inferno", interpolation="nearest")
