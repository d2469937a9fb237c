"""One vector or many: public force functions accept (3,) and (..., 3) alike."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def as_rows(*vectors: npt.ArrayLike) -> tuple[list[np.ndarray], tuple[int, ...]]:
    """Broadcast vectors against each other. (..., 3) each -> list of C-contiguous (n, 3) float64, and the common
    shape."""
    arrays = np.broadcast_arrays(*(np.asarray(vector, dtype=float) for vector in vectors))
    shape = arrays[0].shape
    if not shape or shape[-1] != 3:
        raise ValueError(f"vectors must have three components in their last axis, got shape {shape}")
    return [np.ascontiguousarray(array.reshape(-1, 3)) for array in arrays], shape
