"""``npfm tables``."""

import argparse
from pathlib import Path

import pandas as pd

from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.papers import bagher2016
from npfm.papers.table1 import table1

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.evaluation.tables",
    "npfm.papers.bagher2016",
    "npfm.papers.table1",
)
#: And what it covers for some of the kinds.
CODE_OF_KIND = {
    "published": (
        "npfm.fitting.sources",
        "npfm.papers.authors_distance",
        "npfm.datasets.published_factors",
    ),
    "fidelity": ("npfm.fitting.sources", "npfm.evaluation.fidelity"),
    "where": ("npfm.fitting.sources", "npfm.evaluation.where"),
}
#: What each table holds, and what it is made from.
KINDS = {
    "psnr": (
        "PSNR in dB of every picture against that of the measurement",
        ("run", "scenes", "materials", "variants"),
    ),
    "fits": (
        "seconds, iterations and objective (share of the zero model's) of every fitted channel",
        ("run", "materials", "variants"),
    ),
    "materials": (
        "diffuseness of every material, dimensionless: equation 19 of the naive fit",
        ("run", "materials"),
    ),
    "summary": (
        "mean and median PSNR in dB and size in bytes of every variant, beside the paper's",
        ("run", "psnr"),
    ),
    "published": (
        "objective and distance of the factors that the paper's authors published, and of our fits",
        ("run", "materials", "factors"),
    ),
    "fidelity": (
        "PSNR in dB of pictures and of tables, by two peaks: Figure 4 of Peng et al. 2017",
        ("run", "psnr", "measured"),
    ),
    "where": (
        "where the error of fits sits, in percent: by angles, and by the slant of a lone sphere",
        ("run", "materials", "variants"),
    ),
    "table1": ("seconds and counts of our fits, beside the paper's Table I", ("fits",)),
}
#: How each of those is declared, and a value for the example.
SOURCES = {
    "run": ({"help": "folder of the run"}, "results/smoke"),
    "scenes": ({"nargs": "+", "help": "the scenes that count, in order"}, "A D"),
    "materials": ({"nargs": "+", "help": "the materials that count, in order"}, "chrome felt"),
    "variants": ({"nargs": "+", "help": "the variants that count, in order"}, "naive bivariate"),
    "psnr": ({"help": "CSV made by npfm tables psnr; what it lists counts"}, "psnr.csv"),
    "measured": ({"nargs": "+", "help": "tables of the materials"}, "satin.bin twill.bin"),
    "fits": ({"help": "CSV made by npfm tables fits"}, "fits.csv"),
    "factors": ({"help": "published factors (.npz); docs/data.md"}, "npf_reference.npz"),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = _example("psnr")
    kinds = parser.add_subparsers(dest="table", required=True, metavar="table")
    for kind, (contents, sources) in KINDS.items():
        chosen = kinds.add_parser(
            kind,
            help=contents,
            description=f"{contents[0].upper()}{contents[1:]}.",
            epilog=_example(kind),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        for source in sources:
            chosen.add_argument(f"--{source}", required=True, **SOURCES[source][0])
        if "variants" in sources:
            chosen.add_argument(
                "--missing",
                nargs="+",
                default=[],
                metavar="VARIANT/MATERIAL",
                help="fits that there are not, to be left out",
            )
        if kind == "where":
            chosen.add_argument(
                "--spheres", nargs="+", default=[], help="the scenes of a lone sphere that count"
            )
            chosen.add_argument(
                "--max-angle",
                type=float,
                default=89.0,
                help="of the objective, in degrees (default: 89)",
            )
            chosen.add_argument(
                "--no-compressive",
                action="store_true",
                help="an objective without the compressive weight",
            )
            chosen.add_argument(
                "--cells", default="volume-form", help="its weight of cells (default: volume-form)"
            )
        chosen.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Gather the table, and write it."""
    a = arguments
    match a.table:
        case "psnr":
            table = tables.psnr(a.run, a.scenes, a.materials, a.variants, a.missing)
        case "fits":
            table = tables.fits(a.run, a.materials, a.variants, a.missing)
        case "materials":
            table = tables.materials(a.run, a.materials)
        case "summary":
            psnr = tables.read_psnr(a.psnr)
            sizes = tables.sizes(a.run, psnr)
            table = tables.summary(psnr, sizes, bagher2016.MEAN_PSNR_DB)
        case "published":
            table = _published(a)
        case "fidelity":
            table = _fidelity(a)
        case "where":
            table = _where(a)
        case "table1":
            text, numbers = ["material", "variant"], ["seconds", "iterations", "gss_calls"]
            table = table1(tables.read(a.fits, text, numbers))
    tables.write(a.output, table)


def _published(a: argparse.Namespace) -> pd.DataFrame:
    """Compare the published factors of the materials that have some."""
    from npfm.datasets import published_factors
    from npfm.fitting.sources import table
    from npfm.papers import authors_distance

    published = published_factors.read(a.factors)
    found = [
        authors_distance.distance(
            name,
            table(f"{a.run}/materials/{name}.binary"),
            published[name],
            table(f"{a.run}/fits/independent-g/{name}.npz"),
        )
        for name in a.materials
        if name in published
    ]
    return pd.concat(found) if found else pd.DataFrame(columns=authors_distance.COLUMNS)


def _fidelity(a: argparse.Namespace) -> pd.DataFrame:
    """Compare the tables and the pictures of the materials that the table of PSNR lists."""
    from npfm.evaluation.fidelity import fidelity
    from npfm.fitting.sources import table

    psnr = tables.read_psnr(a.psnr)
    measured = {Path(path).stem: path for path in a.measured}
    if missing := sorted(set(psnr["material"]) - measured.keys()):
        raise NpfmError(f"{a.psnr}: no table of {missing[0]}; name its file after --measured")
    return fidelity(a.run, psnr, measured, table)


def _where(a: argparse.Namespace) -> pd.DataFrame:
    """Find where the error of all fits that there are sits."""
    from npfm.evaluation.where import where
    from npfm.fitting.objective import Objective
    from npfm.fitting.sources import table

    left_out = set(a.missing)
    fits = {
        name: [variant for variant in a.variants if f"{variant}/{name}" not in left_out]
        for name in a.materials
    }
    objective = Objective(not a.no_compressive, a.max_angle, a.cells)
    return where(a.run, a.spheres, fits, objective, table)


def _example(kind: str) -> str:
    options = " ".join(f"--{source} {SOURCES[source][1]}" for source in KINDS[kind][1])
    return f"example:\n  python -m npfm tables {kind} {options} -o {kind}.csv\n"
