"""How different two pictures look: measures made for the eye, averaged over the foreground.

Pictures as they are shown are uint8, taken for sRGB; those of radiance are linear. FLIP and SSIM
look at a pixel with its neighbours: at the rim of an object also at the background, which is the
same in both pictures.
"""

from collections.abc import Mapping

import flip_evaluator
import numpy as np
from numpy.typing import NDArray

from npfm.evaluation.metrics import NoPSNR

#: Standard deviation of the window of SSIM in pixels, and half its width (Wang et al. 2004).
SSIM_SIGMA, SSIM_REACH = 1.5, 5
#: What FLIP assumes of the viewer: a display of 0.7 m and 3840 pixels, seen from 0.7 m (Andersson
#: et al. 2020).
PIXELS_PER_DEGREE = 67.0
#: The tone mapper of HDR-FLIP is (a x^2 + b x) / (d x^2 + e x + f), Narkowicz' fit of ACES at
#: 0.6 times the value; the exposures begin where it takes the largest luminance to `BRIGHT`, and
#: end where it takes the median there (Andersson et al. 2021).
ACES = 0.6**2 * 2.51, 0.6 * 0.03, 0.6**2 * 2.43, 0.6 * 0.59, 0.14
BRIGHT = 0.85
#: Luminance of linear sRGB (Rec. 709).
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def shown(picture: NDArray, reference: NDArray, foreground: NDArray) -> dict[str, float]:
    """Compare two pictures as they are shown.

    Parameters
    ----------
    picture, reference : ndarray of uint8, shape (height, width, 3)
    foreground : ndarray of bool, shape (height, width)
        Which pixels count.

    Returns
    -------
    dict of str to float
        ``psnr-tone-mapped`` (dB; infinite if they are equal), ``ssim`` (NaN if they are smaller
        than its window), ``ldr-flip``, and the means of CIEDE2000 and HyAB in CIELAB.
    """
    return {
        "psnr-tone-mapped": _psnr_shown(picture, reference, foreground),
        "ssim": ssim(picture, reference, foreground),
        "ldr-flip": ldr_flip(picture, reference, foreground),
        **color_differences(picture[foreground], reference[foreground]),
    }


def _psnr_shown(picture: NDArray, reference: NDArray, foreground: NDArray) -> float:
    """PSNR of display values; its peak is 255, whatever the reference reaches."""
    difference = picture[foreground].astype(float) - reference[foreground]
    error = np.mean(difference**2)
    return float(20 * np.log10(255) - 10 * np.log10(error)) if error > 0 else float("inf")


def ssim(picture: NDArray, reference: NDArray, foreground: NDArray) -> float:
    """Structural similarity of display values, mean over the foreground and the channels.

    Wang et al. 2004: Gaussian window, population covariances.
    """
    # It takes a third of a second to import.
    from skimage.metrics import structural_similarity

    if min(foreground.shape) < 2 * SSIM_REACH + 1:
        return float("nan")
    _, similarity = structural_similarity(
        reference,
        picture,
        channel_axis=2,
        data_range=255,
        gaussian_weights=True,
        sigma=SSIM_SIGMA,
        use_sample_covariance=False,
        full=True,
    )
    return float(similarity[foreground].mean())


def color_differences(colors: NDArray, wanted: NDArray) -> dict[str, float]:
    """Means of two colour differences.

    CIEDE2000; and HyAB, |L - L'| + |(a, b) - (a', b')|, made for differences that are large (Abasi
    et al. 2020).

    Parameters
    ----------
    colors, wanted : ndarray of uint8, shape (n, 3)
        Display values, taken for sRGB.
    """
    from skimage.color import deltaE_ciede2000, rgb2lab

    one, other = rgb2lab(wanted), rgb2lab(colors)
    lightness, *chroma = np.moveaxis(other - one, -1, 0)
    hyab = np.abs(lightness) + np.hypot(*chroma)
    return {
        "delta-e-2000": float(deltaE_ciede2000(one, other).mean()),
        "hyab": float(hyab.mean()),
    }


def ldr_flip(picture: NDArray, reference: NDArray, foreground: NDArray) -> float:
    """FLIP of display values (Andersson et al. 2020), mean over the foreground: 0 to 1."""
    one, other = (image.astype(np.float32) / 255 for image in (reference, picture))
    return _flip(one, other, "LDR", {}, foreground)


def hdr_flip(picture: NDArray, reference: NDArray, foreground: NDArray) -> float:
    """FLIP of radiance over a range of exposures (Andersson et al. 2021): 0 to 1.

    Parameters
    ----------
    picture, reference : ndarray, shape (height, width, 3)
        Linear radiance.
    foreground : ndarray of bool, shape (height, width)
        Which pixels count, and which the exposures are taken from: they are the same for every
        picture of one reference, whatever stands behind the object.

    Raises
    ------
    NoPSNR
        If a value is not finite, of which FLIP would make a number, or the foreground of the
        reference is black.
    """
    for name, values in (("picture", picture), ("reference", reference)):
        if wrong := np.count_nonzero(~np.isfinite(values)):
            raise NoPSNR(f"{wrong} values of the {name} are NaN or infinite")
    one, other = (np.maximum(image, 0).astype(np.float32) for image in (reference, picture))
    return _flip(one, other, "HDR", _exposures(reference[foreground]), foreground)


def _exposures(radiance: NDArray) -> dict[str, float | int]:
    """Start, stop and number of the exposures, as FLIP chooses them, from the foreground alone."""
    luminance = np.maximum(radiance, 0) @ LUMINANCE
    if not luminance.any():
        raise NoPSNR("the foreground of the reference is black")
    a, b, d, e, f = ACES
    square, linear, constant = a - BRIGHT * d, b - BRIGHT * e, -BRIGHT * f
    level = max(np.roots([square, linear, constant]).real)
    start = np.log2(level / luminance.max())
    stop = np.log2(level / np.median(luminance[luminance > 0]))
    return {
        "startExposure": float(start),
        "stopExposure": float(max(start, stop)),
        "numExposures": max(2, int(np.ceil(stop - start))),
    }


def _flip(
    reference: NDArray,
    picture: NDArray,
    kind: str,
    exposures: Mapping[str, float | int],
    foreground: NDArray,
) -> float:
    errors, _, _ = flip_evaluator.evaluate(
        reference,
        picture,
        kind,
        applyMagma=False,
        computeMeanError=False,
        parameters={"ppd": PIXELS_PER_DEGREE, **exposures},
    )
    return float(np.asarray(errors)[..., 0][foreground].mean())
