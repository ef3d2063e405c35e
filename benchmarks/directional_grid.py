r"""What a scene of a directional grid costs, and how far its pictures are from exact lookups.

    python benchmarks/directional_grid.py --shapes 6x48x6x48 12x96x12x96 --resolution 96

For each shape of the grid: seconds, non-zeros and bytes of the matrix of a sphere, beside MERL's
grid. For each material and number of columns beyond the last elevation (`BEYOND`): PSNR of the
picture by the matrix against the sum of lookups that are extrapolated and cut at 0 one by one, as
the readers of the UTIA database do.
"""

import argparse
import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.datasets import synthetic_anisotropic
from npfm.evaluation.metrics import psnr
from npfm.reflectance import directional, grids
from npfm.reflectance.directional import UTIA
from npfm.reflectance.grids import Grid
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table
from npfm.rendering.assembly import build
from npfm.rendering.lights.generated import generate
from npfm.rendering.scenes import Scene
from npfm.rendering.transport import Transport, render

SPHERE = Scene(("sphere",))
BEYOND = (1, 2, directional.BEYOND, 6, 15)
SMALL = 32


class Looked:
    """A grid that holds a material: a column each channel, which has the values of lookups."""

    anisotropic = True
    column_count = 3

    def __init__(self, table: Table) -> None:
        self.values = np.maximum(table.values, 0).reshape(3, -1)
        self.cells = table.grid.cells
        self.axes = table.grid.axes
        self.theta_h_edges, self.theta_h_bin = table.grid.theta_h_edges, table.grid.theta_h_bin

    def columns(self, light: NDArray, view: NDArray, point: NDArray) -> tuple[NDArray, NDArray]:
        """All three columns, and the BRDF in each as its share."""
        index, share = self.cells(light, view, point)
        looked = [np.maximum((plane[index] * share).sum(axis=1), 0) for plane in self.values]
        return np.broadcast_to(np.arange(3, dtype=np.int32), (len(light), 3)), np.stack(looked, -1)


def exact(matrix: Transport) -> NDArray:
    """Picture of a matrix of `Looked`."""
    lit = [channel @ np.eye(3)[k] for k, channel in enumerate(matrix.matrices)]
    return np.stack(lit, axis=-1).reshape(*matrix.coverage.shape, 3)


def cost(words: Sequence[str], resolution: int, samples: int) -> None:
    """Print what a scene takes."""
    grid: Grid = grids.parse(words)
    light = generate("grove", 256)
    began = time.process_time()
    matrix = build(SPHERE, light, grid, resolution, samples, 1)
    seconds, size = time.process_time() - began, sum(a.nbytes for a in matrix.arrays.values())
    entries = matrix.indices.size / 1e6
    print(f"{grid.name}: {seconds:.1f} s, {entries:.1f} million entries, {size / 1e6:.0f} MB")


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--shapes", nargs="+", default=["6x48x6x48"])
    parser.add_argument("--resolution", type=int, default=96)
    parser.add_argument("--samples", type=int, default=1024)
    arguments = parser.parse_args()
    for words in ([MERL.kind], *([UTIA.kind, shape] for shape in arguments.shapes)):
        cost(words, arguments.resolution, arguments.samples)
    light = generate("grove", 256)
    for name in synthetic_anisotropic.MATERIALS:
        table = synthetic_anisotropic.load(name, 1)
        looked = exact(build(SPHERE, light, Looked(table), SMALL, arguments.samples, 1))  # type: ignore[arg-type]
        found = []
        for directional.BEYOND in BEYOND:
            matrix = build(SPHERE, light, UTIA, SMALL, arguments.samples, 1)
            picture = render(matrix, table)[..., :3] - matrix.backdrop
            found.append(
                f"{psnr(picture, looked, matrix.foreground):.1f} dB by {directional.BEYOND}"
            )
        print(f"{name}: {', '.join(found)}", flush=True)


if __name__ == "__main__":
    main()
