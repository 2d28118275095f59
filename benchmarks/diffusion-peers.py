"""Adds to the tables of the benchmark "diffusion" what others' solvers take on the same pictures, where they are installed.

    /usr/bin/python3 benchmarks/diffusion-peers.py [output=FOLDER] [limit=SECONDS] [quick] [fraction=AREA]

They solve what tools of the field assemble: finite volumes with harmonic faces on the pixels (D2Q5, D3Q7), one unknown each.

  scipy CG     conjugate gradients with Jacobi's preconditioner, as PuMA does   (python3-scipy)
  scipy LU     SuperLU, as OpenPNM does where it finds no other                 (python3-scipy)
  petsc AMG    conjugate gradients with BoomerAMG                               (python3-petsc4py)

Processor time of one thread, matrix and solve; iterations stop at a relative residual of 1e-8. A value that is not that of our own solver on
the same picture, within 1e-4, ends the script: one of the two is wrong then. `./dev bench diffusion` runs it after the measurements.
"""

import csv
import sys

from timing import timed  # first: from here on one thread

import numpy as np
from drawing import places, rows_of

SCENES = {  # dimension, share of the inclusion, conductivity of matrix and inclusion
    "heat": (2, None, (1, 0.023)),
    "vapour": (2, None, (0.004, 1)),
    "spheres": (3, 0.3, (1, 10)),
}
RESIDUAL = 1e-8  # at 1e-6 the value of Jacobi-CG errs by 1e-4 on 256 nodes across


def picture(dimension, n, fraction, conductivity):
    """A disk or a sphere in the middle of a cell, by pixel: its own value where the centre is inside."""
    radius = n * (np.cbrt(3 * fraction / (4 * np.pi)) if dimension == 3 else np.sqrt(fraction / np.pi))
    squares = (np.arange(n) + 0.5 - n / 2) ** 2
    distance = sum(np.meshgrid(*[squares] * dimension, indexing="ij"))
    return np.where(distance < radius * radius, conductivity[1], conductivity[0])


def system(k):
    """Row, column and value of the matrix, and the right-hand side: 1 and 0 on the faces of the last axis, half a pixel outside."""
    number = np.arange(k.size).reshape(k.shape)
    diagonal = np.zeros(k.shape)
    rows, columns, values = [], [], []
    for axis in range(k.ndim):
        low = tuple(slice(None, -1) if a == axis else slice(None) for a in range(k.ndim))
        high = tuple(slice(1, None) if a == axis else slice(None) for a in range(k.ndim))
        link = 2 / (1 / k[low] + 1 / k[high])
        diagonal[low] += link
        diagonal[high] += link
        for a, b in ((low, high), (high, low)):
            rows.append(number[a].ravel())
            columns.append(number[b].ravel())
            values.append(-link.ravel())
    diagonal[..., 0] += 2 * k[..., 0]
    diagonal[..., -1] += 2 * k[..., -1]
    right = np.zeros(k.shape)
    right[..., 0] = 2 * k[..., 0]
    rows.append(number.ravel())
    columns.append(number.ravel())
    values.append(diagonal.ravel())
    return np.concatenate(rows), np.concatenate(columns), np.concatenate(values), right.ravel()


def effective(k, u):
    """Mean of what the two faces say."""
    u = u.reshape(k.shape)
    inlet, outlet = np.sum(2 * k[..., 0] * (1 - u[..., 0])), np.sum(2 * k[..., -1] * u[..., -1])
    return 0.5 * (inlet + outlet) * k.shape[-1] / (k.size / k.shape[-1])


def with_scipy():
    import scipy
    from scipy import sparse
    from scipy.sparse import linalg

    def matrix(k):
        rows, columns, values, right = system(k)
        return sparse.csr_matrix((values, (rows, columns)), shape=(k.size, k.size)), right

    def iterations(k):
        a, right = matrix(k)
        u, failed = linalg.cg(a, right, tol=RESIDUAL, M=sparse.diags(1 / a.diagonal()), maxiter=10**6)
        assert not failed
        return u

    def direct(k):
        a, right = matrix(k)
        return linalg.spsolve(a.tocsc(), right)

    # how the time grows at least with twice the pixels along each axis, over the number of pixels
    return scipy.__version__, {"scipy CG": (iterations, 2), "scipy LU": (direct, 2)}


def with_petsc():
    import petsc4py

    petsc4py.init([sys.argv[0]])
    from petsc4py import PETSc

    def iterations(k):
        from scipy import sparse  # only to put the rows in order

        rows, columns, values, right = system(k)
        a = sparse.csr_matrix((values, (rows, columns)), shape=(k.size, k.size))
        matrix = PETSc.Mat().createAIJ(size=a.shape, csr=(a.indptr.astype(PETSc.IntType), a.indices.astype(PETSc.IntType), a.data))
        solver = PETSc.KSP().create()
        solver.setOperators(matrix)
        solver.setType("cg")
        solver.getPC().setType("hypre")
        solver.getPC().setHYPREType("boomeramg")
        solver.setTolerances(rtol=RESIDUAL)
        u = matrix.createVecRight()
        solver.solve(PETSc.Vec().createWithArray(right), u)
        assert solver.getConvergedReason() > 0
        return u.getArray().copy()

    return petsc4py.__version__, {"petsc AMG": (iterations, 1)}


def measure(scene, table, methods, limit, fraction):
    ours = {row["nodes"]: row for row in rows_of(table) if row["method"] == "steady" and row["stencil"] in ("d2q5", "d3q7")}
    dimension, share, conductivity = SCENES[scene]
    with open(table, "a", newline="", encoding="utf-8") as file:
        write = csv.writer(file, lineterminator="\n")
        for method, (solve, growth) in methods.items():
            last = 0
            for nodes, row in sorted(ours.items()):
                if growth * 2**dimension * last >= limit:
                    break
                k = picture(dimension, int(nodes), share or fraction, conductivity)
                u, last = timed(solve, k)
                value = effective(k, u)
                if abs(value / row["value"] - 1) > 1e-4:
                    sys.exit(f"error: {method} gives {value:.8g} for {scene} on {nodes:.0f} nodes, and our solver {row['value']:.8g}\n"
                             "hint: are fraction= and the tables those of one run?")
                error = value / (row["value"] / (1 + row["error"])) - 1
                write.writerow([scene, method, row["stencil"], int(nodes), value, error, last])
                print(f"{method:22} {row['stencil']:6} {nodes:5.0f}  {value:12.8f} {error:+10.2e} {last:10.4g}", flush=True)


def main():
    keys = {key: value or "1" for key, _, value in (argument.partition("=") for argument in sys.argv[1:])}
    folder, _ = places("diffusion")
    tables = {scene: folder / f"diffusion-{scene}.csv" for scene in SCENES}
    tables = {scene: table for scene, table in tables.items() if rows_of(table)}
    limit = float(keys.get("limit", 1 if "quick" in keys else 5))
    for peer, package in ((with_scipy, "python3-scipy"), (with_petsc, "python3-petsc4py")):
        try:
            version, methods = peer()
        except ImportError:
            print(f"  not measured: {package} is not installed")
            continue
        for scene, table in tables.items():
            done = {row["method"] for row in rows_of(table)}
            print(f"{scene}: {package} {version}")
            measure(scene, table, {name: how for name, how in methods.items() if name not in done}, limit, float(keys.get("fraction", 0.6)))


if __name__ == "__main__":
    main()
