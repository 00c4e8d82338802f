"""How far a picture is from the reference."""

from __future__ import annotations

import numpy as np

TRIMMED = 1e-3
"""Part of the pixels, those with the largest errors, that the trimmed relMSE leaves out."""

FLOOR = 0.01
"""Where the reference is dark the error is relative to √FLOOR of its mean instead (Rousselle, Knaus & Zwicker 2011, §5, free of units)."""


def weights(reference: np.ndarray) -> np.ndarray:
    """1 / (R² + FLOOR m²) for each value R of ``reference`` (h, w, 3), m their mean: squared errors times these are relative."""
    reference = np.asarray(reference, dtype=np.float64)
    floor = FLOOR * reference.mean() ** 2
    return 1.0 / (reference**2 + (floor if floor > 0.0 else 1.0))


def rel_mse(picture: np.ndarray, reference: np.ndarray, trimmed: float = 0.0) -> float:
    """Mean over the pixels of (I − R)² / (R² + FLOOR m²), averaged over the channels; without the ``trimmed`` part of the largest."""
    error = (weights(reference) * (np.asarray(picture, dtype=np.float64) - reference) ** 2).mean(axis=-1).ravel()
    kept = len(error) - int(np.ceil(trimmed * len(error))) if trimmed > 0.0 else len(error)
    return float(np.sort(error)[:max(1, kept)].mean())


def flip(picture: np.ndarray, reference: np.ndarray) -> float | None:
    """Mean HDR-ꟻLIP (Andersson et al. 2021), or None where flip-evaluator is not installed."""
    try:
        import flip_evaluator
    except ImportError:
        return None
    pictures = [np.maximum(np.asarray(p, dtype=np.float32), 0.0) for p in (reference, picture)]
    return float(flip_evaluator.evaluate(*pictures, "HDR", applyMagma=False)[1])
