"""Golden-section search on a unit interval."""

from collections.abc import Callable

#: The smaller part of the golden section.
SECTION = (3 - 5**0.5) / 2


def golden_section(objective: Callable[[float], float], tolerance: float = 1e-3) -> float:
    """Minimum of a function on [0, 1] (Press et al. 2007, section 10.2).

    Parameters
    ----------
    objective : callable
        Function of a number in [0, 1]; the minimum found is the global one if it has one
        minimum only.
    tolerance : float
        Length of the last interval relative to its upper end, so that short steps are found too.

    Returns
    -------
    float
        The best point evaluated.
    """
    low, high = 0.0, 1.0
    left, right = SECTION, 1 - SECTION
    f_left, f_right = objective(left), objective(right)
    best = min((f_left, left), (f_right, right))
    while high - low > tolerance * high and high > 1e-9:
        if f_left < f_right:
            high, right, f_right = right, left, f_left
            left = low + SECTION * (high - low)
            f_left = objective(left)
            best = min(best, (f_left, left))
        else:
            low, left, f_left = left, right, f_right
            right = high - SECTION * (high - low)
            f_right = objective(right)
            best = min(best, (f_right, right))
    return best[1]
