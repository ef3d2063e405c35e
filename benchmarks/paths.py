"""What a picture costs here and in Mitsuba 3, at the same error.

    python benchmarks/paths.py results/neural-10/lights/grace.exr \
        results/neural-10/materials/chrome.binary

A sphere in a light, the same table without interpolation, direct light, smooth edges. Either
renders with more and more samples, twice each, with other random numbers; the two tell the error of
one: its PSNR under the peak of the picture, over the pixels that the sphere covers entirely.
Mitsuba combines directions towards the light with those of the material (`--sampling`). Seconds
are of processor time, without what is compiled once. In between they are interpolated, on
logarithmic scales; ours are of building T, which materials share, and of T @ table.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from npfm.exports.mitsuba import engine
from npfm.reflectance.merl import read_binary
from npfm.reflectance.table import Table
from npfm.rendering.assembly import build
from npfm.rendering.lights import environment
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import CAMERA, Scene, place
from npfm.rendering.transport import Transport, render

SCENE = Scene(("sphere",), ("antialiasing",))
OURS = (64, 128, 256, 512, 1024, 2048, 4096, 8192)  # samples a pixel
THEIRS = (64, 256, 1024, 4096, 16384)  # paths a pixel
#: Paths a pixel that are followed at once; more do not fit into memory.
AT_ONCE = 64
MATERIALS = (1, 10, 100)
Picture = NDArray[np.float32]


def timed(make: Callable[[], Any]) -> tuple[Any, float]:
    """What is made, and the seconds of processor time that it took."""
    began = time.process_time()
    made = make()
    return made, time.process_time() - began


def noise_db(one: Picture, other: Picture, foreground: NDArray[np.bool_]) -> float:
    """PSNR of one of two pictures that differ in their random numbers alone."""
    square = np.mean((one[foreground] - other[foreground]) ** 2) / 2
    return float(10 * np.log10(((one + other)[foreground].max() / 2) ** 2 / square))


def ours(light: Environment, table: Table, resolution: int) -> Iterator[tuple[int, list, list]]:
    """Samples; two matrices with pictures; seconds of building and of rendering."""
    for samples in OURS:
        pairs, seconds = [], []
        for seed in (1, 2):
            matrix, building = timed(
                lambda n=samples, s=seed: build(SCENE, light, table.grid, resolution, n, s)
            )
            picture, rendering = timed(lambda m=matrix: render(m, table)[..., :3])
            pairs.append((matrix, picture))
            seconds.append((building, rendering))
        yield samples, pairs, seconds


def world(light: Environment, table: Table, resolution: int, sampling: str) -> Any:
    """The same for Mitsuba; our columns of pixels run as its own."""
    # They need to know the variant.
    from npfm.exports.mitsuba import plugin, shapes

    [sphere] = place(SCENE)
    bsdf = plugin.bsdf(table, plugin.sampler(table, sampling))
    camera = {
        "type": "perspective",
        "fov": float(np.degrees(CAMERA.field)),
        "to_world": mi.ScalarTransform4f().look_at(CAMERA.position.tolist(), [0, 0, 0], [0, 1, 0]),
        "film": {
            "type": "hdrfilm",
            **{"width": resolution, "height": resolution},
            "rfilter": {"type": "box"},
        },
    }
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct"},
            "sensor": camera,
            "light": shapes.light(light),
            "sphere": shapes.shape(sphere, bsdf),
        }
    )


def followed(scene: Any, paths: int, seed: int) -> Picture:
    """Picture of so many paths a pixel."""
    passes = range(paths // AT_ONCE)
    seeds = (seed * THEIRS[-1] + k for k in passes)
    made = (np.array(mi.render(scene, spp=AT_ONCE, seed=each))[..., :3] for each in seeds)
    return sum(made) / len(passes)


def theirs(scene: Any) -> Iterator[tuple[int, list[Picture], list[float]]]:
    """Paths a pixel, two pictures, and their seconds."""
    followed(scene, AT_ONCE, 0)  # compiles
    for paths in THEIRS:
        made = [timed(lambda n=paths, s=seed: followed(scene, n, s)) for seed in (1, 2)]
        yield paths, [picture for picture, _ in made], [seconds for _, seconds in made]


def at(level: float, decibels: list[float], seconds: list[float]) -> float:
    """Seconds to a PSNR, NaN outside of what was tried."""
    order = np.argsort(decibels)
    found = np.interp(
        level, np.array(decibels)[order], np.log(seconds)[order], left=np.nan, right=np.nan
    )
    return float(np.exp(found))


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("light")
    parser.add_argument("table")
    parser.add_argument("--resolution", type=int, default=128)
    parser.add_argument("--sampling", default="per-view")
    parser.add_argument("--levels", type=float, nargs="+", default=[55.0, 60.0, 64.0])
    parser.add_argument("--variant", help="of Mitsuba, such as llvm_ad_rgb or scalar_rgb")
    a = parser.parse_args()
    engine.start(a.variant)
    light, table = environment.read(a.light), read_binary(a.table)
    build(SCENE, light, table.grid, 16, 64, 1)  # compiles
    print(f"{Path(a.table).stem} in {Path(a.light).stem}, {mi.variant()}, {a.sampling}")
    known: dict[str, tuple[list[float], list[float]]] = {"ours": ([], []), "Mitsuba": ([], [])}
    rendering, matrix, converged = [], None, None
    for samples, pairs, seconds in ours(light, table, a.resolution):
        matrix, converged = pairs[0]
        level = noise_db(*(picture for _, picture in pairs), matrix.foreground)
        building = float(np.mean([each for each, _ in seconds]))
        rendering += [each for _, each in seconds]
        known["ours"][0].append(level)
        known["ours"][1].append(building)
        print(f"ours    {samples:6} samples {level:6.1f} dB {building:8.2f} s of building T")
    assert isinstance(matrix, Transport) and converged is not None
    for paths, pictures, seconds in theirs(world(light, table, a.resolution, a.sampling)):
        level = noise_db(*pictures, matrix.foreground)
        known["Mitsuba"][0].append(level)
        known["Mitsuba"][1].append(float(np.mean(seconds)))
        print(f"Mitsuba {paths:6} paths   {level:6.1f} dB {np.mean(seconds):8.2f} s")
    one = float(np.median(rendering))
    apart = noise_db(np.mean(pictures, axis=0), converged, matrix.foreground) - 10 * np.log10(2)
    print(f"T @ table: {one:.3f} s; the two pictures are {apart:.1f} dB apart")
    print("PSNR (dB)  T (s)  Mitsuba (s)", *(f"ratio for {n}" for n in MATERIALS))
    for level in a.levels:
        built, path = (at(level, *known[name]) for name in known)
        ratios = (n * path / (built + n * one) for n in MATERIALS)
        print(f"{level:9.1f} {built:6.2f} {path:12.2f}", *(f"{ratio:11.1f}" for ratio in ratios))


if __name__ == "__main__":
    main()
