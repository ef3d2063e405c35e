"""How every figure looks: sizes, fonts, one colour and marker a variant, and how it is saved."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from itertools import cycle
from pathlib import Path
from typing import Any

import matplotlib.style
from matplotlib.axis import XAxis, YAxis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from npfm.storage.files import Kind, check_replaceable, marked, replacing

#: Inches; the text of an ACM Transactions on Graphics page is 7 in wide, a column 3.33 in.
PAGE_WIDTH, COLUMN_WIDTH = 7.0, 3.33
DPI = 300
SETTINGS: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same glyphs on every machine
    "font.size": 7,
    "axes.titlesize": 7,
    "axes.linewidth": 0.5,
    "grid.linewidth": 0.3,
    "grid.color": "0.85",
    "lines.linewidth": 0.7,
    "lines.markersize": 2.8,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2,
    "ytick.major.size": 2,
    "pdf.fonttype": 42,  # TrueType: text in the PDF can be searched and edited
}
#: What a figure is written as, and how one of ours is told from others.
KINDS = {
    ".pdf": Kind("a figure", ".pdf", marked(b"%PDF", b"/Creator (npfm)")),
    ".png": Kind("a figure", ".png", marked(b"PNG\r\n", b"Software\0npfm")),
}
#: What would differ from run to run or from machine to machine is left out of the files.
METADATA = {
    ".pdf": {"Creator": "npfm", "Producer": None, "CreationDate": None},
    ".png": {"Software": "npfm"},
}


@dataclass(frozen=True)
class Look:
    """How a variant is drawn; the names are matplotlib's."""

    color: str
    marker: str
    linestyle: str = "-"
    filled: bool = True

    @property
    def mark(self) -> dict[str, Any]:
        """Arguments of `Axes.plot` for the marker."""
        face, edge = (self.color, 0.0) if self.filled else ("white", 0.6)
        return {
            "marker": self.marker,
            "markerfacecolor": face,
            "markeredgecolor": self.color,
            "markeredgewidth": edge,
        }


# Colours of Okabe and Ito 2008, "Color Universal Design", told apart in all common forms of
# colour blindness; yellow is left out, it is too pale for thin lines on white. Variants of one
# form have one colour, and what is published open marks on dashed lines.
LOOKS = {
    "bivariate": Look("#000000", "s"),
    "independent-g": Look("#0072B2", "o"),
    "independent-g-published": Look("#0072B2", "o", "--", filled=False),
    "g-from-d": Look("#E69F00", "^"),
    "naive": Look("#009E73", "D"),
    "bivariate-g": Look("#7F7F7F", "P"),
    "low-rank-b": Look("#7F7F7F", "X"),
    "shared-lobes": Look("#8C510A", "D"),
    "tucker-20": Look("#882255", "*"),
    "factored": Look("#661100", "*"),
    "abc-e2": Look("#D55E00", "v"),
    "abc-ours": Look("#D55E00", ">"),
    "abc-published": Look("#D55E00", "v", "--", filled=False),
    "shifted-gamma": Look("#CC79A7", "p"),
    "shifted-gamma-published": Look("#CC79A7", "p", "--", filled=False),
    "power-iteration": Look("#CC6677", "<"),
    "ggx": Look("#117733", "8"),
    "ggx-fitted": Look("#117733", "H", "-."),
    "beckmann": Look("#44AA99", "d"),
    "ward": Look("#999933", "<"),
    "ward-published": Look("#999933", "<", "--", filled=False),
    "blinn-phong": Look("#332288", "P"),
    "blinn-phong-published": Look("#332288", "P", "--", filled=False),
    "lafortune": Look("#AA4499", "X"),
    "lafortune-published": Look("#AA4499", "X", "--", filled=False),
    "cook-torrance": Look("#56B4E9", "h"),
    "cook-torrance-published": Look("#56B4E9", "h", "--", filled=False),
}
#: For other variants in their order: 12 pairs, since 3 and 4 have no common divisor. Colours of
#: Tol 2021, "Colour schemes", muted.
OTHER_COLORS = ("#AA4499", "#999933", "#332288")
OTHER_MARKERS = ("v", "P", "X", "*")


def looks(variants: Iterable[str], colors: Mapping[str, str] | None = None) -> dict[str, Look]:
    """Return the look of each variant: its own where it has one, else the next free one.

    Parameters
    ----------
    variants : iterable of str
        Names.
    colors : mapping of str to str, optional
        Colours of some of them, in place of the project's.
    """
    others = zip(cycle(OTHER_COLORS), cycle(OTHER_MARKERS), strict=False)
    own = {name: LOOKS.get(name) or Look(*next(others), "--") for name in variants}
    return {
        name: replace(look, color=(colors or {}).get(name, look.color))
        for name, look in own.items()
    }


def context() -> AbstractContextManager:
    """Return the settings to draw and save under, whatever the user's own settings are."""
    return matplotlib.style.context(["default", SETTINGS])


def plain_logarithmic(axis: XAxis | YAxis) -> None:
    """Make an axis logarithmic, with 1, 2 and 5 of each decade written as plain numbers."""
    axis.axes.set(**{f"{axis.axis_name}scale": "log"})
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())


def save(figure: Figure, paths: Sequence[str | Path]) -> None:
    """Write a figure; the same figure gives the same bytes.

    Parameters
    ----------
    figure : Figure
        Drawn under `context`.
    paths : sequence of str or Path
        Ending in ``.pdf`` (vector) or ``.png`` (300 dpi).

    Raises
    ------
    NpfmError
        If a name ends in something else, or something else is there.
    """
    files = [Path(path) for path in paths]
    for file in files:
        check_replaceable(file, *KINDS.values())
    for file in files:
        with context(), replacing(file, KINDS[file.suffix]) as temporary:
            figure.savefig(temporary, dpi=DPI, metadata=METADATA[file.suffix])
