"""Numbers printed in Lawrence et al. 2004, to stand beside ours."""

import math

SOURCE = "Lawrence et al. 2004"

#: Samples a pixel that Tables 2 and 3 are for, and trials that variances are from.
SAMPLES, TRIALS = 100, 50
#: Its measured materials, under the names of MERL; it calls them nickel, plastic and metallic-blue,
#: and which of MERL's plastics it has is not said: the one here is a guess.
MATERIALS = ("nickel", "maroon-plastic", "blue-metallic-paint")
#: The strategies of its comparison, in the order of its tables.
STRATEGIES = ("cosine", "lafortune", "ashikhmin-shirley", "per-view")
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
