"""Figure 8 of Bagher et al. 2016: rendering errors across all materials."""

import argparse
import operator
from collections.abc import Mapping, Sequence
from functools import reduce

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import quality, tables
from npfm.evaluation.quality import Metric
from npfm.figures import own_colors, style

PSNR = quality.METRICS["psnr"]
REFERENCE_VARIANT = "independent-g"  # whose error sorts the materials in the paper
#: What stands below the axis.
ORDERS = {
    "diffuseness": "material, by increasing diffuseness (equation 19)",
    "error": f"material, by decreasing error of {REFERENCE_VARIANT}",
}
MEAN_HEIGHT, SCENE_HEIGHT, LINE_HEIGHT = 2.1, 1.1, 0.15  # inches
AXIS_WIDTH = 6.3  # inches, of the page's width after the labels
TEXT_SIZE = style.SETTINGS["font.size"]  # points
LETTER = 0.6  # width of a letter, of its size
LEGEND_MARK = 0.45  # inches, of a column of the legend besides the text
POINTS = 72  # an inch


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--psnr", help="CSV made by npfm tables psnr")
    source.add_argument("--quality", help="CSV made by npfm quality gather, for --metric")
    parser.add_argument(
        "--metric", help=f"with --quality: which is drawn, {', '.join(quality.METRICS)}"
    )
    parser.add_argument(
        "--order",
        required=True,
        choices=list(ORDERS),
        help="sort materials by increasing diffuseness, or by decreasing error of independent-g",
    )
    parser.add_argument(
        "--materials", help="CSV made by npfm tables materials; needed for --order diffuseness"
    )
    own_colors.add_colors(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the tables that the arguments name."""
    a = arguments
    values, metric = _values(a.psnr, a.quality, a.metric)
    if a.order == "diffuseness" and not a.materials:
        raise NpfmError("--order diffuseness needs --materials; make it with npfm tables materials")
    try:
        if a.order == "error":
            order = by_error(values, metric)
        else:
            materials = tables.read(a.materials, ["material"], ["diffuseness"])
            order = by_diffuseness(values, materials)
    except NpfmError as error:
        raise NpfmError(f"{a.materials or a.psnr or a.quality}: {error}") from error
    return draw(values, order, ORDERS[a.order], own_colors.colors(a), metric)


def _values(psnr: str | None, table: str | None, name: str | None) -> tuple[pd.DataFrame, Metric]:
    """What is drawn, as scene, material, variant and value, and what it is."""
    if psnr:
        if name:
            raise NpfmError("--metric needs --quality, not --psnr; make it with npfm quality")
        return tables.read_psnr(psnr).rename(columns={"psnr_db": "value"}), PSNR
    if not name:
        raise NpfmError(f"--quality needs --metric; give one of {', '.join(quality.METRICS)}")
    metric = quality.metric(name)
    assert table is not None  # one of the two is required
    try:
        return quality.values_of(quality.read(table), name), metric
    except NpfmError as error:
        raise NpfmError(f"{table}: {error}") from error


def by_diffuseness(values: pd.DataFrame, materials: pd.DataFrame) -> list[str]:
    """Sort the materials by increasing diffuseness.

    Parameters
    ----------
    values, materials : DataFrame
        Columns material, ...; and material, diffuseness.

    Raises
    ------
    NpfmError
        If the diffuseness of a material is not known.
    """
    names = values["material"].unique()
    if unknown := sorted(set(names) - set(materials["material"])):
        raise NpfmError(
            f"no diffuseness of {', '.join(unknown)}; give them to npfm tables materials as well"
        )
    ranked = materials[materials["material"].isin(names)].sort_values(["diffuseness", "material"])
    return list(ranked["material"])


def by_error(values: pd.DataFrame, metric: Metric = PSNR) -> list[str]:
    """Sort the materials by decreasing error, such as increasing mean PSNR, of independent-g.

    Materials without one come last, after those whose pictures are equal to the reference.

    Raises
    ------
    NpfmError
        If independent-g is not in the table.
    """
    if REFERENCE_VARIANT not in set(values["variant"]):
        raise NpfmError(
            f"no {metric.label} of {REFERENCE_VARIANT} to sort by; "
            "give it to npfm tables psnr as well"
        )
    mean = _panels(values)[0][REFERENCE_VARIANT].sort_index()
    best_last = metric.better == "higher"
    return list(mean.sort_values(ascending=best_last, kind="stable", na_position="last").index)


def draw(
    values: pd.DataFrame,
    order: list[str],
    order_label: str,
    colors: Mapping[str, str] | None = None,
    metric: Metric = PSNR,
) -> Figure:
    """Draw a metric over materials: the mean over the scenes, and below it every scene.

    What is missing or infinite is left out as a gap, and counted in the legend.

    Parameters
    ----------
    values : DataFrame
        Columns scene, material, variant, value.
    order : list of str
        Materials from left to right.
    order_label : str
        What that order is, for the axis.
    colors : mapping of str to str, optional
        Colours of variants, in place of the project's.
    metric : Metric
        What the values are.
    """
    mean, scenes = _panels(values)
    panels = {_title(name): panel for name, panel in scenes.items()}
    if len(panels) > 1:
        panels = {f"mean over the scenes {', '.join(scenes)}": mean, **panels}
    panels = {title: panel.reindex(order) for title, panel in panels.items()}
    legend = [_legend_entry(row, metric) for _, row in mean.reindex(order).items()]
    name_size = min(TEXT_SIZE, 0.9 * AXIS_WIDTH * POINTS / len(order))
    names_height = LETTER * name_size * max(map(len, order)) / POINTS
    columns = _legend_columns(legend)
    with style.context():
        figure, axes = _axes(len(panels), names_height, 1 + -(-len(legend) // columns))
        for ax, (title, panel) in zip(axes, panels.items(), strict=True):
            _draw_panel(ax, panel, title, style.looks(panel.columns, colors))
            ax.set_ylabel(_axis_label(metric))
        axes[-1].set_xticks(range(len(order)), order, rotation=90, fontsize=name_size)
        axes[-1].set_xlabel(order_label)
        figure.legend(
            axes[0].get_lines(),
            legend,
            title=f"variant: mean {metric.label} over the materials drawn",
            loc="outside upper center",
            ncols=columns,
            frameon=False,
        )
    return figure


def _title(scene: str) -> str:
    return "every table" if scene == quality.ALL else f"scene {scene}"


def _axis_label(metric: Metric) -> str:
    said = [metric.unit] if metric.unit != "1" else []
    said += ["lower is better"] if metric.better == "lower" else []
    return f"{metric.label} ({', '.join(said)})" if said else metric.label


def _panels(values: pd.DataFrame) -> tuple[pd.DataFrame, Mapping[str, pd.DataFrame]]:
    """Values by material and variant: the mean over the scenes, and each scene.

    A mean is missing where the value of any scene is.
    """
    variants = values["variant"].unique()
    scenes = {
        str(scene): rows.pivot(index="material", columns="variant", values="value")
        for scene, rows in values.groupby("scene", sort=False)
    }
    scenes = {scene: panel.reindex(columns=variants) for scene, panel in scenes.items()}
    return reduce(operator.add, scenes.values())[variants] / len(scenes), scenes


def _axes(panels: int, names_height: float, legend_lines: int) -> tuple[Figure, NDArray]:
    heights = [MEAN_HEIGHT] + [SCENE_HEIGHT] * (panels - 1)
    height = sum(heights) + names_height + 0.3 + LINE_HEIGHT * legend_lines
    figure = Figure(figsize=(style.PAGE_WIDTH, height), layout="constrained")
    axes = figure.subplots(
        panels, 1, sharex=True, sharey=True, squeeze=False, height_ratios=heights
    )
    return figure, axes[:, 0]


def _draw_panel(ax: Axes, panel: pd.DataFrame, title: str, looks: Mapping[str, style.Look]) -> None:
    for variant, look in looks.items():
        values = panel[variant].where(np.isfinite(panel[variant]))
        ax.plot(
            range(len(values)),
            values,
            color=(look.color, 0.5),  # the line only guides the eye from mark to mark
            **look.mark,
            linestyle=look.linestyle,
        )
    ax.set_title(title, loc="left", pad=2)
    ax.margins(x=0.01)
    ax.grid(True)
    ax.set_axisbelow(True)


def _legend_entry(values: pd.Series, metric: Metric) -> str:
    """Name, mean over what is drawn, and how many materials are not."""
    drawn = values[np.isfinite(values)]
    gaps = len(values) - len(drawn)
    said = f"{drawn.mean():.2f} dB" if metric.unit == "dB" else f"{drawn.mean():.4g}"
    mean = said if len(drawn) else "nothing finite"
    return f"{values.name}: {mean}" + (f", {gaps} gap{'s' * (gaps > 1)}" if gaps else "")


def _legend_columns(labels: Sequence[str]) -> int:
    """As many columns as fit the page; matplotlib fills them one after the other."""
    widths = [LEGEND_MARK + LETTER * TEXT_SIZE * len(label) / POINTS for label in labels]
    for columns in range(len(widths), 1, -1):
        if sum(column.max() for column in np.array_split(widths, columns)) < style.PAGE_WIDTH:
            return columns
    return 1
