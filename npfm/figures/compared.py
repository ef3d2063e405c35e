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
