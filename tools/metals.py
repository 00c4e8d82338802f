"""Reduces measured spectra of metals' complex refractive index to linear Rec. 709: prints the table of lumiere/bsdf/metals.py.

Per channel the weights are the product of the illuminant D65, the CIE 1931 observer (multi-lobe fits of Wyman, Sloan & Shirley 2013, "Simple
Analytic Approximations to the CIE XYZ Color Matching Functions") and the matrix from XYZ to Rec. 709, normalised so that a constant spectrum
keeps its value. η is the weighted mean of the measured η. k is not: it is chosen so that the reflectance at normal incidence,
R = ((η − 1)² + k²) / ((η + 1)² + k²), is the weighted mean of the measured reflectance, so that the metal's colour is the spectral one.
A channel that exceeds the highest measured reflectance (gold's red, outside of Rec. 709) is lowered to it.

The spectra are tables of wavelength in nm, η and k, as collected (in the public domain) by M. N. Polyanskiy, refractiveindex.info.
"""

from __future__ import annotations

import numpy as np

JOHNSON_CHRISTY_1972 = "Johnson & Christy 1972, Phys. Rev. B 6, 4370"
JOHNSON_CHRISTY_1974 = "Johnson & Christy 1974, Phys. Rev. B 9, 5056"
RAKIC_1995 = "Rakić 1995, Appl. Opt. 34, 4755"
RAKIC_1998 = "Rakić et al. 1998, Appl. Opt. 37, 5271 (Lorentz–Drude)"
WEAVER_1975 = "Weaver, Olson & Lynch 1975, Phys. Rev. B 12, 1293"
QUERRY_1985 = "Querry 1985, CRDC-CR-85034 (70 % Cu, 30 % Zn)"

SPECTRA = {
    "aluminium": (RAKIC_1995, """
        364.66 0.39877 4.3957  413.28 0.52135 5.0008  442.80 0.60790 5.3676  476.87 0.72780 5.7781  516.60 0.87340 6.2418
        563.57 1.0728 6.7839  619.93 1.3660 7.4052  652.25 1.5724 7.7354  688.81 1.8301 8.0601  729.32 2.1606 8.3565  774.91 2.6154 8.4914"""),
    "brass": (QUERRY_1985, """
        370 1.497 1.818  390 1.471 1.813  400 1.445 1.805  410 1.405 1.794  420 1.350 1.786  430 1.278 1.784  440 1.191 1.797
        450 1.094 1.829  460 0.994 1.883  470 0.900 1.957  480 0.816 2.046  490 0.745 2.145  500 0.686 2.250  510 0.639 2.358
        520 0.602 2.464  530 0.573 2.568  540 0.549 2.668  550 0.527 2.765  560 0.505 2.860  570 0.484 2.958  580 0.468 3.059
        590 0.460 3.159  600 0.450 3.253  610 0.452 3.345  620 0.449 3.434  630 0.445 3.522  640 0.444 3.609  650 0.444 3.695
        660 0.445 3.778  680 0.444 3.943  700 0.446 4.106  720 0.450 4.266  750 0.457 4.501  780 0.464 4.737"""),
    "chromium": (JOHNSON_CHRISTY_1974, """
        368 1.87 2.69  381 1.92 2.74  397 2.00 2.83  413 2.08 2.93  431 2.19 3.04  451 2.33 3.14  471 2.51 3.24  496 2.75 3.30
        521 2.94 3.33  549 3.18 3.33  582 3.22 3.30  617 3.17 3.30  659 3.09 3.34  704 3.05 3.39  756 3.08 3.42  821 3.20 3.48"""),
    "cobalt": (JOHNSON_CHRISTY_1974, """
        368 1.50 2.71  381 1.53 2.82  397 1.57 2.93  413 1.61 3.05  431 1.67 3.17  451 1.74 3.28  471 1.81 3.41  496 1.88 3.55
        521 1.97 3.68  549 2.05 3.82  582 2.13 3.96  617 2.19 4.11  659 2.25 4.27  704 2.31 4.45  756 2.40 4.64  821 2.53 4.88"""),
    "copper": (JOHNSON_CHRISTY_1972, """
        367.9 1.36 1.975  381.5 1.33 2.045  397.4 1.32 2.116  413.3 1.28 2.207  430.5 1.25 2.305  450.9 1.24 2.397  471.4 1.25 2.483
        495.9 1.22 2.564  520.9 1.18 2.608  548.6 1.02 2.577  582.1 0.70 2.704  616.8 0.30 3.205  659.5 0.22 3.747  704.5 0.21 4.205
        756.0 0.24 4.665  821.1 0.26 5.180"""),
    "gold": (JOHNSON_CHRISTY_1972, """
        367.9 1.48 1.895  381.5 1.46 1.933  397.4 1.47 1.952  413.3 1.46 1.958  430.5 1.45 1.948  450.9 1.38 1.914  471.4 1.31 1.849
        495.9 1.04 1.833  520.9 0.62 2.081  548.6 0.43 2.455  582.1 0.29 2.863  616.8 0.21 3.272  659.5 0.14 3.697  704.5 0.13 4.103
        756.0 0.14 4.542  821.1 0.16 5.083"""),
    "iron": (JOHNSON_CHRISTY_1974, """
        368 2.02 2.43  381 2.12 2.50  397 2.24 2.58  413 2.35 2.65  431 2.48 2.71  451 2.59 2.77  471 2.67 2.82  496 2.74 2.88
        521 2.86 2.91  549 2.95 2.93  582 2.94 2.99  617 2.88 3.05  659 2.92 3.10  704 2.86 3.19  756 2.87 3.28  821 2.94 3.39"""),
    "nickel": (JOHNSON_CHRISTY_1974, """
        368 1.70 2.40  381 1.72 2.48  397 1.72 2.57  413 1.70 2.69  431 1.71 2.82  451 1.73 2.95  471 1.78 3.09  496 1.82 3.25
        521 1.85 3.42  549 1.92 3.61  582 1.96 3.80  617 1.99 4.02  659 1.99 4.26  704 2.06 4.50  756 2.13 4.73  821 2.26 4.97"""),
    "palladium": (JOHNSON_CHRISTY_1974, """
        368 1.24 2.74  381 1.26 2.83  397 1.30 2.93  413 1.33 3.03  431 1.37 3.14  451 1.41 3.26  471 1.46 3.39  496 1.52 3.54
        521 1.57 3.68  549 1.64 3.84  582 1.68 4.02  617 1.75 4.21  659 1.80 4.42  704 1.86 4.65  756 1.95 4.89  821 2.06 5.19"""),
    "platinum": (RAKIC_1998, """
        369.71 1.6416 2.6660  389.02 1.6945 2.7865  409.34 1.7489 2.9075  430.72 1.8037 3.0306  451.44 1.8546 3.1479
        471.31 1.9019 3.2596  492.06 1.9507 3.3763  511.71 1.9971 3.4872  532.14 2.0464 3.6027  551.23 2.0939 3.7106
        573.24 2.1509 3.8345  593.81 2.2065 3.9492  612.70 2.2597 4.0533  632.20 2.3165 4.1590  652.32 2.3770 4.2658
        673.08 2.4412 4.3734  694.50 2.5088 4.4813  719.41 2.5889 4.6028  751.08 2.6918 4.7507  781.08 2.7893 4.8844"""),
    "silver": (JOHNSON_CHRISTY_1972, """
        367.9 0.07 1.657  381.5 0.05 1.864  397.4 0.05 2.070  413.3 0.05 2.275  430.5 0.04 2.462  450.9 0.04 2.657  471.4 0.05 2.869
        495.9 0.05 3.093  520.9 0.05 3.324  548.6 0.06 3.586  582.1 0.05 3.858  616.8 0.06 4.152  659.5 0.05 4.483  704.5 0.04 4.838
        756.0 0.03 5.242  821.1 0.04 5.727"""),
    "titanium": (JOHNSON_CHRISTY_1974, """
        368 1.90 2.90  381 1.99 2.93  397 2.08 2.95  413 2.14 2.98  431 2.21 3.01  451 2.27 3.04  471 2.32 3.10  496 2.36 3.19
        521 2.44 3.30  549 2.54 3.43  582 2.60 3.58  617 2.67 3.72  659 2.76 3.84  704 2.86 3.96  756 3.00 4.01  821 3.21 4.01"""),
    "tungsten": (WEAVER_1975, """
        372.0 3.431 2.621  391.2 3.445 2.460  411.5 3.379 2.416  425.3 3.346 2.439  448.7 3.314 2.511  469.4 3.332 2.591
        493.7 3.384 2.668  511.1 3.433 2.700  532.7 3.497 2.719  548.9 3.522 2.739  573.9 3.526 2.794  602.4 3.562 2.866
        626.8 3.609 2.907  657.2 3.697 2.943  684.9 3.818 2.904  717.3 3.896 2.850  754.9 3.857 2.784  793.8 3.705 2.733"""),
    "vanadium": (JOHNSON_CHRISTY_1974, """
        368 2.68 3.40  381 2.87 3.45  397 3.07 3.48  413 3.31 3.49  431 3.52 3.49  451 3.59 3.46  471 3.81 3.38  496 3.92 3.26
        521 3.86 3.18  549 4.00 3.04  582 3.83 3.00  617 3.54 3.02  659 3.25 3.09  704 3.18 3.15  756 3.20 3.20  821 3.16 3.25"""),
}
"""Name → source, and rows of wavelength (nm), η, k."""

D65 = np.array([
    49.98, 54.65, 82.75, 91.49, 93.43, 86.68, 104.86, 117.01, 117.81, 114.86, 115.92, 108.81, 109.35, 107.80, 104.79, 107.69, 104.41,
    104.05, 100.00, 96.33, 95.79, 88.69, 90.01, 89.60, 87.70, 83.29, 83.70, 80.03, 80.21, 82.28, 78.28, 69.72, 71.61, 74.35, 61.60, 69.89,
    75.09, 63.59, 46.42, 66.81, 63.38])
"""Relative power of CIE standard illuminant D65, 380 to 780 nm by 10."""

XYZ_TO_RGB = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]])


def channel_weights(wavelength: np.ndarray) -> np.ndarray:
    """Weights of linear Rec. 709 red, green and blue, shape (3, n), each summing to 1, for equally spaced wavelengths (n) in nm."""

    def lobe(center: float, below: float, above: float) -> np.ndarray:
        return np.exp(-0.5 * np.square((wavelength - center) / np.where(wavelength < center, below, above)))

    x = 1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2)
    y = 0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1)
    z = 1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)
    weights = XYZ_TO_RGB @ np.stack([x, y, z]) * np.interp(wavelength, np.linspace(380.0, 780.0, len(D65)), D65)
    return weights / weights.sum(axis=1, keepdims=True)


def reduce(rows: str) -> tuple[np.ndarray, np.ndarray]:
    """(η, k) in Rec. 709, each of shape (3,), of a spectrum."""
    data = np.array(rows.split(), float).reshape(-1, 3).T
    wavelength = np.arange(380.0, 781.0)
    eta, k = (np.interp(wavelength, data[0], values) for values in data[1:])
    weights = channel_weights(wavelength)
    spectral = ((eta - 1) ** 2 + k**2) / ((eta + 1) ** 2 + k**2)
    reflectance = np.minimum(weights @ spectral, spectral.max())
    mean_eta = weights @ eta
    return mean_eta, np.sqrt((reflectance * (mean_eta + 1) ** 2 - (mean_eta - 1) ** 2) / (1 - reflectance))


def main() -> None:
    for name, (source, rows) in SPECTRA.items():
        eta, k = (tuple(float(round(x, 4)) for x in values) for values in reduce(rows))
        print(f'    "{name}": ({eta}, {k}),  # {source}')


if __name__ == "__main__":
    main()
