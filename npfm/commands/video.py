"""``npfm video``."""

import argparse
from pathlib import Path

import numpy as np

from npfm.commands.numbers import positive
from npfm.commands.outputs import output
from npfm.exports.gallery.kinds import PAGE
from npfm.figures import own_colors
from npfm.reflectance.table import CHANNELS
from npfm.storage.animations import GIF, write_gif
from npfm.storage.pictures import EXR

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.exports.gallery.kinds",
    "npfm.figures.own_colors",
    "npfm.reflectance.table",
    "npfm.storage.animations",
    "npfm.storage.pictures",
)
#: And what it covers for each of the kinds, which are imported where they are made: frames are
#: rendered in scenes that are built for them alone.
CODE_OF_KIND = {
    "frames": (
        "npfm.fitting.sources",
        "npfm.evaluation.turned_light",
        "npfm.reflectance.table_files",
        "npfm.storage.names",
    ),
    "page": (
        "npfm.evaluation.turned_light",
        "npfm.exports.gallery.video",
        "npfm.fitting.iterations",
    ),
    "light": (
        "npfm.evaluation.turned_light",
        "npfm.exports.gallery.video",
        "npfm.figures.animations",
    ),
    "starts": (
        "npfm.exports.gallery.starts",
        "npfm.figures.animations",
        "npfm.fitting.iterations",
    ),
}
EXAMPLE = """\
examples:
  python -m npfm fit chrome.binary --model independent-g --iterations starts.npz -o chrome.npz
  python -m npfm scene --light grace.exr --turn 90 --objects sphere --resolution 64 -o turned/90
  python -m npfm video frames chrome.binary --scenes turned/0 turned/90 \\
      --fits independent-g=chrome.npz bivariate=two.npz -o frames.exr
  python -m npfm video page chrome --frames frames.exr --iterations starts.npz -o chrome.html
  python -m npfm video light chrome --frames frames.exr -o chrome-light.gif
  python -m npfm video starts chrome --iterations starts.npz --channel green -o chrome-starts.gif
frames renders the measurement and the fits in every turn of the light, the page shows them and the
starts of a fit to be turned and stepped through in a browser, and the animations are for a talk.
"""
#: How long a picture of an animation is shown, and the last one of a fit, in milliseconds.
TURN, ITERATION, END = 100, 160, 2000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="frames|page|light|starts")
    frames, page = kinds.add_parser("frames"), kinds.add_parser("page")
    light, starts = kinds.add_parser("light"), kinds.add_parser("starts")
    frames.add_argument("table", help="MERL .binary file of the material")
    frames.add_argument(
        "--scenes", nargs="+", required=True, help="folders made by npfm scene --turn, named by it"
    )
    frames.add_argument(
        "--fits", nargs="+", required=True, metavar="VARIANT=FILE", help="fits (.npz) of the table"
    )
    for kind in (page, light, starts):
        kind.add_argument("material", help="what it is called")
    for kind in (page, light):
        kind.add_argument("--frames", required=True, help="EXR made by npfm video frames")
        kind.add_argument("--exposure", type=positive, default=0.02, help="factor (default: 0.02)")
        kind.add_argument("--gamma", type=positive, default=2.2, help="exponent (default: 2.2)")
    for kind in (page, starts):
        kind.add_argument("--iterations", required=True, help="made by npfm fit --iterations")
    page.add_argument("--materials", nargs="+", default=[], help="pages that lie beside it")
    own_colors.add_colors(page)
    starts.add_argument("--channel", choices=CHANNELS, default="green", help="(default: green)")
    for kind, written in ((frames, EXR), (page, PAGE), (light, GIF), (starts, GIF)):
        kind.add_argument(
            "-o", "--output", type=output(written), required=True, help=f"{written.name} to write"
        )


def run(arguments: argparse.Namespace) -> str:
    """Make what is asked for; return how large it is."""
    {"frames": _frames, "page": _page, "light": _light, "starts": _starts}[arguments.kind](
        arguments
    )
    return f"{Path(arguments.output).stat().st_size / 1e6:.1f} MB"


def _frames(a: argparse.Namespace) -> None:
    from npfm.evaluation import turned_light
    from npfm.fitting.sources import table
    from npfm.reflectance.table_files import read_table
    from npfm.storage.names import distinct, named

    distinct(Path(scene).name for scene in a.scenes)
    paths = named(a.fits, "ggx=ggx.npz", taken=[turned_light.MEASURED])
    fits = {variant: table(path) for variant, path in paths.items()}
    made = turned_light.render(read_table(a.table), fits, a.scenes)
    turned_light.write(a.output, made)


def _page(a: argparse.Namespace) -> None:
    from npfm.evaluation import turned_light
    from npfm.exports.gallery import video
    from npfm.fitting import iterations

    video.write(
        a.output,
        a.material,
        a.materials or [a.material],
        iterations.load(a.iterations),
        turned_light.read(a.frames),
        (a.exposure, a.gamma),
        own_colors.colors(a),
    )


def _light(a: argparse.Namespace) -> None:
    from npfm.evaluation import turned_light
    from npfm.exports.gallery import video
    from npfm.figures import animations

    turned = turned_light.read(a.frames)
    shown = video.shown(turned, (a.exposure, a.gamma))
    drawn = animations.light(a.material, turned.degrees, turned.names, shown, turned.psnr())
    frames = list(drawn)
    write_gif(a.output, frames, [TURN] * len(frames), dithered=True)


def _starts(a: argparse.Namespace) -> None:
    from npfm.exports.gallery import starts
    from npfm.figures import animations
    from npfm.fitting import iterations

    found = iterations.load(a.iterations)
    channel = CHANNELS.index(a.channel)
    factors = starts.relative(found)
    chosen = [
        np.flatnonzero((found.channel == channel) & (found.start == k))
        for k in range(len(found.names))
    ]
    states = [{name: values[at] for name, values in factors.items()} for at in chosen]
    title = f"{a.material}, {a.channel}: {len(states)} starts, the best thick"
    looks, best = starts.looks(found.names), found.best(channel)
    frames = list(animations.starts(title, found.angles, states, looks, best))
    write_gif(a.output, frames, [ITERATION] * (len(frames) - 1) + [END], dithered=False)
