"""How far a picture is from its reference."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from npfm.errors import NpfmError


class NoPSNR(ValueError):
    """Pictures without a PSNR: a foreground value is not finite, or the reference is black."""


class NoForeground(NpfmError, ValueError):
    """Pictures none of whose pixels an object covers entirely, as those of a few pixels."""


def psnr(picture: ArrayLike, reference: ArrayLike, foreground: ArrayLike) -> float:
    """Peak signal-to-noise ratio over the foreground, in linear radiance.

    Bagher et al. 2016, section 5: the peak is the largest value of any colour component of any
    foreground pixel of the reference; the squared error is averaged over all foreground pixels
    and colour components.

    Parameters
    ----------
    picture, reference : array_like, shape (height, width, 3)
        Linear RGB radiance, before any tone mapping.
    foreground : array_like of bool, shape (height, width)
        The pixels directly covered by an object.

    Returns
    -------
    float
        Decibels; infinite when the pictures agree in every foreground pixel.

    Raises
    ------
    ValueError
        If the shapes differ.
    NoForeground
        If the foreground is empty.
    NoPSNR
        If a foreground value is not finite, or the foreground of the reference is black.
    """
    pixels, wanted = (np.asarray(p, dtype=np.float64) for p in (picture, reference))
    inside = np.asarray(foreground, dtype=bool)
    if pixels.shape != wanted.shape or inside.shape != wanted.shape[:2]:
        raise ValueError(
            f"shapes differ: picture {pixels.shape}, reference {wanted.shape}, "
            f"foreground {inside.shape}"
        )
    if not inside.any():
        raise NoForeground(
            f"none of the {inside.size} pixels is foreground; build the scene with more pixels"
        )
    pixels, wanted = pixels[inside], wanted[inside]
    for name, values in (("picture", pixels), ("reference", wanted)):
        if wrong := np.count_nonzero(~np.isfinite(values)):
            raise NoPSNR(f"{wrong} foreground values of the {name} are NaN or infinite")
    peak = wanted.max()
    if peak <= 0:
        raise NoPSNR(f"the largest foreground value of the reference is {peak:g}")
    error = np.mean((pixels - wanted) ** 2)
    return float(20 * np.log10(peak) - 10 * np.log10(error)) if error > 0 else float("inf")


def psnr_or_gap(
    picture: ArrayLike, reference: ArrayLike, foreground: ArrayLike
) -> tuple[float, str]:
    """`psnr`, and an empty string; or NaN, and why the values have none."""
    try:
        return psnr(picture, reference, foreground), ""
    except NoPSNR as why:
        return float("nan"), str(why)


def mean_db(values: ArrayLike) -> float:
    """Mean of finite decibels: neither gaps nor pictures equal to their reference count.

    Parameters
    ----------
    values : array_like
        dB; NaN for a gap.

    Returns
    -------
    float
        dB; infinite if no picture differs from its reference, NaN if there is none.
    """
    decibels = np.asarray(values, dtype=np.float64)
    decibels = decibels[~np.isnan(decibels)]
    finite = decibels[np.isfinite(decibels)]
    if len(finite):
        return float(finite.mean())
    return float("inf") if len(decibels) else float("nan")


def absolute_error(picture: ArrayLike, reference: ArrayLike) -> NDArray[np.float64]:
    """Sum of the absolute errors of the colour channels at every pixel, in linear radiance.

    Bagher et al. 2016, Figure 14.

    Parameters
    ----------
    picture, reference : array_like, shape (height, width, 3)
        Linear RGB radiance, before any tone mapping.

    Returns
    -------
    ndarray, shape (height, width)
        In the unit of the radiance.
    """
    pixels, wanted = (np.asarray(p, dtype=np.float64) for p in (picture, reference))
    return np.abs(pixels - wanted).sum(axis=2)


def delta_e(picture: ArrayLike, reference: ArrayLike) -> NDArray[np.float64]:
    """CIEDE2000 colour difference at every pixel of two pictures as they are shown.

    Parameters
    ----------
    picture, reference : array_like of uint8, shape (height, width, 3)
        Display values, taken for sRGB.

    Returns
    -------
    ndarray, shape (height, width)
        About 1 is just noticeable, 100 the difference of black and white.
    """
    # It takes a tenth of a second to import.
    from skimage.color import deltaE_ciede2000, rgb2lab

    return deltaE_ciede2000(*(rgb2lab(np.asarray(p)[..., :3]) for p in (reference, picture)))
