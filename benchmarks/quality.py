"""What each metric of pictures and tables costs, imports apart.

    python benchmarks/quality.py results/neural-10 A chrome independent-g

Prints processor seconds of one comparison, the least of five, and those that the libraries take
to be imported.
"""

import argparse
import os
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"
REPEATS = 5


def seconds(function: Callable[[], object], repeats: int = REPEATS) -> float:
    """Least processor seconds of some calls."""
    found = []
    for _ in range(repeats):
        start = time.process_time()
        function()
        found.append(time.process_time() - start)
    return min(found)


def flip() -> None:
    """Import FLIP, as the first comparison of a job does."""
    import flip_evaluator  # noqa: F401


def scikit_image() -> None:
    """Import what is needed of scikit-image."""
    from skimage.color import deltaE_ciede2000, rgb2lab  # noqa: F401
    from skimage.metrics import structural_similarity  # noqa: F401


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path, help="folder of a run")
    parser.add_argument("names", nargs=3, metavar="name", help="scene, material and variant")
    arguments = parser.parse_args()
    costs = {
        "import of FLIP": seconds(flip, 1),
        "import of scikit-image": seconds(scikit_image, 1),
    }
    scene, material, variant = arguments.names
    from npfm.evaluation import perceived
    from npfm.evaluation.comparison import read_reference
    from npfm.evaluation.metrics import psnr
    from npfm.evaluation.table_distances import distances
    from npfm.fitting.sources import table
    from npfm.storage.pictures import read_exr, read_png

    folder = arguments.run / "renders" / scene / material
    radiance, foreground = read_reference(folder / "measured.exr")
    fitted = read_exr(folder / f"{variant}.exr")[..., :3]
    one, other = (read_png(folder / f"{name}.png") for name in (variant, "measured"))
    measured = table(arguments.run / "materials" / f"{material}.binary")
    values = table(arguments.run / "fits" / variant / f"{material}.npz")
    shown = one, other, foreground
    for name, function in {
        "psnr": partial(psnr, fitted, radiance, foreground),
        "ssim": partial(perceived.ssim, *shown),
        "ldr-flip": partial(perceived.ldr_flip, *shown),
        "hdr-flip": partial(perceived.hdr_flip, fitted, radiance, foreground),
        "colour differences": partial(
            perceived.color_differences, one[foreground], other[foreground]
        ),
        "both distances of tables": partial(distances, values, measured),
    }.items():
        function()
        costs[name] = seconds(function)
    for name, cost in costs.items():
        print(f"{name:26}{cost:8.4f} s")


if __name__ == "__main__":
    main()
