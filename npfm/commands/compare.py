"""``npfm compare``."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from npfm.commands.outputs import output
from npfm.evaluation.comparison import decibels
from npfm.storage.names import distinct
from npfm.storage.pictures import EXR, read_exr, write_exr_parts

EXAMPLE = """\
example:
  python -m npfm compare measured.exr independent-g.exr naive.exr -o all.exr
prints the PSNR of each picture in dB (peak: the largest value in the reference's foreground, which
is where its alpha is 1) and writes all of them as the parts of one EXR file, to be flipped in a
viewer. With --metrics it prints what docs/quality.md tells of as well; the tone-mapped PNG of every
picture has to lie beside it, as npfm render leaves it.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("reference", help="EXR of linear radiance to compare with")
    parser.add_argument("pictures", nargs="+", metavar="picture", help="EXR of the same size")
    parser.add_argument(
        "--metrics", action="store_true", help="print SSIM, FLIP and colour differences as well"
    )
    parser.add_argument(
        "-o",
        "--output",
        type=output(EXR),
        help="EXR to write, reference and pictures as its parts",
    )


def run(arguments: argparse.Namespace) -> None:
    """Print the table, and write the parts if asked to."""
    paths = [arguments.reference, *arguments.pictures]
    names = [Path(path).stem for path in paths]
    if len(set(names)) < len(names):
        names = paths
    rows = _metrics(paths) if arguments.metrics else _decibels(paths)
    if arguments.output:
        parts = dict(zip(distinct(names), map(read_exr, paths), strict=True))
        write_exr_parts(arguments.output, parts)
    width = max(map(len, [*names, "picture"]))
    print(f"{'picture':{width}}", *rows[0], sep="  ")
    for name, row in zip(names[1:], rows, strict=True):
        numbers = (f"{value:>{max(7, len(head))}}" for head, value in row.items())
        print(f"{name:{width}}", *numbers, sep="  ")


def _decibels(paths: Sequence[str]) -> list[dict[str, str]]:
    """What is printed of each picture: numbers as text, by the heads of their columns."""
    return [{"psnr_db": f"{value:.2f}"} for value in decibels(paths[0], paths[1:])]


def _metrics(paths: Sequence[str]) -> list[dict[str, str]]:
    from npfm.evaluation import quality, quality_of_fits

    found = quality_of_fits.compare(paths[0], paths[1:])
    digits = {name: 2 if metric.unit == "dB" else 4 for name, metric in quality.PICTURES.items()}
    return [
        {f"{name:>7}": f"{value:.{digits[name]}f}" for name, value in row.items()} for row in found
    ]
