"""Models and solvers by name. Each is imported when it is asked for."""

import difflib
from functools import partial
from types import ModuleType

from npfm.errors import NpfmError
from npfm.solvers.problem import Solve, Solver

#: Models in the order of the paper's Figure 8, best average first.
MODELS = ("bivariate", "independent-g", "g-from-d", "naive")
SOLVERS = ("gauss-newton", "awls")


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
        case _:
            raise unknown("model", name, MODELS)
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
            raise unknown("solver", settings.method, SOLVERS)
    return partial(module.solve, settings=settings)


def unknown(kind: str, name: str, known: tuple[str, ...]) -> NpfmError:
    """Return the error for a name that is not known, with the nearest ones that are."""
    near = difflib.get_close_matches(name, known, n=3, cutoff=0.4)
    hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}"
    return NpfmError(f"unknown {kind} '{name}'; {hint}")
