import math

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.evaluation.metrics import NoPSNR, mean_db, psnr, psnr_or_gap


def test_psnr_by_hand():
    # Peak 4; squared errors 1 and 1 over two pixels of three components: mean 1/3.
    reference = np.array([[[1.0, 2.0, 4.0], [0.0, 1.0, 1.0], [9.0, 9.0, 9.0]]])
    picture = np.array([[[2.0, 2.0, 4.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]])
    foreground = np.array([[True, True, False]])
    assert psnr(picture, reference, foreground) == pytest.approx(10 * math.log10(16 * 3))
    assert psnr(picture, reference, foreground) == pytest.approx(16.8124, abs=1e-4)


def test_psnr_agrees_with_a_loop():
    rng = np.random.default_rng(0)
    reference, picture = rng.random((2, 6, 5, 3)) * 100
    foreground = rng.random((6, 5)) < 0.6
    peak = total = count = 0
    for i, j in zip(*np.nonzero(foreground), strict=True):
        for k in range(3):
            peak = max(peak, reference[i, j, k])
            total += (picture[i, j, k] - reference[i, j, k]) ** 2
            count += 1
    expected = 10 * math.log10(peak**2 / (total / count))
    assert psnr(picture, reference, foreground) == pytest.approx(expected, rel=1e-12)


def test_what_lies_outside_the_foreground_does_not_count():
    rng = np.random.default_rng(1)
    reference, picture = rng.random((2, 4, 4, 3))
    foreground = np.eye(4, dtype=bool)
    before = psnr(picture, reference, foreground)
    reference[~foreground], picture[~foreground] = 1e6, np.nan
    assert psnr(picture, reference, foreground) == before


def test_units_of_radiance_do_not_matter():
    rng = np.random.default_rng(2)
    reference, picture = rng.random((2, 4, 4, 3))
    foreground = np.ones((4, 4), dtype=bool)
    before = psnr(picture, reference, foreground)
    for scale in (1e-6, 0.02, 1e6):
        assert psnr(scale * picture, scale * reference, foreground) == pytest.approx(before)


def test_ten_times_the_error_costs_twenty_decibels():
    reference = np.ones((3, 3, 3))
    foreground = np.ones((3, 3), dtype=bool)
    assert psnr(reference + 1e-3, reference, foreground) == pytest.approx(60)
    assert psnr(reference + 1e-2, reference, foreground) == pytest.approx(40)


def test_float32_pictures_are_compared_in_float64():
    reference = np.full((2, 2, 3), 1.0, dtype=np.float32)
    picture = reference.copy()
    picture[0, 0, 0] = np.nextafter(np.float32(1), np.float32(2))
    found = psnr(picture, reference, np.ones((2, 2), dtype=bool))
    assert found == pytest.approx(-10 * math.log10(2.0**-46 / 12))


def test_identical_pictures():
    reference = np.random.default_rng(3).random((4, 4, 3))
    assert psnr(reference, reference.copy(), np.ones((4, 4), dtype=bool)) == math.inf


@pytest.mark.parametrize(
    ("picture", "foreground", "message"),
    [
        (np.ones((4, 5, 3)), np.ones((4, 4), dtype=bool), r"picture \(4, 5, 3\)"),
        (np.ones((4, 4, 3)), np.ones((5, 4), dtype=bool), r"foreground \(5, 4\)"),
        (np.ones((4, 4, 3)), np.zeros((4, 4), dtype=bool), "none of the 16 pixels"),
        (np.full((4, 4, 3), np.nan), np.eye(4, dtype=bool), "12 foreground values of the picture"),
    ],
)
def test_what_cannot_be_compared(picture, foreground, message):
    with pytest.raises(ValueError, match=message):
        psnr(picture, np.ones((4, 4, 3)), foreground)


def test_a_picture_without_foreground_is_told_to_the_user():
    with pytest.raises(NpfmError, match="is foreground; build the scene with more pixels"):
        psnr_or_gap(*np.ones((2, 4, 4, 3)), np.zeros((4, 4), dtype=bool))


def test_a_black_reference_has_no_peak():
    pictures = np.ones((2, 2, 3)), np.zeros((2, 2, 3)), np.ones((2, 2), dtype=bool)
    with pytest.raises(NoPSNR, match="largest foreground value of the reference is 0"):
        psnr(*pictures)
    value, gap = psnr_or_gap(*pictures)
    assert math.isnan(value) and "reference is 0" in gap


def test_pictures_of_different_places_are_no_gap():
    with pytest.raises(ValueError, match="shapes differ"):
        psnr_or_gap(np.ones((2, 3, 3)), np.ones((2, 2, 3)), np.ones((2, 2), dtype=bool))
    assert psnr_or_gap(*np.ones((2, 2, 2, 3)), np.ones((2, 2), dtype=bool)) == (math.inf, "")


@pytest.mark.parametrize(
    ("values", "mean"),
    [
        ([10.0, 30.0], 20.0),
        ([10.0, 30.0, math.nan], 20.0),
        ([10.0, 30.0, math.inf], 20.0),
        ([math.inf, math.nan], math.inf),
        ([math.nan], math.nan),
        ([], math.nan),
    ],
)
def test_means_are_over_finite_decibels(values, mean):
    assert mean_db(values) == pytest.approx(mean, nan_ok=True)
