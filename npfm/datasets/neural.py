"""The MERL materials as small neural networks, read from the public ``merl_nbrdf.zip``.

Sztrajman et al. 2021, "Neural BRDF Representation and Importance Sampling", repository
asztr/Neural-BRDF: for each material one Keras file with the layers 6-21-21-3.
"""

import io
import zipfile
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError, suggest
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import INVALID, Table
from npfm.storage.archives import opened, read_member

#: Inputs and outputs of the layers ``dense_1``, ``dense_2`` and ``dense_3``.
LAYERS = {"dense_1": (6, 21), "dense_2": (21, 21), "dense_3": (21, 3)}

#: Such a file has 19 KB, of which 2.7 are weights. Nothing larger is unpacked.
MEMBER_BYTES = 2**20
WHAT = "the zip of the neural materials"
ORIGIN = "get data/merl_nbrdf.zip from github.com/asztr/Neural-BRDF"

Network = list[tuple[NDArray[np.float64], NDArray[np.float64]]]


def materials(archive: str | Path) -> list[str]:
    """Names of the networks in an archive, sorted.

    Raises
    ------
    NpfmError
        If the archive is absent, is not a zip, or holds no network.
    """
    with opened(archive, WHAT, ORIGIN) as networks:
        return sorted(_members(archive, networks))


def load(archive: str | Path, name: str) -> Table:
    """Evaluate the network of a material at the cell centres of the MERL grid.

    Parameters
    ----------
    archive : str or Path
        The zip, as published.
    name : str
        A name out of ``materials(archive)``.

    Returns
    -------
    Table
        BRDF in 1/sr, `INVALID` below the horizon. The networks' last step, exp(x) - 1, may end
        slightly below 0 where the material is black; such values become 0, since negative would
        mean "not measured".

    Raises
    ------
    NpfmError
        If the archive is absent, is not a zip, has no such material, or the network is damaged,
        has other layers, or gives no finite reflectance.
    """
    with opened(archive, WHAT, ORIGIN) as networks:
        members = _members(archive, networks)
        if name not in members:
            raise NpfmError(
                f"{archive}: no network of a material '{name}'; {suggest(name, members)}"
            )
        content = read_member(networks, members[name], MEMBER_BYTES)
    source = f"{archive}: {members[name].filename}"
    network = _network(content, source)
    with np.errstate(over="ignore", invalid="ignore"):
        values = _evaluate(network)
    if not np.isfinite(values).all():
        raise NpfmError(f"{source}: it gives reflectances that are not finite; leave it out")
    return Table(values)


def _members(archive: str | Path, networks: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Member of the archive by material; folders, and what macOS packs beside files, are none."""
    members: dict[str, zipfile.ZipInfo] = {}
    for member in networks.infolist():
        path = PurePosixPath(member.filename.replace("\\", "/"))
        if member.is_dir() or path.name.startswith(".") or path.suffix.lower() != ".h5":
            continue
        if path.stem in members:
            raise NpfmError(
                f"{archive}: two networks of a material '{path.stem}', "
                f"{members[path.stem].filename} and {member.filename}; keep one of them"
            )
        members[path.stem] = member
    if not members:
        raise NpfmError(f"{archive}: holds no network (*.h5); give merl_nbrdf.zip as published")
    return members


def _network(content: bytes, source: str) -> Network:
    """Kernel and bias of each layer; `source` names the file in messages."""
    import h5py  # 0.1 s, and a listing of the names does not need it

    try:
        with h5py.File(io.BytesIO(content)) as file:
            return [(_weights(file, k, "kernel"), _weights(file, k, "bias")) for k in LAYERS]
    # A damaged file is met with whatever exception comes up in the depths of HDF5.
    except Exception as error:
        reason = " ".join(str(error).split()).strip("\"'")
        raise NpfmError(
            f"{source}: not a Keras file with the layers dense_1 to dense_3 ({reason}); "
            "use the published merl_nbrdf.zip"
        ) from None


def _weights(file: Any, layer: str, part: str) -> NDArray[np.float64]:
    """One array of a layer, its shape and type checked before anything is read."""
    stored = file[f"{layer}/{layer}/{part}:0"]
    expected = LAYERS[layer] if part == "kernel" else LAYERS[layer][1:]
    shape = getattr(stored, "shape", None)
    if shape != expected or stored.dtype.kind != "f":
        raise ValueError(f"the {part} of {layer} is {shape} where {expected} is expected")
    weights = stored[()].astype(np.float64)
    if not np.isfinite(weights).all():
        raise ValueError(f"the {part} of {layer} holds a NaN or an infinity")
    return weights


def _evaluate(network: Network) -> NDArray[np.float64]:
    """BRDF on the MERL grid, shape (3, 90, 90, 180)."""
    (kernel_1, bias_1), (kernel_2, bias_2), (kernel_3, bias_3) = network
    theta_d, phi_d = MERL.theta_d[:, None], MERL.phi_d
    difference_vector = np.stack(
        np.broadcast_arrays(
            np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)
        ),
        axis=-1,
    )
    # The first layer is linear in half and difference vector, so their shares simply add.
    share = difference_vector @ kernel_1[3:] + bias_1
    values = np.full((3, *MERL.shape), INVALID)
    for h, theta_h in enumerate(MERL.theta_h):
        above = MERL.above_horizon[h]
        half_vector = np.array([np.sin(theta_h), 0.0, np.cos(theta_h)])
        hidden = np.maximum(share[above] + half_vector @ kernel_1[:3], 0)
        hidden = np.maximum(hidden @ kernel_2 + bias_2, 0)
        values[:, h, above] = np.maximum(np.expm1(hidden @ kernel_3 + bias_3), 0).T
    return values
