"""The configuration of a run, checked, and what follows from it for the workflow's rules."""

import os
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from npfm.datasets.names import matching
from npfm.errors import NpfmError, suggest
from npfm.exports import registry as exports
from npfm.fitting import registry
from npfm.fitting.solvers.choice import module_of as solver_module
from npfm.reflectance.grids import Grid
from npfm.reflectance.half_difference import MERL
from npfm.rendering.sampling import registry as sampling
from npfm.rendering.scenes import STRATEGIES, Scene
from npfm.run import datasets
from npfm.run.entries import Variant, missing_fits, read_variants
from npfm.run.formats import wanted
from npfm.run.names import check_names
from npfm.run.provenance import command_code
from npfm.run.schema import check_schema, settled
from npfm.run.words import as_input, option, path_word

ONLY_HALF_DIFFERENCE = (
    "config: dataset: on a directional grid there is no Figure 3, and no target accuracy_cost, "
    "basis, blends, bounces, effects, exports, factorisation, importance, perception, psnr_level, "
    "shared_lobes, uniqueness, video or where: they are of theta_h, or for isotropic tables alone"
)
#: The model that has one D, F and G a channel, whose fits `npfm blends` takes.
BLENDED = "independent-g"


@dataclass(frozen=True)
class Run:
    """A checked configuration.

    Parameters
    ----------
    config : mapping
        What is left of the one that Snakemake merged (`npfm.run.schema.settled`).
    materials : tuple of str
        Names of the materials, sorted.
    variants : dict of str to Variant
        In the order of the configuration.
    missing : frozenset of (str, str)
        Variants and materials that there are no parameters of: such fits are not made.
    grid : Grid
        Of all tables.
    """

    config: Mapping[str, Any]
    materials: tuple[str, ...]
    variants: Mapping[str, Variant]
    missing: frozenset[tuple[str, str]] = frozenset()
    grid: Grid = MERL

    def with_variants(self, entries: Iterable[str | Mapping[str, Any]]) -> "Run":
        """Return the same run with other variants.

        Parameters
        ----------
        entries : iterable of str or mapping
            As the key `variants` has them.

        Raises
        ------
        NpfmError
            If they cannot be read, fitted on the run's grid, or found where they are published.
        """
        config = {**self.config, "variants": list(entries)}
        named = read_variants(config)
        _check_grid(named, self.grid)
        missing = missing_fits(named, self.materials)
        return replace(self, config=config, variants=named, missing=missing)

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
        ] + [ONLY_HALF_DIFFERENCE] * self.grid.anisotropic

    def priority(self, wildcards: Mapping[str, str], usual: int) -> int:
        """Priority of a job: those of the first material come before all others, 0 to 3."""
        return usual + 4 * (wildcards.get("material") == self.materials[0])

    def table(self, name: str) -> str:
        """Return where the table of a material is."""
        end = ".bin" if self.grid.anisotropic else ".binary"
        return f"{self.folder}/materials/{name}{end}"

    @property
    def grid_options(self) -> list[str]:
        """Argument of ``npfm scene`` for the grid, unless that is the usual one."""
        return ["--grid", *self.grid.name.split()] if self.grid != MERL else []

    def variants_of(self, material: str) -> list[str]:
        """Names of the variants that there is a fit of for a material, in order."""
        return [name for name in self.variants if (name, material) not in self.missing]

    @property
    def fits(self) -> list[tuple[str, str]]:
        """All fits: material and variant."""
        return [(name, variant) for name in self.materials for variant in self.variants_of(name)]

    @property
    def has_demo(self) -> bool:
        """Whether a variant is of a model that the demo of the gallery renders."""
        shown = exports.declared("glsl").models
        models = {variant.model for variant in self.variants.values()}
        return not self.grid.anisotropic and not models.isdisjoint(shown)

    @property
    def demo_option(self) -> list[str]:
        """Argument of ``npfm gallery`` for pages that link to the demo, if there is one."""
        return ["--demo"] if self.has_demo else []

    @property
    def demo_tables(self) -> list[str]:
        """Materials whose measured tables the demo has."""
        return matching(self.config["gallery"]["measured"] if self.has_demo else [], self.materials)

    @property
    def demo_figure(self) -> list[str]:
        """The first scene that has a figure, which is that of the demo: one, or none."""
        scenes = self.config["scenes"].items() if self.has_demo else ()
        return [name for name, scene in scenes if "figure" in scene["objects"]][:1]

    @property
    def missing_option(self) -> list[str]:
        """Argument of ``npfm tables`` for the fits that there are not, if any."""
        return option("--missing", (f"{variant}/{name}" for variant, name in sorted(self.missing)))

    @property
    def spheres(self) -> list[str]:
        """Scenes that show nothing but a sphere."""
        scenes = self.config["scenes"].items()
        return [name for name, scene in scenes if scene["objects"] == ["sphere"]]

    @property
    def where_options(self) -> list[str]:
        """Arguments of ``npfm tables where`` for the pictures and the objective."""
        objective = self.config["objective"]
        return [
            *option("--spheres", self.spheres),
            *("--max-angle", f"{objective['max_angle']}"),
            *([] if objective["compressive"] else ["--no-compressive"]),
            *(["--cells", objective["cells"]] if "cells" in objective else []),
        ]

    @property
    def colors_option(self) -> list[str]:
        """Argument of the figures that draw variants in colours, if the run has its own."""
        colors = self.config["colors"].items()
        return option("--colors", (f"{name}={color}" for name, color in colors))

    def user_file(self, path: str) -> str:
        """Return a path of the user's, relative ones starting from the key `data`."""
        return str(Path(self.config["data"]) / path)

    @property
    def published_factors(self) -> list[str]:
        """The file of the factors that the paper's authors published: one path, or none."""
        path = self.config.get("published_factors")
        return [self.user_file(path)] if path else []

    @property
    def opinions(self) -> list[str]:
        """The folder of what people said of pictures of fits: one path, or none."""
        path = self.config.get("perceptual")
        return [self.user_file(path)] if path else []

    @property
    def dataset_option(self) -> list[str]:
        """Argument of ``npfm reproduction`` for where the tables are from."""
        kind = str(self.config["dataset"]["kind"])
        turned = "-anisotropic" if kind == "rgl" and self.grid.anisotropic else ""
        return ["--dataset", f"{kind}{turned}"]

    def material_inputs(self, name: str) -> list[str]:
        """Files that a material is made from."""
        dataset = self.config["dataset"]
        match dataset["kind"]:
            case "neural":
                return [as_input(self.user_file(dataset["path"]))]
            case "utia" | "rgl" as kind:
                end = {"utia": ".bin", "rgl": ".bsdf"}[kind]
                return [as_input(str(Path(self.user_file(dataset["path"])) / f"{name}{end}"))]
            case "merl":
                # With a url, the same before and after a download; whoever reads the table sees a
                # change of the file through the link.
                file = Path(self.user_file(dataset["path"])) / f"{name}.binary"
                return [] if "url" in dataset else [as_input(str(file))]
            case _:
                return []

    def material_options(self, name: str) -> list[str]:
        """Arguments of ``npfm material`` for a material."""
        dataset = self.config["dataset"]
        shape = ["--shape", dataset["shape"]] if "shape" in dataset else []
        if dataset["kind"] in datasets.MADE:
            seed = ["--seed", f"{dataset['seed']}"] if "seed" in dataset else []
            return [f"--{dataset['kind']}", name, *seed, *shape]
        url = ["--url", dataset["url"]] if "url" in dataset else []
        path = path_word(self.user_file(dataset["path"]))
        return [f"--{dataset['kind']}", name, "--from", path, *url, *shape]

    def material_code(self) -> str:
        """Digest of the code that makes materials."""
        return command_code(f"material {self.config['dataset']['kind']}")

    def fit_code(self, variant: str) -> str:
        """Digest of the code that fits a variant: its model, and its solver if it uses one."""
        chosen = self.variants[variant]
        model = registry.declared(chosen.model)
        solver = [solver_module(chosen.solver)] if model.solver else []
        return command_code("fit", model.module, *solver)

    def published_inputs(self, variant: str) -> list[str]:
        """Files that a variant reads published parameters from: one, or none."""
        published = self.variants[variant].published
        return [as_input(published)] if published else []

    def model_modules(self, *names: str) -> list[str]:
        """Modules of the models of some variants."""
        return sorted({registry.declared(self.variants[name].model).module for name in names})

    def render_code(self, variant: str) -> str:
        """Digest of the code that renders a variant, or the measurement."""
        fitted = [variant] if variant in self.variants else []
        return command_code("render", *self.model_modules(*fitted))

    def light_code(self, name: str) -> str:
        """Digest of the code that makes a light."""
        kind = "file" if "file" in self.config["lights"][name] else "generate"
        return command_code(f"light {kind}")

    def light_inputs(self, name: str) -> list[str]:
        """Files that a light is made from."""
        light = self.config["lights"][name]
        return [as_input(self.user_file(light["file"]))] if "file" in light else []

    def light_options(self, name: str) -> list[str]:
        """Arguments of ``npfm light`` for a light."""
        light = self.config["lights"][name]
        source = (
            [path_word(self.user_file(light["file"])), "--layout", light["layout"]]
            if "file" in light
            else ["--generate", light["generate"]]
        )
        return [*source, "--height", f"{self.config['light_height']}"]

    def mesh(self, scene: str) -> list[str]:
        """Files that the figure of a scene is made from: one, or none."""
        mesh = self.config["scenes"][scene].get("mesh")
        return [as_input(self.user_file(mesh))] if mesh else []

    def mesh_option(self, scene: str) -> list[str]:
        """Argument that names the mesh of the figure of a scene, if it has one of its own."""
        mesh = self.config["scenes"][scene].get("mesh")
        return ["--mesh", path_word(self.user_file(mesh))] if mesh else []

    def light(self, scene: str) -> str:
        """The light of a scene, as a file of the run."""
        return f"{self.folder}/lights/{self.config['scenes'][scene]['light']}.exr"

    def tone_options(self, *scenes: str) -> list[str]:
        """Arguments of ``npfm render`` for the PNGs of some scenes."""
        described = [self.config["scenes"][name] for name in scenes]
        return [
            *option("--exposure", (f"{scene['exposure']}" for scene in described)),
            *option("--gamma", (f"{scene['gamma']}" for scene in described)),
        ]

    @property
    def tones(self) -> list[str]:
        """Scenes as ``npfm gallery`` takes them, each with how its pictures are shown."""
        scenes = self.config["scenes"].items()
        return [f"{name}={scene['exposure']},{scene['gamma']}" for name, scene in scenes]

    def scene_options(self, scene: str) -> list[str]:
        """Arguments of ``npfm scene`` for a scene."""
        described = self.config["scenes"][scene]
        sampled = described.get("sampling", {})
        return [
            *("--objects", *described["objects"]),
            *option("--effects", _scene(described).built),
            *self.mesh_option(scene),
            *self.grid_options,
            *("--resolution", f"{self.config['resolution']}"),
            *("--samples", f"{described['samples']}"),
            *(["--seed", f"{described['seed']}"] if "seed" in described else []),
            *option("--sampling", sampled.get("strategies", [])),
            *(["--power", f"{sampled['power']}"] if "power" in sampled else []),
        ]

    @property
    def bouncing(self) -> list[str]:
        """Names of the scenes that list light that bounces."""
        return [name for name, scene in self.config["scenes"].items() if _scene(scene).bounces]

    def bounced(self, rendered: Mapping[str, str], folder: str | None = None) -> list[str]:
        """Light that bounces in the scenes that list it, as a file for each, in order.

        Parameters
        ----------
        rendered : mapping of str to str
            The material and variant; without a variant, it is the measurement.
        folder : str, optional
            Of a study with variants of its own.
        """
        name = f"{rendered['material']}/{rendered.get('variant', 'measured')}"
        return [f"{folder or self.folder}/bounced/{scene}/{name}.exr" for scene in self.bouncing]

    def bounced_option(self, files: Iterable[str]) -> list[str]:
        """Argument of ``npfm render`` for these files, or for none of them."""
        pairs = zip(self.bouncing, files, strict=False)
        return option("--bounced", (f"{self.folder}/scenes/{s}={file}" for s, file in pairs))

    def bounced_options(self, scene: str) -> list[str]:
        """Arguments of ``npfm interreflect`` for a scene."""
        described = self.config["scenes"][scene]
        return [
            *("--objects", *described["objects"]),
            *option("--effects", _scene(described).built),
            *self.mesh_option(scene),
            *("--resolution", f"{self.config['resolution']}"),
            *(["--paths", f"{described['paths']}"] if "paths" in described else []),
            *(["--seed", f"{described['seed']}"] if "seed" in described else []),
        ]

    def bounced_code(self, *variants: str) -> str:
        """Digest of the code that renders light that bounces off a variant, or the measurement."""
        fitted = [name for name in variants if name in self.variants]
        return command_code("interreflect", *self.model_modules(*fitted))

    def scene_code(self, scene: str) -> str:
        """Digest of the code that builds a scene, with the strategies that it is sampled by."""
        chosen = self.config["scenes"][scene].get("sampling", {}).get("strategies", STRATEGIES)
        return command_code("scene", *sampling.modules(chosen))


def prefer_this_python() -> None:
    """Let jobs find the Python and the npfm that run the workflow, wherever they run it."""
    for variable, folder in (
        ("PATH", Path(sys.executable).parent),
        ("PYTHONPATH", Path(__file__).parents[2]),
    ):
        others = os.environ.get(variable)
        os.environ[variable] = os.pathsep.join([str(folder), *([others] if others else [])])


def check(config: Mapping[str, Any]) -> Run:
    """Check a configuration and work out the materials and variants.

    Parameters
    ----------
    config : mapping
        As Snakemake merged it, so that what is laid over another may say ``null``.

    Raises
    ------
    NpfmError
        If a key is unknown or missing, a value is not allowed, or a name stands for nothing.
    """
    config = settled(config)
    check_schema(config)
    check_names([config["name"]], "run")
    check_names(config["lights"], "light")
    check_names(config["scenes"], "scene")
    if "all" in config["scenes"]:
        raise NpfmError("config: scenes/all: tables have a row 'all' for the mean; rename it")
    named = read_variants(config)
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
    for key in ("accuracy_cost", "blends", "video"):
        scene = config[key].get("scene")
        if scene is not None and scene not in config["scenes"]:
            hint = suggest(scene, config["scenes"])
            raise NpfmError(f"config: {key}/scene: unknown scene '{scene}'; {hint}")
    if unknown := [name for name in config["video"]["variants"] if name not in known]:
        hint = suggest(unknown[0], known)
        raise NpfmError(f"config: video/variants: unknown variant '{unknown[0]}'; {hint}")
    blended = config["blends"]["variant"]
    model = named[blended].model if blended in named else blended
    if model != BLENDED:
        raise NpfmError(
            f"config: blends/variant: '{blended}' has no D, F and G to be blended; give {BLENDED} "
            "or a variant of it"
        )
    for name in config["importance"].get("lights", []):
        if name not in config["lights"]:
            hint = suggest(name, config["lights"])
            raise NpfmError(f"config: importance/lights: unknown light '{name}'; {hint}")
    materials = datasets.chosen(config)
    grid = datasets.grid(config, materials)
    _check_grid(named, grid)
    for scene, described in config["scenes"].items():
        if grid.anisotropic and _scene(described).bounces:
            raise NpfmError(
                f"config: scenes/{scene}: interreflection is for tables on a half-difference grid; "
                "take it off the list"
            )
    missing = missing_fits(named, materials)
    wanted(config, named)
    return Run(config, materials, named, missing, grid)


def _check_grid(named: Mapping[str, Variant], grid: Grid) -> None:
    for name, variant in named.items():
        try:
            registry.check_grid(variant.model, grid.kind)
        except NpfmError as error:
            raise NpfmError(f"config: variants/{name}: {error}") from error


def _scene(described: Mapping[str, Any]) -> Scene:
    return Scene(tuple(described["objects"]), tuple(described["effects"]))


def _check_scene(name: str, described: Mapping[str, Any]) -> None:
    try:
        _scene(described)
        sampling.check_scene(described.get("sampling", {}).get("strategies", STRATEGIES))
    except NpfmError as error:
        raise NpfmError(f"config: scenes/{name}: {error}") from error
