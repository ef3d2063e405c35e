"""``npfm shared-lobes``."""

import argparse
from pathlib import Path

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import shared_lobes as study
from npfm.evaluation import tables
from npfm.evaluation.accuracy_cost import FITS, read
from npfm.fitting import fits
from npfm.fitting.registry import tabulated
from npfm.rendering.lights import environment
from npfm.storage.bounds import check_size

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.evaluation.accuracy_cost",
    "npfm.evaluation.shared_lobes",
    "npfm.evaluation.tables",
    "npfm.fitting.fits",
    "npfm.fitting.registry",
    "npfm.rendering.lights.environment",
    "npfm.storage.bounds",
)
EXAMPLE = """\
examples:
  python -m npfm shared-lobes psnr chrome.csv nylon.csv -o psnr.csv
  python -m npfm shared-lobes lobes chrome.csv nylon.csv -o lobes.csv
  python -m npfm shared-lobes sampling chrome.npz --light grace.exr -o chrome-sampling.csv
  python -m npfm shared-lobes gather chrome-sampling.csv nylon-sampling.csv -o sampling.csv
psnr and lobes gather what npfm accuracy-cost fits says of the stages 'compared' and 'lobes', whose
settings are names of variants, and such as 3-shared and 3-own; sampling renders a sphere by the
cosine, by D, and by both, several times: PSNR in dB of the root mean square error.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="psnr|lobes|sampling|gather")
    for kind in ("psnr", "lobes"):
        chosen = kinds.add_parser(kind)
        chosen.add_argument("found", nargs="+", help="CSVs made by npfm accuracy-cost fits")
    gather = kinds.add_parser("gather")
    gather.add_argument("found", nargs="+", help="CSVs made by npfm shared-lobes sampling")
    sampling = kinds.add_parser("sampling")
    sampling.add_argument("fit", help="fit (.npz) of shared-lobes")
    sampling.add_argument("--light", required=True, help="lat-long EXR, made by npfm light")
    for name, least, default, what in (
        ("--resolution", 4, 32, "pixels along one side"),
        ("--reference-samples", 1, 32768, "light directions a pixel of the reference"),
        ("--repetitions", 1, 10, "pictures of each number, with other random numbers"),
    ):
        sampling.add_argument(
            name, type=whole(least), default=default, help=f"{what} (default: {default})"
        )
    sampling.add_argument(
        "--samples",
        type=whole(1),
        nargs="+",
        default=[16, 64, 128, 256, 1024, 4096],
        help="light directions a pixel (default: 16 64 128 256 1024 4096)",
    )
    for chosen in kinds.choices.values():
        chosen.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    a = arguments
    match a.kind:
        case "psnr":
            made = study.psnr(read(a.found, FITS))
        case "lobes":
            made = study.lobes(read(a.found, FITS))
        case "sampling":
            check_size(a.output, a.resolution, a.resolution)
            effort = study.Effort(
                a.resolution, sorted(set(a.samples)), a.reference_samples, a.repetitions
            )
            fit, light = _fit(a.fit), environment.read(a.light)
            made = study.sampling(fit, tabulated(a.fit), light, effort)
            made = made.assign(material=Path(a.fit).stem)[list(study.SAMPLING)]
        case "gather":
            made = study.read_sampling(a.found)
    tables.write(a.output, made)


def _fit(path: str) -> fits.Fit:
    fit = fits.load(path)
    if fit.model != "shared-lobes" or fit.grid.anisotropic:
        raise NpfmError(
            f"{path}: a fit of '{fit.model}' on {fit.grid.name}; give one of shared-lobes to a "
            "MERL table"
        )
    return fit
