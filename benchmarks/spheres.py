"""The scenes of the benchmark "volumes": a cell of the simple cubic array of spheres, volume fraction 0.3, in a matrix of conductivity 1.

The sphere is in the middle of the cell. Then every face of the cell is a mirror of the array, insulated and periodic sides give the same, and
programs that have but one of them can be compared.
"""

import numpy as np

FRACTION = 0.3
CONDUCTIVITY = {"spheres": 10, "pores": 0}  # of the sphere, by scene


def sangani_acrivos(fraction, s):
    """Proc. R. Soc. A 386 (1983) 263, equation 52, simple cubic: to the order 25/3 in the fraction. @param s sphere over matrix"""
    def ratio(i):
        return (s - 1) / (s + 2 * i / (2 * i - 1))

    def power(e):
        return fraction ** (e / 3)

    d = (-1 / ratio(1) + fraction + 1.305 * ratio(2) * power(10) * (1 + 0.231 * ratio(3) * power(11)) / (1 - 0.405 * ratio(2) * power(7))
         + 0.0723 * ratio(3) * power(14) + 0.153 * ratio(4) * power(18) + 0.0105 * ratio(5) * power(22))
    return 1 - 3 * fraction / d


TRUTH = {"spheres": 1.88774006, "pores": 0.60566125}  # by multipoles: sphere-arrays.py


def shares(n, samples=8):
    """Part of each of n³ voxels inside the sphere; where the surface may cross one, of samples³ points in it."""
    radius = np.cbrt(3 * FRACTION / (4 * np.pi)) * n
    middle = np.arange(n) + 0.5 - n / 2
    distance = np.sqrt(middle[:, None, None] ** 2 + middle[:, None] ** 2 + middle**2)
    share = (distance < radius).astype(float)
    near = np.argwhere(np.abs(distance - radius) <= np.sqrt(3) / 2)
    part = (np.arange(samples) + 0.5) / samples - 0.5
    for some in np.array_split(near, len(near) // 1000 + 1):
        z, y, x = (middle[some[:, axis], None] + part for axis in range(3))
        squares = z[:, :, None, None] ** 2 + y[:, None, :, None] ** 2 + x[:, None, None, :] ** 2
        share[tuple(some.T)] = np.mean(squares < radius**2, axis=(1, 2, 3))
    return share


def voxels(n, layers=0):
    """1 where at least half of a voxel is sphere, else 0. @param layers more or less along the first axis: the array goes on"""
    phase = (shares(n) >= 0.5).astype(np.uint8)
    return np.concatenate([phase, phase[:layers]]) if layers > 0 else phase[:n + layers]
