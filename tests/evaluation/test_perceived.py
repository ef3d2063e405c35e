import flip_evaluator
import numpy as np
import pytest

from npfm.evaluation import perceived
from npfm.evaluation.metrics import NoPSNR

HEIGHT, WIDTH = 20, 24


@pytest.fixture
def radiance():
    """A reference of a few decades of radiance, a picture of it, and a disc of foreground."""
    rng = np.random.default_rng(3)
    reference = np.float32(100 * rng.random((HEIGHT, WIDTH, 3)) ** 4)
    picture = np.float32(reference * rng.uniform(0.7, 1.3, reference.shape))
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    return picture, reference, np.hypot(y - 10, x - 12) < 8


@pytest.fixture
def shown(radiance):
    """The same as display values."""
    picture, reference, foreground = radiance
    clipped = (np.uint8(255 * np.minimum(p / 50, 1) ** 0.45) for p in (picture, reference))
    return *clipped, foreground


def lab(rgb):
    """CIELAB of display values by the formulas of sRGB (IEC 61966-2-1) and CIE 15, D65."""
    v = np.asarray(rgb) / 255
    linear = np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)
    to_xyz = np.array(
        [
            [0.412453, 0.357580, 0.180423],
            [0.212671, 0.715160, 0.072169],
            [0.019334, 0.119193, 0.950227],
        ]
    )
    t = linear @ to_xyz.T / [0.95047, 1.0, 1.08883]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]),
                     200 * (f[..., 1] - f[..., 2])], axis=-1)  # fmt: skip


def test_equal_pictures_do_not_differ(shown, radiance):
    _, reference, foreground = shown
    assert perceived.shown(reference, reference, foreground) == {
        "psnr-tone-mapped": np.inf,
        "ssim": 1,
        "ldr-flip": 0,
        "delta-e-2000": 0,
        "hyab": 0,
    }
    assert perceived.hdr_flip(radiance[1], radiance[1], foreground) == 0


def test_black_and_white():
    black, white = np.zeros((16, 16, 3), np.uint8), np.full((16, 16, 3), 255, np.uint8)
    values = perceived.shown(black, white, np.ones((16, 16), bool))
    assert values["psnr-tone-mapped"] == 0
    assert values["ssim"] == pytest.approx(1e-4, rel=1e-3)  # C1 / (255^2 + C1)
    assert values["delta-e-2000"] == pytest.approx(100, abs=1e-3)
    assert values["hyab"] == pytest.approx(100, abs=1e-2)  # white is not quite neutral
    assert 0.9 < values["ldr-flip"] <= 1


def test_psnr_of_display_values_has_the_peak_of_the_display(shown):
    picture, reference, foreground = shown
    errors = [
        (int(picture[i, j, k]) - int(reference[i, j, k])) ** 2
        for i, j in zip(*np.nonzero(foreground), strict=True)
        for k in range(3)
    ]
    expected = 10 * np.log10(255**2 / np.mean(errors))
    assert perceived.shown(*shown)["psnr-tone-mapped"] == pytest.approx(expected, rel=1e-12)


def test_hyab_by_the_formulas(shown):
    picture, reference, foreground = shown
    d = (lab(picture) - lab(reference))[foreground]
    expected = np.mean(abs(d[:, 0]) + np.sqrt(d[:, 1] ** 2 + d[:, 2] ** 2))
    assert perceived.shown(*shown)["hyab"] == pytest.approx(expected, rel=1e-4)


def test_ssim_against_a_loop(shown):
    """Wang et al. 2004, equation 13, in a window of Gaussian weights, pixel by pixel."""
    picture, reference, foreground = shown
    foreground = foreground.copy()
    foreground[:5] = foreground[-5:] = foreground[:, :5] = foreground[:, -5:] = False
    g = np.exp(-(np.arange(-5, 6) ** 2) / (2 * 1.5**2))
    window = np.outer(g, g) / g.sum() ** 2
    found = []
    for i, j in zip(*np.nonzero(foreground), strict=True):
        for k in range(3):
            x, y = (p[i - 5 : i + 6, j - 5 : j + 6, k].astype(float) for p in (picture, reference))
            mx, my = (window * x).sum(), (window * y).sum()
            vx, vy = (window * x**2).sum() - mx**2, (window * y**2).sum() - my**2
            cov = (window * x * y).sum() - mx * my
            c1, c2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2
            found.append((2 * mx * my + c1) * (2 * cov + c2)
                         / ((mx**2 + my**2 + c1) * (vx + vy + c2)))  # fmt: skip
    assert perceived.ssim(picture, reference, foreground) == pytest.approx(np.mean(found), rel=1e-9)


def test_pictures_smaller_than_the_window_have_no_ssim():
    small = np.zeros((10, 12, 3), np.uint8)
    values = perceived.shown(small, small, np.ones((10, 12), bool))
    assert np.isnan(values["ssim"]) and values["ldr-flip"] == 0


def test_the_exposures_are_those_that_flip_would_choose(radiance):
    picture, reference, foreground = radiance
    _, _, used = flip_evaluator.evaluate(reference, picture, "HDR", applyMagma=False)
    found = perceived._exposures(reference[np.ones_like(foreground)])
    assert found["numExposures"] == used["numExposures"]
    for name in ("startExposure", "stopExposure"):
        # It takes the upper one of two middle values for the median.
        assert found[name] == pytest.approx(used[name], abs=0.02)


def test_hdr_flip_is_the_largest_ldr_flip_of_all_exposures(radiance):
    """Andersson et al. 2021: at each pixel, over pictures tone-mapped at each exposure."""
    picture, reference, foreground = radiance
    exposures = perceived._exposures(reference[foreground])
    start, stop, number = exposures.values()

    def mapped(image, exposure):
        x = 0.6 * image * np.float32(2**exposure)
        return np.clip((2.51 * x**2 + 0.03 * x) / (2.43 * x**2 + 0.59 * x + 0.14), 0, 1)

    errors = [
        flip_evaluator.evaluate(
            mapped(reference, e), mapped(picture, e), "LDR", inputsRGB=False, applyMagma=False,
            parameters={"ppd": 67.0},
        )[0][..., 0]
        for e in np.linspace(start, stop, number)
    ]  # fmt: skip
    expected = np.max(errors, axis=0)[foreground].mean()
    assert perceived.hdr_flip(*radiance) == pytest.approx(expected, rel=2e-3)


def test_units_of_radiance_do_not_matter_to_hdr_flip(radiance):
    picture, reference, foreground = radiance
    scaled = perceived.hdr_flip(1e3 * picture, 1e3 * reference, foreground)
    assert scaled == pytest.approx(perceived.hdr_flip(*radiance), rel=1e-3)


def test_what_stands_behind_the_object_does_not_set_the_exposures(radiance):
    picture, reference, foreground = (np.pad(p, [(40, 40)] * 2 + [(0, 0)] * (p.ndim - 2))
                                      for p in radiance)  # fmt: skip
    before = perceived.hdr_flip(picture, reference, foreground)
    picture[:5], reference[:5] = 1e5, 1e5
    assert perceived.hdr_flip(picture, reference, foreground) == pytest.approx(before, rel=1e-6)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_flip_is_refused_what_it_would_make_a_number_of(radiance, value):
    picture, reference, foreground = radiance
    picture[0, 0, 0] = value
    assert np.isfinite(flip_evaluator.evaluate(reference, picture, "HDR", applyMagma=False)[1])
    with pytest.raises(NoPSNR, match="1 values of the picture are NaN or infinite"):
        perceived.hdr_flip(picture, reference, foreground)
    with pytest.raises(NoPSNR, match="1 values of the reference"):
        perceived.hdr_flip(reference, picture, foreground)


def test_a_black_reference_has_no_exposure(radiance):
    picture, reference, foreground = radiance
    with pytest.raises(NoPSNR, match="black"):
        perceived.hdr_flip(picture, 0 * reference, foreground)
