"""How noisy paths are through the still life, by what chooses their directions: a table."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.storage.files import Kind, marked
from npfm.storage.names import distinct
from npfm.storage.pictures import read_exr_parts

RECORD = Kind("a record of paths", ".json", marked(b'"paths"', b'"seconds_paths"'))
COLUMNS = (
    "sampler", "paths", "seconds", "n_var", "n_var_error", "times", "times_by_seconds",
    "rms", "seconds_paths", "seconds_rms", "reference_rms",
)  # fmt: skip

Array = NDArray[np.float64]


def read(path: str) -> tuple[dict[str, NDArray], dict]:
    """Read pictures of ``npfm bounces render``, and the record beside them.

    Raises
    ------
    NpfmError
        If one of them is missing or damaged.
    """
    parts, beside = read_exr_parts(path), Path(path).with_suffix(".json")
    try:
        record = json.loads(beside.read_text())
        record = {key: float(record[key]) for key in ("paths", "seconds", "seconds_paths")}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NpfmError(f"{beside}: cannot be read ({error}); render again") from error
    if missing := {"samples", "variance"} - set(parts):
        raise NpfmError(f"{path}: no picture '{missing.pop()}' in it; render again")
    return {name: part[..., :3].astype(float) for name, part in parts.items()}, record


def table(reference: str, pictures: Sequence[str]) -> pd.DataFrame:
    """Compare samplers with each other and with the reference.

    Parameters
    ----------
    reference : str
        Picture of many paths that look for the lamps.
    pictures : sequence of str
        Of each sampler, which the name of the file is.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`. n_var is the variance of one path over the squared mean of the picture,
        both means over pixels and channels, and n_var_error its standard error, were pixels
        independent. times is how many times as many paths it takes as the sampler that needs the
        fewest, for the same noise, and times_by_seconds how many times as much CPU time. rms are
        errors of the pictures of equal samples and of equal seconds against the reference, over
        its mean, and reference_rms is the reference's own.
    """
    truth, made = read(reference)
    mean = truth["samples"].mean()
    noise = np.sqrt(truth["variance"].mean() / made["paths"]) / mean
    rows = []
    for name, path in zip(distinct(Path(p).stem for p in pictures), pictures, strict=True):
        parts, record = read(path)
        each = parts["variance"].mean(axis=-1) / mean**2
        error = each.std() / np.sqrt(each.size)
        timed = parts.get("seconds")
        rms, timed_rms = (
            np.nan if picture is None else _rms(picture, truth["samples"])
            for picture in (parts["samples"], timed)
        )
        cost = record["paths"], record["seconds"]
        errors = rms, record["seconds_paths"], timed_rms, noise
        rows.append((name, *cost, each.mean(), error, 0.0, 0.0, *errors))
    found = pd.DataFrame(rows, columns=COLUMNS)
    price = found["n_var"] * found["seconds"] / found["paths"]
    found["times"] = found["n_var"] / found["n_var"].min()
    found["times_by_seconds"] = price / price.min()
    return found


def _rms(picture: Array, truth: Array) -> float:
    return float(np.sqrt(np.mean((picture - truth) ** 2)) / truth.mean())
