"""Singular values of an iterate as views see them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from app.picture.shown import MOST_SPECTRA, MOST_VALUES, Floats, thinned
from solver.latin import Iterate
from solver.reduction.svd import friction_spectra


@lru_cache(maxsize=1)
def spectra_of(iterate: Iterate) -> Floats:
    """Give singular values, shape (n_substructures, n_values), NaN where there is none.

    They are those of the substructures `thinned(number, MOST_SPECTRA)`. Whoever looks at one
    instant of an iterate after the other has them once: of many they cost more than all else that
    is drawn.
    """
    spectra = friction_spectra(iterate)
    chosen = [spectra[place][:MOST_VALUES] for place in thinned(len(spectra), MOST_SPECTRA)]
    table = np.full((len(chosen), max(map(len, chosen))), np.nan, dtype=np.float32)
    for row, values in zip(table, chosen, strict=True):
        row[: len(values)] = values
    return table
