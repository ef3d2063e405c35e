"""Pictures on disk: linear radiance as OpenEXR, tone-mapped for the eye as PNG."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import OpenEXR
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from npfm.errors import NpfmError
from npfm.storage.files import replacing

if TYPE_CHECKING:
    from OpenImageIO import ImageInput

#: What people call the formats that OpenImageIO calls so.
FORMAT_NAMES = {"openexr": "OpenEXR", "hdr": "HDR (Radiance RGBE)"}


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
    with replacing(path) as temporary, OpenEXR.File(header, _channels(pixels)) as file:
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
    with replacing(path) as temporary, OpenEXR.File(parts_list) as file:
        file.write(str(temporary))


def _header() -> dict:
    return {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}


def _channels(pixels: ArrayLike) -> dict[str, NDArray[np.float32]]:
    # OpenEXR reads the memory as it lies: an array that is not contiguous would be scrambled.
    pixels = np.ascontiguousarray(pixels, dtype=np.float32)
    names = {3: "RGB", 4: "RGBA"}
    if pixels.ndim != 3 or pixels.shape[2] not in names:
        raise ValueError(f"pixels must be of shape (height, width, 3 or 4), not {pixels.shape}")
    return {names[pixels.shape[2]]: pixels}


def read_exr(path: str | Path) -> NDArray[np.float32]:
    """Read the first part of an OpenEXR file, as `read_radiance` does."""
    return read_radiance(path, ("openexr",))


def read_radiance(
    path: str | Path, formats: tuple[str, ...] = ("openexr", "hdr")
) -> NDArray[np.float32]:
    """Read a picture of linear radiance.

    Parameters
    ----------
    path : str or Path
        The file to read.
    formats : tuple of str
        The formats that will do, by OpenImageIO's names; both of those that hold radiance.

    Returns
    -------
    ndarray, shape (height, width, 3) or (height, width, 4)
        RGB or RGBA of the first part; row 0 is the top.

    Raises
    ------
    NpfmError
        If the file is absent, of another format, damaged, or has no red, green and blue.
    """
    return _pixels(_opened(Path(path), formats), Path(path), 0)


def read_exr_parts(path: str | Path) -> dict[str, NDArray[np.float32]]:
    """Read the pictures that `write_exr_parts` wrote, by name; errors as in `read_radiance`."""
    path, parts = Path(path), {}
    file = _opened(path, ("openexr",))
    while file.seek_subimage(len(parts), 0):
        name = file.spec().getattribute("name")
        parts[name] = _pixels(file, path, len(parts))
    return parts


def _opened(path: Path, formats: tuple[str, ...]) -> "ImageInput":
    # Only reading needs it, and rendering does not read: the import takes some milliseconds.
    import OpenImageIO as oiio

    wanted = " or ".join(FORMAT_NAMES[name] for name in formats)
    if not path.is_file():
        raise NpfmError(f"{path}: no such file; give the path of an {wanted} picture")
    file = oiio.ImageInput.open(str(path))
    if file is None or file.format_name() not in formats:
        oiio.geterror()  # An error that nobody fetches is printed at exit.
        raise NpfmError(f"{path}: not an {wanted} file, or cut off; give a picture in that format")
    return file


def _pixels(file: "ImageInput", path: Path, part: int) -> NDArray[np.float32]:
    """Pixels of a part of an open file."""
    names = file.spec().channelnames
    if names[:3] != ("R", "G", "B"):
        raise NpfmError(f"{path}: channels {', '.join(names)}; red, green and blue are needed")
    pixels = file.read_image(part, 0, 0, 4 if names[3:4] == ("A",) else 3, "float")
    if pixels is None or file.geterror():
        raise NpfmError(f"{path}: cut off or damaged; copy or make the file again")
    return pixels


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
    visible = -np.expm1(-np.log(2) * exposure * np.maximum(radiance, 0.0))
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
    with replacing(path) as temporary:
        Image.fromarray(rgb).save(temporary, format="PNG")
