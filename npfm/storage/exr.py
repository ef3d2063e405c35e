"""OpenEXR pictures, read as their headers say: windows, parts, layers and types of channels."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.storage.bounds import check_size

if TYPE_CHECKING:
    from OpenImageIO import ImageInput, ImageSpec

MAGIC = b"\x76\x2f\x31\x01"
#: What programs call the channels.
COLORS = {name: name[0].upper() for name in ("red", "green", "blue", "alpha")}
COLORS |= {name[0]: color for name, color in COLORS.items()}
#: So many names of channels or layers are listed in a message.
FEW = 12


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels; `x` grows to the right and `y` downwards."""

    x: int
    y: int
    width: int
    height: int

    def __and__(self, other: "Window") -> "Window":
        x, y = max(self.x, other.x), max(self.y, other.y)
        right = min(self.x + self.width, other.x + other.width)
        bottom = min(self.y + self.height, other.y + other.height)
        return Window(x, y, max(0, right - x), max(0, bottom - y))

    def __str__(self) -> str:
        return f"{self.width} x {self.height} at ({self.x}, {self.y})"

    def slices(self, origin: "Window") -> tuple[slice, slice]:
        """Rows and columns of this window in an array that holds `origin`."""
        x, y = self.x - origin.x, self.y - origin.y
        return slice(y, y + self.height), slice(x, x + self.width)


@dataclass(frozen=True)
class Layer:
    """Red, green and blue of a part of a file, and alpha if it has one.

    Parameters
    ----------
    spec : ImageSpec
        The part's header, as OpenImageIO gives it.
    part : int
        Its index in the file.
    name : str
        What stands before the last dot in the names of the channels.
    channels : dict of str to int
        Indices of the channels R, G, B and, where there is one, A.
    """

    spec: "ImageSpec"
    part: int
    name: str
    channels: dict[str, int]

    @cached_property
    def data(self) -> Window:
        """The pixels that are stored."""
        return Window(self.spec.x, self.spec.y, self.spec.width, self.spec.height)

    @cached_property
    def display(self) -> Window:
        """The pixels that make the picture."""
        s = self.spec
        return Window(s.full_x, s.full_y, s.full_width, s.full_height)

    @property
    def shown(self) -> Window:
        """The pixels of the picture that are stored."""
        return self.data & self.display


def read(path: Path) -> NDArray[np.float32]:
    """Read the picture of an OpenEXR file, over its display window.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    ndarray of float32, shape (height, width, 3) or (height, width, 4)
        RGB or RGBA: the channels R, G and B of the first part, or else the only layer of any part
        that has red, green and blue. Black where nothing is stored; overscan is left out.

    Raises
    ------
    NpfmError
        If the file is damaged, too large, or has no or several such layers, deep pixels or
        integers.
    """
    file = _opened(path)
    return _pixels(file, path, _only(path, file))


def read_parts(path: Path) -> dict[str, NDArray[np.float32]]:
    """Read the channels R, G, B and A of every part, by the name of the part."""
    file, parts = _opened(path), {}
    for part, spec in enumerate(_specs(file)):
        layers = {layer.name: layer for layer in _layers(spec, part)}
        if "" not in layers:
            raise NpfmError(_missing(path, spec.channelnames))
        parts[spec.getattribute("name")] = _pixels(file, path, layers[""])
    return parts


def windows(path: Path) -> tuple[Window, Window]:
    """Display window of the picture that `read` reads, and that of its pixels that are stored."""
    layer = _only(path, _opened(path))
    return layer.display, layer.shown


def _opened(path: Path) -> "ImageInput":
    # Only reading needs it, and rendering does not read: the import takes some milliseconds.
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    why = oiio.geterror()  # An error that nobody fetches is printed at exit.
    if file is None:
        # Without the path that some messages begin with, and advice for programmers at their end.
        reason = " ".join(why.split()).rpartition(f"({path}): ")[2].partition(". ")[0]
        raise NpfmError(f"{path}: cannot be read as OpenEXR ({reason}); write the picture again")
    return file


def _specs(file: "ImageInput") -> Iterator["ImageSpec"]:
    for part in count():
        if not file.seek_subimage(part, 0):
            file.geterror()
            return
        yield file.spec()


def _layers(spec: "ImageSpec", part: int) -> list[Layer]:
    """Layers of a part that have red, green and blue."""
    found: dict[str, dict[str, int]] = {}
    for index, name in enumerate(spec.channelnames):
        layer, _, channel = name.rpartition(".")
        if color := COLORS.get(channel.lower()):
            found.setdefault(layer, {}).setdefault(color, index)
    return [
        Layer(spec, part, name, {color: channels[color] for color in "RGBA" if color in channels})
        for name, channels in found.items()
        if set("RGB") <= set(channels)
    ]


def _only(path: Path, file: "ImageInput") -> Layer:
    """The layer that is meant: that without a name in the first part, or the only one."""
    specs = list(_specs(file))
    layers = [layer for part, spec in enumerate(specs) for layer in _layers(spec, part)]
    plain = [layer for layer in layers if layer.part == 0 and layer.name == ""]
    if plain or len(layers) == 1:
        return (plain or layers)[0]
    if not layers:
        raise NpfmError(_missing(path, [name for spec in specs for name in spec.channelnames]))
    names = [layer.name or f"part {layer.part + 1}" for layer in layers]
    raise NpfmError(
        f"{path}: several layers have red, green and blue ({_listed(names)}); "
        "write the one that is meant as the channels R, G and B"
    )


def _missing(path: Path, names: Sequence[str]) -> str:
    return f"{path}: channels {_listed(names)}; red, green and blue are needed"


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:FEW]) + (f" and {len(names) - FEW} others" if names[FEW:] else "")


def _pixels(file: "ImageInput", path: Path, layer: Layer) -> NDArray[np.float32]:
    """Pixels of a layer over the display window."""
    _check(path, layer)
    chosen = list(layer.channels.values())
    first = min(chosen)
    stored = file.read_image(layer.part, 0, first, max(chosen) + 1, "float")
    if stored is None or file.geterror():
        raise NpfmError(f"{path}: cut off or damaged; copy or make the file again")
    stored = stored[..., [channel - first for channel in chosen]]
    if layer.data == layer.display:
        return stored
    pixels = np.zeros((layer.display.height, layer.display.width, len(chosen)), dtype=np.float32)
    pixels[layer.shown.slices(layer.display)] = stored[layer.shown.slices(layer.data)]
    return pixels


def _check(path: Path, layer: Layer) -> None:
    """Refuse what would be read wrongly, or would not fit into memory."""
    spec = layer.spec
    for window in (layer.data, layer.display):
        check_size(path, window.width, window.height)
    if spec.deep:
        raise NpfmError(f"{path}: deep pixels, with many samples each; flatten the picture")
    # OpenImageIO maps the whole range of integers to 0 .. 1.
    for channel in layer.channels.values():
        if str(spec.channelformat(channel)) == "uint":
            name = spec.channelnames[channel]
            raise NpfmError(
                f"{path}: the channel {name} is of type uint32, which holds identifiers; "
                "write it as half or float"
            )
    if spec.get_int_attribute("Orientation", 1) != 1:
        raise NpfmError(f"{path}: the attribute Orientation turns the picture; write it upright")
