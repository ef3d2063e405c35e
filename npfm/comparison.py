"""Pictures on disk against their reference."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from npfm.errors import NpfmError
from npfm.metrics import psnr
from npfm.pictures import read_exr


def decibels(reference: str | Path, pictures: Iterable[str | Path]) -> list[float]:
    """PSNR of pictures against one reference, over the foreground of the reference.

    Parameters
    ----------
    reference : str or Path
        EXR of linear radiance. Foreground is where its alpha, the coverage, is exactly 1; without
        an alpha channel, everywhere.
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
    measured = read_exr(reference)
    has_alpha = measured.shape[2] == 4
    foreground = measured[..., 3] == 1 if has_alpha else np.ones(measured.shape[:2], dtype=bool)
    values = []
    for path in pictures:
        picture = read_exr(path)
        try:
            values.append(psnr(picture[..., :3], measured[..., :3], foreground))
        except ValueError as error:
            raise NpfmError(
                f"{path}: cannot be compared with {reference} ({error}); render both again"
            ) from error
    return values
