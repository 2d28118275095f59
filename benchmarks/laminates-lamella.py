"""Rotated laminates on elements, of isotropic and of orthotropic materials, against their exact tensor.

Prints a table: the tensor's largest error over its norm, with 16, 32 and 64 voxels a side as they are, and extrapolated from the
last two. `plain`: a voxel is of the phase in its middle. `within`: of isotropic materials also with a tensor for each voxel that a
surface cuts, its phases in series across the surface and in parallel along it.
"""

import argparse
import time

import lamella
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk

SIZES = (16, 32, 64)
SAMPLES = 8  # along each axis, of a voxel's share


def turned(principal, angle, about):
    """An orthotropic tensor of these principal values, turned by an angle about an axis."""
    n = np.asarray(about, dtype=float) / np.linalg.norm(about)
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turn @ np.diag(principal) @ turn.T


MATERIALS = {
    "isotropic, 10": (np.eye(3), 10 * np.eye(3)),
    "orthotropic": (turned((10, 3, 1), 0.5, (1, 1, 0.2)), turned((1, 0.2, 0.5), -0.9, (0.3, -1, 1))),
}


def layered(first, second, normal, share):
    """The tensor of layers of two materials, a share of the second (Milton, The Theory of Composites, 2002, chapter 9)."""
    n = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
    parts = [(1 - share, first, first @ n, n @ first @ n), (share, second, second @ n, n @ second @ n)]
    flux = sum(f * kn / a for f, _, kn, a in parts)
    tensor = sum(f * (k - np.outer(kn, kn) / a) for f, k, kn, a in parts)
    return tensor + np.outer(flux, flux) / sum(f / a for f, _, _, a in parts)


def shares(size, waves, samples):
    """The share of the second material in each voxel, indexed [z, y, x]."""
    found = np.zeros((size,) * 3)
    steps = (np.arange(size * samples) + 0.5) / (size * samples)
    for dz in range(samples):
        for dy in range(samples):
            for dx in range(samples):
                z, y, x = steps[dz::samples], steps[dy::samples], steps[dx::samples]
                phase = waves[0] * x + waves[1] * y[:, None] + waves[2] * z[:, None, None] + 0.137
                found += phase - np.floor(phase) < 0.5
    return found / samples**3


def solved(size, waves, pair, within):
    found = shares(size, waves, SAMPLES if within else 1)
    volume = lamella.from_array((found > 0.5).astype(np.uint8), names=["first", "second"])
    given = {"first": pair[0], "second": pair[1]}
    if within:
        levels = SAMPLES**3
        table = np.array([layered(*pair, waves, level / levels).ravel() for level in range(levels + 1)])
        rows = numpy_to_vtk(table[np.rint(found.ravel() * levels).astype(int)], deep=True)
        rows.SetName("tensor")
        volume.vtk.GetPointData().AddArray(rows)
        given = {}
    return lamella.diffusion(volume, given, sides="periodic", tolerance=1e-6)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.parse_known_args()
    print("| materials | layers across | voxels | 16 | 32 | 64 | extrapolated from 32 and 64 | order | iterations | seconds at 64 |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, pair in MATERIALS.items():
        for waves in ((1, 1, 1), (1, 2, 2), (1, -1, 3)):
            exact = layered(*pair, waves, 0.5)
            for within in (False, True):
                tensors, iterations, seconds = [], 0, 0
                for size in SIZES:
                    begun = time.perf_counter()
                    result = solved(size, waves, pair, within)
                    seconds = time.perf_counter() - begun
                    iterations = max(iterations, *result.iterations.values())
                    tensors.append(result.effective)
                error = [np.abs(k - exact).max() / np.linalg.norm(exact) for k in [*tensors, 2 * tensors[2] - tensors[1]]]
                print(f"| {name} | {', '.join(map(str, waves))} | {'within' if within else 'plain'} | "
                      + " | ".join(f"{e:.1e}" for e in error)
                      + f" | {np.log2(error[1] / error[2]):.2f} | {iterations} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
