"""How claims about anisotropic materials are put to the tables of a run."""

import pandas as pd

from npfm.papers import peng2017
from npfm.papers.evidence import Evidence, Untestable
from npfm.papers.measures import Finding

#: By the name that a run has the model of Peng et al. 2017 under.
LOBES = "shared lobes"
#: And that of Dupuy et al. 2015.
FACETS = "power iterations"
NOT_UTIA = "the paper's materials are those of the UTIA database, and it does not say by which peak"


def rendering_psnr(evidence: Evidence) -> Finding:
    """Mean PSNR of all pictures, by a peak of 255 where the mean of the reference is 1.

    Raises
    ------
    Untestable
        Unless the run has as many materials as the UTIA database.
    """
    eight_bit, common, count = _renderings(evidence)
    ours = f"{eight_bit:.2f} dB; {common:.2f} dB with the largest value as the peak"
    _needs_utia(count, ours)
    return Finding(ours, eight_bit >= peng2017.RENDERING_DB - 2, ours)


def few_below(evidence: Evidence) -> Finding:
    """How many materials are below 100 dB, by the same peak."""
    fidelity = _of_lobes(evidence)
    below = int((fidelity["rendering_8_bit_db"] < peng2017.FEW_DB).sum())
    ours = f"{below} of {len(fidelity)}"
    _needs_utia(len(fidelity), ours)
    return Finding(ours, below <= peng2017.BELOW, ours)


def size(evidence: Evidence) -> Finding:
    """How many values a fit has, of four bytes each."""
    count = int(evidence.bytes[evidence.variant(LOBES)]) // 4
    return Finding(f"{count}", count == peng2017.ANISOTROPIC_PARAMETERS, f"{count}")


def small(evidence: Evidence, most: int) -> Finding:
    """How many bytes a fit by power iterations has."""
    count = int(evidence.bytes[evidence.variant(FACETS)])
    return Finding(f"{count} bytes", count <= most, f"{count - most} bytes more")


def of_one_material(evidence: Evidence, material: str) -> Finding:
    """What only a material of the UTIA database can tell.

    Raises
    ------
    Untestable
        Always: nothing that is measured here tells it.
    """
    raise Untestable(f"it is said of {material} of the UTIA database")


def _of_lobes(evidence: Evidence) -> pd.DataFrame:
    name = evidence.variant(LOBES)
    if evidence.fidelity is None:
        raise Untestable("the run has no table of fidelity")
    return evidence.fidelity[evidence.fidelity["variant"] == name]


def _renderings(evidence: Evidence) -> tuple[float, float, int]:
    fidelity = _of_lobes(evidence)
    columns = (fidelity[f"rendering{peak}_db"] for peak in ("_8_bit", ""))
    eight_bit, common = (float(column.mean()) for column in columns)
    return eight_bit, common, len(fidelity)


def _needs_utia(count: int, ours: str) -> None:
    if count != peng2017.UTIA_MATERIALS:
        raise Untestable(f"{NOT_UTIA}; here, {ours} ({count} materials)")
