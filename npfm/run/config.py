"""The configuration of a run, checked, and what follows from it for the workflow's rules."""

import os
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jsonschema
import yaml

from npfm.datasets import merl_folder, neural, parameter_files, synthetic
from npfm.datasets.names import MERL_NAMES, select
from npfm.datasets.parameter_files import FitFile
from npfm.errors import NpfmError, suggest
from npfm.fitting import registry
from npfm.fitting.registry import Model
from npfm.fitting.solvers.choice import SOLVERS
from npfm.rendering.sampling import registry as sampling
from npfm.rendering.scenes import STRATEGIES, Scene
from npfm.run.provenance import digest

SCHEMA = Path(__file__).parents[2] / "workflow" / "schemas" / "config.schema.yaml"


@dataclass(frozen=True)
class Variant:
    """A model with the settings it is fitted with; `options` are those of ``npfm fit``.

    `published` is the file of a model whose parameters are read instead.
    """

    name: str
    model: str
    solver: str
    options: str
    published: str | None = None


@dataclass(frozen=True)
class Run:
    """A checked configuration.

    Parameters
    ----------
    config : mapping
        The configuration as Snakemake merged it.
    materials : tuple of str
        Names of the materials, sorted.
    variants : dict of str to Variant
        In the order of the configuration.
    missing : frozenset of (str, str)
        Variants and materials that there are no parameters of: such fits are not made.
    """

    config: Mapping[str, Any]
    materials: tuple[str, ...]
    variants: Mapping[str, Variant]
    missing: frozenset[tuple[str, str]] = frozenset()

    @property
    def folder(self) -> str:
        """Where the results go."""
        return f"results/{self.config['name']}"

    @property
    def scenes(self) -> tuple[str, ...]:
        """Names of the scenes."""
        return tuple(self.config["scenes"])

    @property
    def orders(self) -> list[str]:
        """Orders of Figure 8 that the variants allow: each is that of one variant."""
        orders = {"naive": "diffuseness", "independent-g": "error"}
        return [order for variant, order in orders.items() if variant in self.variants]

    @property
    def warnings(self) -> list[str]:
        """What is asked for and not done, one line each."""
        return [
            f"config: scenes/{name}: {warning}"
            for name, described in self.config["scenes"].items()
            for warning in _scene(described).warnings
        ]

    def variants_of(self, material: str) -> list[str]:
        """Names of the variants that there is a fit of for a material, in order."""
        return [name for name in self.variants if (name, material) not in self.missing]

    @property
    def fits(self) -> list[tuple[str, str]]:
        """All fits: material and variant."""
        return [(name, variant) for name in self.materials for variant in self.variants_of(name)]

    @property
    def missing_option(self) -> str:
        """Argument of ``npfm tables`` for the fits that there are not, if any."""
        pairs = [f"{variant}/{name}" for variant, name in sorted(self.missing)]
        return f"--missing {' '.join(pairs)}" if pairs else ""

    @property
    def colors_option(self) -> str:
        """Argument of the figures that draw variants in colours, if the run has its own."""
        pairs = [f"'{name}={color}'" for name, color in self.config["colors"].items()]
        return f"--colors {' '.join(pairs)}" if pairs else ""

    def user_file(self, path: str) -> str:
        """Return a path of the user's, relative ones starting from the key `data`."""
        return str(Path(self.config["data"]) / path)

    def material_inputs(self, name: str) -> list[str]:
        """Files that a material is made from."""
        dataset = self.config["dataset"]
        match dataset["kind"]:
            case "neural":
                return [self.user_file(dataset["path"])]
            case "merl":
                file = Path(self.user_file(dataset["path"])) / f"{name}.binary"
                return [str(file)] if file.exists() or "url" not in dataset else []
            case _:
                return []

    def material_options(self, name: str) -> str:
        """Arguments of ``npfm material`` for a material."""
        dataset = self.config["dataset"]
        if dataset["kind"] == "synthetic":
            return f"--synthetic {name}"
        path = self.user_file(dataset["path"])
        url = f" --url '{dataset['url']}'" if "url" in dataset else ""
        return f"--{dataset['kind']} {name} --from '{path}'{url}"

    def material_code(self) -> str:
        """Digest of the code that makes materials."""
        kind = self.config["dataset"]["kind"]
        module = "merl_folder" if kind == "merl" else kind
        entries = (f"npfm.datasets.{module}", "npfm.reflectance.merl")
        return digest(entries, ("npfm.commands.material",))

    def fit_code(self, variant: str) -> str:
        """Digest of the code that fits a variant: its model, and its solver if it uses one."""
        chosen = self.variants[variant]
        model = registry.declared(chosen.model)
        entries = [model.module, "npfm.fitting.fits", "npfm.reflectance.merl"]
        if model.solver:
            entries.append(f"npfm.fitting.solvers.{chosen.solver.replace('-', '_')}")
        return digest(tuple(entries), ("npfm.commands.fit",))

    def published_inputs(self, variant: str) -> list[str]:
        """Files that a variant reads published parameters from: one, or none."""
        published = self.variants[variant].published
        return [published] if published else []

    def render_code(self, variant: str) -> str:
        """Digest of the code that renders a variant, or the measurement."""
        entries = ["npfm.rendering.transport", "npfm.storage.pictures", "npfm.fitting.fits"]
        if variant in self.variants:
            entries.append(registry.declared(self.variants[variant].model).module)
        return digest(tuple(entries), ("npfm.commands.render", "npfm.commands.sources"))

    def light_code(self, name: str) -> str:
        """Digest of the code that makes a light."""
        kind = "formats" if "file" in self.config["lights"][name] else "generated"
        return digest((f"npfm.rendering.lights.{kind}",), ("npfm.commands.light",))

    def light_inputs(self, name: str) -> list[str]:
        """Files that a light is made from."""
        light = self.config["lights"][name]
        return [self.user_file(light["file"])] if "file" in light else []

    def light_options(self, name: str) -> str:
        """Arguments of ``npfm light`` for a light."""
        light = self.config["lights"][name]
        source = (
            f"'{self.user_file(light['file'])}' --layout {light['layout']}"
            if "file" in light
            else f"--generate {light['generate']}"
        )
        return f"{source} --height {self.config['light_height']}"

    def mesh(self, scene: str) -> list[str]:
        """The mesh of a scene's figure: one path, or none."""
        mesh = self.config["scenes"][scene].get("mesh")
        return [self.user_file(mesh)] if mesh else []

    def tone(self, scene: str) -> str:
        """Arguments of ``npfm render`` for the PNG of a scene."""
        described = self.config["scenes"][scene]
        return f"--exposure {described['exposure']} --gamma {described['gamma']}"

    def scene_options(self, scene: str) -> str:
        """Arguments of ``npfm scene`` for a scene."""
        described = self.config["scenes"][scene]
        effects = " ".join(_scene(described).simulated)
        return (
            f"--objects {' '.join(described['objects'])}"
            + (f" --effects {effects}" if effects else "")
            + "".join(f" --mesh '{mesh}'" for mesh in self.mesh(scene))
            + f" --resolution {self.config['resolution']} --samples {described['samples']}"
            + _sampling_options(described.get("sampling", {}))
        )

    def scene_code(self, scene: str) -> str:
        """Digest of the code that builds a scene, with the strategies that it is sampled by."""
        chosen = self.config["scenes"][scene].get("sampling", {}).get("strategies", STRATEGIES)
        entries = ("npfm.rendering.assembly", "npfm.rendering.transport", *sampling.modules(chosen))
        return digest(entries, ("npfm.commands.scene",))


def prefer_this_python() -> None:
    """Let jobs find the Python that runs the workflow first, its environment active or not."""
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])


def check(config: Mapping[str, Any]) -> Run:
    """Check a configuration and work out the materials and variants.

    Parameters
    ----------
    config : mapping
        The merged configuration.

    Raises
    ------
    NpfmError
        If a key is unknown or missing, a value is not allowed, or a name stands for nothing.
    """
    _check_schema(config)
    named = _variants(config)
    known = {**named, **registry.models()}
    if unknown := [name for name in config["colors"] if name not in known]:
        hint = suggest(unknown[0], known)
        raise NpfmError(f"config: colors: unknown variant '{unknown[0]}'; {hint}")
    for name, light in config["lights"].items():
        if ("generate" in light) == ("file" in light) or ("file" in light) != ("layout" in light):
            raise NpfmError(
                f"config: lights/{name} needs either 'generate', or 'file' and 'layout'"
            )
    for scene, described in config["scenes"].items():
        if described["light"] not in config["lights"]:
            hint = suggest(described["light"], config["lights"])
            raise NpfmError(
                f"config: scenes/{scene}/light: unknown light '{described['light']}'; {hint}"
            )
        _check_scene(scene, described)
    if (scene := config["accuracy_cost"]["scene"]) not in config["scenes"]:
        hint = suggest(scene, config["scenes"])
        raise NpfmError(f"config: accuracy_cost/scene: unknown scene '{scene}'; {hint}")
    materials = tuple(select(config["dataset"]["materials"], _available(config)))
    return Run(config, materials, named, _missing(named, materials))


def _check_schema(config: Mapping[str, Any]) -> None:
    schema = yaml.safe_load(SCHEMA.read_text())
    errors = jsonschema.Draft202012Validator(schema).iter_errors(config)
    error = jsonschema.exceptions.best_match(errors)
    if error is None:
        return
    where = "/".join(map(str, error.absolute_path)) or "top level"
    if error.validator == "additionalProperties":
        known = error.schema.get("properties", {})
        key = next(key for key in error.instance if key not in known)
        raise NpfmError(f"config: {where}: unknown key '{key}'; {suggest(key, known)}")
    raise NpfmError(f"config: {where}: {error.message}; see docs/configuration.md")


def _scene(described: Mapping[str, Any]) -> Scene:
    return Scene(tuple(described["objects"]), tuple(described["effects"]))


def _sampling_options(said: Mapping[str, Any]) -> str:
    """Arguments of ``npfm scene`` for what a scene says of its sampling, if anything."""
    strategies = " ".join(said.get("strategies", ()))
    return (f" --sampling {strategies}" if strategies else "") + (
        f" --power {said['power']}" if "power" in said else ""
    )


def _check_scene(name: str, described: Mapping[str, Any]) -> None:
    try:
        _scene(described)
        sampling.check_scene(described.get("sampling", {}).get("strategies", STRATEGIES))
    except NpfmError as error:
        raise NpfmError(f"config: scenes/{name}: {error}") from error


def _variants(config: Mapping[str, Any]) -> dict[str, Variant]:
    named: dict[str, Variant] = {}
    for entry in config["variants"]:
        entry = {"name": entry, "model": entry} if isinstance(entry, str) else entry
        try:
            model = registry.declared(entry["model"])
        except NpfmError as error:
            raise NpfmError(f"config: variants: {error}") from error
        if entry["name"] in named or entry["name"] == "measured":
            raise NpfmError(
                f"config: variants: the name '{entry['name']}' is taken; give this one another"
            )
        objective = config["objective"] | entry.get("objective", {})
        solver = config["solver"] | entry.get("solver", {})
        if solver["method"] not in SOLVERS:
            hint = suggest(solver["method"], SOLVERS)
            raise NpfmError(f"config: solver: unknown solver '{solver['method']}'; {hint}")
        published = _published_file(model, config)
        options = (
            f"--model {entry['model']} --solver {solver['method']}"
            f" --tolerance {solver['tolerance']} --max-iterations {solver['max_iterations']}"
            + _own_settings(entry, solver, model)
            + (f" --published {shlex.quote(published)}" if published else "")
            + f" --max-angle {objective['max_angle']}"
            + ("" if objective["compressive"] else " --no-compressive")
            + (f" --seed {config['seed']}" if model.random else "")
        )
        named[entry["name"]] = Variant(
            entry["name"], entry["model"], solver["method"], options, published
        )
    return named


def _own_settings(entry: Mapping[str, Any], solver: Mapping[str, Any], model: Model) -> str:
    """Arguments of ``npfm fit`` for what the model alone can be told."""
    known = ["name", "model", "objective", "solver", *model.settings]
    if unknown := [key for key in entry if key not in known]:
        hint = suggest(unknown[0], known)
        raise NpfmError(f"config: variants/{entry['name']}: unknown key '{unknown[0]}'; {hint}")
    given = {key: {**solver, **entry}.get(key) for key in model.settings}
    for key, value in given.items():
        words = model.settings[key]
        if isinstance(words, str) and not isinstance(value, int | None):
            raise NpfmError(f"config: variants/{entry['name']}/{key}: give a whole number")
        if not isinstance(words, str) and value is not None and value not in words:
            where, hint = f"config: variants/{entry['name']}/{key}", suggest(str(value), words)
            raise NpfmError(f"{where}: unknown {key} '{value}'; {hint}")
    return "".join(f" --{key} {value}" for key, value in given.items() if value is not None)


def _published_file(model: Model, config: Mapping[str, Any]) -> str | None:
    if not model.published:
        return None
    return str(Path(config["data"]) / config["published_fits"] / model.published["name"])


def _missing(named: Mapping[str, Variant], materials: Sequence[str]) -> frozenset[tuple[str, str]]:
    """Pairs of variant and material that a published file lacks."""
    missing = set()
    for variant in named.values():
        if variant.published:
            file = FitFile(**registry.declared(variant.model).published)
            there = parameter_files.read(variant.published, file)
            absent = {(variant.name, name) for name in materials if name not in there}
            if len(absent) == len(materials):
                raise NpfmError(
                    f"config: variants/{variant.name}: {variant.published} has none of the run's "
                    "materials; leave this variant out"
                )
            missing |= absent
    return frozenset(missing)


def _available(config: Mapping[str, Any]) -> list[str]:
    dataset = config["dataset"]
    if dataset["kind"] == "synthetic":
        return synthetic.materials()
    if "path" not in dataset:
        raise NpfmError(f"config: dataset: kind '{dataset['kind']}' needs a 'path'")
    path = Path(config["data"]) / dataset["path"]
    if dataset["kind"] == "neural":
        return neural.materials(path)
    if "url" in dataset:
        here = merl_folder.materials(path) if path.is_dir() else []
        return sorted({*MERL_NAMES, *here})
    return merl_folder.materials(path)
