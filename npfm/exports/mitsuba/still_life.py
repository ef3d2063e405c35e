"""A still life in a studio, for paths that bounce: five materials that see each other.

A cove, a bowl with two balls in it and one beside, a vase, and the project's knot on its pedestal,
under two large lamps and a dim sky. Lengths are those of the scenes: the figure is 2 high.
"""

from typing import Any

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from npfm.exports.mitsuba import shapes
from npfm.rendering import meshes
from npfm.rendering.camera import Camera
from npfm.rendering.geometry import Mesh, Shape, Sphere

Array = NDArray[np.float64]

#: What is of each of the five materials, in their order.
PARTS = ("cove", "bowl", "figure", "balls", "vase")
#: The camera looks down on the table from here, to there.
EYE, AIM, FIELD = (0.0, 2.6, 6.4), (0.05, 0.72, 0.0), np.radians(28)
#: Centre, half width, half height, and radiance of each lamp; it faces the table.
LAMPS = (
    ((-3.2, 4.0, 2.0), 1.3, 1.0, (9.0, 8.6, 8.0)),
    ((3.4, 3.2, 1.0), 0.8, 1.2, (6.0, 6.6, 7.5)),
)
SKY = (0.25, 0.27, 0.3)
#: Outlines from the foot to the rim and back inside, as (radius, height).
BOWL = ((0, 0), (0.3, 0), (0.34, 0.06), (0.62, 0.22), (0.82, 0.48), (0.87, 0.66), (0.82, 0.66))
BOWL_INSIDE = ((0.76, 0.5), (0.56, 0.27), (0.3, 0.13), (0, 0.1))
VASE = (
    (0, 0),
    (0.3, 0),
    (0.42, 0.3),
    (0.4, 0.7),
    (0.2, 1.1),
    (0.16, 1.35),
    (0.27, 1.6),
    (0.22, 1.6),
)
VASE_INSIDE = ((0.1, 1.3), (0, 1.2))


def parts() -> dict[str, tuple[Shape, ...]]:
    """Objects of each part."""
    figure = meshes.standing(meshes.figure(), height=2.0, width=0.95, foot=(-1.1, 0.0, -0.1))
    balls = (
        Sphere((0.42, 0.47, 0.5), 0.32),
        Sphere((0.78, 0.42, 0.12), 0.24),
        Sphere((-0.42, 0.24, 1.2), 0.24),
    )
    return {
        "cove": (_cove(),),
        "bowl": (_turned((*BOWL, *BOWL_INSIDE), (0.55, 0.0, 0.35)),),
        "figure": (figure,),
        "balls": balls,
        "vase": (_turned((*VASE, *VASE_INSIDE), (1.35, 0.0, -0.75)),),
    }


def world(bsdfs: dict[str, Any], *, lamps_sampled: bool) -> Any:
    """Make the scene.

    Parameters
    ----------
    bsdfs : dict
        Of each of `PARTS`.
    lamps_sampled : bool
        Whether paths look for the lamps at every point, or meet them by chance alone.
    """
    weight = 1.0 if lamps_sampled else 0.0
    made: dict[str, Any] = {"type": "scene"}
    for part, items in parts().items():
        made |= {f"{part}{k}": shapes.shape(item, bsdfs[part]) for k, item in enumerate(items)}
    for k, lamp in enumerate(LAMPS):
        made[f"lamp{k}"] = _lamp(*lamp, weight)
    made["sky"] = {"type": "constant", "radiance": _rgb(SKY), "sampling_weight": weight}
    # Mitsuba cannot do without any lamp to look for; this one is dark.
    made["dark"] = {"type": "point", "position": [0, 9, 0], "intensity": _rgb((0, 0, 0))}
    return mi.load_dict(made)


def rays(pixels: NDArray[np.int64], offsets: Array, resolution: int) -> tuple[Array, Array]:
    """Origins and directions of rays, each through a point of a pixel.

    Parameters
    ----------
    pixels : ndarray of int, shape (n,)
    offsets : ndarray, shape (n, 2)
        In [0, 1).
    resolution : int
        Pixels along one side.
    """
    row, column = np.divmod(pixels, resolution)
    place = (column + offsets[:, 0]), (row + offsets[:, 1])
    camera = Camera(0.0, FIELD)
    level = camera.directions(np.zeros(1, dtype=int), np.stack(place, axis=1) / resolution, 1)[0]
    back = np.subtract(EYE, AIM) / np.linalg.norm(np.subtract(EYE, AIM))
    right = np.cross([0.0, 1.0, 0.0], back)
    right /= np.linalg.norm(right)
    frame = np.stack([right, np.cross(back, right), back])
    return np.broadcast_to(EYE, level.shape), level @ frame


def _lamp(centre: Any, width: float, height: float, radiance: Any, weight: float) -> dict[str, Any]:
    pose = mi.ScalarTransform4f().look_at(list(centre), list(AIM), [0, 1, 0])
    return {
        "type": "rectangle",
        "to_world": pose @ mi.ScalarTransform4f().scale([width, height, 1]),
        "bsdf": {"type": "diffuse", "reflectance": _rgb((0, 0, 0))},
        "emitter": {"type": "area", "radiance": _rgb(radiance), "sampling_weight": weight},
    }


def _rgb(value: Any) -> dict[str, Any]:
    return {"type": "rgb", "value": list(value)}


def _cove() -> Mesh:
    """Make a floor that bends up into a wall behind the table."""
    bend = np.linspace(0, np.pi / 2, 24)
    z = np.concatenate([[6.0], -1.6 - 1.2 * np.sin(bend), [-2.8]])
    y = np.concatenate([[0.0], 1.2 - 1.2 * np.cos(bend), [6.0]])
    x = np.array([-6.0, 6.0])
    points = np.stack(np.broadcast_arrays(x, y[:, None], z[:, None]), axis=-1)
    return meshes.lattice_mesh(points, meshes.lattice(np.arange(points.size // 3).reshape(-1, 2)))


def _turned(outline: Any, foot: Any) -> Mesh:
    """Make a solid of revolution from the corners of its outline, smoothed between them."""
    corners = np.asarray(outline, dtype=float)
    steps = np.linspace(0, len(corners) - 1, 12 * len(corners))
    radius, height = (np.interp(steps, np.arange(len(corners)), c) for c in corners.T)
    smooth = np.hanning(15) / np.hanning(15).sum()
    radius, height = (np.convolve(np.pad(c, 7, "edge"), smooth, "valid") for c in (radius, height))
    radius[[0, -1]] = 0
    angle = np.linspace(0, 2 * np.pi, 96, endpoint=False)
    ring = [radius[:, None] * np.cos(angle), height[:, None], -radius[:, None] * np.sin(angle)]
    points = np.stack(np.broadcast_arrays(*ring), axis=-1) + np.asarray(foot)
    return meshes.lattice_mesh(points, meshes.quads(*points.shape[:2], closed=False))
