"""Our objects and lights as Mitsuba has them."""

from typing import Any

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from npfm.rendering.geometry import Mesh, Shape, Sphere
from npfm.rendering.lights.environment import Environment


def shape(item: Shape, bsdf: Any) -> Any:
    """Make what stands for an object in the dictionary of a scene."""
    if isinstance(item, Sphere):
        centre = [float(x) for x in item.centre]
        return {"type": "sphere", "center": centre, "radius": float(item.radius), "bsdf": bsdf}
    assert isinstance(item, Mesh), "scenes are of spheres and meshes"
    return mesh(item, bsdf)


def mesh(item: Mesh, bsdf: Any) -> Any:
    """Make a mesh with smooth normals, whichever way round its triangles are."""
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": bsdf})
    size = len(item.vertices), len(item.faces)
    made = mi.Mesh("mesh", *size, has_vertex_normals=True, props=properties)
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = np.ravel(item.vertices).astype(np.float32)
    parameters["vertex_normals"] = np.ravel(item.normals).astype(np.float32)
    parameters["faces"] = np.ravel(item.faces).astype(np.uint32)
    parameters.update()
    return made


def light(environment: Environment) -> dict[str, Any]:
    """Make an environment emitter with the energy of every texel of ours.

    Mitsuba interpolates between points, whose rows reach from pole to pole and whose first column
    is right of -z, and we have constant texels. Two columns of points in each texel, and a row in
    its middle and on its upper and lower edge, there with the mean of both texels, keep the energy.
    """
    texels = np.repeat(environment.radiance, 2, axis=1)
    texels = np.roll(texels, -environment.radiance.shape[1], axis=1)
    points = np.empty((2 * len(texels) + 1, *texels.shape[1:]))
    points[1::2] = texels
    points[2:-1:2] = (texels[1:] + texels[:-1]) / 2
    points[[0, -1]] = texels[[0, -1]]
    return {"type": "envmap", "bitmap": bitmap(points)}


def bitmap(pixels: NDArray) -> Any:
    """Make a picture of linear radiance."""
    return mi.Bitmap(np.ascontiguousarray(pixels, dtype=np.float32))
