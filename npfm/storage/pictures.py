"""Pictures on disk: linear radiance as OpenEXR, tone-mapped for the eye as PNG."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import OpenEXR
from numpy.typing import ArrayLike, NDArray
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from npfm.errors import NpfmError
from npfm.storage import exr, hdr
from npfm.storage.files import Kind, marked, replacing

#: What is written tells who wrote it, so that nothing else is ever overwritten.
SOFTWARE = "npfm"
EXR = Kind("an OpenEXR picture", ".exr", marked(exr.MAGIC, b"software\0string\0\4\0\0\0npfm"))
PNG = Kind("a PNG picture", ".png", marked(b"PNG\r\n", b"Software\0npfm"))
#: Formats that hold radiance: how their files begin, and what reads them.
READERS = {"OpenEXR": (exr.MAGIC, exr.read), "HDR (Radiance RGBE)": (hdr.MAGIC, hdr.read)}


def write_exr(
    path: str | Path, pixels: ArrayLike, attributes: Mapping[str, str | float] | None = None
) -> None:
    """Write a picture of linear radiance as an OpenEXR file with float32 channels.

    Parameters
    ----------
    path : str or Path
        The file to write.
    pixels : array_like, shape (height, width, 3) or (height, width, 4)
        RGB or RGBA; row 0 is the top.
    attributes : mapping, optional
        Text or numbers to be kept in the header (numbers as float32).
    """
    header = _header() | dict(attributes or {})
    with replacing(path, EXR) as temporary, OpenEXR.File(header, _channels(pixels)) as file:
        file.write(str(temporary))


def write_exr_parts(path: str | Path, parts: Mapping[str, ArrayLike]) -> None:
    """Write several pictures as the named parts of one OpenEXR file, to be flipped in a viewer.

    Parameters
    ----------
    path : str or Path
        The file to write.
    parts : mapping of str to array_like of shape (height, width, 3) or (height, width, 4)
        Linear RGB or RGBA by name, in the order in which a viewer shows them.
    """
    parts_list = [OpenEXR.Part(_header(), _channels(p), name) for name, p in parts.items()]
    with replacing(path, EXR) as temporary, OpenEXR.File(parts_list) as file:
        file.write(str(temporary))


def _header() -> dict:
    return {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "software": SOFTWARE,
    }


def _channels(pixels: ArrayLike) -> dict[str, NDArray[np.float32]]:
    # OpenEXR reads the memory as it lies: an array that is not contiguous would be scrambled.
    pixels = np.ascontiguousarray(pixels, dtype=np.float32)
    names = {3: "RGB", 4: "RGBA"}
    if pixels.ndim != 3 or pixels.shape[2] not in names:
        raise ValueError(f"pixels must be of shape (height, width, 3 or 4), not {pixels.shape}")
    return {names[pixels.shape[2]]: pixels}


def read_exr(path: str | Path) -> NDArray[np.float32]:
    """Read the picture of an OpenEXR file, as `read_radiance` does."""
    return read_radiance(path, ("OpenEXR",))


def read_radiance(
    path: str | Path, formats: tuple[str, ...] = ("OpenEXR", "HDR (Radiance RGBE)")
) -> NDArray[np.float32]:
    """Read a picture of linear radiance.

    Parameters
    ----------
    path : str or Path
        The file to read.
    formats : tuple of str
        The formats that will do, of `READERS`; both of them.

    Returns
    -------
    ndarray, shape (height, width, 3) or (height, width, 4)
        RGB or RGBA over the display window; row 0 is the top. Of an OpenEXR file with several
        layers or parts, `npfm.storage.exr.read` tells which.

    Raises
    ------
    NpfmError
        If the file is absent, of another format, damaged, too large, or has no red, green and
        blue of linear radiance.
    """
    path = Path(path)
    return READERS[_format(path, formats)][1](path)


def read_exr_parts(path: str | Path) -> dict[str, NDArray[np.float32]]:
    """Read the pictures that `write_exr_parts` wrote, by name; errors as in `read_radiance`."""
    path = Path(path)
    _format(path, ("OpenEXR",))
    return exr.read_parts(path)


def windows(path: str | Path) -> tuple[exr.Window, exr.Window]:
    """Display window of an OpenEXR picture, and the window of its pixels that are stored."""
    path = Path(path)
    _format(path, ("OpenEXR",))
    return exr.windows(path)


def _format(path: Path, formats: tuple[str, ...]) -> str:
    """Which of the formats a file is of, by its first bytes."""
    wanted = " or ".join(formats)
    if not path.is_file():
        raise NpfmError(f"{path}: no such file; give the path of an {wanted} picture")
    with path.open("rb") as file:
        start = file.read(4)
    for name in formats:
        if start.startswith(READERS[name][0]):
            return name
    raise NpfmError(f"{path}: not an {wanted} file, or cut off; give a picture in that format")


def tone_map(radiance: ArrayLike, exposure: float, gamma: float) -> NDArray[np.uint8]:
    """Turn linear radiance into display values, for showing only.

    Bagher et al. 2016, section 5: output = (1 - 2^(-exposure x pixel))^(1 / gamma).

    Parameters
    ----------
    radiance : array_like
        Linear radiance; negative values are shown as black.
    exposure, gamma : float
        The paper has 0.02 and 2.2, and for its Ennis light 1 and 2.8.

    Returns
    -------
    ndarray of uint8
        Display values of the same shape, 0 to 255.
    """
    return _display(_exposed(radiance, exposure), gamma)


def tone_map_layers(
    layers: Sequence[tuple[NDArray, NDArray]], exposure: float, gamma: float
) -> NDArray[np.uint8]:
    """Tone-map what shares pixels each by itself, as a film would that is finer than the pixels.

    Averaged before it is exposed, a window that fills a sixteenth of a pixel would be all that is
    seen of it, and silhouettes before windows would have steps.

    Parameters
    ----------
    layers : sequence of (radiance, share)
        Linear RGB radiance (h, w, 3), times the share (h, w) of the pixel that it comes from. The
        shares add up to 1.
    exposure, gamma : float
        As in `tone_map`, which gives the same where one of the shares is 1.

    Returns
    -------
    ndarray of uint8, shape (h, w, 3)
        Display values, 0 to 255.
    """
    visible = []
    for radiance, share in layers:
        part = share[..., None]
        visible.append(part * _exposed(radiance / np.where(part > 0, part, 1), exposure))
    return _display(np.sum(visible, axis=0), gamma)


def _exposed(radiance: ArrayLike, exposure: float) -> NDArray:
    """Share of the light of a display, 0 to 1."""
    return -np.expm1(-np.log(2) * exposure * np.maximum(radiance, 0.0))


def _display(visible: NDArray, gamma: float) -> NDArray[np.uint8]:
    return np.rint(255 * visible ** (1 / gamma)).astype(np.uint8)


def write_png(path: str | Path, rgb: NDArray[np.uint8]) -> None:
    """Write display values as a PNG file.

    Parameters
    ----------
    path : str or Path
        The file to write.
    rgb : ndarray of uint8, shape (height, width, 3)
        Display values; row 0 is the top.
    """
    about = PngInfo()
    about.add_text("Software", SOFTWARE)
    with replacing(path, PNG) as temporary:
        Image.fromarray(rgb).save(temporary, format="PNG", pnginfo=about)


def read_png(path: str | Path) -> NDArray[np.uint8]:
    """Read the display values of a PNG file, shape (height, width, 3); row 0 is the top.

    Raises
    ------
    NpfmError
        If the file is absent or is no PNG picture.
    """
    path = Path(path)
    if not path.is_file():
        raise NpfmError(f"{path}: no such picture; make it with npfm render")
    try:
        with Image.open(path, formats=["PNG"]) as picture:
            return np.asarray(picture.convert("RGB"))
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise NpfmError(f"{path}: not a PNG picture ({error}); make it with npfm render") from error


#: A larger texture would take gigabytes as numbers, and no picture of ours shows more.
MOST_TEXELS = 2**24
#: Modes of PNG pictures whose bands are weights, and what each is read as; a palette's are colours.
BANDS = {"1": "L", "L": "L", "RGB": "RGB", "RGBA": "RGBA", "P": "RGB"}


def read_bands(path: str | Path) -> NDArray[np.float64]:
    """Read the values of a PNG picture of 8 bits: grey, RGB or RGBA.

    Returns
    -------
    ndarray, shape (height, width, 1, 3 or 4)
        From 0 to 1; row 0 is the top. Alpha is a band like the others.

    Raises
    ------
    NpfmError
        If the file is absent, is no PNG picture of one of `BANDS`, or is too large.
    """
    path = Path(path)
    if not path.is_file():
        raise NpfmError(f"{path}: no such picture; give the path of a PNG")
    try:
        with Image.open(path, formats=["PNG"]) as picture:
            width, height = picture.size
            if width * height > MOST_TEXELS:
                raise NpfmError(
                    f"{path}: {width} x {height} pixels; give at most {MOST_TEXELS}, as 4096 x 4096"
                )
            if picture.mode not in BANDS:
                raise NpfmError(
                    f"{path}: a picture of mode {picture.mode}; give a PNG of 8 bits, in grey, RGB "
                    "or RGBA"
                )
            values = np.asarray(picture.convert(BANDS[picture.mode]), dtype=float) / 255
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise NpfmError(f"{path}: cannot be read as a picture ({error}); give a PNG") from error
    return values[..., None] if values.ndim == 2 else values
