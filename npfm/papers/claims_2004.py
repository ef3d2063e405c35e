"""What Lawrence et al. 2004 claim, as `npfm.papers.claims` of the other papers."""

from functools import partial

from npfm.papers import lawrence2004
from npfm.papers import measures_2004 as m04
from npfm.papers.claims import Claim, Topic

POINTS = (
    "points of the renderer (Sobol, rotated) are stratified in both of their numbers, which helps "
    "some strategies more than others; how the paper stratifies is not said in full"
)
PLASTIC = (
    "which of the measured plastics the paper has is not said, nor how its opponents were fitted; "
    "and a small share of our directions are spread by the cosine, whereas the paper's tabulated "
    "slices have zeros"
)

TOPICS = (
    Topic(
        f"Importance sampling ({lawrence2004.SOURCE}; factors by the paper's recipe)",
        ("importance_improvement", "importance_samples"),
        (
            Claim(
                "at least 5 to 10 times less variance than directions by the cosine",
                "5 or more",
                partial(m04.better_than, strategy="cosine", least=5),
                POINTS,
            ),
            Claim(
                "at least twice as good as a Lafortune fit",
                "2 or more",
                partial(m04.better_than, strategy="lafortune", least=2),
                PLASTIC,
            ),
            Claim(
                "at least twice as good as an Ashikhmin-Shirley fit",
                "2 or more, though 1.34 for plastic",
                partial(m04.better_than, strategy="blinn-phong", least=2),
                PLASTIC,
            ),
            Claim(
                "variance falls as the inverse of the samples, for all strategies",
                "approximately (here: an exponent of -1 within 0.15)",
                m04.inverse_of_samples,
                POINTS,
            ),
            *(
                Claim(
                    f"{material}, {light} light: {', '.join(lawrence2004.STRATEGIES)}",
                    ", ".join(
                        f"{lawrence2004.improvement(light, material, name):g}"
                        for name in lawrence2004.STRATEGIES
                    )
                    + " (here: within a factor of 2)",
                    partial(m04.as_printed, light=light, material=material),
                    PLASTIC,
                )
                for light in lawrence2004.IMPROVEMENT
                for material in lawrence2004.MATERIALS
            ),
        ),
    ),
)
