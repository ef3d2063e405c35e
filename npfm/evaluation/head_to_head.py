"""Two variants against each other, rendering by rendering, as the paper counts them."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

TIE_DB = 2.0  # Bagher et al. 2016, section 5: "a tie is defined as rendering PSNR within 2db"


@dataclass(frozen=True)
class HeadToHead:
    """How many renderings of one variant are better than, as good as, worse than another's."""

    wins: int
    ties: int
    losses: int
    missing: int

    @property
    def compared(self) -> int:
        """Renderings that both variants have."""
        return self.wins + self.ties + self.losses


def head_to_head(psnr: pd.DataFrame, ours: str, other: str) -> HeadToHead:
    """Count wins, ties (within `TIE_DB`) and losses over all renderings.

    Bagher et al. 2016, section 5. Renderings that one of the two lacks are counted as missing;
    two that both equal the reference are a tie.

    Parameters
    ----------
    psnr : DataFrame
        Columns scene, material, variant, psnr_db.
    ours, other : str
        The variants.
    """
    table = renderings(psnr, [ours, other])
    both = table.dropna()
    equal = both[ours] == both[other]  # infinite ones have no difference
    gain = np.where(equal, 0.0, both[ours] - both[other].where(~equal, 0.0))
    return HeadToHead(
        wins=int(np.sum(gain > TIE_DB)),
        ties=int(np.sum(np.abs(gain) <= TIE_DB)),
        losses=int(np.sum(gain < -TIE_DB)),
        missing=len(table) - len(both),
    )


def renderings(psnr: pd.DataFrame, variants: list[str]) -> pd.DataFrame:
    """PSNR in dB by (material, scene) and variant, in the table's order; NaN where one is missing.

    Every picture of the table has its row, whichever variant it is of.
    """
    index = pd.MultiIndex.from_frame(psnr[["material", "scene"]].drop_duplicates())
    table = psnr.pivot(index=["material", "scene"], columns="variant", values="psnr_db")
    return table.reindex(index=index, columns=variants)
