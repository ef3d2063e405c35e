r"""What the power of the heuristic that combines ways of sampling is worth.

    python benchmarks/heuristic.py results/neural-10/lights/grace.exr --objects sphere \
        --materials results/neural-10/materials/*.binary

For each set of strategies and number of samples, prints the error of pictures with power 1 and with
power 2, each material by itself (root mean square over the foreground, as a share of the picture's
own), and the geometric mean of their ratios.
"""

import argparse
from pathlib import Path

import numpy as np

from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import read_binary
from npfm.rendering.assembly import build
from npfm.rendering.lights import environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import Scene
from npfm.rendering.transport import render

SETS = (("light", "half-vector"), ("light", "half-vector", "cosine"), ("light", "cosine"))
SAMPLES, REFERENCE_SAMPLES = (192, 768, 3072), 32768
POWERS = (1, 2)
SEEDS, REFERENCE_SEED = (11, 12), 2
RESOLUTION = 32


def main() -> None:
    """Print the errors."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("light", help="lat-long EXR, made by npfm light")
    parser.add_argument("--objects", nargs="+", required=True)
    parser.add_argument("--effects", nargs="*", default=[])
    parser.add_argument("--materials", nargs="+", required=True, help="MERL .binary files")
    arguments = parser.parse_args()
    scene = Scene(tuple(arguments.objects), tuple(arguments.effects))
    light = environment.read(arguments.light)
    tables = {Path(path).stem: read_binary(path) for path in arguments.materials}

    def pictures(samples: int, seed: int, names: tuple[str, ...], power: float) -> np.ndarray:
        """Foreground pixels of every material, shape (materials, pixels, 3)."""
        strategies = registry.make(names, Given(light, MERL))
        matrix = build(scene, light, MERL, RESOLUTION, samples, seed, strategies, power)
        shown = [render(matrix, table)[..., :3] for table in tables.values()]
        return np.stack(shown)[:, matrix.foreground].astype(float)

    reference = pictures(REFERENCE_SAMPLES, REFERENCE_SEED, SETS[0], 1)
    for names in SETS:
        for samples in SAMPLES:
            error = np.empty((len(POWERS), len(tables)))
            for k, power in enumerate(POWERS):
                made = [pictures(samples, seed, names, power) for seed in SEEDS]
                square = np.mean([(m - reference) ** 2 for m in made], axis=(0, 2, 3))
                error[k] = np.sqrt(square / (reference**2).mean(axis=(1, 2)))
            by_material = ", ".join(
                f"{name} {100 * one:.3f} % {100 * two:.3f} %"
                for name, one, two in zip(tables, *error, strict=True)
            )
            ratio = np.exp(np.log(error[1] / error[0]).mean())
            print(f"{' '.join(names)}, {samples}: ratio {ratio:.3f} ({by_material})", flush=True)


if __name__ == "__main__":
    main()
