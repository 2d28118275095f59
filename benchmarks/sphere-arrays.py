"""Effective conductivity of the simple cubic array of spheres: the truths of the benchmark "surface-shares".

    /usr/bin/python3 benchmarks/sphere-arrays.py [output=FILE] [membranes=FILE]

Checks itself against known values, then writes two files (default: benchmarks/sphere-arrays.csv and sphere-membranes.csv). Conductivities
are over the matrix's.

Rayleigh's method (Phil. Mag. 34 (1892) 481) as McPhedran and McKenzie (Proc. R. Soc. A 359 (1978) 45) and Sangani and Acrivos (Proc. R. Soc.
A 386 (1983) 263) have it. Cells of side 1, mean gradient 1 along z. Around a sphere of radius a the potential is the sum over l, m of
A_lm r^l Y_lm + B_lm r^-(l+1) Y_lm; by symmetry l is odd and m a multiple of 4. The sphere's surface asks

    B_lm = -a^(2l+1) l (s - 1) / (s l + l + 1) A_lm

and A_lm is the mean gradient and what the multipoles of all other spheres add: sums over the lattice of solid harmonics of the orders
l + l' = 2, 4, 6 ... That of order 2 does not converge absolutely; periodic potentials without a mean gradient give it the value 2 pi/3. The
others are done as Ewald's sums. Of the dipole, k = 1 - 4 pi B_10. Orders l grow until the first 8 digits stand still.

Spheres whose surface has a resistance R, where the potential jumps by R times the flux: inside it is A r^l, the flux k l A a^(l-1), the
potential outside A a^l (1 + l k R/a). So at order l they answer like perfect ones of the conductivity k/(1 + l k R/a), and at l = 1 as
Hasselman and Johnson (J. Compos. Mater. 21 (1987) 508) and Benveniste (J. Appl. Phys. 61 (1987) 2840) have it.
"""

import csv
import pathlib
import sys
from math import erfc, lgamma, log, pi

import numpy as np
from spheres import sangani_acrivos

FRACTIONS = (0.1, 0.2, 0.3, 0.4, 0.5)
CONTRASTS = (0, 0.001, 0.1, 10, 1000, 1e6)
MEMBRANES = {0.1: (0.1, 1, 10), 10: (0.1, 0.9, 1, 10), 1000: (0.1, 0.999, 1, 10)}  # R over radius and matrix, by contrast
STILL = 1e-9  # change, relative, by four more orders
HIGHEST = 61  # order l: enough for a gap between spheres of 0.015, at any contrast
REACH = 6  # cells along each axis; what lies beyond is below 1e-15


def legendre(n, m, x):
    """sqrt((n - m)!/(n + m)!) P_nm(x), m >= 0, without the phase (-1)^m: m is even here"""
    here = np.exp(0.5 * lgamma(2 * m + 1) - m * log(2) - lgamma(m + 1)) * (1 - x * x) ** (m / 2)
    before = np.zeros_like(here)
    for k in range(m + 1, n + 1):
        before, here = here, ((2 * k - 1) * x * here - np.sqrt((k - 1) ** 2 - m**2) * before) / np.sqrt(k**2 - m**2)
    return here


def upper_gamma(n, x):
    """Gamma(n + 1/2, x)/Gamma(n + 1/2)"""
    q = erfc(np.sqrt(x))
    for k in range(n):
        q += np.exp((k + 0.5) * log(x) - x - lgamma(k + 1.5))
    return q


def lattice_sums(highest):
    """{(n, k): sum over R of legendre(n, k, cos theta) cos(k phi)/R^(n+1)}, even n from 4 to highest, k = 0, 4 ... n"""
    x, y, z = (axis.ravel() for axis in np.mgrid[-REACH : REACH + 1, -REACH : REACH + 1, -REACH : REACH + 1])
    square = x * x + y * y + z * z
    near = (square > 0) & (square <= REACH**2)
    x, y, z, square = x[near], y[near], z[near], square[near]
    cosine = z / np.sqrt(square)
    angle = np.arctan2(y, x)
    shells = np.unique(square)
    sums = {}
    for n in range(4, highest + 1, 2):
        # theta functions: sum of H(R)/R^(2n+1), H of degree n, is split where t = 1; both halves fall like exp(-pi R^2)
        direct = np.array([upper_gamma(n, pi * q) * q ** (-(n + 1) / 2) for q in shells])
        dual = np.array([np.exp((n + 0.5) * log(pi) - lgamma(n + 0.5) + n / 2 * log(q) - pi * q - log(pi * q)) for q in shells])
        weight = (direct + (-1) ** (n // 2) * dual)[np.searchsorted(shells, square)]
        for k in range(0, n + 1, 4):
            sums[n, k] = np.sum(weight * legendre(n, k, cosine) * np.cos(k * angle))
    sums[2, 0] = 2 * pi / 3
    return sums


SUMS = lattice_sums(2 * HIGHEST)


def matrix(highest, radius):
    """What multipole (l, m) adds to the regular part (j, k), both scaled to the radius and by sqrt((l - m)! (l + m)!)"""
    orders = [(l, m) for l in range(1, highest + 1, 2) for m in range(0, l + 1, 4)]

    def entry(j, k, l, m):
        n, t = j + l, abs(m + k)
        size = (lgamma(n - t + 1) + lgamma(n + t + 1) - lgamma(l - m + 1) - lgamma(l + m + 1) - lgamma(j - k + 1) - lgamma(j + k + 1)) / 2
        return -SUMS[n, t] * np.exp(size + (n + 1) * log(radius))  # the sign is (-1)^j

    # of m > 0 the multipoles of m and -m are alike
    return orders, np.array([[entry(j, k, l, m) + (entry(j, k, l, -m) if m else 0) for l, m in orders] for j, k in orders])


def behind(contrast, resistance, order):
    """What a sphere with a resistance on its surface seems to conduct"""
    return contrast / (1 + order * resistance * contrast) if contrast < float("inf") else 1 / (order * resistance) if resistance else contrast


def truncated(fraction, contrast, highest, resistance):
    radius = np.cbrt(3 * fraction / (4 * pi))
    orders, added = matrix(highest, radius)
    seen = [behind(contrast, resistance, l) for l, _ in orders]
    jump = np.array([l * (s - 1) / (l * (s - 1) + 2 * l + 1) if s < float("inf") else 1.0 for (l, _), s in zip(orders, seen)])
    gradient = np.zeros(len(orders))
    gradient[0] = 1
    multipoles = np.linalg.solve(np.eye(len(orders)) + jump[:, None] * added, -jump * gradient)
    return 1 - 3 * fraction * multipoles[0]


def conductivity(fraction, contrast, resistance=0.0):
    """@param contrast sphere over matrix, 0 to infinity
    @param resistance of the sphere's surface, over its radius and times the matrix's conductivity"""
    value = truncated(fraction, contrast, 1, resistance)
    for highest in range(5, HIGHEST + 1, 4):
        before, value = value, truncated(fraction, contrast, highest, resistance)
        if abs(value - before) < STILL * value:
            return value
    raise SystemExit(f"error: fraction {fraction}, contrast {contrast}: orders to {HIGHEST} do not suffice")


def check():
    """Ends with an error where a known value is not met."""
    infinite = float("inf")
    known = [  # name, value, what it must be, within
        # McPhedran & McKenzie 1978, to their digits
        *((f"fraction {f}, contrast {s}", conductivity(f, s), value, 0.5e-4)
          for f, s, value in ((0.1, 10, 1.2433), (0.1, infinite, 1.3336), (0.3, 10, 1.8877), (0.3, infinite, 2.3329),
                              (0.4, 10, 2.3644), (0.4, infinite, 3.2626))),
        # Sangani & Acrivos 1983, equation 52: a series that ends, which the larger fractions show
        ("fraction 0.3, contrast 0", conductivity(0.3, 0), 0.60567, 1e-5),
        *((f"fraction {f}, contrast {s:g}", conductivity(f, s), sangani_acrivos(f, s), within)
          for f, within in ((0.05, 0.5e-6), (0.1, 0.5e-6), (0.2, 0.5e-5)) for s in (0, 0.1, 10, 1e9)),
        # Rayleigh's first two sums, of P_4/R^5 and P_6/R^7
        ("sum of order 4", SUMS[4, 0], 3.1082, 0.5e-4),
        ("sum of order 6", SUMS[6, 0], 0.5733, 0.5e-4),
        ("contrast 1", conductivity(0.5, 1), 1, 1e-12),
    ]
    for s in (0, 0.1, 10, infinite):  # Maxwell: the next term is of the order fraction^(13/3)
        part = 1e-3 * (1 - 3 / (s + 2))
        known.append((f"fraction 0.001, contrast {s}", conductivity(1e-3, s), (1 + 2 * part) / (1 - part), 1e-11))
    for s, r in ((0.1, 1), (10, 0.1), (10, 10), (infinite, 1)):  # Hasselman and Johnson
        part = 1e-3 * (1 - 3 / (behind(s, r, 1) + 2))
        known.append((f"fraction 0.001, contrast {s}, resistance {r}", conductivity(1e-3, s, r), (1 + 2 * part) / (1 - part), 1e-11))
    known.append(("a sphere that is not seen", conductivity(0.4, 10, 0.9), 1, 1e-12))
    known.append(("a surface that lets nothing through", conductivity(0.3, 10, 1e9), conductivity(0.3, 0), 1e-8))
    failed = [f"{name}: {value:.9g} instead of {wanted:.9g}" for name, value, wanted, within in known if not abs(value - wanted) <= within]
    if failed:
        raise SystemExit("error: " + "\n".join(failed))
    print(f"{len(known)} known values met")


def main():
    keys = dict(word.partition("=")[::2] for word in sys.argv[1:])
    check()
    file = pathlib.Path(keys.get("output", pathlib.Path(__file__).with_suffix(".csv")))
    with file.open("w", newline="") as out:
        out.write("# Effective conductivity of the simple cubic array of spheres by sphere-arrays.py. Contrast: sphere over matrix.\n")
        table = csv.writer(out, lineterminator="\n")
        table.writerow(["fraction", "contrast", "conductivity"])
        table.writerows([f, f"{s:g}", f"{conductivity(f, s):.8f}"] for f in FRACTIONS for s in CONTRASTS)
    print(file)
    file = pathlib.Path(keys.get("membranes", pathlib.Path(__file__).with_name("sphere-membranes.csv")))
    with file.open("w", newline="") as out:
        out.write("# The same of spheres whose surface has a resistance: times the matrix's conductivity, over the radius.\n")
        table = csv.writer(out, lineterminator="\n")
        table.writerow(["fraction", "contrast", "resistance", "conductivity"])
        table.writerows([f, f"{s:g}", f"{r:g}", f"{conductivity(f, s, r):.8f}"] for f in FRACTIONS[:4] for s in MEMBRANES for r in MEMBRANES[s])
    print(file)


if __name__ == "__main__":
    main()
