"""Table I of Bagher et al. 2016, "Fitting statistics over all materials", beside ours."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from npfm.papers import bagher2016


def table1(fits: pd.DataFrame) -> pd.DataFrame:
    """Our fitting statistics over all materials, beside Table I of the paper.

    Ours are of a material, its channels and starts together. As in the paper, whose minimum is 1
    though not all materials invoke it, the golden-section calls are counted over those materials
    that invoke it at all.

    Parameters
    ----------
    fits : DataFrame
        As `fits` makes it.

    Returns
    -------
    DataFrame
        One row a technique and source.
    """
    columns = ["seconds", "iterations", "gss_calls"]
    ours = fits.groupby(["variant", "material"], sort=False)[columns].sum()
    rows = []
    for technique in dict.fromkeys([*bagher2016.TABLE_I, *fits["variant"]]):
        if technique in ours.index:
            row = _statistics(ours.loc[technique])
            rows.append({"technique": technique, "source": "ours", **row})
        if technique in bagher2016.TABLE_I:
            row = _table1_row(bagher2016.TABLE_I[technique], bagher2016.TABLE_I_MATERIALS)
            source = f"paper ({bagher2016.SOURCE}, Table I)"
            rows.append({"technique": technique, "source": source, **row})
    return pd.DataFrame(rows)


def _statistics(materials: pd.DataFrame) -> dict:
    invoking = materials["gss_calls"][materials["gss_calls"] > 0]
    counted = {
        "seconds": materials["seconds"],
        "iterations": materials["iterations"],
        "gss_calls": invoking if len(invoking) else [0],
    }
    ranges = {key: (np.min(v), np.mean(v), np.max(v)) for key, v in counted.items()}
    return _table1_row(ranges | {"materials_invoking_gss": len(invoking)}, len(materials))


def _table1_row(entry: Mapping, materials: int) -> dict:
    row: dict[str, float] = {"materials": materials}
    for quantity in ("seconds", "iterations", "gss_calls"):
        for statistic, value in zip(("min", "avg", "max"), entry[quantity], strict=True):
            row[f"{quantity}_{statistic}"] = float(value)
    return row | {"materials_invoking_gss": entry["materials_invoking_gss"]}
