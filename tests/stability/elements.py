"""Stiffness by elements: judged by a dense solve of the same elements, integrated here, and by bounds."""

import itertools
import math

import numpy as np

from settings import NAMES, Sample, random_nodes

VOIDS = ["void", "beta", "gamma", "delta"]
PLACE = {2: {(0, 0): 0, (1, 1): 1, (0, 1): 2}, 3: {(0, 0): 0, (1, 1): 1, (2, 2): 2, (1, 2): 3, (0, 2): 4, (0, 1): 5}}


def lame(young, poisson, continuum):
    return young * poisson / ((1 + poisson) * (1 - poisson if continuum == "plane-stress" else 1 - 2 * poisson)), young / (2 * (1 + poisson))


def tensor(lam, mu, d):
    n = 3 * (d - 1)
    c = np.diag([2 * mu] * d + [mu] * (n - d))
    c[:d, :d] += lam
    return c


def strains(d):
    """Of an element's corners, component by component: mean strain by displacement, and at each Gauss point."""
    corners = list(itertools.product((0, 1), repeat=d))  # of x, y(, z)
    points = []
    for q in corners:
        b = np.zeros((3 * (d - 1), d * len(corners)))
        for k, corner in enumerate(corners):
            for a in range(d):
                slope = 2 * corner[a] - 1
                for other in range(d):
                    if other != a:
                        slope *= 0.5 * (1 + (2 * corner[other] - 1) * (2 * q[other] - 1) / math.sqrt(3))
                for u in range(d):
                    b[PLACE[d][tuple(sorted((u, a)))], d * k + u] += slope
        points.append(b)
    return corners, np.mean(points, axis=0), points


class Elements:
    """@param lam, mu of every voxel, arrays [z,] y, x"""

    def __init__(self, lam, mu, periodic):
        self.d = d = lam.ndim
        self.shape = lam.shape[::-1]
        nodes = self.shape if periodic else tuple(n + 1 for n in self.shape)
        count = int(np.prod(nodes))
        corners, mean, points = strains(d)
        n = 3 * (d - 1)
        self.matrix, self.force, self.mean = np.zeros((d * count, d * count)), np.zeros((d * count, n)), np.zeros((n, n))
        held = np.zeros(nodes, bool)
        if not periodic:
            for axis in range(d):
                held[tuple(slice(None) if a != axis else [0, -1] for a in range(d))] = True
        made = {}
        for index in np.ndindex(self.shape):
            key = (lam[index[::-1]], mu[index[::-1]])
            if key not in made:
                full, capped = tensor(*key, d), tensor(min(key[0], 2 * key[1]), key[1], d)
                vary = sum((b - mean).T @ capped @ (b - mean) for b in points) / len(points)
                made[key] = mean.T @ full @ mean + vary, mean.T @ full, full
            stiffness, load, full = made[key]
            place = [np.ravel_multi_index(tuple((i + c) % m for i, c, m in zip(index, corner, nodes)), nodes) for corner in corners]
            where = np.array([d * p + u for p in place for u in range(d)])
            np.add.at(self.matrix, (where[:, None], where[None, :]), stiffness)
            np.add.at(self.force, where, -load)
            self.mean += full
        self.free = np.repeat(~held.ravel(), d)

    def solve(self):
        voxels = np.prod(self.shape)
        if not self.free.any():
            return self.mean / voxels
        a, f = self.matrix[np.ix_(self.free, self.free)], self.force[self.free]
        scale = 1 / np.sqrt(np.maximum(np.diag(a), 1e-300))
        values, modes = np.linalg.eigh(scale[:, None] * a * scale)
        load = modes.T @ (scale[:, None] * f)
        keep = values > 1e-11 * max(values[-1], 1e-300)
        return (self.mean - (load[keep] / values[keep, None]).T @ load[keep]) / voxels


def stiffness(setting):
    dimension = setting.one_of(2, 2, 3)
    nodes = random_nodes(setting, dimension, least=setting.one_of(1, 3, 6), most=(14, 6))
    sample = Sample(setting, nodes)
    voids, sides = setting.chance(0.4), setting.one_of("periodic", "periodic", "periodic", "uniform-strain", "straight", "slip", "uniform-stress")
    widest = setting.one_of(0.3, 3, 6, 12)
    continuum = "space" if dimension == 3 else setting.one_of("plane-stress", "plane-strain")
    names = VOIDS if voids else NAMES
    lam, mu, words = np.zeros(4), np.zeros(4), []
    for phase in sample.present:
        if voids and phase == 0:
            continue
        young, poisson = setting.magnitude(-widest / 2, widest / 2) * 1e9, round(setting.one_of(0.3, setting.random.uniform(-0.9, 0.49)), 6)
        lam[phase], mu[phase] = lame(young, poisson, continuum)
        words += ["--young", f"{names[phase]}={young!r}", "--poisson", f"{names[phase]}={poisson!r}"]
    command = ["stiffness", *sample.words(names), *words, "--sides", sides]
    command += ["--plane", continuum] if dimension == 2 else []
    command += ["--no-error-estimate"] if setting.chance(0.6) else []
    command += ["--threads", "2"] if setting.chance(0.1) else []
    command += ["--mean-strain", "xx=0.01"] if setting.chance(0.2) else []
    answer = setting.lamella(*command)
    c = np.array(answer["stiffness"])
    setting.must(np.isfinite(c).all(), "not finite")
    values = np.linalg.eigvalsh((c + c.T) / 2)
    voigt = np.array(answer["bounds"]["voigt"])
    floor = 1e-7 * np.abs(voigt).max()  # what rounding leaves of nothing
    setting.must(values[0] >= -1e-4 * values[-1] - floor, f"a negative stiffness: {values[0]} of {values[-1]}")
    if sides in ("periodic", "uniform-strain", "uniform-stress"):
        setting.must(np.linalg.eigvalsh(voigt - (c + c.T) / 2)[0] >= -1e-4 * np.abs(voigt).max(), "above Voigt's bound")
        reuss = np.array(answer["bounds"]["reuss"])
        setting.must(np.linalg.eigvalsh((c + c.T) / 2 - reuss)[0] >= -1e-4 * np.abs(voigt).max(), "below Reuss's bound")
    setting.against("bounds")
    l, m = lam[nodes], mu[nodes]
    flat = dimension == 3 and 1 in nodes.shape  # a volume of one layer is a picture, if that is the last axis
    if not flat and sides in ("periodic", "uniform-strain") and l.size * dimension <= 400 and m.max() > 0 and m.max() <= 1e6 * m[m > 0].min():
        right = Elements(l / m.max(), m / m.max(), sides == "periodic").solve() * m.max()
        setting.against("dense solve")
        size = max(np.abs(right).max(), 1e-5 * np.abs(voigt).max(), 1e-7 * m.max())
        off = np.abs(c - right).max() / size
        # the energy of each strain to 1e-6, so stresses besides to its root
        setting.must(off < 2e-3, f"the stiffness errs by {off} of its largest component")
        worst = np.abs(np.diag(c) - np.diag(right)).max() / size
        setting.must(worst < max(1e-4, 2 * answer["solver_error"]), f"the diagonal errs by {worst} of its largest")
