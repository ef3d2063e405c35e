"""The page of a material in motion: its light turned around it, and its fit converging."""

import base64
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from npfm.evaluation.turned_light import Turned
from npfm.exports.gallery import looks, page, starts
from npfm.exports.gallery.material import LARGEST_ERROR, color_map
from npfm.fitting.iterations import Iterations
from npfm.storage.pictures import tone_map

DECIMALS = 2  # of PSNR


def write(
    path: str | Path,
    material: str,
    materials: Sequence[str],
    followed: Iterations,
    turned: Turned,
    tone: tuple[float, float],
    colors: Mapping[str, str],
) -> None:
    """Write the page of a material in motion.

    Parameters
    ----------
    path : str or Path
        The page; those of the other materials lie beside it.
    material : str
    materials : sequence of str
        All that there are such pages of.
    followed : Iterations
        Of a fit of the material.
    turned : Turned
        The measurement and some fits in the light.
    tone : (float, float)
        Exposure and gamma (`pictures.tone_map`).
    colors : mapping of str to str
        Of some variants, in place of the project's.
    """
    data = {
        "material": material,
        "materials": list(materials),
        "light": _light(turned, tone, colors),
        "starts": starts.described(followed) | {"looks": starts.looks(followed.names)},
        "errors": {"largest": LARGEST_ERROR, "colors": color_map()},
    }
    page.write(path, "video", f"{material} in motion", data, [starts.packed(followed)])


def _light(turned: Turned, tone: tuple[float, float], colors: Mapping[str, str]) -> dict[str, Any]:
    """What a page is told of the pictures, with the pictures."""
    height, width = turned.coverage.shape
    measured, *fits = turned.names
    return {
        "degrees": list(turned.degrees),
        "names": [measured, *fits],
        "looks": looks.variants(fits, colors),
        "height": height,
        "width": width,
        "psnr": [[page.number(round(v, DECIMALS)) for v in row] for row in turned.psnr().tolist()],
        "sheet": _data_address(sheet(turned, tone)),
    }


def shown(turned: Turned, tone: tuple[float, float]) -> NDArray[np.uint8]:
    """Return display values of all pictures, those that are not numbers black."""
    return tone_map(np.nan_to_num(turned.radiance, nan=0.0, posinf=np.inf), *tone)


def sheet(turned: Turned, tone: tuple[float, float]) -> NDArray[np.uint8]:
    """All pictures in one, a row each turn, a column each name, shape (rows, columns, 3)."""
    display = shown(turned, tone)
    turns, names, height, width, _ = display.shape
    return display.transpose(0, 2, 1, 3, 4).reshape(turns * height, names * width, 3)


def _data_address(pixels: NDArray[np.uint8]) -> str:
    """A PNG file as an address: scripts may not read the pixels of one that lies beside a page."""
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, format="PNG", optimize=True)
    return f"data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}"
