"""What it changes to evaluate fits of independent-g at directions and not at centres of cells.

    python benchmarks/cell_centres.py results/neural-10 grace chrome nylon white-fabric2

A sphere, rendered from the same light directions in four ways: as npfm renders, with every angle at
the centre of its cell; with the cosines of equation 3 of Bagher et al. 2016 at the directions
themselves; with the G of it at these; with both, as a shader does. A row of CSV each material and
way: PSNR in dB beside the first, and by how much the channels are brighter in the mean.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import pandas as pd

from npfm.exports.gallery.lights import coarse
from npfm.fitting import fits
from npfm.fitting.factors.microfacet import G_THETA
from npfm.reflectance.angles import half_difference
from npfm.reflectance.half_difference import MERL
from npfm.rendering.lights import environment
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.combination import combine
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.light import LightSampling
from npfm.rendering.sampling.low_discrepancy import low_discrepancy, rotate
from npfm.rendering.scenes import CAMERA, Scene, place
from npfm.rendering.surfaces import look

#: Whether G, and whether the cosines, are taken at the directions themselves.
WAYS = {"cells": (False, False), "cosines": (False, True), "G": (True, False), "both": (True, True)}
STEP = 64  # points of the surface at a time


def main() -> None:
    """Render in all ways and compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="folder of the run")
    parser.add_argument("light", help="a light of the run")
    parser.add_argument("materials", nargs="+")
    parser.add_argument("--resolution", type=int, default=32)
    parser.add_argument("--samples", type=int, default=8192, help="light directions a pixel")
    given = parser.parse_args()
    light = Environment(coarse(environment.read(given.run / f"lights/{given.light}.exr")))
    found = {
        name: {k: a.astype(float) for k, a in fits.load(path).parameters.items()}
        for name in given.materials
        for path in [given.run / f"fits/independent-g/{name}.npz"]
    }
    pictures = rendered(light, found, given.resolution, given.samples)
    rows = []
    for name, ways in pictures.items():
        reference = ways["cells"]
        for way, picture in list(ways.items())[1:]:
            error = np.mean((picture - reference) ** 2)
            brighter = picture.mean(axis=0) / reference.mean(axis=0) - 1
            rows.append((name, way, 10 * np.log10(reference.max() ** 2 / error), *brighter))
    names = ["material", "way", "psnr_db", *(f"brighter_{c}" for c in "rgb")]
    pd.DataFrame(rows, columns=names).to_csv(sys.stdout, index=False, float_format="%.4g")


def rendered(light, found, resolution, samples):
    """Radiance (p, 3) of the p points that are seen, by material and way."""
    sphere, centre = place(Scene(("sphere",))), np.array([[0.5, 0.5]])
    surface, _, _ = look(CAMERA, sphere, light, centre, resolution)
    strategies = LightSampling(light), HalfVectorSampling(MERL)
    points, rng = low_discrepancy(samples // 2), np.random.default_rng(1)
    made = {name: {way: np.zeros((len(surface), 3)) for way in WAYS} for name in found}
    for first in range(0, len(surface), STEP):
        at = surface[slice(first, first + STEP)]
        u = [rotate(points, rng.random((len(at), 1, 2))) for _ in strategies]
        to, density = combine(strategies, u, at)
        i, j = np.nonzero((at.cosines(to) > 0) & (density > 0))
        to = to[i, j]
        cos_i = np.einsum("ij,ij->i", to, at.normal[i])
        weight = light.lookup(to) * (cos_i / density[i, j])[:, None]
        cell = np.unravel_index(
            MERL.cell(*half_difference(to, at.view[i], at.normal[i])), MERL.shape
        )
        exact = cos_i, at.cos_o[i]
        central = tuple(cosine[cell] for cosine in MERL.cosines)
        above = np.minimum(*central) > 0
        for name, p in found.items():
            for way, (G_exact, cosines_exact) in WAYS.items():
                rho = brdf(
                    p, cell, exact if G_exact else central, exact if cosines_exact else central
                )
                if way != "both":
                    rho *= above
                for c in range(3):
                    part = np.bincount(i, weight[:, c] * rho[c], minlength=len(at))
                    made[name][way][first : first + STEP, c] = part
    return made


def brdf(p, cell, for_G, for_cosines):
    """Equation 3, shape (3, n), with G and cosines at cosines of theta_i and theta_o."""
    h, d, _ = cell
    ends = np.cos(G_THETA[-1]), np.cos(G_THETA[0])
    theta = [np.arccos(np.clip(cosine, *ends)) for cosine in for_G]
    under = np.prod([np.clip(cosine, *ends) for cosine in for_cosines], axis=0)
    G = [np.prod([np.interp(t, G_THETA, channel) for t in theta], axis=0) for channel in p["G"]]
    factors = p["D"][:, h] * p["F"][:, d] * np.stack(G) / under
    return p["rho_d"][:, None] + p["rho_s"][:, None] * factors


if __name__ == "__main__":
    main()
