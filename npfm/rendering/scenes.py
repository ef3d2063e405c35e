"""Scenes: which objects stand before the camera, and which effects are simulated.

The light is not part of a scene; any scene can be put in any light.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError, suggest
from npfm.rendering.camera import Camera
from npfm.rendering.effects import EFFECTS, check_effects
from npfm.rendering.geometry import Shape, Sphere

OBJECTS = ("figure", "sphere", "cloth")
#: Strategies that a scene is sampled by if it names no others.
STRATEGIES = ("light", "half-vector")
#: Far enough for a sphere of radius 1 to fill nine tenths of the field, and for a figure of
#: height 2 to do the same.
CAMERA = Camera(distance=4.4, field=np.radians(30))


@dataclass(frozen=True)
class Scene:
    """What is seen and what is simulated.

    Parameters
    ----------
    objects : tuple of str
        Of `OBJECTS`: the sphere alone fills the picture; beside the figure it is smaller and
        stands to the right of it. The cloth hangs behind the others, and before it a sphere is
        smaller too.
    effects : tuple of str
        Names of `npfm.rendering.effects.EFFECTS`; no others are simulated or paid for, nor those
        that `pointless` lists.
    mesh : Path or None
        The mesh of the figure; None stands for the project's own.

    Raises
    ------
    NpfmError
        If an object or an effect is unknown or named twice, or there is no object.
    """

    objects: tuple[str, ...]
    effects: tuple[str, ...] = ()
    mesh: Path | None = None

    def __post_init__(self) -> None:
        for name in self.objects:
            if name not in OBJECTS:
                raise NpfmError(f"unknown object '{name}' in a scene; {suggest(name, OBJECTS)}")
        if not self.objects or len(set(self.objects)) < len(self.objects):
            raise NpfmError(f"a scene needs one or more of {', '.join(OBJECTS)}, each once")
        check_effects(self.effects)

    @property
    def pointless(self) -> tuple[str, ...]:
        """Effects that it lists and that cannot change the picture.

        A sphere is convex: where light comes from above the horizon of a point, the sphere itself
        is not in the way, and no light of the sphere's own arrives.
        """
        if self.objects != ("sphere",):
            return ()
        effects = ((name, EFFECTS[name]) for name in self.effects)
        return tuple(name for name, effect in effects if effect.reaches or effect.bounces)

    @property
    def simulated(self) -> tuple[str, ...]:
        """Effects that it lists and that can change the picture."""
        return tuple(name for name in self.effects if name not in self.pointless)

    @property
    def built(self) -> tuple[str, ...]:
        """Simulated effects that the transport matrix has in it."""
        return tuple(name for name in self.simulated if not EFFECTS[name].bounces)

    @property
    def bounces(self) -> bool:
        """Whether light that bounces is added to its pictures."""
        return self.built != self.simulated

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line about each effect that is refused."""
        why = "changes nothing on a lone sphere and is left out; take it off the list"
        return tuple(f"effect '{name}' {why}" for name in self.pointless)


def camera_offsets(scene: Scene) -> NDArray[np.float64]:
    """Where camera rays pass through a pixel, in [0, 1), shape (rays, 2)."""
    offsets = np.array([[0.5, 0.5]])
    for name in scene.simulated:
        if film := EFFECTS[name].film:
            offsets = film(offsets)
    return offsets


def place(scene: Scene) -> tuple[Shape, ...]:
    """Make the objects of a scene, standing around the origin before `CAMERA`.

    Raises
    ------
    NpfmError
        If the mesh of the figure cannot be used.
    """
    figure, sphere, cloth = (name in scene.objects for name in OBJECTS)
    made: list[Shape] = []
    if figure:
        made += [_figure(scene.mesh, x=-0.47 if sphere else 0.0)]
    if sphere and figure:
        made += [Sphere((0.52, -0.58, 0.1), 0.42)]
    elif sphere:
        made += [Sphere((0.0, -0.2, 0.4), 0.55) if cloth else Sphere((0.0, 0.0, 0.0), 1.0)]
    if cloth:
        made += [_cloth(behind=len(made) > 0)]
    return tuple(made)


def _figure(path: Path | None, x: float) -> Shape:
    from npfm.rendering import mesh_files, meshes

    mesh = meshes.figure() if path is None else mesh_files.load_mesh(path)
    return meshes.standing(mesh, height=2.0, width=0.95, foot=(x, -1.0, 0.0))


def _cloth(*, behind: bool) -> Shape:
    from npfm.rendering import meshes

    # Alone it shows its hem; behind others it is larger than the field of the camera there.
    depth, size = (-1.0, 3.1) if behind else (0.0, 2.0)
    return meshes.standing(meshes.cloth(), size, size, (0.0, -size / 2, depth))
