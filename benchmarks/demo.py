"""How near the demo of the gallery comes to npfm render, in the same light.

    python benchmarks/demo.py results/neural-10 grace chrome nylon white-fabric2

Needs Chromium. A row of CSV each material and variant: PSNR in dB of one picture of the sphere,
what it leads to with ever more samples, and by how much the channels are brighter in the mean. The
row `cells` is of the table of the first variant, which the demo reads as it reads a measured one:
as offline, every value is that of the centre of its cell.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
import demos

from npfm.exports.gallery import demo
from npfm.exports.gallery.lights import coarse
from npfm.exports.gallery.material import Scene as Shown
from npfm.fitting import registry
from npfm.reflectance.half_difference import MERL
from npfm.rendering.assembly import build
from npfm.rendering.lights import environment
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import Scene
from npfm.rendering.transport import render

CELLS = "cells"
SECONDS = 3600  # for all pictures of the demo


def main() -> None:
    """Render and compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="folder of the run")
    parser.add_argument("light", help="a light of the run")
    parser.add_argument("materials", nargs="+")
    parser.add_argument("--variants", nargs="+", default=["independent-g"])
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--samples", type=int, default=4096, help="of the demo")
    parser.add_argument("--reference-samples", type=int, default=16384, help="offline")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        compared(given, Path(folder)).to_csv(sys.stdout, index=False, float_format="%.6g")


def compared(given: argparse.Namespace, folder: Path) -> pd.DataFrame:
    """Rows of the table."""
    light = Environment(coarse(environment.read(given.run / f"lights/{given.light}.exr")))
    environment.write(folder / "light.exr", light)
    light = environment.read(folder / "light.exr")
    pairs = [(m, v) for m in given.materials for v in given.variants]
    made = pd.DataFrame(pairs, columns=["material", "variant"])
    shown = [(Shown("A", 1.0, 2.2), str(folder / "light.exr"))]
    page = folder / "demo.html"
    demo.write(page, "benchmark", given.run, shown, made, given.materials)
    pairs += [(material, CELLS) for material in given.materials]
    jobs = [({"material": m, "left": demo_name(v)}, seed) for m, v in pairs for seed in (1, 2)]
    tables = {}
    for material, variant in pairs:
        by = given.variants[0] if variant == CELLS else variant
        tables[material, variant] = registry.tabulated(given.run / f"fits/{by}/{material}.npz")
        if variant == CELLS:
            demo.write_table(folder / f"tables/{material}.js", tables[material, variant])
    pictures = demos.pictures(page, jobs, given.resolution, given.samples // 2, SECONDS)
    T = build(Scene(("sphere",)), light, MERL, given.resolution, given.reference_samples, 1)
    seen, rows = T.foreground, []
    for (material, variant), *two in zip(pairs, pictures[::2], pictures[1::2], strict=True):
        reference = render(T, tables[material, variant])[..., :3]
        error = np.mean((two[0] - reference)[seen] ** 2)
        brighter = two[0][seen].mean(axis=0) / reference[seen].mean(axis=0) - 1
        psnr = 10 * np.log10(reference[seen].max() ** 2 / error)
        rows.append((material, variant, psnr, demos.limit(two, reference, seen), *brighter))
    names = ["material", "variant", "psnr_db", "limit_db", *(f"brighter_{c}" for c in "rgb")]
    return pd.DataFrame(rows, columns=names)


def demo_name(variant: str) -> str:
    """What the page calls it."""
    return "measured" if variant == CELLS else variant


if __name__ == "__main__":
    main()
