"""``npfm gallery``."""

import argparse
import re
from pathlib import Path

from npfm.commands.outputs import output
from npfm.datasets import published_factors
from npfm.errors import NpfmError
from npfm.evaluation import quality, tables
from npfm.exports.gallery import material, overview
from npfm.exports.gallery.page import PAGE
from npfm.exports.gallery.pixels import THUMBNAILS
from npfm.figures import style

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.evaluation.quality",
    "npfm.evaluation.tables",
    "npfm.exports.gallery.material",
    "npfm.exports.gallery.overview",
    "npfm.datasets.published_factors",
)
EXAMPLE = """\
examples:
  python -m npfm gallery material chrome --run results/neural-10 --scenes A=1,2.2 B=1,2.8 \\
      --variants independent-g naive --quality chrome.csv -o gallery/materials/chrome.html
  python -m npfm gallery overview neural-10 --quality quality.csv --fits fits.csv \\
      --summary summary.csv --materials materials.csv -o gallery/index.html
A page is one file that a browser opens from disk, without a server and without a request to
anywhere. material also writes chrome.jpg, the small pictures that the overview shows.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="material|overview")
    one, all_ = kinds.add_parser("material"), kinds.add_parser("overview")
    one.add_argument("material", help="the material")
    one.add_argument("--run", required=True, help="folder of the run")
    one.add_argument(
        "--scenes",
        nargs="+",
        required=True,
        metavar="NAME=EXPOSURE,GAMMA",
        help="the scenes that are shown, and the tone map of each at first",
    )
    one.add_argument("--variants", nargs="+", required=True, help="the fits that are shown")
    one.add_argument("--published", help="published factors (.npz), to be drawn dashed")
    all_.add_argument("name", help="what the run is called")
    all_.add_argument("--fits", required=True, help="CSV made by npfm tables fits")
    all_.add_argument("--summary", required=True, help="CSV made by npfm tables summary")
    all_.add_argument("--materials", help="CSV made by npfm tables materials, for the diffuseness")
    for kind, beside in ((one, THUMBNAILS), (all_, None)):
        kind.add_argument("--quality", required=True, help="CSV made by npfm quality")
        style.add_colors(kind)
        kind.add_argument(
            "-o", "--output", type=output(PAGE, beside=beside), required=True, help="page to write"
        )


def run(arguments: argparse.Namespace) -> str:
    """Write the page; return how large it is."""
    (_material if arguments.kind == "material" else _overview)(arguments)
    return f"{Path(arguments.output).stat().st_size / 1e6:.1f} MB"


def _material(a: argparse.Namespace) -> None:
    published = published_factors.read(a.published).get(a.material, {}) if a.published else {}
    material.write(
        a.output,
        a.run,
        a.material,
        [_scene(given) for given in a.scenes],
        a.variants,
        quality.read(a.quality),
        published,
        style.colors(a),
    )


def _overview(a: argparse.Namespace) -> None:
    fits = tables.read(a.fits, ["material", "variant"], ["seconds", "objective"])
    sizes = tables.read(a.summary, ["variant"], ["bytes"])
    diffuse = tables.read(a.materials, ["material"], ["diffuseness"]) if a.materials else None
    overview.write(
        a.output,
        a.name,
        quality.read(a.quality),
        fits,
        dict(zip(sizes.variant, sizes.bytes.astype(int), strict=True)),
        {} if diffuse is None else dict(zip(diffuse.material, diffuse.diffuseness, strict=True)),
        style.colors(a),
    )


def _scene(given: str) -> material.Scene:
    """Return the scene that NAME=EXPOSURE,GAMMA stands for.

    Raises
    ------
    NpfmError
        If it is written otherwise, or a number is not positive.
    """
    found = re.fullmatch(r"(.+)=([^=,]+),([^=,]+)", given)
    try:
        name, exposure, gamma = found.groups() if found else ("", "", "")
        scene = material.Scene(name, float(exposure), float(gamma))
    except ValueError as error:
        raise NpfmError(f"--scenes: '{given}' is not written NAME=EXPOSURE,GAMMA") from error
    if not (0 < scene.exposure < float("inf") and 0 < scene.gamma < float("inf")):
        raise NpfmError(f"--scenes: '{given}': exposure and gamma are numbers above 0")
    return scene
