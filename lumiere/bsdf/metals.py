"""Named metals: complex refractive indices in linear Rec. 709, relative to air.

Reduced from published measurements by ``tools/metals.py``, which holds the spectra and says how.
"""

from __future__ import annotations

from lumiere.scene.fields import Spectrum

METALS: dict[str, tuple[Spectrum, Spectrum]] = {
    "none": ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),  # a purely imaginary index reflects everything at every angle
    "aluminium": ((1.4732, 0.9856, 0.5977), (7.5885, 6.5478, 5.3136)),  # Rakić 1995, Appl. Opt. 34, 4755
    "brass": ((0.421, 0.5184, 1.123), (4.0293, 2.6635, 1.8097)),  # Querry 1985, CRDC-CR-85034 (70 % Cu, 30 % Zn)
    "chromium": ((3.2491, 3.1087, 2.2791), (3.2859, 3.3358, 3.1144)),  # Johnson & Christy 1974, Phys. Rev. B 9, 5056
    "cobalt": ((2.2474, 2.0341, 1.7092), (4.2163, 3.7956, 3.2349)),  # Johnson & Christy 1974, Phys. Rev. B 9, 5056
    "copper": ((0.1789, 1.0408, 1.2904), (2.9563, 2.6271, 2.3573)),  # Johnson & Christy 1972, Phys. Rev. B 6, 4370
    "gold": ((0.0631, 0.4973, 1.4593), (3.0103, 2.262, 1.7708)),  # Johnson & Christy 1972, Phys. Rev. B 6, 4370
    "iron": ((2.9233, 2.9177, 2.5454), (3.0751, 2.9382, 2.7498)),  # Johnson & Christy 1974, Phys. Rev. B 9, 5056
    "nickel": ((2.0208, 1.9019, 1.7242), (4.1824, 3.5724, 2.893)),  # Johnson & Christy 1974, Phys. Rev. B 9, 5056
    "palladium": ((1.7855, 1.6208, 1.392), (4.3482, 3.813, 3.2086)),  # Johnson & Christy 1974, Phys. Rev. B 9, 5056
    "platinum": ((2.3354, 2.0751, 1.8277), (4.2222, 3.67, 3.0924)),  # Rakić et al. 1998, Appl. Opt. 37, 5271 (Lorentz–Drude)
    "silver": ((0.0556, 0.0547, 0.0429), (4.4306, 3.5409, 2.58)),  # Johnson & Christy 1972, Phys. Rev. B 6, 4370
    "titanium": ((2.7338, 2.5087, 2.2362), (3.8343, 3.3995, 3.0132)),  # Johnson & Christy 1974, Phys. Rev. B 9, 5056
    "tungsten": ((3.6335, 3.4948, 3.3143), (2.9224, 2.7485, 2.507)),  # Weaver, Olson & Lynch 1975, Phys. Rev. B 12, 1293
    "vanadium": ((3.4801, 3.9569, 3.617), (2.9843, 3.076, 3.4751)),  # Johnson & Christy 1974, Phys. Rev. B 9, 5056
}
"""Name → (η, k)."""
