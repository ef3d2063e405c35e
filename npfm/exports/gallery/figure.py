"""The figure of a run's scenes, for the demo."""

import json
import zlib
from pathlib import Path

import numpy as np

from npfm.exports.gallery import page
from npfm.exports.gallery.kinds import FIGURE, FIGURE_START
from npfm.rendering.geometry import Mesh
from npfm.rendering.scenes import Scene, place
from npfm.storage.files import replacing

#: Largest of the 16-bit whole numbers that stand for coordinates from -1 to 1.
LARGEST = 2**15 - 1


def write(path: str | Path, mesh: Path | None) -> None:
    """Write the figure as a script that the demo loads when it is asked for.

    It calls ``npfmFigure`` with the number of vertices, the length of the unit and the base 64 of a
    zlib stream: 16-bit coordinates of positions and of normals, x, y and z of a vertex together,
    and 32-bit indices of the corners of the triangles.

    Parameters
    ----------
    path : str or Path
        The file to write, with the suffix ``.js``.
    mesh : Path or None
        The mesh of the figure; None stands for the project's own.

    Raises
    ------
    NpfmError
        If the mesh cannot be used.
    """
    [shape] = place(Scene(("figure",), mesh=mesh))
    assert isinstance(shape, Mesh), "the figure is a mesh"
    scale = float(np.abs(shape.vertices).max())
    numbers = np.stack([shape.vertices / scale, shape.normals])
    words = np.round(np.clip(numbers, -1, 1) * LARGEST).astype("<i2")
    content = words.tobytes() + shape.faces.astype("<u4").tobytes()
    packed = page.base64_of(zlib.compress(content, 9))
    given = ", ".join(json.dumps(each) for each in (len(shape.vertices), scale, packed))
    with replacing(path, FIGURE) as temporary:
        temporary.write_text(f"{FIGURE_START}{given});\n", encoding="ascii", newline="\n")
