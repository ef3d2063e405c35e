"""``npfm compare``."""

import argparse
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
viewer.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("reference", help="EXR of linear radiance to compare with")
    parser.add_argument("pictures", nargs="+", metavar="picture", help="EXR of the same size")
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
    values = decibels(arguments.reference, arguments.pictures)
    if arguments.output:
        parts = dict(zip(distinct(names), map(read_exr, paths), strict=True))
        write_exr_parts(arguments.output, parts)
    width = max(map(len, [*names, "picture"]))
    print(f"{'picture':{width}}  psnr_db")
    for name, value in zip(names[1:], values, strict=True):
        print(f"{name:{width}}  {value:7.2f}")
