"""Models and solvers by name. Each is imported when it is asked for."""

from functools import partial
from types import ModuleType

from npfm.errors import NpfmError, suggest
from npfm.solvers.problem import Solve, Solver

#: Models in the order of the paper's Figure 8, best average first, then those beyond the paper.
MODELS = ("bivariate", "independent-g", "g-from-d", "naive", "bivariate-g", "low-rank-b")
SOLVERS = ("gauss-newton", "awls")
#: Settings that single models have: keywords of their `fit`.
SETTINGS = {"independent-g": "starts", "low-rank-b": "rank"}
#: Models whose minimum needs no solver.
CLOSED_FORM = ("bivariate",)


def model(name: str) -> ModuleType:
    """Return the module of a model: `fit`, `tabulate` and `parameter_count`.

    Raises
    ------
    NpfmError
        If there is no model of that name.
    """
    match name:
        case "bivariate":
            from npfm.models import bivariate as module
        case "independent-g":
            from npfm.models import independent_g as module
        case "g-from-d":
            from npfm.models import g_from_d as module
        case "naive":
            from npfm.models import naive as module
        case "bivariate-g":
            from npfm.models import bivariate_g as module
        case "low-rank-b":
            from npfm.models import low_rank_b as module
        case _:
            raise NpfmError(f"unknown variant '{name}'; {suggest(name, MODELS)}")
    return module


def solver(settings: Solver) -> Solve:
    """Return the solver that the settings name, with the settings applied.

    Raises
    ------
    NpfmError
        If there is no solver of that name.
    """
    match settings.method:
        case "gauss-newton":
            from npfm.solvers import gauss_newton as module
        case "awls":
            from npfm.solvers import awls as module
        case _:
            raise NpfmError(
                f"unknown solver '{settings.method}'; {suggest(settings.method, SOLVERS)}"
            )
    return partial(module.solve, settings=settings)
