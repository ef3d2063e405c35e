"""Variants as the figures draw them: colours told apart in all forms of colour blindness."""

from collections.abc import Iterable, Mapping
from typing import Any

from matplotlib.markers import MarkerStyle
from matplotlib.path import Path

from npfm.figures import style

#: Letters of SVG for the codes of a path of matplotlib.
LETTERS = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C"}


def variants(names: Iterable[str], colors: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return name, colour, mark and line of each variant.

    Parameters
    ----------
    names : iterable of str
        In the order of the run.
    colors : mapping of str to str
        Of some of them, in place of the project's.

    Returns
    -------
    list of dict
        `mark` is a path of SVG that fits into a square of side 1 around the origin.
    """
    return [
        {
            "name": name,
            "color": look.color,
            "mark": mark(look.marker),
            "filled": look.filled,
            "dashed": look.linestyle != "-",
        }
        for name, look in style.looks(names, colors).items()
    ]


def mark(marker: str) -> str:
    """Return a marker of matplotlib as a path of SVG, whose y points downwards."""
    drawn = MarkerStyle(marker)
    path = drawn.get_path().transformed(drawn.get_transform())
    said = []
    for vertices, code in path.iter_segments(curves=True, simplify=False):
        if code == Path.CLOSEPOLY:
            said.append("Z")
        else:
            places = zip(vertices[::2], -vertices[1::2], strict=True)
            said.append(LETTERS[code] + " ".join(f"{x:.3g},{y:.3g}" for x, y in places))
    return "".join(said)
