"""Numbers printed in Lawrence et al. 2004, to stand beside ours."""

import math
from dataclasses import dataclass

SOURCE = "Lawrence et al. 2004"

#: Samples a pixel that Tables 2 and 3 are for, and trials that variances are from.
SAMPLES, TRIALS = 100, 50
#: Its measured materials, under the names of MERL; it calls them nickel, plastic and metallic-blue,
#: and which of MERL's plastics it has is not said: the one here is a guess.
MATERIALS = ("nickel", "maroon-plastic", "blue-metallic-paint")
#: The strategies of its comparison, in the order of its tables; blinn-phong follows the model of
#: Ashikhmin and Shirley.
STRATEGIES = ("cosine", "lafortune", "blinn-phong", "per-view")
#: Factor of improvement in variance over each of them, by light and material (Tables 2 and 3).
IMPROVEMENT = {
    "constant": {
        "cook-torrance": (16.38, 13.27, 3.53, 0.75),
        "poulin-fournier": (5.86, 1.85, 6.11, math.nan),
        "hapke-lommel": (3.32, 2.14, 11.61, 1.99),
        "nickel": (306.17, 11.52, 2.17, 1.66),
        "maroon-plastic": (157.12, 14.40, 1.34, 18.53),
        "blue-metallic-paint": (8.88, 6.73, 6.75, 0.44),
    },
    "beach": {
        "cook-torrance": (25.79, 10.28, 2.23, 0.75),
        "poulin-fournier": (1.40, 1.09, 1.53, math.nan),
        "hapke-lommel": (0.89, 1.61, 1.87, 1.00),
        "nickel": (572.76, 3.45, 2.17, 4.80),
        "maroon-plastic": (381.94, 21.60, 1.67, 55.64),
        "blue-metallic-paint": (9.17, 5.96, 5.71, 0.55),
    },
}


def improvement(light: str, material: str, strategy: str) -> float:
    """Printed factor of improvement over a strategy, NaN where there is none."""
    printed = IMPROVEMENT.get(light, {}).get(material, ())
    return dict(zip(STRATEGIES, printed, strict=False)).get(strategy, math.nan)


@dataclass(frozen=True)
class Factored:
    """A row of Table 1.

    Parameters
    ----------
    resolution : tuple of four int
        Bins of theta_o, phi_o, theta_p and phi_p.
    terms : tuple of two int
        J and K.
    half : bool
        Whether p is the half vector, not the light.
    error : float
        Normalised mean absolute error of the factors; NaN if it is none of the table's.
    lafortune : float
        That of the best fit of Lafortune's lobes.
    lobes : int
        How many these are.
    """

    resolution: tuple[int, int, int, int]
    terms: tuple[int, int]
    half: bool
    error: float = math.nan
    lafortune: float = math.nan
    lobes: int = 2


_MEASURED: tuple[int, int, int, int] = (16, 16, 128, 16)
_SMALL: tuple[int, int, int, int] = (16, 16, 32, 16)
#: Table 1, by the names of `MATERIALS` and of the formulas.
TABLE_1 = {
    "cook-torrance": Factored(_SMALL, (4, 1), True, 0.192, 0.632, 3),
    "ward": Factored((16, 16, 100, 100), (2, 4), True, 0.094, 1.092),
    "poulin-fournier": Factored(_SMALL, (3, 1), False, 0.142, 0.348),
    "hapke-lommel": Factored(_SMALL, (3, 1), False, 0.186, 0.464),
    "nickel": Factored(_MEASURED, (2, 1), True, 0.201, 0.643),
    "maroon-plastic": Factored(_MEASURED, (3, 1), True, 0.266, 0.874),
    "blue-metallic-paint": Factored(_MEASURED, (4, 1), True, 0.118, 0.464),
}


def factored(material: str) -> Factored:
    """Row of Table 1; of a material that is not in it, as it has the plastic, without errors."""
    return TABLE_1.get(material, Factored(_MEASURED, (3, 1), True))
