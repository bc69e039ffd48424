"""How values are spaced: by equal steps or by equal ratios."""

import numpy as np

DECADES = 20.0  # ratio of values beyond which their logarithm is shown


def is_logarithmic(values: np.ndarray) -> bool:
    """Whether the steps of the sorted values are more even in the logarithm."""
    values = np.sort(values)
    if len(values) < 3 or values[0] <= 0:
        return False
    return bool(np.ptp(np.diff(np.log(values))) / np.log(values[-1] / values[0]) <
                np.ptp(np.diff(values)) / (values[-1] - values[0]) * (1 - 1e-9))


def spans_decades(values: np.ndarray) -> bool:
    """Whether positive values are so different that their logarithm is shown."""
    known = values[np.isfinite(values)]
    return bool(known.size > 0 and known.min() > 0 and known.max() > DECADES * known.min())
