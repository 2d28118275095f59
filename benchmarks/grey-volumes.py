"""Volumes of known phases as grey tomograms, with blur, noise, uneven light and rings, and what is found in them.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/grey-volumes.py [edge=80] [output=FOLDER] [real=FOLDER]

Prints the table of docs/solvers/segmentation.md: the share of voxels with the wrong phase by Otsu's level alone and by --segment, the share
of the solid and the conductivity along x, of the truth and as found. FOLDER (default: results/bench-grey-volumes) gets grey-volumes.csv.
`real`, or LAMELLA_REAL_DATA, is where berea_200x200x200_u8.raw.gz lies; without it that sample is left out.
"""

import csv
import gzip
import os
import sys
import tempfile
import time

import lamella
import numpy as np

VOID_SOLID = {"..otsu": "void", "otsu..": "solid"}
SCANS = {  # noise, how far it hangs together [voxels], light at the faces over that in the middle less 1, rings
    "blur": (0.02, 0, 0, 0),
    "noise 10 %": (0.1, 0, 0, 0),
    "noise 30 %": (0.3, 0, 0, 0),
    "noise 60 %": (0.6, 0, 0, 0),
    "coarse noise 20 %": (0.2, 0.8, 0, 0),
    "uneven light 40 %, noise 10 %": (0.1, 0, 0.4, 0),
    "rings 10 %, noise 10 %": (0.1, 0, 0, 0.1),
    "all three": (0.25, 0, 0.4, 0.05),
}


def blurred(values, deviation):
    """Convolved with a Gaussian, periodic."""
    if not deviation:
        return values
    transfer = 1.0
    for axis, n in enumerate(values.shape):
        frequency = np.fft.fftfreq(n) if axis < 2 else np.fft.rfftfreq(n)
        along = np.exp(-2 * (np.pi * frequency * deviation) ** 2)
        transfer = transfer * along.reshape([-1 if i == axis else 1 for i in range(3)])
    return np.fft.irfftn(np.fft.rfftn(values) * transfer, s=values.shape, axes=(0, 1, 2))


def tomogram(solid, noise, coarse, shade, rings, blur=0.8):
    """8-bit greys of a volume (z, y, x): void at 60, solid at 170, lengths in voxels, the rest over that contrast."""
    random = np.random.default_rng(1)
    z, y, x = (np.linspace(-1, 1, n) for n in solid.shape)
    square = (x[None, :] ** 2 + y[:, None] ** 2) / 2
    light = 1 + shade * (square[None] + 0.3 * z[:, None, None])
    share = blurred(solid.astype(float), blur) * light + 0.3 * shade * square[None]
    middle = (np.array(solid.shape[1:]) - 1) / 2
    radius = np.hypot(*(np.indices(solid.shape[1:]) - middle[:, None, None])).astype(int)
    share += rings * random.normal(size=radius.max() + 1)[radius][None]
    grain = blurred(random.normal(size=solid.shape), coarse)
    share += noise * grain / grain.std()
    return np.clip(np.rint(60 + 110 * share), 0, 255).astype(np.uint8)


def samples(edge, real):
    """Name: (solid or not, z y x; conductivity of void and solid)."""
    heat = {"void": 0.05, "solid": 1}
    wood = np.asarray(lamella.softwood((edge,) * 3, solid_fraction=0.35, spacing=1e-6, seed=2)) == 1
    yield "softwood, cells of 30 voxels", wood, heat
    thin = np.asarray(lamella.softwood((edge,) * 3, solid_fraction=0.3, spacing=2e-6, seed=2)) == 1
    yield "softwood, cells of 15 voxels", thin, heat
    cells = max(1, edge // 24)
    radius = (0.3 * 0.75 / np.pi) ** (1 / 3) * edge / cells
    yield f"spheres, radius of {radius:.0f} voxels", np.asarray(lamella.spheres((edge,) * 3, 0.3, cells)) == 1, heat
    path = os.path.join(real, "berea_200x200x200_u8.raw.gz") if real else ""
    if os.path.exists(path):
        with gzip.open(path) as file:
            rock = np.frombuffer(file.read(), np.uint8).reshape(200, 200, 200)
        start = (200 - edge) // 2
        part = tuple(slice(start, start + edge) for _ in range(3))
        yield "Berea sandstone", rock[part] == 0, {"void": 1, "solid": 0}


def effective(solid, conductivity):
    sample = lamella.from_array(np.ascontiguousarray(solid, np.uint8), ["void", "solid"])
    return lamella.diffusion(sample, conductivity, direction="x", field=False, flux=False).effective[0, 0]


def main():
    keys = dict(word.split("=", 1) for word in sys.argv[1:])
    edge = int(keys.get("edge", 80))
    folder = keys.get("output", "results/bench-grey-volumes")
    rows = []
    print("| sample | scan | wrong by Otsu's level [%] | wrong [%] | solid | found | conductivity | found | |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        for name, solid, conductivity in samples(edge, keys.get("real", os.environ.get("LAMELLA_REAL_DATA", ""))):
            true = effective(solid, conductivity)
            for scan, settings in SCANS.items():
                path = os.path.join(scratch, "t_{0}x{0}x{0}_u8.raw".format(edge))
                tomogram(solid, *settings).tofile(path)
                plain = np.asarray(lamella.read_picture(path, VOID_SOLID)) == 1
                start = time.perf_counter()
                sample = lamella.read_picture(path, VOID_SOLID, segment=True)
                seconds = time.perf_counter() - start
                found = np.asarray(sample) == 1
                value = effective(found, conductivity)
                row = {
                    "sample": name, "scan": scan, "edge": edge, "wrong_otsu": np.mean(plain != solid), "wrong": np.mean(found != solid),
                    "solid": solid.mean(), "found": found.mean(), "conductivity": true, "conductivity_found": value, "seconds": seconds,
                    "segmentation": "; ".join(sample.segmentation)}  # fmt: skip
                rows.append(row)
                print("| {sample} | {scan} | {0:.2f} | {1:.2f} | {solid:.4f} | {found:.4f} | {conductivity:.4f} | {conductivity_found:.4f} | "
                      "{2:+.1f} % |".format(100 * row["wrong_otsu"], 100 * row["wrong"], 100 * (value / true - 1), **row), flush=True)
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "grey-volumes.csv"), "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, rows[0])
        table.writeheader()
        table.writerows(rows)


if __name__ == "__main__":
    main()
