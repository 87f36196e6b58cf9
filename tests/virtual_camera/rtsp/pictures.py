"""How alike pictures are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def difference(a: NDArray[np.uint8], b: NDArray[np.uint8]) -> float:
    """Return the mean difference of two pictures in grey levels."""
    assert a.shape == b.shape
    return float(np.abs(a.astype(float) - b).mean())
