"""One run of another program on a volume, for the benchmark "elements": the six unit strains of a box that repeats.

    PYTHON benchmarks/elements-peers.py mugrid|fourier FILE_u8.raw NX,NY,NZ TOLERANCE ID=YOUNG,POISSON ...

  mugrid   muGrid (`pip install muGrid NuMPI muTimer`): the same trilinear elements, matrix-free, conjugate gradients preconditioned by a
           homogeneous material in Fourier space (FFT); one core
  fourier  a plain version: conjugate gradients on strains, projected in Fourier space (Zeman, Vondrejc, Novak & Marek, J. Comput. Phys. 229
           (2010) 8065) on the rotated grid (Willot, C. R. Mecanique 343 (2015) 232), which voids want; numpy alone, one core

Prints the tensor, seconds of wall and processor after the libraries are there, and peak bytes as a line of JSON.
"""

import json
import resource
import sys
import time

import numpy as np

PAIRS = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]


def by_mugrid(lam, mu, tolerance):
    import muGrid
    from muGrid.Preconditioners import make_reference_stiffness_preconditioner
    from muGrid.Solvers import conjugate_gradients

    world = muGrid.Communicator()
    grid = muGrid.FFTEngine(lam.shape, world, nb_ghosts_left=(1,) * 3, nb_ghosts_right=(1,) * 3)
    space = grid.real_space_collection
    fields = {name: space.real_field(name) for name in ("lam", "mu")}
    for name, values in (("lam", lam), ("mu", mu)):
        fields[name].p[...] = values
        grid.communicate_ghosts(fields[name])
    u, force = space.real_field("u", (3,)), space.real_field("force", (3,))
    product = muGrid.IsotropicStiffnessOperator3D((1.0,) * 3, muGrid.FEMElement.q1)
    means = float(lam.mean()), float(mu.mean())

    def apply(x, y):
        grid.communicate_ghosts(x)
        product.apply(x, fields["lam"], fields["mu"], y)

    def reference(x, y):
        grid.communicate_ghosts(x)
        product.apply_uniform(x, *means, y)

    smooth = make_reference_stiffness_preconditioner(grid, reference, 3, dtype=np.float64)
    tensor, iterations = np.zeros((6, 6)), []
    for case, (i, j) in enumerate(PAIRS):
        strain = np.zeros((3, 3))
        strain[i, j] += 0.5
        strain[j, i] += 0.5
        flat = [float(v) for v in strain.ravel()]
        product.apply_macro_rhs(fields["lam"], fields["mu"], flat, force)
        force.s[...] *= -1.0
        u.s[...] = 0.0
        count = [0]
        conjugate_gradients(world, space, force, u, hessp=apply, prec=smooth, rtol=tolerance, maxiter=20000,
                            callback=lambda n, _: count.__setitem__(0, n))
        iterations.append(count[0])
        grid.communicate_ghosts(u)
        stress = np.array(product.average_stress(u, fields["lam"], fields["mu"], flat)).reshape(3, 3) / lam.size
        tensor[:, case] = [stress[pair] for pair in PAIRS]
    return tensor, iterations


def by_fourier(lam, mu, tolerance):
    shape = lam.shape
    waves = [2 * np.pi * np.fft.fftfreq(n) for n in shape[:2]] + [2 * np.pi * np.fft.rfftfreq(shape[2])]
    turns = [np.exp(1j * wave) for wave in np.meshgrid(*waves, indexing="ij", sparse=True)]
    way = [(turns[a] - 1) * (turns[(a + 1) % 3] + 1) * (turns[(a + 2) % 3] + 1) / 4 for a in range(3)]
    norm = sum(np.abs(v) ** 2 for v in way)
    way = np.stack([v * np.where(norm > 1e-12, 1 / np.sqrt(np.maximum(norm, 1e-12)), 0) for v in way])
    place = {pair: c for c, pair in enumerate(PAIRS)}

    def compatible(field):
        found = np.fft.rfftn(field, axes=(1, 2, 3))
        along = [sum(found[place[min(i, j), max(i, j)]] * way[j].conj() for j in range(3)) for i in range(3)]
        twice = sum(along[i] * way[i].conj() for i in range(3))
        shift = [2 * along[i] - way[i] * twice for i in range(3)]
        for c, (i, j) in enumerate(PAIRS):
            found[c] = 0.5 * (shift[i] * way[j] + shift[j] * way[i])
        return np.fft.irfftn(found, s=shape, axes=(1, 2, 3))

    def stress(strain):
        found = 2 * mu * strain
        found[:3] += lam * (strain[0] + strain[1] + strain[2])
        return found

    def dot(a, b):
        return sum(weight * float(np.dot(x.ravel(), y.ravel())) for weight, x, y in zip((1, 1, 1, 2, 2, 2), a, b))

    tensor, iterations = np.zeros((6, 6)), []
    for case in range(6):
        mean = np.zeros(6)
        mean[case] = 1 if case < 3 else 0.5
        strain = np.broadcast_to(mean[:, None, None, None], (6, *shape)).copy()
        rest = -compatible(stress(strain))
        way_down, square, count = rest.copy(), dot(rest, rest), 0
        first = square
        while square > tolerance**2 * first and square > 1e-26 and count < 20000:
            product = compatible(stress(way_down))
            step = square / dot(way_down, product)
            strain += step * way_down
            rest -= step * product
            before, square = square, dot(rest, rest)
            way_down = rest + square / before * way_down
            count += 1
        iterations.append(count)
        tensor[:, case] = stress(strain).reshape(6, -1).mean(axis=1)
    return tensor, iterations


def main():
    method, file, size, tolerance = sys.argv[1:5]
    tables = np.zeros((2, 256))
    for word in sys.argv[5:]:
        number, constants = word.split("=")
        young, poisson = map(float, constants.split(","))
        tables[:, int(number)] = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    phase = np.fromfile(file, np.uint8).reshape([int(n) for n in size.split(",")][::-1]).transpose(2, 1, 0)
    start = time.perf_counter(), time.process_time()
    tensor, iterations = {"mugrid": by_mugrid, "fourier": by_fourier}[method](tables[0][phase], tables[1][phase], float(tolerance))
    print(json.dumps({"stiffness": tensor.tolist(), "iterations": iterations, "wall_seconds": time.perf_counter() - start[0],
                      "cpu_seconds": time.process_time() - start[1],
                      "peak_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss}))


if __name__ == "__main__":
    main()
