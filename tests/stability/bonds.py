"""Stiffness, equilibrium, fracture and motion of bonds: judged by a dense solve of the same bonds, balances and scales."""

import itertools
import math

import numpy as np

from settings import NAMES, Sample, random_nodes

VOIDS = ["void", "beta", "gamma", "delta"]


def offsets(dimension, horizon):
    reach = math.floor(horizon + 1e-9)
    for step in itertools.product(range(-reach, reach + 1), repeat=dimension):
        if step > (0,) * dimension and sum(s * s for s in step) <= horizon**2 * (1 + 1e-12):
            yield np.array(step)


def micromodulus(dimension, horizon, continuum):
    factor = {"plane-stress": 9 / math.pi, "plane-strain": 48 / (5 * math.pi), "space": 12 / math.pi}[continuum]
    return factor / horizon ** (dimension + 1)


class Bonds:
    """All bonds of a small sample, in lists. Axes as in arrays, the last is x; node distance 1."""

    def __init__(self, young, horizon, continuum, periodic=False):
        """@param young of every node, 0: void"""
        self.shape, self.dimension = young.shape, young.ndim
        self.number = np.arange(young.size).reshape(young.shape)
        c = micromodulus(self.dimension, horizon, continuum)
        self.first, self.second, self.step, self.stiffness = [], [], [], []
        for step in offsets(self.dimension, horizon):
            other = np.roll(young, tuple(-step), axis=tuple(range(self.dimension)))
            number = np.roll(self.number, tuple(-step), axis=tuple(range(self.dimension)))
            there = (young > 0) & (other > 0)
            if not periodic:
                for axis, s in enumerate(step):
                    place = np.indices(self.shape)[axis] + s
                    there &= (place >= 0) & (place < self.shape[axis])
            e = 2 / (1 / young[there] + 1 / other[there])
            self.first += list(self.number[there])
            self.second += list(number[there])
            self.step += [step] * int(there.sum())
            self.stiffness += list(c * e / np.linalg.norm(step))  # c s with s = η·ξ/|ξ|², along ξ/|ξ|
        self.first, self.second = np.array(self.first, int), np.array(self.second, int)
        self.step = np.array(self.step, float).reshape(-1, self.dimension)
        self.stiffness = np.array(self.stiffness)
        self.normal = self.step / np.maximum(np.linalg.norm(self.step, axis=1), 1)[:, None]
        if len(self.step):
            self.normal = self.step / np.linalg.norm(self.step, axis=1)[:, None]

    def matrix(self):
        d, n = self.dimension, int(np.prod(self.shape))
        k = np.zeros((n, d, n, d))
        blocks = self.stiffness[:, None, None] * self.normal[:, :, None] * self.normal[:, None, :]
        for i, j, block in zip(self.first, self.second, blocks):
            k[i, :, i] += block
            k[j, :, j] += block
            k[i, :, j] -= block
            k[j, :, i] -= block
        return k.reshape(n * d, n * d)

    def stretches(self, u):
        """Elongation over length, of displacements by node."""
        length = np.linalg.norm(self.step, axis=1)
        return np.einsum("ba,ba->b", u[self.second] - u[self.first], self.normal) / length

    def mean_tensor(self):
        """Effective stiffness of a periodic cell, by mean strains; rows and columns xx, yy(, zz, yz, xz), xy."""
        d, n = self.dimension, int(np.prod(self.shape))
        x = {name: d - 1 - "xyz".index(name) for name in "xyz"[:d]}  # axis of the array
        pairs = [("x", "x"), ("y", "y"), ("x", "y")] if d == 2 else [
            ("x", "x"), ("y", "y"), ("z", "z"), ("y", "z"), ("x", "z"), ("x", "y")]
        elongation = []  # n · ε ξ under each unit strain; shear strains are angles
        for p, q in pairs:
            s = self.step
            m = self.normal
            value = m[:, x[p]] * s[:, x[p]] if p == q else 0.5 * (m[:, x[p]] * s[:, x[q]] + m[:, x[q]] * s[:, x[p]])
            elongation.append(value)
        elongation = np.array(elongation).T
        k = self.matrix()
        force = np.zeros((n * d, len(pairs)))
        for a in range(d):
            pull = self.stiffness[:, None] * elongation * self.normal[:, a][:, None]
            np.add.at(force, self.first * d + a, pull)
            np.add.at(force, self.second * d + a, -pull)
        u = np.linalg.lstsq(k, force, rcond=1e-12)[0].reshape(n, d, len(pairs))
        total = elongation + np.einsum("bac,ba->bc", u[self.second] - u[self.first], self.normal)
        return (total * self.stiffness[:, None]).T @ total / n


def materials(setting, sample, voids, widest):
    young = [setting.magnitude(-widest / 2, widest / 2) * 1e9 for _ in range(4)]
    names = VOIDS if voids else NAMES
    words = []
    for phase in sample.present:
        if not (voids and phase == 0):
            words += ["--young", f"{names[phase]}={young[phase]!r}"]
    if voids:
        young[0] = 0.0
    return young, names, [*words, "--mixing", "harmonic"]


def stiffness(setting):
    dimension = setting.one_of(2, 2, 3)
    nodes = random_nodes(setting, dimension, least=setting.one_of(1, 3, 5), most=(14, 6))
    sample = Sample(setting, nodes)
    voids = setting.chance(0.4)
    widest = setting.one_of(0.3, 3, 6, 24)
    young, names, words = materials(setting, sample, voids, widest)
    horizon = setting.one_of(1, 1.5, 2, 3, 3, 4)
    continuum = "space" if dimension == 3 else setting.one_of("plane-stress", "plane-strain")
    command = ["bond-stiffness", *sample.words(names), *words, "--micromodulus", "continuum", "--horizon", horizon, "--continuum", continuum]
    command += ["--no-error-estimate"] if setting.chance(0.7) else []
    command += ["--threads", "2"] if setting.chance(0.1) else []
    answer = setting.lamella(*command)
    c = np.array(answer["stiffness"])
    e = np.array(young)[nodes]
    setting.must(np.isfinite(c).all(), "not finite")
    values = np.linalg.eigvalsh((c + c.T) / 2)
    doubt = "so far below"
    setting.should(values[0] >= -1e-5 * values[-1], f"a negative stiffness: {values[0]} of {values[-1]}", doubt)
    voigt = np.array(answer["bounds"]["voigt"])
    setting.must(np.linalg.eigvalsh(voigt - (c + c.T) / 2)[0] >= -1e-5 * np.abs(voigt).max(), "above Voigt's bound")
    setting.against("bounds")
    if e.size * dimension <= 500 and e.max() > 0 and e.max() <= 1e6 * e[e > 0].min():
        right = Bonds(e / e.max(), horizon, continuum, periodic=True).mean_tensor() * e.max()
        setting.against("dense solve")
        off = np.abs(c - right).max() / max(np.abs(right).max(), 1e-9 * e.max())
        # the residual is 1e-6 of the forces of the mean strain; a warning tells where that may be more than 1 %
        setting.should(off < 1e-2, f"the stiffness errs by {off} of its largest component", doubt)


def platens(setting, dimension, reach):
    """Nodes, with enough of them between the platens."""
    nodes = random_nodes(setting, dimension, least=setting.one_of(1, 2, 2 * reach + 2), most=(14, 7))
    return nodes


def equilibrium(setting):
    dimension = setting.one_of(2, 2, 3)
    horizon = setting.one_of(1, 1.5, 2, 3, 3, 4) if dimension == 2 else setting.one_of(1, 1.5, 2, 3)
    nodes = platens(setting, dimension, int(horizon))
    sample = Sample(setting, nodes)
    young, names, words = materials(setting, sample, setting.chance(0.4), setting.one_of(0.3, 3, 6, 24))
    continuum = "space" if dimension == 3 else setting.one_of("plane-stress", "plane-strain")
    axis = setting.one_of(*"xyz"[:dimension])
    strain = setting.one_of(1e-3, -1e-3, 1e-9, 0.3)
    stretch = setting.magnitude(-8, 0)
    command = ["equilibrium", *sample.words(names), *words, "--micromodulus", "continuum", "--horizon", horizon, "--continuum", continuum, "--axis", axis,
               f"--strain={strain}"]
    for phase in sample.present:
        if young[phase] > 0:
            command += ["--critical-stretch", f"{names[phase]}={stretch!r}"]
    smooth = setting.chance(0.3)
    command += ["--smooth-platens"] if smooth else []
    command += ["--solver", setting.one_of("jacobi", "direct", "dynamic-relaxation")] if setting.chance(0.15) else []
    command += ["--threads", "2"] if setting.chance(0.1) else []
    answer = setting.lamella(*command)
    modulus = answer["effective_modulus"]
    e = np.array(young)[nodes]
    setting.against("balance")
    doubt = "the platens pull with"
    a = "xyz".index(axis)
    low, high = answer["reactions"]["low"], answer["reactions"]["high"]
    scale = max(abs(low[a]), abs(high[a]))
    if scale > 1e-9 * e.max() * abs(strain) * 1e-6:
        setting.should(abs(low[a] + high[a]) <= 1.01e-2 * scale, f"the platens pull with {low[a]} and {high[a]}", doubt)
    setting.should(modulus >= -1e-9 * e.max(), f"the modulus is {modulus}", "tolerance of nothing")
    if e.size * dimension <= 700 and e.max() > 0 and e.max() <= 1e6 * e[e > 0].min():
        right, first = stretched(e / e.max(), horizon, continuum, dimension - 1 - a, smooth)
        right *= e.max()
        setting.against("dense solve")
        if not any("tolerance of nothing" in line for line in setting.warnings):
            setting.near(modulus, right, 1e-3, "the modulus", floor=1e-6 * e.max())
        found = answer["first_break"]
        if strain > 0 and found is not None and right > 1e-6 * e.max() and len(sample.present) == 1:
            setting.near(found["strain"], stretch / first, 1e-3, "the strain of the first break")


def stretched(young, horizon, continuum, axis, smooth):
    """Modulus, and largest elongation of a bond for a unit strain, by a dense solve; platens as the documentation says."""
    bonds = Bonds(young, horizon, continuum)
    d, n = bonds.dimension, young.size
    layers = math.floor(horizon + 1e-9)
    place = np.indices(young.shape)[axis].ravel()
    held = (place < layers) | (place >= young.shape[axis] - layers)
    given = np.zeros((n, d))
    given[:, axis] = np.where(held, place - (layers - 1), 0)
    fixed = np.zeros((n, d), bool)
    fixed[held, axis] = True
    if not smooth:
        fixed[held] = True
    k = bonds.matrix()
    free = ~fixed.ravel()
    u = given.ravel().copy()
    u[free] = np.linalg.lstsq(k[np.ix_(free, free)], -k[np.ix_(free, ~free)] @ u[~free], rcond=1e-12)[0]
    force = (k @ u).reshape(n, d)
    high = place >= young.shape[axis] - layers
    pull = force[high, axis].sum()
    strains = bonds.stretches(u.reshape(n, d))
    return pull / (n / young.shape[axis]), strains.max() if len(strains) else 0.0


def fracture(setting):
    dimension = setting.one_of(2, 2, 2, 3)
    horizon = setting.one_of(1.5, 2, 3, 3)
    nodes = platens(setting, dimension, int(horizon))
    sample = Sample(setting, nodes)
    young, names, words = materials(setting, sample, setting.chance(0.4), setting.one_of(0.3, 2, 6, 24))
    continuum = "space" if dimension == 3 else setting.one_of("plane-stress", "plane-strain")
    axis = setting.one_of(*"xyz"[:dimension])
    how = setting.one_of("stretch", "energy", "toughness")
    command = [*sample.words(names), "--horizon", horizon, "--continuum", continuum, "--axis", axis]
    for phase in sample.present:
        if young[phase] > 0:
            option = {"stretch": "critical-stretch", "energy": "fracture-energy", "toughness": "toughness"}[how]
            value = {"stretch": setting.magnitude(-6, -1), "energy": setting.magnitude(-3, 4), "toughness": setting.magnitude(2, 7)}[how]
            command += [f"--{option}", f"{names[phase]}={value!r}"]
    command += ["--breaking", "batched"] if setting.chance(0.3) else []
    command += ["--compression"] if setting.chance(0.15) else []
    command += ["--threads", "2"] if setting.chance(0.1) else []
    command += ["--max-broken", setting.whole(1, 400)]
    first = setting.lamella("fracture", *command, *words)
    broken = first["broken"]
    setting.must(0 <= broken <= first["bonds"], f"{broken} of {first['bonds']} bonds broke")
    setting.must(sum(first["broken_by_pair"].values()) == broken, f"by pair {first['broken_by_pair']}, in all {broken}")
    energy = first["broken_energy"]
    setting.must(energy is None or energy >= 0, f"the energy in broken bonds is {energy}")
    if first["first_break"]:
        setting.must(first["peak_stress"] >= first["first_break"]["stress"] * (1 - 1e-9), "the peak is below the first break")
        setting.against("equilibrium")
        e = np.array(young)[nodes]
        if "--compression" not in command and not any("may be off by" in line for line in setting.warnings):  # which it says from 1e-3 on
            still = setting.lamella("equilibrium", *command_of_equilibrium(command), *words)
            setting.near(first["effective_modulus"], still["effective_modulus"], 1e-3, "the modulus", floor=1e-7 * e.max())
            setting.near(first["first_break"]["strain"], still["first_break"]["strain"], 1e-3, "the first break")


def command_of_equilibrium(command):
    kept = []
    skip = 0
    for word in command:
        if skip:
            skip -= 1
            continue
        if word in ("--breaking", "--max-broken"):
            skip = 1
            continue
        kept.append(word)
    return kept


def dynamics(setting):
    dimension = setting.one_of(2, 2, 2, 3)
    horizon = setting.one_of(1.5, 2, 3, 3)
    nodes = platens(setting, dimension, int(horizon))
    sample = Sample(setting, nodes)
    young, names, words = materials(setting, sample, setting.chance(0.4), setting.one_of(0.3, 2, 6, 12))
    densities = [setting.magnitude(0, 4) for _ in range(4)]
    spacing = setting.magnitude(-9, 0)
    command = ["dynamics", *sample.words(names, pixel=repr(spacing)), *words, "--horizon", horizon]
    wave = 0.0
    for phase in sample.present:
        if young[phase] > 0:
            command += ["--density", f"{names[phase]}={densities[phase]!r}"]
            wave = max(wave, math.sqrt(young[phase] / densities[phase]))
            if setting.chance(0.7):
                command += ["--critical-stretch", f"{names[phase]}={setting.magnitude(-5, -1)!r}"]
    end = setting.magnitude(0, 2.3) * spacing / (wave or 1)
    axis = setting.one_of(*"xyz"[:dimension])
    kind = setting.one_of("pull", "velocity", "traction", "start")
    zeros = ["0"] * dimension
    if kind == "pull":
        command += ["--axis", axis, "--strain-rate", repr(setting.magnitude(-5, 0) * wave / spacing)]
    elif kind == "velocity":
        speed = list(zeros)
        speed["xyz".index(axis)] = repr(wave * setting.magnitude(-7, -1))
        command += ["--velocity", f"{axis}+=" + ",".join(speed)]
    elif kind == "traction":
        force = list(zeros)
        force["xyz".index(axis)] = repr(setting.magnitude(0, 9))
        command += ["--traction", f"{axis}+=" + ",".join(force)]
    else:
        speed = [repr(wave * setting.magnitude(-7, -1)) for _ in zeros]
        command += ["--initial-velocity", ",".join(speed)]
    command += ["--end-time", repr(end)]
    command += ["--damping", "0.1"] if setting.chance(0.2) else []
    command += ["--threads", "2"] if setting.chance(0.1) else []
    answer = setting.lamella(*command)
    energies = answer["energies"]
    defect = answer["energy_defect"]
    setting.against("energy")
    setting.must(all(math.isfinite(v) for v in energies.values()), f"energies {energies}")
    for name in ("kinetic", "elastic", "broken", "damped"):
        setting.must(energies[name] >= -1e-12 * max(map(abs, energies.values())), f"{name} energy is {energies[name]}")
    setting.should(defect is None or abs(defect) <= 0.05, f"the energies do not add up by {defect}", "energ")
    setting.must(0 <= answer["broken"] <= answer["bonds"], f"{answer['broken']} broken")
