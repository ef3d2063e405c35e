"""Directions over a surface with the normal z, by their angles, one path at a time."""

from typing import Any

import drjit as dr
import mitsuba as mi


def elevation(direction: Any) -> Any:
    """Angle with the normal, exact where it is small; `direction` may be of any length."""
    level = dr.sqrt(dr.square(direction.x) + dr.square(direction.y))
    return dr.atan2(level, direction.z)


def azimuth_between(view: Any, light: Any) -> Any:
    """Azimuth of a light direction from the view's, in [-pi, pi]."""
    x, y = _heading(view)
    return dr.atan2(x * light.y - y * light.x, x * light.x + y * light.y)


def turned(view: Any, z: Any, level: Any, azimuth: Any) -> Any:
    """Direction of a height and a length along the surface, its azimuth counted from the view's."""
    x, y = _heading(view)
    sine, cosine = dr.sincos(azimuth)
    return mi.Vector3f(level * (x * cosine - y * sine), level * (y * cosine + x * sine), z)


def mirrored(view: Any, square: Any, azimuth: Any) -> Any:
    """Light that half vectors, given by the squared sine of theta_h, mirror to the view."""
    half = turned(view, dr.safe_sqrt(1 - square), dr.sqrt(square), azimuth)
    return 2 * dr.dot(half, view) * half - view


def _heading(view: Any) -> tuple[Any, Any]:
    """Unit vector along the surface below the view; looking straight down, any."""
    level = dr.sqrt(dr.square(view.x) + dr.square(view.y))
    steep = level < 1e-7
    safe = dr.select(steep, 1.0, level)
    return dr.select(steep, 1.0, view.x / safe), dr.select(steep, 0.0, view.y / safe)
