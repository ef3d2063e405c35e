"""Which pictures of Lavoué et al. 2021 our variants make again.

People compared renderings of 21 approximations of the 100 materials of MERL with renderings of the
measurement. Some of those approximations have parameters that were published, or are made by a
procedure that is published.
"""

SOURCE = "Lavoué et al. 2021"

#: What we have of an approximation: its published parameters, the same procedure, or only a fit of
#: ours of the same model, which is not what people saw.
PUBLISHED, MADE_AGAIN, OURS = "published", "made again", "our fit"
#: By variant: the approximation as the study names it, and what the variant is of it. BAGHER is
#: taken for the model of 2016, since the study lists that of 2012, SGD, apart. LAFORTUNE is that of
#: Ngan et al. 2005, which has one lobe.
SHOWN = {
    "abc-published": ("ABC", PUBLISHED),
    "shifted-gamma-published": ("SGD", PUBLISHED),
    "ward-published": ("WARD", PUBLISHED),
    "lafortune-published": ("LAFORTUNE", PUBLISHED),
    "blinn-phong-published": ("BLINN-PHONG", PUBLISHED),
    "independent-g-published": ("BAGHER", PUBLISHED),
    "power-iteration": ("DUPUY", MADE_AGAIN),
    "ggx": ("GGX", MADE_AGAIN),
    "beckmann": ("BECKMAN", MADE_AGAIN),
    "independent-g": ("BAGHER", MADE_AGAIN),
    "abc-e2": ("ABC", OURS),
    "shifted-gamma": ("SGD", OURS),
    "ward": ("WARD", OURS),
    "blinn-phong": ("BLINN-PHONG", OURS),
    "lafortune": ("LAFORTUNE", OURS),
}
