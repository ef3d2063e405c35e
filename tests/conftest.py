"""Fixtures that every test module may use."""

import os
from pathlib import Path

import npfm.__main__  # noqa: F401  Before numpy: one thread, as every job has.

# isort: split
import numpy as np
import pytest

from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import Environment, write

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real inputs (docs/data.md); tests that need it skip where it is absent."""
    folder = Path(os.environ.get("NPFM_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"the real inputs are not at {folder}; set NPFM_DATA to their folder")
    return folder


@pytest.fixture(scope="session")
def light_file(tmp_path_factory) -> Path:
    """A sky with a sun in it, as a lat-long EXR; those of `npfm.rendering.lights` take seconds."""
    rng = np.random.default_rng(3)
    radiance = rng.uniform(0.2, 1.0, (16, 32, 3))
    radiance[4, 9] = (300.0, 250.0, 200.0)
    path = tmp_path_factory.mktemp("light") / "sky.exr"
    write(path, Environment(radiance))
    return path


@pytest.fixture(scope="session")
def grid() -> HalfDifference:
    """Every fifth bin of MERL's grid: its centres are centres of MERL's."""
    return HalfDifference(18, 18, 36)


@pytest.fixture(scope="session")
def table(grid) -> Table:
    """A glossy, a satin and a nearly diffuse channel, noisy, not reciprocal, with gaps.

    Each is a lobe in theta_h times a rise in theta_d over a diffuse part, dimmed at grazing
    angles, and not quite a product: so no model but the measurement itself fits it exactly.
    """
    rng = np.random.default_rng(11)
    theta_h, theta_d = grid.theta_h[:, None, None], grid.theta_d[:, None]
    cos_i, cos_o = (np.maximum(cosine, 0) for cosine in grid.cosines)
    channels = []
    for width, specular, diffuse in ((0.1, 40.0, 0.05), (0.3, 2.0, 0.2), (0.7, 0.2, 0.3)):
        lobe = np.exp(-((np.tan(theta_h) / width) ** 2)) + 0.01
        fresnel = 0.05 + 0.95 * (1 - np.cos(theta_d)) ** (5 - 2 * theta_h)
        dimmed = np.sqrt((0.1 + cos_i) * (0.1 + cos_o))
        value = diffuse + specular * lobe * fresnel * dimmed
        channels.append(value * (1 + 0.03 * rng.standard_normal(grid.shape)))
    missing = rng.random((3, *grid.shape)) < 0.02
    return Table(np.where(grid.above_horizon & ~missing, np.stack(channels), -1.0), grid)


@pytest.fixture(scope="session")
def gappy(table) -> Table:
    """The table without three of its theta_h bins and one of its theta_d bins."""
    values = table.values.copy()
    values[:, [5, 6, 17]] = -1
    values[:, :, 9] = -1
    return Table(values, table.grid)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whole runs come first: a long one that came last would leave the other workers idle."""
    items.sort(key=lambda item: "workflow" not in item.path.parts)
