"""The MERL materials as small neural networks, read from the public ``merl_nbrdf.zip``.

Sztrajman et al. 2021, "Neural BRDF Representation and Importance Sampling", repository
asztr/Neural-BRDF: for each material one Keras file with the layers 6-21-21-3.
"""

import io
import zipfile
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError, suggest
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import INVALID, Table

#: Inputs and outputs of the layers ``dense_1``, ``dense_2`` and ``dense_3``.
LAYERS = {"dense_1": (6, 21), "dense_2": (21, 21), "dense_3": (21, 3)}

Network = list[tuple[NDArray[np.float64], NDArray[np.float64]]]


def materials(archive: str | Path) -> list[str]:
    """Names of the networks in an archive, sorted.

    Raises
    ------
    NpfmError
        If the archive is absent, is not a zip, or holds no network.
    """
    with _open(archive) as opened:
        return sorted(_members(archive, opened))


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
        If the archive is absent, is not a zip, has no such material, or its layers differ.
    """
    with _open(archive) as opened:
        members = _members(archive, opened)
        if name not in members:
            raise NpfmError(
                f"{archive}: no network of a material '{name}'; {suggest(name, members)}"
            )
        content = opened.read(members[name])
    return Table(_evaluate(_network(content, f"{archive}: {members[name]}")))


def _open(archive: str | Path) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(archive)
    except FileNotFoundError:
        raise NpfmError(
            f"{archive}: no such file; get data/merl_nbrdf.zip from github.com/asztr/Neural-BRDF"
        ) from None
    except (zipfile.BadZipFile, OSError) as error:
        raise NpfmError(
            f"{archive}: cannot be read as a zip ({error}); download merl_nbrdf.zip again"
        ) from None


def _members(archive: str | Path, opened: zipfile.ZipFile) -> dict[str, str]:
    """Material name -> member of the archive."""
    paths = {PurePosixPath(member): member for member in opened.namelist()}
    members = {path.stem: member for path, member in paths.items() if path.suffix == ".h5"}
    if not members:
        raise NpfmError(f"{archive}: holds no network (*.h5); give merl_nbrdf.zip as published")
    return members


def _network(content: bytes, source: str) -> Network:
    """Kernel and bias of each layer; `source` names the file in messages."""
    import h5py  # 0.1 s, and a listing of the names does not need it

    try:
        with h5py.File(io.BytesIO(content)) as file:
            layers = [(file[f"{k}/{k}/kernel:0"][()], file[f"{k}/{k}/bias:0"][()]) for k in LAYERS]
    except (OSError, KeyError) as error:
        reason = str(error).strip("\"'")
        raise NpfmError(
            f"{source}: not a Keras file with the layers dense_1 to dense_3 ({reason}); "
            "use the published merl_nbrdf.zip"
        ) from None
    shapes = [kernel.shape for kernel, _ in layers]
    if shapes != list(LAYERS.values()) or any(b.shape != k.shape[1:] for k, b in layers):
        found = ", ".join("x".join(map(str, shape)) for shape in shapes)
        raise NpfmError(
            f"{source}: the layers are {found} where 6x21, 21x21, 21x3 are expected; "
            "use the published merl_nbrdf.zip"
        )
    return [(kernel.astype(np.float64), bias.astype(np.float64)) for kernel, bias in layers]


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
