r"""What building a scene costs in compiled passes, and by strategies in array operations.

    python benchmarks/transport.py results/neural-10/lights/grace.exr
    python benchmarks/transport.py results/neural-10/lights/ennis.exr --objects figure sphere \
        --effects visibility antialiasing --samples 8192

CPU seconds of either, the least of some builds that take turns, their ratio, and how far the two
matrices are apart. Both find cells and sum up rows in the same compiled passes.
"""

import argparse
import time

import numpy as np

from npfm.reflectance import grids
from npfm.rendering.assembly import build
from npfm.rendering.lights import environment
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.light import LightSampling
from npfm.rendering.scenes import Scene
from npfm.rendering.transport import Transport


class Plain(LightSampling):
    """The same strategy, under a name that no compiled pass knows."""


def apart(one: Transport, other: Transport) -> float:
    """Largest difference of two weights, by the larger of them; infinite between other entries."""
    if not np.array_equal(one.indices, other.indices):
        return np.inf
    larger = np.maximum(one.weights, other.weights)
    return float((np.abs(one.weights - other.weights) / np.where(larger > 0, larger, 1)).max())


def main() -> None:
    """Build, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("light")
    parser.add_argument("--objects", nargs="+", default=["sphere"])
    parser.add_argument("--effects", nargs="+", default=[])
    parser.add_argument("--grid", nargs="+", default=["half-difference"])
    parser.add_argument("--resolution", type=int, default=128)
    parser.add_argument("--samples", type=int, default=2048)
    parser.add_argument("--repeats", type=int, default=2)
    arguments = parser.parse_args()
    light, grid = environment.read(arguments.light), grids.parse(arguments.grid)
    scene = Scene(tuple(arguments.objects), tuple(arguments.effects))
    ways = {"compiled": LightSampling, "arrays": Plain}
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    built = {}
    for _ in range(arguments.repeats):
        for name, kind in ways.items():
            strategies = kind(light), HalfVectorSampling(grid)
            began = time.process_time()
            built[name] = build(
                scene, light, grid, arguments.resolution, arguments.samples, 1, strategies
            )
            seconds[name].append(time.process_time() - began)
    least = {name: min(each) for name, each in seconds.items()}
    print(
        f"compiled {least['compiled']:.1f} s, arrays {least['arrays']:.1f} s, "
        f"ratio {least['arrays'] / least['compiled']:.1f}, apart {apart(*built.values()):.1e}"
    )


if __name__ == "__main__":
    main()
