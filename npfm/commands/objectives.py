"""What is minimised and when to stop, on the command line of verbs that fit or weigh fits."""

import argparse

from npfm.commands.numbers import positive, whole
from npfm.fitting.objective import CELLS, Objective
from npfm.fitting.solvers.problem import SolverSettings


def add_objective(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments that `objective` reads."""
    parser.add_argument(
        "--max-angle",
        type=float,
        default=Objective.max_angle,
        help="largest theta_i and theta_o that count, in degrees (default: %(default)s)",
    )
    parser.add_argument(
        "--no-compressive", action="store_true", help="leave the compressive weight out"
    )
    parser.add_argument(
        "--cells",
        choices=CELLS,
        default=Objective.cells,
        help="how much a cell of the table counts: by the paper's volume form, or by the solid "
        "angles of light and view, for fits to look right (default: %(default)s)",
    )


def objective(arguments: argparse.Namespace) -> Objective:
    """Return the objective that the arguments name."""
    return Objective(not arguments.no_compressive, arguments.max_angle, arguments.cells)


def add_solver(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments that `solver` reads."""
    parser.add_argument(
        "--tolerance",
        type=positive,
        default=SolverSettings.tolerance,
        help="stop when an iteration lowers the objective by less than this share "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--max-iterations",
        type=whole(1),
        default=SolverSettings.max_iterations,
        help="cap on the iterations of one run (default: %(default)s)",
    )


def solver(arguments: argparse.Namespace) -> SolverSettings:
    """Return the settings that the arguments name."""
    return SolverSettings(tolerance=arguments.tolerance, max_iterations=arguments.max_iterations)
