"""``npfm accuracy-cost``."""

import argparse
from pathlib import Path
from typing import Any

import pandas as pd

from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import accuracy_cost as costs
from npfm.evaluation import tables
from npfm.fitting.sources import table
from npfm.reflectance.table import Table
from npfm.reflectance.table_files import read_table
from npfm.rendering import transport
from npfm.storage.names import distinct, named

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.evaluation.accuracy_cost",
    "npfm.evaluation.tables",
    "npfm.storage.names",
)
EXAMPLE = """\
examples:
  python -m npfm accuracy-cost traces --fits awls=fits/old gauss-newton=fits/new \\
      --materials chrome pink-felt -o traces.csv
  python -m npfm accuracy-cost fits chrome.binary --scenes scenes/A scenes/D \\
      --fits model:naive/awls=fits/old starts:1=fits/one -o chrome.csv
  python -m npfm accuracy-cost sampling --reference scenes/many --builds scenes/few scenes/more \\
      --tables chrome.binary --fits chrome.npz -o sampling.csv
  python -m npfm accuracy-cost table --fits chrome.csv --sampling sampling.csv -o cost.csv
Seconds are those that fits and scenes recorded when they were made; PSNR is in dB.
"""
#: What each kind of table is made from.
SOURCES: dict[str, dict[str, dict[str, Any]]] = {
    "traces": {
        "--fits": {"nargs": "+", "metavar": "SOLVER=FOLDER"},
        "--materials": {"nargs": "+", "help": "names of the fits"},
    },
    "fits": {
        "table": {"help": "MERL .binary or UTIA .bin file of the material"},
        "--fits": {"nargs": "+", "metavar": "STAGE:SETTING=FOLDER"},
        "--scenes": {"nargs": "+", "help": "folders made by npfm scene"},
    },
    "sampling": {
        "--reference": {"help": "folder of a scene of many samples"},
        "--builds": {"nargs": "+", "help": "folders of others, each with its --record beside it"},
        "--tables": {"nargs": "+", "help": "MERL .binary or UTIA .bin files"},
        "--fits": {"nargs": "+", "help": "a fit (.npz) of each table"},
    },
    "table": {
        "--fits": {"nargs": "+", "help": "CSVs made by npfm accuracy-cost fits"},
        "--sampling": {"help": "CSV made by npfm accuracy-cost sampling"},
    },
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="|".join(SOURCES))
    for kind, sources in SOURCES.items():
        chosen = kinds.add_parser(kind)
        for name, options in sources.items():
            required: dict[str, Any] = {"required": True} if name.startswith("--") else {}
            chosen.add_argument(name, **required, **options)
        chosen.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    match arguments.kind:
        case "traces":
            made = costs.traces(named(arguments.fits, "awls=folder"), arguments.materials)
        case "fits":
            made = _fits(arguments)
        case "sampling":
            made = costs.sampling(arguments.reference, arguments.builds, _materials(arguments))
        case "table":
            fits = costs.read(arguments.fits, costs.FITS)
            made = costs.cost(fits, costs.read([arguments.sampling], costs.SAMPLING))
    tables.write(arguments.output, made)


def _materials(arguments: argparse.Namespace) -> dict[str, tuple[Table, Table]]:
    """Measured and fitted table of every material."""
    if len(arguments.tables) != len(arguments.fits):
        raise NpfmError("--tables and --fits differ in number; name a fit of each table")
    names = distinct(Path(path).stem for path in arguments.tables)
    pairs = zip(map(table, arguments.tables), map(table, arguments.fits), strict=True)
    return dict(zip(names, pairs, strict=True))


def _stage(name: str) -> tuple[str, str]:
    stage, colon, setting = name.partition(":")
    if not colon:
        raise NpfmError(f"'{name}' has no ':'; name the stage, as in stage:setting=folder")
    return stage, setting


def _fits(arguments: argparse.Namespace) -> pd.DataFrame:
    material = Path(arguments.table).stem
    folders = named(arguments.fits, "stage:setting=folder")
    settings = {_stage(name): f"{folder}/{material}.npz" for name, folder in folders.items()}
    names = distinct(Path(path).name for path in arguments.scenes)
    scenes = dict(zip(names, map(transport.load, arguments.scenes), strict=True))
    made = costs.fits(read_table(arguments.table), settings, scenes, table)
    return made.assign(material=material)[list(costs.FITS)]
