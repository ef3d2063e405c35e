"""What the target `uniqueness` makes beside a run: fits whose starts are followed to their ends."""

from dataclasses import dataclass

from npfm.fitting import registry
from npfm.fitting.solvers.choice import module_of as solver_module
from npfm.run.basis import OBJECTIVE, told
from npfm.run.config import Run
from npfm.run.entries import Variant, listed
from npfm.run.provenance import command_code
from npfm.run.study import Study

#: Whose factors are compared, and whose singular values are looked at.
MODEL, BIVARIATE = "independent-g", "bivariate"
#: Share of the solver's tolerance: starts are compared on some of the samples to ten times what is
#: asked for, and what lies apart shall not be what has not arrived.
SHARPER = 0.1


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes."""

    name = "uniqueness"

    @property
    def followed(self) -> Variant:
        """The variant whose starts are followed."""
        return self.study.variants[MODEL]

    @property
    def follow_options(self) -> list[str]:
        """Arguments of ``npfm fit``; of one that is given twice, the last counts."""
        tolerance = SHARPER * float(self.run.config["solver"]["tolerance"])
        return [*self.followed.options, "--tolerance", f"{tolerance:g}"]

    @property
    def follow_code(self) -> str:
        """Digest of the code that follows the starts of a fit."""
        model, solver = registry.declared(MODEL).module, solver_module(self.followed.solver)
        return command_code("fit", model, solver, "npfm.fitting.iterations")

    def bivariate(self, material: str) -> str:
        """Fit of a material by the bivariate model: the run's, if that has it."""
        return self.fit(BIVARIATE, material)

    @property
    def measure_options(self) -> list[str]:
        """Arguments of ``npfm uniqueness measure`` but for its files."""
        return told(self.followed, OBJECTIVE)


def plan(run: Run) -> Plan:
    """Work out what to make: by the run's variants of the models' names, or else the models."""
    own = {e["name"]: e for e in listed(run.config) if e["name"] == e["model"]}
    return Plan(run, run.with_variants(own.get(name, name) for name in (MODEL, BIVARIATE)))
