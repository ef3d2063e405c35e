"""``npfm fit``."""

import argparse
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

from tqdm import tqdm

from npfm.commands.numbers import whole
from npfm.commands.objectives import add_objective, add_solver, objective, solver
from npfm.commands.outputs import output
from npfm.errors import NpfmError, suggest
from npfm.fitting import fits, registry
from npfm.fitting.fits import Fit
from npfm.fitting.registry import Model, Published
from npfm.fitting.solvers.choice import SOLVERS, chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.table_files import read_table

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.objectives",
    "npfm.commands.outputs",
    "npfm.fitting.registry",
    "npfm.fitting.solvers.choice",
    "npfm.fitting.fits",
    "npfm.fitting.objective",
    "npfm.reflectance.table_files",
)
EXAMPLE = """\
example:
  python -m npfm fit chrome.binary --model independent-g -o chrome.npz
writes chrome.npz (float32 parameters; rho_d and rho_s in 1/sr) and chrome.json (seconds,
iterations and objective of every start).
  python -m npfm fit chrome.binary --model independent-g --iterations starts.npz -o chrome.npz
also writes D, G and F of every start after each iteration, for npfm video page.
  python -m npfm fit chrome.binary --model abc-published --published low_lowmicrofacet_E2.fit \\
      -o chrome.npz
takes the parameters that the file has for chrome, the name of the table. The objective is
dimensionless: its share of the weighted sum of squares of the measurement.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("table", help="MERL .binary or UTIA .bin file to fit")
    parser.add_argument("--model", required=True, help=f"one of {', '.join(registry.models())}")
    parser.add_argument(
        "-o",
        "--output",
        type=output(fits.FIT, beside=fits.RECORD),
        required=True,
        help="fit to write (.npz)",
    )
    parser.add_argument(
        "--iterations",
        type=output(fits.ITERATIONS),
        help="file to write (.npz): D, G and F of every start after each iteration, "
        "of independent-g and g-from-d",
    )
    parser.add_argument(
        "--solver",
        default=SolverSettings.method,
        help=f"{' or '.join(SOLVERS)} (default: %(default)s)",
    )
    add_solver(parser)
    for setting, (words, meaning) in _own_settings().items():
        kind = {"choices": words} if words else {"type": int, "metavar": "N"}
        parser.add_argument(f"--{setting}", help=meaning, **kind)
    parser.add_argument(
        "--published",
        metavar="FILE",
        help="file that a model *-published reads: .fit, or .npz of factors",
    )
    add_objective(parser)
    parser.add_argument(
        "--seed", type=whole(0), default=1, help="seed of random starts (default: 1)"
    )


def run(arguments: argparse.Namespace) -> str:
    """Fit, and write the fit and its record; what it came to, in a line."""
    model = registry.declared(arguments.model)
    own = _given(model, arguments)
    settings = replace(solver(arguments), method=arguments.solver)
    minimised = objective(arguments)
    if arguments.iterations and not model.solver:
        raise NpfmError(f"'{arguments.model}' runs no iterations; leave --iterations out")
    with tqdm(desc=f"fit {arguments.model}", unit="start", disable=None) as progress:
        solve = chosen(settings, after_start=progress.update) if model.solver else _none
        recorder = _recorder(solve) if arguments.iterations else None
        table = read_table(arguments.table)
        try:
            registry.check_grid(arguments.model, table.grid.kind)
            fit = model.load().fit(table, minimised, recorder or solve, arguments.seed, **own)
        except NpfmError as error:
            raise NpfmError(f"{arguments.table}: {error}") from error
    fits.save(arguments.output, fit)
    if recorder:
        recorder.save(arguments.iterations, fit)
    return _summary(fit)


def _recorder(solve: Any) -> Any:
    """Return the solver with its states kept."""
    from npfm.fitting.iterations import Recorder  # which other fits do not depend on

    return Recorder(solve)


def _summary(fit: Fit) -> str:
    """Objective, floor, time, size and status of a fit, in a line."""
    records = fit.records
    objective, floor = (
        sum(getattr(record, name) for record in records) / len(records)
        for name in ("objective", "objective_floor")
    )
    seconds = sum(record.seconds for record in records)
    statuses = ", ".join(dict.fromkeys(record.status for record in records))
    size = sum(array.nbytes for array in fit.parameters.values())
    return (
        f"objective {objective:.3g} (floor {floor:.3g}), {seconds:.2f} s, {size} bytes, {statuses}"
    )


def _none(problem: Any, starts: Any) -> NoReturn:
    """Stand for the solver of a model that declares to run none: no module of one is imported."""
    raise AssertionError("this model declares SOLVER = False and runs a solver; declare it")


def _own_settings() -> dict[str, tuple[list[str], str]]:
    """Settings that only some models have: their words, if they take words, and their meanings."""
    words: dict[str, list[str]] = {}
    meanings: dict[str, dict[str, list[str]]] = {}
    for name, model in registry.models().items():
        for setting, meaning in model.settings.items():
            choices = {} if isinstance(meaning, str) else meaning
            listed = "; ".join(f"{k}: {v}" for k, v in choices.items())
            text = meaning if isinstance(meaning, str) else listed
            words.setdefault(setting, []).extend(choices)
            meanings.setdefault(setting, {}).setdefault(text, []).append(name)
    return {
        setting: (
            list(dict.fromkeys(words[setting])),
            "; ".join(f"of {', '.join(names)}: {meaning}" for meaning, names in said.items()),
        )
        for setting, said in meanings.items()
    }


def _given(model: Model, arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the settings that were given and only some models have."""
    given = {name: getattr(arguments, name) for name in (*_own_settings(), "published")}
    given = {name: value for name, value in given.items() if value is not None}
    own = {*model.settings, *(["published"] if model.published else [])}
    if wrong := [name for name in given if name not in own]:
        raise NpfmError(f"--{wrong[0]} is not a setting of '{arguments.model}'; leave it out")
    if model.published:
        given["published"] = _parameters(arguments, model.published)
    return given


def _parameters(arguments: argparse.Namespace, published: Published) -> Mapping[str, Any]:
    """Return the published parameters of the material that the table is named after."""
    path = arguments.published
    if path is None:
        raise NpfmError(f"'{arguments.model}' needs --published, the path of {published.name}")
    name, found = Path(arguments.table).stem, published.read(path)
    if name not in found:
        raise NpfmError(f"{path}: has no material '{name}'; {suggest(name, found)}")
    return found[name]
