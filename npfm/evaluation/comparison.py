"""Pictures on disk against their reference."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation.metrics import psnr_or_gap
from npfm.storage.pictures import read_exr, windows


def read_reference(path: str | Path) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Read the picture of a measurement, and which of its pixels are compared.

    Parameters
    ----------
    path : str or Path
        EXR of linear radiance.

    Returns
    -------
    radiance : ndarray, shape (height, width, 3)
    foreground : ndarray of bool, shape (height, width)
        Where the alpha, the coverage, is exactly 1; without an alpha channel, everywhere.
    """
    pixels = read_exr(path)
    has_alpha = pixels.shape[2] == 4
    foreground = pixels[..., 3] == 1 if has_alpha else np.ones(pixels.shape[:2], dtype=bool)
    return pixels[..., :3], foreground


def decibels(reference: str | Path, pictures: Iterable[str | Path]) -> list[float]:
    """PSNR of pictures against one reference, over the foreground of the reference.

    Parameters
    ----------
    reference : str or Path
        As `read_reference` takes it.
    pictures : iterable of str or Path
        EXRs of the same size.

    Returns
    -------
    list of float
        dB, one a picture; infinite for a picture equal to the reference.

    Raises
    ------
    NpfmError
        If a file cannot be read, or a picture cannot be compared with the reference.
    """
    pictures = list(pictures)
    found = decibels_and_gaps(reference, pictures)
    for path, (_, gap) in zip(pictures, found, strict=True):
        if gap:
            raise NpfmError(f"{path}: has no PSNR with {reference} as the reference: {gap}")
    return [value for value, _ in found]


def decibels_and_gaps(
    reference: str | Path, pictures: Iterable[str | Path]
) -> list[tuple[float, str]]:
    """As `decibels`; but a picture whose values have no PSNR is NaN, with the reason beside it."""
    measured, foreground = read_reference(reference)
    found = []
    for path in pictures:
        picture = read_exr(path)
        check_windows(reference, path)
        try:
            found.append(psnr_or_gap(picture[..., :3], measured, foreground))
        except ValueError as error:
            raise NpfmError(
                f"{path}: cannot be compared with {reference} ({error}); render both again"
            ) from error
    return found


def check_windows(reference: str | Path, path: str | Path) -> None:
    """Refuse a picture of another place, or with pixels where the reference has none."""
    for what, ours, theirs in zip(
        ("shows", "has the pixels"), windows(path), windows(reference), strict=True
    ):
        if ours != theirs:
            raise NpfmError(
                f"{path}: cannot be compared with {reference}: it {what} {ours}, "
                f"the other {theirs}; give pictures of one window"
            )
