"""``npfm material``."""

import argparse
import os
from pathlib import Path

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.declarations import NAMES_ARE, is_name
from npfm.errors import NpfmError
from npfm.reflectance.merl import BINARY, read_binary, write_binary
from npfm.storage.files import Kind, replacing

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.declarations",
    "npfm.reflectance.merl",
)
#: And what it covers for some of the kinds.
CODE_OF_KIND = {
    "synthetic": ("npfm.datasets.synthetic",),
    "neural": ("npfm.datasets.neural",),
    "merl": ("npfm.datasets.merl_folder",),
}
EXAMPLE = """\
examples:
  python -m npfm material --synthetic car-paint --seed 1 -o car-paint.binary
  python -m npfm material --neural chrome --from merl_nbrdf.zip -o chrome.binary
  python -m npfm material --merl chrome --from brdfs -o chrome.binary
The last one checks brdfs/chrome.binary and links to it; with --url, a file that is missing there is
downloaded first. Tables are BRDFs in 1/sr, in MERL's own scaling.
"""

LINK = Kind(
    "a link to a table",
    ".binary",
    lambda path: path.is_symlink() and path.readlink().suffix == ".binary",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument("--synthetic", metavar="NAME", help="a material that the project makes")
    kind.add_argument("--neural", metavar="NAME", help="a material of the neural archive")
    kind.add_argument("--merl", metavar="NAME", help="a material of a folder of .binary files")
    parser.add_argument("--from", dest="source", help="the archive, or the folder")
    parser.add_argument("--url", help="where to download from, with {name} for the material")
    parser.add_argument(
        "--seed", type=whole(0), default=1, help="seed of synthetic noise (default: 1)"
    )
    parser.add_argument(
        "-o",
        "--output",
        type=output(BINARY, LINK),
        required=True,
        help="MERL .binary file to write",
    )


def run(arguments: argparse.Namespace) -> None:
    """Write the table, or link to it."""
    if not arguments.synthetic and not arguments.source:
        raise NpfmError("--neural and --merl need --from, the archive or the folder")
    if arguments.synthetic:
        from npfm.datasets import synthetic

        write_binary(arguments.output, synthetic.load(arguments.synthetic, arguments.seed))
    elif arguments.neural:
        from npfm.datasets import neural

        write_binary(arguments.output, neural.load(arguments.source, arguments.neural))
    else:
        _link(arguments)


def _link(arguments: argparse.Namespace) -> None:
    from npfm.datasets import merl_folder

    if not is_name(arguments.merl):
        raise NpfmError(f"--merl {arguments.merl!r}: {NAMES_ARE}; rename the file")
    folder = Path(arguments.source)
    if arguments.url and not (folder / f"{arguments.merl}.binary").exists():
        merl_folder.download(arguments.url, arguments.merl, folder)
    source = merl_folder.path(folder, arguments.merl)
    read_binary(source)
    if Path(arguments.output).absolute().parent.resolve() == folder.resolve():
        raise NpfmError(f"{arguments.output}: lies among the measurements; give another output")
    with replacing(arguments.output, LINK) as temporary:
        os.symlink(source.resolve(), temporary)
