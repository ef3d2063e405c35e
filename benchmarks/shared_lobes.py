r"""What brings the gain of shared lobes, and what their D is worth as a density.

    python benchmarks/shared_lobes.py lobes data/merl_nbrdf.zip data/probes/grace_probe.hdr \
        --materials chrome nylon -o lobes.csv
    python benchmarks/shared_lobes.py sampling data/merl_nbrdf.zip data/probes/grace_probe.hdr \
        --materials black-obsidian -o sampling.csv -f sampling.svg

    python benchmarks/shared_lobes.py factors data/merl_nbrdf.zip \\
        --materials aluminium violet-acrylic polyurethane-foam -f factors.svg

`lobes` fits one to five lobes, which the channels share or have each for itself, and renders a
sphere in the light: a row is a material, with the bytes, the objective (mean of the channels'
shares of the zero model's), seconds of processor time and PSNR in dB.

`sampling` renders the sphere with few light directions a pixel, chosen by the cosine, by D, and
half and half, several times with other random numbers: a row holds the root mean square error over
pixels and repetitions as a share of the largest value of the reference, and as a PSNR in dB.

`factors` draws D, F and G of materials, as Figure 5 of Peng et al. 2017 does.
"""

import argparse
import os
import sys
import time
from collections.abc import Iterator

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")

import numpy as np
import pandas as pd

from npfm.datasets import neural
from npfm.evaluation.metrics import psnr
from npfm.fitting.channels import as_table
from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples, evaluate, fold
from npfm.fitting.shared_lobes.fit import fit_lobes
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import shared_lobes
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table
from npfm.rendering import assembly
from npfm.rendering.lights.environment import Environment
from npfm.rendering.lights.formats import load_probe
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import STRATEGIES, Scene
from npfm.rendering.transport import Transport, render

LOBES = (1, 2, 3, 5)
SAMPLES = (16, 64, 128, 256, 1024, 4096)
WAYS = {
    "cosine": ("cosine",),
    "D": ("normal-distribution",),
    "D and cosine": ("normal-distribution", "cosine"),
}
SPHERE, LIGHT_HEIGHT = Scene(("sphere",)), 512
REFERENCE_SAMPLES, RESOLUTION = 1 << 15, 32


def scene(light: Environment, samples: int, seed: int, ways: tuple[str, ...], given: Given):
    """Transport of the sphere with light directions chosen in some ways."""
    strategies = registry.make(ways, given)
    return assembly.build(SPHERE, light, MERL, RESOLUTION, samples, seed, strategies)


def fitted(table: Table, lobes: int, shared: bool) -> tuple[Table, int]:
    """Table of a fit and its bytes; lobes that are not shared are fitted channel by channel."""
    solve = chosen(SolverSettings())
    if shared:
        fit = shared_lobes.fit(table, Objective(), solve, 1, lobes=lobes)
        return shared_lobes.tabulate(fit), fit.parameter_bytes
    channels, count = [], 0
    for channel in range(3):
        samples = fold(channel_samples(table, channel, Objective()))
        state, _ = fit_lobes([samples], solve, 1, lobes, 3, False)
        own = {
            "D": state.D[None],
            "F": np.repeat(state.F, 3, axis=0),
            "G": state.G[None],
            "rho_s": np.repeat(state.rho_s * samples.scale, 3, axis=0),
            "rho_d": np.repeat(state.rho_d * samples.scale, 3),
        }
        own = {name: array.astype(np.float32) for name, array in own.items()}
        made = shared_lobes.tabulate(Fit(shared_lobes.NAME, own, table.grid))
        channels.append(made.values[channel])
        count += state.D.size + state.F.size + state.G.size + lobes + 1
    return as_table(channels, table.grid), 4 * count


def lobe_rows(name: str, table: Table, transport: Transport) -> Iterator[dict]:
    """A row for each number of lobes, shared and not."""
    reference = render(transport, table)[..., :3]
    samples = [channel_samples(table, channel, Objective()) for channel in range(3)]
    for lobes in LOBES:
        for shared in (True, False):
            began = time.process_time()
            made, size = fitted(table, lobes, shared)
            seconds = time.process_time() - began
            shares = [
                evaluate(s, values / s.scale) / s.energy
                for s, values in zip(samples, made.values, strict=True)
            ]
            picture = render(transport, made)[..., :3]
            yield {
                "material": name,
                "lobes": lobes,
                "shared": shared,
                "bytes": size,
                "objective": np.mean(shares),
                "seconds": seconds,
                "psnr_db": psnr(picture, reference, transport.foreground),
            }


def sampling_rows(name: str, table: Table, light: Environment, repeats: int) -> Iterator[dict]:
    """A row for each way of choosing directions and number of them."""
    fit = shared_lobes.fit(table, Objective(), chosen(SolverSettings()), 1)
    # What is rendered is the fit, as in the paper: noise is all that differs.
    table = shared_lobes.tabulate(fit)
    given = Given(light, MERL, table, fit.parameters)
    best = scene(light, REFERENCE_SAMPLES, 0, STRATEGIES, given)
    reference, inside = render(best, table)[..., :3], best.foreground
    peak = reference[inside].max()
    for way, names in WAYS.items():
        for samples in SAMPLES:
            squares = []
            for seed in range(1, repeats + 1):
                picture = render(scene(light, samples, seed, names, given), table)[..., :3]
                squares.append(np.mean((picture[inside] - reference[inside]) ** 2))
            rms = float(np.sqrt(np.mean(squares))) / peak
            yield {
                "material": name,
                "way": way,
                "samples": samples,
                "rms": rms,
                "psnr_db": -20 * np.log10(rms),
                "repetitions": repeats,
            }


def draw(rows: pd.DataFrame, path: str) -> None:
    """Error against samples, a panel for each material."""
    from matplotlib.figure import Figure

    materials = rows["material"].unique()
    figure = Figure(figsize=(2.6 * len(materials), 2.8), layout="constrained")
    for axes, name in zip(
        figure.subplots(1, len(materials), sharey=True, squeeze=False)[0], materials, strict=True
    ):
        own = rows[rows["material"] == name]
        for way, mark in zip(WAYS, "os^", strict=True):
            points = own[own["way"] == way]
            axes.loglog(points["samples"], points["rms"], marker=mark, ms=3, lw=1, label=way)
        axes.set_title(name, fontsize=8)
        axes.set_xlabel("light directions a pixel", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.grid(lw=0.3)
    figure.axes[0].set_ylabel("RMS error / largest value", fontsize=8)
    figure.axes[0].legend(fontsize=7)
    figure.savefig(path, metadata={"Date": None} if path.endswith(".svg") else None)


def draw_factors(archive: str, materials: list[str], path: str) -> None:
    """D, F and G, a row for each material."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 2.1 * len(materials)), layout="constrained")
    rows = figure.subplots(len(materials), 3, squeeze=False)
    for axes, name in zip(rows, materials, strict=True):
        table = neural.load(archive, name)
        p = shared_lobes.fit(table, Objective(), chosen(SolverSettings()), 1).parameters
        for k, (D, G) in enumerate(zip(p["D"][0], p["G"][0], strict=True), start=1):
            axes[0].semilogy(np.rad2deg(MERL.theta_h), D, lw=1, label=f"lobe {k}")
            axes[2].semilogy(np.rad2deg(G_THETA), G, lw=1)
        for F, color in zip(p["F"], ("#CC3311", "#228833", "#4477AA"), strict=True):
            axes[1].semilogy(np.rad2deg(MERL.theta_d), F, lw=1, color=color)
        axes[0].set_ylabel(name, fontsize=8)
        for column, angle in zip(axes, ("D, theta_h", "F, theta_d", "G, theta"), strict=True):
            column.set_title(angle, fontsize=8)
            column.tick_params(labelsize=7)
            column.grid(lw=0.3)
    rows[0][0].legend(fontsize=7)
    figure.savefig(path, metadata={"Date": None} if path.endswith(".svg") else None)


def main() -> None:
    """Make one of the two tables, or draw factors."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=["lobes", "sampling", "factors"])
    parser.add_argument("archive", help="merl_nbrdf.zip")
    parser.add_argument("light", nargs="?", help="an angular map, such as grace_probe.hdr")
    parser.add_argument("--materials", nargs="+", required=True)
    parser.add_argument("--repeats", type=int, default=10, help="of sampling (default: 10)")
    parser.add_argument("-o", "--output", help="CSV to write, row by row")
    parser.add_argument("-f", "--figure", help="picture of sampling or factors to write")
    a = parser.parse_args()
    if a.what == "factors":
        draw_factors(a.archive, a.materials, a.figure)
        return
    light = load_probe(a.light, "angular-map", LIGHT_HEIGHT)
    rows = []
    for name in a.materials:
        table = neural.load(a.archive, name)
        if a.what == "lobes":
            transport = scene(light, 4096, 1, STRATEGIES, Given(light, MERL))
            found = lobe_rows(name, table, transport)
        else:
            found = sampling_rows(name, table, light, a.repeats)
        for row in found:
            rows.append(row)
            print(*row.values(), file=sys.stderr, flush=True)
            pd.DataFrame(rows).to_csv(a.output, index=False)
    if a.figure:
        draw(pd.DataFrame(rows), a.figure)


if __name__ == "__main__":
    main()
