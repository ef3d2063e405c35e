"""What the target `factorisation` factors: the formulas of Lawrence et al. 2004 and materials."""

from dataclasses import dataclass

from npfm.papers import lawrence2004
from npfm.run.config import Run
from npfm.run.importance import plan as plan_importance
from npfm.run.words import option, path_word

#: Of the figures: what is factored for its steps, and by how many terms, as the paper's Figure 3.
STEPS = ("ward", ("--terms", "2x2", "--resolution", "12x16x48x48", "--recipe", "paper"))
#: Whose error is told by the number of terms (Figure 6), and the most terms.
TERMS = ("ward", ("--most", "4x5", "--resolution", "16x16x48x48"))
#: Formulas that are shown in the light of one direction, as in Figure 5.
SHOWN = ("cook-torrance", "ward")
#: How many materials are.
MOST_SHOWN = 2


@dataclass(frozen=True)
class Plan:
    """What the target makes.

    Parameters
    ----------
    run : Run
    materials : tuple of str
        Names of the materials; the run need not have them.
    """

    run: Run
    materials: tuple[str, ...]

    @property
    def folder(self) -> str:
        """Where all of it goes but tables and figures."""
        return f"{self.run.folder}/factorisation"

    def measured_inputs(self) -> list[str]:
        """What is measured of formulas and materials, one file each."""
        formulas = [name for name in lawrence2004.TABLE_1 if name not in lawrence2004.MATERIALS]
        names = [f"formulas/{name}" for name in formulas]
        names += [f"materials/{name}" for name in self.materials]
        return [f"{self.folder}/{name}.csv" for name in names]

    @property
    def shown(self) -> dict[str, str]:
        """What is shown in the light of one direction, by its name: a formula or a material."""
        theirs = [name for name in lawrence2004.MATERIALS if name in self.materials]
        materials = (theirs or list(self.materials))[:MOST_SHOWN]
        return dict.fromkeys(materials, "materials") | dict.fromkeys(SHOWN, "formulas")

    def source(self, kind: str, name: str) -> list[str]:
        """Files that are made before one is read."""
        return [self.run.table(name)] if kind == "materials" else []

    def word(self, kind: str, name: str) -> str:
        """Word of a command that names one."""
        return path_word(self.run.table(name)) if kind == "materials" else name

    def shown_inputs(self) -> list[str]:
        """Tables and factors of what is shown."""
        tables = [file for name, kind in self.shown.items() for file in self.source(kind, name)]
        return [*tables, *self.shown_factors()]

    def shown_factors(self) -> list[str]:
        """Factors of what is shown."""
        return [f"{self.folder}/{kind}/{name}.npz" for name, kind in self.shown.items()]

    @property
    def shown_options(self) -> list[str]:
        """Arguments of ``npfm figure point_light``."""
        sources = [self.word(kind, name) for name, kind in self.shown.items()]
        return [
            *option("--brdfs", sources),
            *option("--factors", self.shown_factors()),
            *option("--names", self.shown),
        ]

    def recipe(self, name: str) -> list[str]:
        """Arguments of ``npfm factor``: as printed."""
        row = lawrence2004.factored(name)
        return [
            *("--terms", "x".join(map(str, row.terms))),
            *("--resolution", "x".join(map(str, row.resolution))),
            *("--parameterisation", "half-vector" if row.half else "incident"),
            *("--recipe", "paper"),
        ]


def plan(run: Run) -> Plan:
    """Work out what to factor."""
    return Plan(run, plan_importance(run).materials)
