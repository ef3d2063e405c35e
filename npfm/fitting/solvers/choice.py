"""Solvers by name. Each is imported when it is asked for."""

import importlib
from collections.abc import Callable
from functools import partial

from npfm.errors import NpfmError, suggest
from npfm.fitting.solvers.problem import Solver, SolverSettings

SOLVERS = ("gauss-newton", "awls")


def chosen(settings: SolverSettings, after_start: Callable[[], object] = lambda: None) -> Solver:
    """Return the solver that the settings name, with the settings applied.

    Parameters
    ----------
    settings : SolverSettings
    after_start : callable, optional
        Called whenever a run from a start has ended.

    Raises
    ------
    NpfmError
        If there is no solver of that name.
    """
    if settings.method not in SOLVERS:
        raise NpfmError(f"unknown solver '{settings.method}'; {suggest(settings.method, SOLVERS)}")
    module = importlib.import_module(module_of(settings.method))
    return partial(module.solve, settings=settings, after_start=after_start)


def module_of(name: str) -> str:
    """Full name of the module of a solver."""
    return f"npfm.fitting.solvers.{name.replace('-', '_')}"
