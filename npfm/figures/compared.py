"""What Figures 9 to 14 compare, as far as a run has it; told before anything is rendered."""

from collections.abc import Iterable

OURS = "independent-g"
NON_PARAMETRIC = ("g-from-d", "naive")
LOEW = ("abc-published", "abc-e2", "abc-ours")
#: By figure, what stands beside our model.
OTHERS = {
    "figure09": NON_PARAMETRIC,
    "figure10": NON_PARAMETRIC,
    "figure11": ("bivariate",),
    "figure12": LOEW,
    "figure13": ("tucker-20",),
    "figure14": LOEW,
}

#: What each is, in a list of figures.
LABELS = {
    "figure09": "9: the non-parametric fits, with close-ups",
    "figure10": "10: the worst fits",
    "figure11": "11: against the bivariate model",
    "figure12": "12: against Loew's model",
    "figure13": "13: against Bilgili's factorisation",
    "figure14": "14: where the renderings are wrong",
}


def compared(variants: Iterable[str]) -> dict[str, list[str]]:
    """Variants that each figure compares, ours first; figures with nothing to compare left out.

    Parameters
    ----------
    variants : iterable of str
        Those of the run.
    """
    available = set(variants)
    if OURS not in available:
        return {}
    chosen = {figure: [v for v in others if v in available] for figure, others in OTHERS.items()}
    return {figure: [OURS, *others] for figure, others in chosen.items() if others}
