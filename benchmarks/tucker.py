"""Which of its choices make tucker-20 as good as it is, and what noise leaves of that.

    python benchmarks/tucker.py results/neural-10 chrome nylon

Prints the PSNR, mean over the materials and the run's scenes, of fits with other numbers of
products, other scales inside the logarithm or none, fewer nodes, phi_o free, and of products on
MERL's own grid; and of fits of tables whose noise grows towards grazing angles, beside those of
other models. The run's scenes and tables have to be there.
"""

import argparse
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from npfm.evaluation.metrics import mean_db, psnr_or_gap
from npfm.fitting import registry
from npfm.fitting.channels import as_table
from npfm.fitting.objective import Objective, Samples, channel_samples
from npfm.fitting.solvers.choice import SolverSettings, chosen
from npfm.models import tucker
from npfm.reflectance.merl import read_binary
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.rendering.transport import Transport, columns, pictures

PRODUCTS = (5, 10, 20, 40)
#: In units of the weighted median; of the last, the logarithm is a straight line.
SCALES = (1e-3, 1e-2, 1e-1, 1.0, 10.0, 1e6)
#: Nodes that make as many numbers as tucker-20 has if phi_o is free: 90 + 23 + 24 + 24 = 161.
COARSE_THETA_O, AROUND = 23, 24
#: Noise of a cell, as a share: at the normal, and what is added at grazing angles.
LEAST_NOISE, GRAZING_NOISE, STEEPNESS = 0.02, 0.5, 8
AMOUNTS = (0.0, 0.3, 1.0, 3.0)
OTHERS = ("bivariate", "independent-g", "naive")


def summed(factors: list[NDArray]) -> NDArray:
    """Tensor that products add up to."""
    first, *others = factors
    tensor = first
    for factor in others:
        tensor = tensor[..., None, :] * factor
    return tensor.sum(axis=-1)


def as_fitted(samples: Samples, scale: float, terms: int, *, free: bool = False) -> NDArray:
    """Values of a channel by the model, in units of the samples' scale; or with phi_o free."""
    shape = samples.grid.theta_h_bins, tucker.THETA_O_NODES, tucker.PHI_H_NODES
    tensor = tucker.resampled(samples, np.log1p(samples.value / scale)).reshape(shape)
    if free:
        # Nodes 15 degrees apart all around: an azimuth between them is a node from 0 to 180.
        apart = np.abs(np.arange(AROUND)[:, None] - np.arange(AROUND))
        tensor = tensor[..., np.minimum(apart, AROUND - apart)]
    with patch.object(tucker, "TERMS", terms):
        tensor = summed(tucker.products(tensor, 0))
    if free:
        tensor = tensor[:, :, : tucker.PHI_H_NODES, 0]
    logarithm = tucker.nodes(samples.grid).values(tensor.reshape(len(tensor), -1))
    return scale * np.expm1(np.maximum(logarithm, 0.0))


def coarse(samples: Samples, *, free: bool) -> NDArray:
    """The model with nodes of phi_h 15 degrees apart, and 23 of theta_o."""
    with (
        patch.object(tucker, "PHI_H_NODES", AROUND // 2 + 1),
        patch.object(tucker, "THETA_O_NODES", COARSE_THETA_O),
    ):
        tucker.nodes.cache_clear()
        tucker._smoothness.cache_clear()
        values = as_fitted(samples, tucker.SCALE, tucker.TERMS, free=free)
    tucker.nodes.cache_clear()
    tucker._smoothness.cache_clear()
    return values


def on_own_grid(samples: Samples) -> NDArray:
    """Products of theta_h, theta_d and phi_d; cells without a sample are those of the nearest."""
    nearest = distance_transform_edt(
        samples.weight <= 0, return_distances=False, return_indices=True
    )
    logarithm = np.log1p(samples.value / tucker.SCALE)[tuple(nearest)]
    found = summed(tucker.products(logarithm, 0))
    return tucker.SCALE * np.expm1(np.maximum(found, 0.0))


VARIATIONS = {
    "as it is": partial(as_fitted, scale=tucker.SCALE, terms=tucker.TERMS),
    **{
        f"{n} products": partial(as_fitted, scale=tucker.SCALE, terms=n)
        for n in PRODUCTS
        if n != tucker.TERMS
    },
    **{
        f"scale {scale:g}": partial(as_fitted, scale=scale, terms=tucker.TERMS)
        for scale in SCALES
        if scale != tucker.SCALE
    },
    "23 x 13 nodes": partial(coarse, free=False),
    "23 x 24 nodes, phi_o free": partial(coarse, free=True),
    "MERL's own grid": on_own_grid,
}


def varied(measured: Table) -> Iterator[Table]:
    """Tables of all variations."""
    samples = [channel_samples(measured, k, Objective()) for k in range(3)]
    for fitted in VARIATIONS.values():
        yield as_table([fitted(s) * s.scale for s in samples], measured.grid)


def noisy(table: Table, amount: float) -> Table:
    """A table whose cells are wrong by a share that grows towards grazing angles."""
    grazing = np.arccos(np.clip(np.minimum(*table.grid.cosines), 0.0, 1.0)) / (np.pi / 2)
    share = amount * (LEAST_NOISE + GRAZING_NOISE * grazing**STEEPNESS)
    draws = np.random.default_rng(1).standard_normal(table.values.shape)
    return Table(table.values * np.exp(share * draws), table.grid)


def refitted(measured: Table) -> Iterator[Table]:
    """Tables of fits of `tucker-20` and of others."""
    solve = chosen(SolverSettings())
    for name in ("tucker-20", *OTHERS):
        model = registry.model(name)
        own = {"starts": 2} if name == "independent-g" else {}
        yield model.tabulate(model.fit(measured, Objective(), solve, 1, **own))


def decibels(scenes: list[Transport], measured: Table, fits: Iterator[Table]) -> list[list[float]]:
    """PSNR of each fit in each scene."""
    shown = columns([measured, *(fit.where_measured(measured) for fit in fits)])
    found = []
    for matrix in scenes:
        reference, *compared = pictures(matrix, shown)
        found.append([psnr_or_gap(p, reference, matrix.foreground)[0] for p in compared])
    return np.transpose(found).tolist()


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path, help="folder of a run")
    parser.add_argument("materials", nargs="+")
    parser.add_argument("--scenes", nargs="+", default=["A", "B", "C", "D"])
    arguments = parser.parse_args()
    scenes = [transport.load(arguments.run / "scenes" / name) for name in arguments.scenes]
    tables = [read_binary(arguments.run / f"materials/{m}.binary") for m in arguments.materials]
    found = np.array([decibels(scenes, table, varied(table)) for table in tables])
    print(f"{'':30}", *(f"{name:>7}" for name in arguments.scenes), "    all")
    for k, name in enumerate(VARIATIONS):
        means = [mean_db(found[:, k, s]) for s in range(len(scenes))]
        print(f"{name:30}", *(f"{x:7.2f}" for x in (*means, mean_db(found[:, k]))))
    print(f"{'amount of noise':30}", *(f"{name:>13}" for name in ("tucker-20", *OTHERS)))
    for amount in AMOUNTS:
        worse = [noisy(table, amount) for table in tables]
        found = np.array([decibels(scenes, table, refitted(table)) for table in worse])
        print(f"{amount:<30g}", *(f"{mean_db(found[:, k]):13.2f}" for k in range(found.shape[1])))


if __name__ == "__main__":
    main()
