"""Figure 4 of Bagher et al. 2016: the compressive function."""

import argparse
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from npfm.figures import style
from npfm.fitting.objective import COMPRESSION_ALPHA, compressed

HEIGHT = 2.2  # inches
LARGEST = 6.0  # of x
#: alpha, colour and dashes of each curve: the alpha of the objective, half of it and twice as much.
CURVES = {
    r"$\alpha = \frac{1}{2}\log\,2$": (COMPRESSION_ALPHA / 2, "#009E73", (0, (4, 1.5))),
    r"$\alpha = \log\,2$ (objective)": (COMPRESSION_ALPHA, "#0072B2", "-"),
    r"$\alpha = 2\,\log\,2$": (COMPRESSION_ALPHA * 2, "#D55E00", (0, (1, 1))),
}
BOUND: dict[str, Any] = {"color": "0.6", "linewidth": 0.5, "zorder": 1}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from: nothing."""


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure."""
    return draw()


def draw() -> Figure:
    """Draw f(x; alpha) for some alpha, below the two bounds that it nears: x and 1 / alpha."""
    x = np.linspace(0, LARGEST, 241)
    with style.context():
        figure = Figure(figsize=(style.COLUMN_WIDTH, HEIGHT), layout="constrained")
        ax = figure.subplots()
        for label, (alpha, color, dashes) in CURVES.items():
            ax.plot(x, compressed(x, alpha), color=color, linestyle=dashes, lw=1.2, label=label)
            ax.axhline(1 / alpha, linestyle=dashes, **BOUND)
            ax.text(LARGEST, 1 / alpha + 0.04, r"$1/\alpha$ ", ha="right", color=color)
        ax.plot(x, x, **BOUND)
        ax.text(2.4, 2.5, "$x$", ha="right")
        ax.plot(1, compressed(1), "o", color="#0072B2", markersize=3.5)
        line = {"arrowstyle": "-", "linewidth": 0.5}
        ax.annotate("the weighted median", (1, compressed(1)), (1.5, 0.2), arrowprops=line)
        ax.set(xlim=(0, LARGEST), ylim=(0, 2 / COMPRESSION_ALPHA * 1.1))
        ax.set_xlabel(r"$x = \rho^* / \bar\rho$, the BRDF in units of its weighted median")
        ax.set_ylabel(r"$f(x; \alpha)$")
        figure.legend(loc="outside upper center", ncols=3, frameon=False, columnspacing=1)
    return figure
