"""Which fits and pictures are made to see what accuracy costs, and where they are."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from npfm.fitting import registry
from npfm.fitting.solvers.choice import SOLVERS
from npfm.run.config import Run
from npfm.run.entries import listed
from npfm.run.study import Study

#: Whose starts, tolerance and traces are examined.
MODEL = "independent-g"
STARTS = range(1, 9)
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
#: Ways of sampling, by the name they have in tables and folders.
SAMPLINGS = {
    "light": ("light",),
    "half-vector": ("half-vector",),
    "combined": ("light", "half-vector"),
}
#: How many materials count if the run has none of those that the configuration names.
MOST_MATERIALS = 6


@dataclass(frozen=True)
class Plan(Study):
    """What the target `accuracy_cost` makes, beside what the run makes.

    Parameters
    ----------
    stages : dict of str to dict of str to str
        For each stage (``model``, ``starts``, ``tolerance``) the variant of each setting.
    materials : tuple of str
        In the order of the configuration.
    """

    name = "accuracy_cost"

    stages: Mapping[str, Mapping[str, str]]
    materials: tuple[str, ...]

    def settings(self, stage: str) -> dict[str, str]:
        """Folder of the fits of each setting of a stage."""
        folders = self.folders
        return {setting: folders[variant] for setting, variant in self.stages[stage].items()}

    @property
    def standard(self) -> str:
        """Folder of the fits of `MODEL` by the default solver."""
        return self.traced["gauss-newton"]

    @property
    def standard_modules(self) -> list[str]:
        """Modules of the model of these fits."""
        return [registry.declared(MODEL).module]

    @property
    def traced(self) -> dict[str, str]:
        """Folder of the fits of `MODEL` by each solver."""
        settings = self.settings("model")
        return {solver: settings[f"{MODEL}/{solver}"] for solver in SOLVERS}

    def fits(self, material: str) -> list[str]:
        """All fits of a material, without repetition."""
        return [f"{folder}/{material}.npz" for folder in dict.fromkeys(self.folders.values())]

    @property
    def fit_arguments(self) -> list[str]:
        """Arguments of ``npfm accuracy-cost fits`` that name the fits."""
        return [
            f"{stage}:{setting}={folder}"
            for stage in self.stages
            for setting, folder in self.settings(stage).items()
        ]

    @property
    def build_names(self) -> list[str]:
        """Last parts of the names of all scene folders; the last is the reference."""
        samples = self.run.config["accuracy_cost"]["samples"]
        return [*(f"{name}-{n}" for name in SAMPLINGS for n in samples), "reference"]

    @property
    def builds(self) -> list[str]:
        """Scene folders to compare, those of few samples first."""
        return [f"{self.folder}/scenes/{name}" for name in self.build_names[:-1]]

    @property
    def reference(self) -> str:
        """The scene folder to compare them with."""
        return f"{self.folder}/scenes/{self.build_names[-1]}"

    @property
    def scene(self) -> str:
        """Name of the scene whose sampling is examined."""
        return self.run.config["accuracy_cost"].get("scene", self.run.scenes[0])

    def scene_options(self, build: str) -> list[str]:
        """Arguments of ``npfm scene`` for the last part of the name of a scene folder.

        The reference has other random numbers than what is compared with it.
        """
        return self._scene_run(build).scene_options(self.scene)

    def scene_code(self, build: str) -> str:
        """Digest of the code that builds a scene folder."""
        return self._scene_run(build).scene_code(self.scene)

    def _scene_run(self, build: str) -> Run:
        """The run with the scene as it is built in a folder."""
        asked = self.run.config["accuracy_cost"]
        name, _, samples = build.rpartition("-")
        if build == "reference":
            name, samples = "combined", asked["reference_samples"]
        described = self.run.config["scenes"][self.scene]
        seed = described.get("seed", 1) + (build == "reference")
        sampling = described.get("sampling", {}) | {"strategies": SAMPLINGS[name]}
        changed = {"samples": samples, "seed": seed, "sampling": sampling}
        scenes = {self.scene: described | changed}
        changes = {"resolution": asked["resolution"], "scenes": scenes}
        return replace(self.run, config={**self.run.config, **changes})


def plan(run: Run) -> Plan:
    """Work out what to make."""
    stages = _stages(run.config)
    entries = [
        entry | {"name": _variant(stage, setting)}
        for stage, settings in stages.items()
        for setting, entry in settings.items()
    ]
    named = {
        stage: {setting: _variant(stage, setting) for setting in settings}
        for stage, settings in stages.items()
    }
    return Plan(run, run.with_variants(entries), named, materials(run))


def materials(run: Run) -> tuple[str, ...]:
    """Return the materials that the configuration names, or the run's first if it has none."""
    wanted = run.config["accuracy_cost"]["materials"]
    chosen = tuple(name for name in wanted if name in run.materials)
    return chosen or run.materials[:MOST_MATERIALS]


def _variant(stage: str, setting: str) -> str:
    return f"{stage}-{setting}".replace("/", "-")


def _stages(config: Mapping[str, Any]) -> dict[str, dict[str, dict]]:
    """For each stage and setting, an entry of the key `variants`."""
    models: dict[str, dict] = {}
    # What is published took no time here.
    fitted = [entry for entry in listed(config) if not registry.declared(entry["model"]).published]
    for entry in [{"name": MODEL, "model": MODEL}, *fitted]:
        models |= _by_solver(entry, config["accuracy_cost"]["awls_iterations"])
    return {
        "model": models,
        "starts": {str(n): _fast(starts=n) for n in STARTS},
        "tolerance": {f"{t:.0e}": _fast(solver={"tolerance": t}) for t in TOLERANCES},
    }


def _by_solver(entry: dict, awls_iterations: int) -> dict[str, dict]:
    """A variant by each solver, but for one that names its own or needs none."""
    solver = entry.get("solver", {})
    if not registry.declared(entry["model"]).solver:
        return {entry["name"]: entry}
    if "method" in solver:
        return {f"{entry['name']}/{solver['method']}": entry}
    caps = {"awls": {"max_iterations": awls_iterations}}
    return {
        f"{entry['name']}/{name}": entry
        | {"solver": {**solver, "method": name, **caps.get(name, {})}}
        for name in SOLVERS
    }


def _fast(solver: Mapping[str, Any] | None = None, **own: int) -> dict:
    return {"model": MODEL, "solver": {"method": "gauss-newton", **(solver or {})}, **own}
