"""Measures our own part of the benchmark "volumes": error and processor time of the Python package on an array of spheres.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/volumes-lamella.py [output=FOLDER] [size=16,24,32,48,64,96,128,192,256]

Writes volumes-spheres.csv and volumes-pores.csv into FOLDER (default: results/bench-volumes). A cell of the simple cubic array, sphere 10 or
0 in matrix 1 (spheres.py); everything as the package has it by default, one thread, from the array of voxels to the value.

  voxels               one phase a voxel
  voxels extrapolated  2 x fine - coarse of that size and of half of it, both paid for
  shares               the sphere's share of each voxel as a grey
  shares extrapolated  the program's own `extrapolated`, one call: it solves the same and twice as coarse voxels
  layer more, less     voxels of a cell that is a layer longer or shorter along x: what others' solvers take the cell for

`./dev bench volumes` runs it, then volumes-peers.py, then volumes.py.
"""

import csv
import pathlib
import sys

from timing import timed  # first: from here on one thread

import lamella
import numpy as np
from spheres import CONDUCTIVITY, TRUTH, shares, voxels

SIZES = "16,24,32,48,64,96,128,192,256"
GREYS = 254


def diffusion(sample, low, high, **options):
    return lamella.diffusion(sample, {"low": low, "high": high}, "x", field=False, flux=False, **options)


def along_x(phase):
    """Volumes are [z, y, x]; layers are added along the first axis."""
    return np.ascontiguousarray(np.moveaxis(phase, 0, 2))


def of_voxels(phase, high):
    sample = lamella.from_array(phase, ["low", "high"])
    return diffusion(sample, 1, high, estimate_error=False).effective[0, 0]


def of_shares(grey, high):
    return diffusion(lamella.from_array(grey), 1, high, shares=(0, GREYS), estimate_error=False).effective[0, 0]


def extrapolated(grey, high):
    result = diffusion(lamella.from_array(grey), 1, high, shares=(0, GREYS))
    return result.extrapolated["x"]


def measure(scene, sizes):
    high = CONDUCTIVITY[scene]
    plain = {}
    for n in sizes:
        plain[n] = timed(of_voxels, along_x(voxels(n)), high)
        yield "voxels", n, *plain[n]
        if n // 2 in plain:
            coarse = plain[n // 2]
            yield "voxels extrapolated", n, 2 * plain[n][0] - coarse[0], plain[n][1] + coarse[1]
        grey = np.rint(GREYS * shares(n)).astype(np.uint8)
        yield "shares", n, *timed(of_shares, grey, high)
        yield "shares extrapolated", n, *timed(extrapolated, grey, high)
        yield "layer more", n, *timed(of_voxels, along_x(voxels(n, 1)), high)
        yield "layer less", n, *timed(of_voxels, along_x(voxels(n, -1)), high)


def main():
    keys = dict(word.partition("=")[::2] for word in sys.argv[1:])
    folder = pathlib.Path(keys.get("output", "results/bench-volumes"))
    folder.mkdir(parents=True, exist_ok=True)
    sizes = sorted(int(n) for n in keys.get("size", "16,32,64" if "quick" in keys else SIZES).split(","))
    lamella.diffusion(lamella.from_array(voxels(8), ["low", "high"]), {"low": 1, "high": 2}, "x")  # libraries are there from here on
    for scene, truth in TRUTH.items():
        print(f"{scene}: lamella {lamella.__version__}, true {truth:.5f}")
        with open(folder / f"volumes-{scene}.csv", "w", newline="", encoding="utf-8") as file:
            write = csv.writer(file, lineterminator="\n")
            write.writerow(["scene", "method", "nodes", "value", "error", "cpu_seconds"])
            for method, n, value, seconds in measure(scene, sizes):
                write.writerow([scene, method, n, value, value / truth - 1, seconds])
                print(f"{method:20} {n:5}  {value:12.8f} {value / truth - 1:+10.2e} {seconds:10.4g}", flush=True)


if __name__ == "__main__":
    main()
