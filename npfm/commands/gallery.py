"""``npfm gallery``."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.exports.gallery.kinds import FIGURE, PAGE, TABLE, THUMBNAILS
from npfm.figures import own_colors

if TYPE_CHECKING:
    from npfm.exports.gallery.material import Scene

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.exports.gallery.kinds",
    "npfm.figures.own_colors",
)
#: And what it covers for each of the kinds, which are imported where they are made.
CODE_OF_KIND = {
    "material": (
        "npfm.datasets.published_factors",
        "npfm.evaluation.quality",
        "npfm.exports.gallery.material",
    ),
    "overview": (
        "npfm.evaluation.quality",
        "npfm.evaluation.tables",
        "npfm.exports.gallery.overview",
    ),
    "demo": (
        "npfm.evaluation.tables",
        "npfm.exports.gallery.demo",
        "npfm.exports.gallery.material",
    ),
    "table": ("npfm.exports.gallery.demo", "npfm.reflectance.merl"),
    "figure": ("npfm.exports.gallery.figure",),
}
EXAMPLE = """\
examples:
  python -m npfm gallery material chrome --run results/neural-10 --scenes A=1,2.2 B=1,2.8 \\
      --variants independent-g naive --quality chrome.csv -o gallery/materials/chrome.html
  python -m npfm gallery overview neural-10 --quality quality.csv --fits fits.csv \\
      --summary summary.csv --materials materials.csv -o gallery/index.html
  python -m npfm gallery demo neural-10 --run results/neural-10 --scenes A=1,2.2 \\
      --lights grace.exr --fits fits.csv --measured chrome -o gallery/demo.html
  python -m npfm gallery table chrome.binary -o gallery/tables/chrome.js
  python -m npfm gallery figure --mesh bunny.ply -o gallery/figure.js
A page is one file that a browser opens from disk, without a server and without a request to
anywhere. material also writes chrome.jpg, the small pictures that the overview shows; table and
figure write scripts that the demo loads when a measurement or a figure is to be seen.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="|".join(KINDS))
    one, all_, demo_, table, shape = (kinds.add_parser(kind) for kind in KINDS)
    one.add_argument("material", help="the material")
    one.add_argument("--variants", nargs="+", required=True, help="the fits that are shown")
    one.add_argument("--published", help="published factors (.npz), to be drawn dashed")
    one.add_argument("--video", action="store_true", help="link to its page of npfm video")
    for kind in (all_, demo_):
        kind.add_argument("name", help="what the run is called")
        kind.add_argument("--fits", required=True, help="CSV made by npfm tables fits")
    all_.add_argument("--summary", required=True, help="CSV made by npfm tables summary")
    all_.add_argument("--materials", help="CSV made by npfm tables materials, for the diffuseness")
    all_.add_argument("--videos", nargs="+", default=[], help="materials with a page of npfm video")
    demo_.add_argument(
        "--lights", nargs="+", required=True, help="lights of the scenes (.exr), in their order"
    )
    demo_.add_argument(
        "--measured",
        nargs="*",
        default=[],
        metavar="MATERIAL",
        help="materials that there is a table of in the folder tables beside the page",
    )
    demo_.add_argument(
        "--figure", action="store_true", help="there is figure.js beside the page to be seen"
    )
    table.add_argument("table", help="measured table (.binary)")
    shape.add_argument("--mesh", type=Path, help="of the figure; the project's own otherwise")
    for kind in (one, demo_):
        kind.add_argument("--run", required=True, help="folder of the run")
        kind.add_argument(
            "--scenes",
            nargs="+",
            required=True,
            metavar="NAME=EXPOSURE,GAMMA",
            help="the scenes that are shown, and the tone map of each at first",
        )
    for kind in (one, all_):
        kind.add_argument("--quality", required=True, help="CSV made by npfm quality")
        kind.add_argument("--demo", action="store_true", help="link to demo.html of the gallery")
        own_colors.add_colors(kind)
    for kind, written, beside in (
        (one, PAGE, THUMBNAILS),
        (all_, PAGE, None),
        (demo_, PAGE, None),
        (table, TABLE, None),
        (shape, FIGURE, None),
    ):
        kind.add_argument(
            "-o",
            "--output",
            type=output(written, beside=beside),
            required=True,
            help=f"{written.name} to write ({written.suffix})",
        )


def run(arguments: argparse.Namespace) -> str:
    """Write the page; return how large it is."""
    KINDS[arguments.kind](arguments)
    return f"{Path(arguments.output).stat().st_size / 1e6:.1f} MB"


def _material(a: argparse.Namespace) -> None:
    from npfm.datasets import published_factors
    from npfm.evaluation import quality
    from npfm.exports.gallery import material

    published = published_factors.read(a.published).get(a.material, {}) if a.published else {}
    material.write(
        a.output,
        a.run,
        a.material,
        [_scene(given) for given in a.scenes],
        a.variants,
        quality.read(a.quality),
        published,
        own_colors.colors(a),
        demo=a.demo,
        video=a.video,
    )


def _overview(a: argparse.Namespace) -> None:
    from npfm.evaluation import quality, tables
    from npfm.exports.gallery import overview

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
        own_colors.colors(a),
        demo=a.demo,
        videos=a.videos,
    )


def _demo(a: argparse.Namespace) -> None:
    from npfm.evaluation import tables
    from npfm.exports.gallery import demo

    if len(a.lights) != len(a.scenes):
        raise NpfmError(f"{len(a.scenes)} scenes and {len(a.lights)} lights; give one to each")
    made = tables.read(a.fits, ["material", "variant"], [])
    scenes = list(zip(map(_scene, a.scenes), a.lights, strict=True))
    demo.write(a.output, a.name, a.run, scenes, made, a.measured, figure=a.figure)


def _table(a: argparse.Namespace) -> None:
    from npfm.exports.gallery import demo
    from npfm.reflectance.merl import read_binary

    demo.write_table(a.output, read_binary(a.table))


def _figure(a: argparse.Namespace) -> None:
    from npfm.exports.gallery import figure

    figure.write(a.output, a.mesh)


def _scene(given: str) -> "Scene":
    """Return the scene that NAME=EXPOSURE,GAMMA stands for.

    Raises
    ------
    NpfmError
        If it is written otherwise, or a number is not positive.
    """
    from npfm.exports.gallery.material import Scene

    found = re.fullmatch(r"(.+)=([^=,]+),([^=,]+)", given)
    try:
        name, exposure, gamma = found.groups() if found else ("", "", "")
        scene = Scene(name, float(exposure), float(gamma))
    except ValueError as error:
        raise NpfmError(f"--scenes: '{given}' is not written NAME=EXPOSURE,GAMMA") from error
    if not (0 < scene.exposure < float("inf") and 0 < scene.gamma < float("inf")):
        raise NpfmError(f"--scenes: '{given}': exposure and gamma are numbers above 0")
    return scene


KINDS = {
    "material": _material,
    "overview": _overview,
    "demo": _demo,
    "table": _table,
    "figure": _figure,
}
