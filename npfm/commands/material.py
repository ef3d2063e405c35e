"""``npfm material``."""

import argparse
import os
from pathlib import Path

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.declarations import NAMES_ARE, is_name
from npfm.errors import NpfmError
from npfm.reflectance import grids
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.table import Table
from npfm.reflectance.table_files import KINDS, read_table, write_table
from npfm.storage.files import Kind, replacing

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.declarations",
    "npfm.reflectance.table_files",
)
#: And what it covers for some of the kinds.
CODE_OF_KIND = {
    "formula": ("npfm.datasets.analytic",),
    "synthetic": ("npfm.datasets.synthetic",),
    "neural": ("npfm.datasets.neural",),
    "merl": ("npfm.datasets.merl_folder",),
    "utia": ("npfm.datasets.utia_folder",),
    "rgl": ("npfm.datasets.rgl_folder",),
    "synthetic-anisotropic": ("npfm.datasets.synthetic_anisotropic",),
}
EXAMPLE = """\
examples:
  python -m npfm material --synthetic car-paint --seed 1 -o car-paint.binary
  python -m npfm material --neural chrome --from merl_nbrdf.zip -o chrome.binary
  python -m npfm material --merl chrome --from brdfs -o chrome.binary
  python -m npfm material --synthetic-anisotropic brushed-steel -o steel.bin
  python -m npfm material --formula cook-torrance -o rough-metal.binary
  python -m npfm material --utia m002_carpet --from utia -o carpet.bin
  python -m npfm material --rgl chm_orange_rgb --from rgl -o orange.binary
--merl checks brdfs/chrome.binary and links to it, as --utia does; with --url, a file that is
missing there is downloaded first. Tables are BRDFs in 1/sr, in .binary files in MERL's own scaling.
"""


def _link_to(suffix: str) -> Kind:
    def ours(path: Path) -> bool:
        return path.is_symlink() and path.readlink().suffix == suffix

    return Kind("a link to a table", suffix, ours)


LINKS = {kind.suffix: _link_to(kind.suffix) for kind in KINDS}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument("--synthetic", metavar="NAME", help="a material that the project makes")
    kind.add_argument("--formula", metavar="NAME", help="a formula of Lawrence et al. 2004")
    kind.add_argument("--neural", metavar="NAME", help="a material of the neural archive")
    kind.add_argument("--merl", metavar="NAME", help="a material of a folder of .binary files")
    kind.add_argument("--utia", metavar="NAME", help="a material of a folder of .bin files")
    kind.add_argument("--rgl", metavar="NAME", help="a material of a folder of RGL .bsdf files")
    kind.add_argument(
        "--synthetic-anisotropic",
        metavar="NAME",
        help="an anisotropic material that the project makes",
    )
    parser.add_argument("--from", dest="source", help="the archive, or the folder")
    parser.add_argument("--url", help="where to download from, with {name} for the material")
    parser.add_argument(
        "--seed", type=whole(0), default=1, help="seed of synthetic noise (default: 1)"
    )
    parser.add_argument(
        "--shape",
        help="of --synthetic-anisotropic, and of --rgl where the material is anisotropic: how many "
        "theta_i, phi_i, theta_o and phi_o (default: 6x48x6x48)",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=output(*KINDS, *LINKS.values()),
        required=True,
        help="MERL .binary or UTIA .bin file to write",
    )


def run(arguments: argparse.Namespace) -> None:
    """Write the table, or link to it."""
    made = arguments.synthetic or arguments.synthetic_anisotropic or arguments.formula
    if arguments.shape and not (arguments.synthetic_anisotropic or arguments.rgl):
        raise NpfmError("--shape goes with --synthetic-anisotropic and --rgl; leave it out")
    if not made and not arguments.source:
        raise NpfmError("--neural, --merl, --utia and --rgl need --from, the archive or the folder")
    if arguments.synthetic:
        from npfm.datasets import synthetic

        write_table(arguments.output, synthetic.load(arguments.synthetic, arguments.seed))
    elif arguments.synthetic_anisotropic:
        from npfm.datasets import synthetic_anisotropic

        grid = _directional(arguments.shape)
        write_table(arguments.output, synthetic_anisotropic.load(made, arguments.seed, grid))
    elif arguments.formula:
        from npfm.datasets import analytic

        write_table(arguments.output, analytic.tabulated(arguments.formula))
    elif arguments.neural:
        from npfm.datasets import neural

        write_table(arguments.output, neural.load(arguments.source, arguments.neural))
    elif arguments.rgl:
        write_table(arguments.output, _tabulated(arguments))
    else:
        _link(arguments.output, _measured(arguments))


def _directional(shape: str | None) -> Directional:
    """Return the directional grid of a shape, UTIA's if nothing is said."""
    grid = grids.parse([UTIA.kind, *([shape] if shape else [])])
    assert isinstance(grid, Directional)  # as its kind says
    return grid


def _tabulated(arguments: argparse.Namespace) -> Table:
    """Table of a material of the RGL database."""
    from npfm.datasets import rgl_folder

    if not is_name(arguments.rgl):
        raise NpfmError(f"--rgl {arguments.rgl!r}: {NAMES_ARE}; rename the file")
    grid = _directional(arguments.shape)
    if arguments.shape and not rgl_folder.anisotropic(arguments.source, arguments.rgl):
        raise NpfmError(f"--shape: {arguments.rgl} is isotropic; leave it out")
    return rgl_folder.load(arguments.source, arguments.rgl, grid)


def _measured(arguments: argparse.Namespace) -> Path:
    """File of a folder, checked and if need be downloaded."""
    option, name = ("merl", arguments.merl) if arguments.merl else ("utia", arguments.utia)
    if not is_name(name):
        raise NpfmError(f"--{option} {name!r}: {NAMES_ARE}; rename the file")
    folder = Path(arguments.source)
    if option == "utia":
        from npfm.datasets import utia_folder

        return utia_folder.path(folder, name)
    from npfm.datasets import merl_folder

    if arguments.url and not (folder / f"{name}.binary").exists():
        merl_folder.download(arguments.url, name, folder)
    return merl_folder.path(folder, name)


def _link(target: str, source: Path) -> None:
    """Link to a table, after a look at its values."""
    read_table(source)
    if Path(target).suffix != source.suffix:
        raise NpfmError(
            f"{target}: {source} is linked to; give a name that ends in {source.suffix}"
        )
    if Path(target).absolute().parent.resolve() == source.parent.resolve():
        raise NpfmError(f"{target}: lies among the measurements; give another output")
    with replacing(target, LINKS[source.suffix]) as temporary:
        os.symlink(source.resolve(), temporary)
