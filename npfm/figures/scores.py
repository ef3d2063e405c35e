"""Bars of how often one variant renders better than others: the lower part of Figures 12 and 13."""

from collections.abc import Mapping, Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from npfm.evaluation.head_to_head import TIE_DB, HeadToHead, head_to_head
from npfm.papers import bagher2016

NAME, BAR, AXIS, LEGEND = 0.14, 0.15, 0.36, 0.24  # inches; AXIS is under the bars
MARGIN = 0.12  # inches, at the ends of the axis
#: Wins, ties and losses: told apart in all common forms of colour blindness, and printed in grey.
COLORS = ("#0072B2", "0.85", "#E69F00")
INK = ("white", "black", "black")
NARROW = 8.0  # percent: too narrow for its number


def count(psnr: pd.DataFrame, ours: str, others: Sequence[str]) -> dict[str, HeadToHead]:
    """Count wins, ties and losses against each other variant, and then the paper's own counts.

    Parameters
    ----------
    psnr : DataFrame
        Columns scene, material, variant, psnr_db.
    ours, others : str, and sequence of str
        The variants.

    Returns
    -------
    dict of str to HeadToHead
        By what stands beside the bar.
    """
    scores = {other: head_to_head(psnr, ours, other) for other in others}
    models = [bagher2016.HEAD_TO_HEAD_VARIANTS.get(other) for other in others]
    for model in dict.fromkeys(filter(None, models)):
        scores[f"paper: {model}"] = HeadToHead(*bagher2016.HEAD_TO_HEAD[model], missing=0)
    return scores


def height(scores: Mapping[str, HeadToHead]) -> float:
    """Inches that `draw` needs."""
    return (NAME + BAR) * len(scores) + AXIS + LEGEND


def draw(figure: Figure, scores: Mapping[str, HeadToHead], ours: str) -> None:
    """Draw the scores along the lower edge of a figure, one bar a model, its counts above it.

    Each bar is divided by its own number of renderings; those that one of the two lacks are told.
    """
    width, total = figure.get_size_inches()
    bars = (NAME + BAR) * len(scores)
    ax = figure.add_axes((MARGIN / width, AXIS / total, 1 - 2 * MARGIN / width, bars / total))
    for place, (model, score) in enumerate(scores.items()):
        _draw_bar(ax, place * (NAME + BAR), score)
        ax.text(0, place * (NAME + BAR) + 0.7 * NAME, _counts(model, score), va="baseline")
    ax.set(yticks=[], xlim=(0, 100), ylim=(bars, 0))
    ax.set_xlabel("share of the renderings (%)", labelpad=1)
    ax.spines[["top", "right", "left"]].set_visible(False)
    figure.legend(
        [Patch(color=color) for color in COLORS],
        [f"{ours} better", f"within {TIE_DB:g} dB", "worse"],
        loc="lower center",
        bbox_to_anchor=(0.5, (AXIS + bars) / total),
        ncols=3,
        frameon=False,
        borderaxespad=0.2,
        handlelength=1,
    )


def _draw_bar(ax: Axes, top: float, score: HeadToHead) -> None:
    start = 0.0
    counts = (score.wins, score.ties, score.losses)
    middle = top + NAME + BAR / 2
    for number, color, ink in zip(counts, COLORS, INK, strict=True):
        share = 100 * number / max(1, score.compared)
        ax.barh(middle, share, left=start, height=0.8 * BAR, color=color)
        if share > NARROW:
            label = f"{share:.0f} %"
            ax.text(start + share / 2, middle, label, color=ink, ha="center", va="center_baseline")
        start += share


def _counts(model: str, score: HeadToHead) -> str:
    missing = f", {score.missing} missing" if score.missing else ""
    return f"{model}: {score.wins} better, {score.ties} tied, {score.losses} worse{missing}"
