"""Tensor files of the RGL material database, written by hand for the tests that read them."""

import struct

import numpy as np

#: Numbers that stand for types in these files.
CODES = {"u1": 1, "u4": 5, "f4": 10, "f8": 11}


def tensor_file(arrays):
    """Bytes of a tensor file with some arrays, in order, each at a multiple of eight bytes."""
    arrays = {name: np.asarray(a) for name, a in arrays.items()}
    length = 18 + sum(13 + len(name) + 8 * a.ndim for name, a in arrays.items())
    head = struct.pack("<12sBBI", b"tensor_file", 1, 0, len(arrays))
    values = b""
    for name, a in arrays.items():
        values += b"\0" * (-(length + len(values)) % 8)
        head += struct.pack(f"<H{len(name)}s", len(name), name.encode())
        head += struct.pack("<HBQ", a.ndim, CODES[a.dtype.str[1:]], length + len(values))
        head += struct.pack(f"<{a.ndim}Q", *a.shape)
        values += a.tobytes()
    return head + values


def fields(rng, phi_i=(0.0,), elevations=4, nodes=9, scaled=1):
    """Fields of a measurement of random numbers, everywhere above 0."""
    light = len(phi_i), elevations
    arrays = {
        "phi_i": np.array(phi_i),
        "theta_i": np.linspace(0, np.pi / 2, elevations),
        "sigma": rng.uniform(0.2, 1, (3, 8)),
        "ndf": rng.uniform(0.1, 4, (4, 7)),
        "vndf": rng.uniform(0.1, 3, (*light, 12, 10)),
        "luminance": rng.uniform(0.1, 1, (*light, nodes, nodes)),
        "rgb": rng.uniform(0.1, 1, (*light, 3, nodes, nodes)),
    }
    single = {name: a.astype("<f4") for name, a in arrays.items()}
    plain = {
        "version": np.array([1, 0], "<u4"),
        "description": np.frombuffer(b"made up", "u1"),
        "jacobian": np.array([scaled], "u1"),
    }
    return single | plain


def of_brdf(brdf, elevations=9, nodes=65):
    """Fields of an isotropic material whose square is that of the half vectors themselves.

    `brdf` gives (3, n) of unit vectors to light and view, (n, 3) each, above the horizon.
    """
    x, y = np.meshgrid(np.linspace(0, 1, nodes), np.linspace(0, 1, nodes))
    theta_h, phi_h = x**2 * np.pi / 2, (2 * y - 1) * np.pi
    level = np.sin(theta_h)
    half = np.stack([level * np.cos(phi_h), level * np.sin(phi_h), np.cos(theta_h)], -1)
    theta_i = np.linspace(0, np.pi / 2, elevations)
    values = np.zeros((elevations, 3, nodes, nodes))
    for k, theta in enumerate(theta_i):
        light = np.array([np.sin(theta), 0, np.cos(theta)])
        view = 2 * (half @ light)[..., None] * half - light
        above = view[..., 2] > 0
        found = brdf(np.broadcast_to(light, view.shape)[above], view[above])
        values[k][:, above] = found * view[above][:, 2]
    made = {
        "phi_i": np.zeros(1),
        "theta_i": theta_i,
        "sigma": np.ones((2, 2)),
        "ndf": np.ones((2, 2)),
        "vndf": np.ones((1, elevations, 2, 2)),
        "rgb": values[None],
    }
    return {name: a.astype("<f4") for name, a in made.items()} | {"jacobian": np.zeros(1, "u1")}
