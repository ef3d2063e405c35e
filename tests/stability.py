"""The table of docs/stability.md: every hard case, fitted by every model and solver.

    python tests/stability.py fit naive --starts 8 --awls-iterations 60 -o naive.csv
    python tests/stability.py gather naive.csv g-from-d.csv -o stability.csv

A run fails if a warning is raised, or if what must hold of every fit does not.
"""

import argparse
import sys
import warnings
from collections.abc import Iterator
from itertools import product

import numpy as np
import pandas as pd
from hard_cases import CASES
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.fitting import registry
from npfm.fitting.channels import STORED
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, Samples, channel_samples, evaluate, fold
from npfm.fitting.solvers.choice import SOLVERS, chosen
from npfm.fitting.solvers.normal import system
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models.bivariate_g import BivariateGProblem
from npfm.models.g_from_d import GFromDProblem
from npfm.models.independent_g import IndependentGProblem
from npfm.models.low_rank_b import Compressor
from npfm.models.naive import NaiveProblem
from npfm.reflectance.table import Table

COLUMNS = [
    "case", "variant", "solver", "status", "finite", "objective", "objective_floor", "condition",
    "seconds",
]  # fmt: skip
#: Scalings of the factors and of G that leave a model as it is: directions without curvature.
FREEDOMS = {"independent-g": 2, "g-from-d": 1, "naive": 2, "bivariate-g": 2}
#: How far, as a share of the energy, rounding can raise an objective above that of a constant.
ROUNDING = 1e-9
STATUSES = ("converged", "iteration cap", "stalled", "degenerate: ")


def runs() -> Iterator[tuple[str, str]]:
    """Every model with every solver; one that needs none is fitted once."""
    for model, method in product(registry.non_parametric(), SOLVERS):
        if registry.declared(model).solver:
            yield model, method
        elif method == SOLVERS[0]:
            yield model, ""


def fitted(table: Table, model: str, settings: SolverSettings, starts: int) -> Fit:
    """Fit a model; `starts` is how many independent-g has."""
    own = {"starts": starts} if model == "independent-g" else {}
    return registry.model(model).fit(table, Objective(), chosen(settings), 1, **own)


def violations(table: Table, fit: Fit) -> list[str]:
    """What must hold of every fit of any table, and does not."""
    module = registry.model(fit.model)
    made, found = module.tabulate(fit), []
    if not all(np.isfinite(a).all() for a in (*fit.parameters.values(), made.values)):
        found.append("a NaN or an infinity")
    if (made.values[:, table.grid.above_horizon] < 0).any():
        found.append("a negative value")
    for name in {"D", "F", "G", "H"} & fit.parameters.keys():
        factor, clamp = fit.parameters[name], STORED(getattr(module, "CLAMP", 0))
        if not ((factor >= clamp) & (factor <= 1)).all():
            found.append(f"{name} outside [{clamp}, 1]")
    for name in {"rho_d", "rho_s", "B"} & fit.parameters.keys():
        if (fit.parameters[name] < 0).any():
            found.append(f"{name} below 0")
    for channel, record in enumerate(fit.records):
        samples = channel_samples(table, channel, Objective())
        energy = samples.energy or 1.0
        reached = evaluate(samples, made.values[channel] / samples.scale) / energy
        mean = np.vdot(samples.weight, samples.value) / samples.weight.sum()
        constant = evaluate(samples, np.broadcast_to(mean, samples.value.shape)) / energy
        if reached > constant + ROUNDING:
            found.append(f"{record.channel}: {reached:g}, a constant leaves {constant:g}")
        if abs(reached - record.objective) > 1e-5 * reached + ROUNDING:
            found.append(f"{record.channel}: {reached:g}, recorded as {record.objective:g}")
        if not record.status.startswith(STATUSES):
            found.append(f"{record.channel}: status '{record.status}'")
    return found


def condition(model: str, samples: Samples, p: dict[str, NDArray]) -> float:
    """Condition number of what is solved at a fit of one channel.

    Of the Gauss-Newton matrix in the free unknowns, scaled to a unit diagonal, without as many of
    its smallest eigenvalues as a model has scalings that change nothing; for low-rank-b, the
    largest of the systems for a row of U or V. Infinite if singular in double precision, NaN for
    the bivariate model, which solves no system.

    Parameters
    ----------
    model : str
    samples : Samples
        Not folded.
    p : dict of str to ndarray of float64
        Parameters of the channel in the units of the samples.
    """
    match model:
        case "bivariate":
            return float("nan")
        case "naive":
            problem = NaiveProblem(samples)
            state = problem.state(p["D"], p["F"], p["H"])
        case "independent-g":
            problem = IndependentGProblem(fold(samples))
            state = problem.state(p["D"], p["F"], p["G"])
        case "g-from-d":
            problem = GFromDProblem(fold(samples))
            state = problem.start(p["D"], p["F"])
        case _:
            problem = BivariateGProblem(fold(samples))
            state = problem.start(p["G"])
    if model == "low-rank-b":
        return _of_rows(Compressor(problem, state), p["U"], p["V"])
    _, matrix = system(problem, state).reduced
    return _scaled_condition(matrix, FREEDOMS[model]) if matrix.size else float("nan")


def _of_rows(compressor: Compressor, U: NDArray, V: NDArray) -> float:
    equations, found = compressor.equations, []
    for weight, factor in (
        (equations.wkk, V * compressor.columns),
        (equations.wkk.T, U * compressor.rows),
    ):
        basis = np.linalg.qr(factor)[0]
        found += [_scaled_condition((basis.T * row) @ basis, 0) for row in weight if row.any()]
    return max(found, default=float("nan"))


def _scaled_condition(matrix: NDArray, freedoms: int) -> float:
    root = np.sqrt(np.diag(matrix))
    values = np.linalg.eigvalsh(matrix / root / root[:, None])[freedoms:]
    if not values.size:
        return float("nan")
    least = values.size * np.finfo(float).eps * values[-1]
    return float(values[-1] / values[0]) if values[0] > least else float("inf")


def row(case: str, table: Table, model: str, settings: SolverSettings, starts: int) -> dict:
    """One row of the table: over the channels all statuses, the largest values, all seconds."""
    entry = dict.fromkeys(COLUMNS) | {"case": case, "variant": model, "solver": settings.method}
    try:
        fit = fitted(table, model, settings, starts)
    except NpfmError as error:
        return entry | {"status": f"refused: {error}"}
    if wrong := violations(table, fit):
        raise AssertionError(f"{case}, {model}, {settings.method}: {'; '.join(wrong)}")
    conditions = []
    for channel in range(3):
        samples = channel_samples(table, channel, Objective())
        units = dict.fromkeys(("rho_d", "rho_s", "B", "U"), samples.scale)
        p = {key: a[channel].astype(float) / units.get(key, 1) for key, a in fit.parameters.items()}
        conditions.append(condition(model, samples, p))
    return entry | {
        "status": " / ".join(dict.fromkeys(record.status for record in fit.records)),
        "finite": True,
        "objective": max(record.objective for record in fit.records),
        "objective_floor": max(record.objective_floor for record in fit.records),
        "condition": pd.Series(conditions).max(),
        "seconds": sum(record.seconds for record in fit.records),
    }


def rows(model: str, starts: int, awls_iterations: int) -> Iterator[dict]:
    """All cases on MERL's grid, by one model and each solver."""
    methods = [method for name, method in runs() if name == model]
    for case, method in product(CASES, methods):
        cap = awls_iterations if method == "awls" else SolverSettings.max_iterations
        settings = SolverSettings(method or SolverSettings.method, max_iterations=cap)
        entry = row(case, CASES[case](), model, settings, starts) | {"solver": method}
        print(*entry.values(), file=sys.stderr, flush=True)
        yield entry


def gathered(paths: list[str]) -> pd.DataFrame:
    """Join tables, sorted by case."""
    table = pd.concat([pd.read_csv(path, keep_default_na=False) for path in paths])
    order = {case: place for place, case in enumerate(CASES)}
    return table.sort_values("case", key=lambda cases: cases.map(order), kind="stable")


def main() -> None:
    """Make the rows of one model, or gather those of several."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    verbs = parser.add_subparsers(dest="verb", required=True)
    fit = verbs.add_parser("fit", help="fit all cases by a model")
    fit.add_argument("model", choices=registry.non_parametric())
    fit.add_argument("--starts", type=int, required=True, help="of independent-g")
    fit.add_argument("--awls-iterations", type=int, required=True, help="cap on a start of awls")
    gather = verbs.add_parser("gather", help="join tables")
    gather.add_argument("tables", nargs="+")
    for verb in (fit, gather):
        verb.add_argument("-o", "--output", required=True, help="CSV to write")
    a = parser.parse_args()
    warnings.simplefilter("error")
    if a.verb == "gather":
        table = gathered(a.tables)
    else:
        table = pd.DataFrame(rows(a.model, a.starts, a.awls_iterations), columns=COLUMNS)
    tables.write(a.output, table)


if __name__ == "__main__":
    main()
