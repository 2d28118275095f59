"""Measures the stiffness of volumes by elements: time, memory and iterations, by size, by material, and beside other programs.

    /usr/bin/python3 benchmarks/elements.py lamella=PROGRAM [output=FOLDER] [part=sizes,materials,peers] [size=64,128,200,400]
                                            [threads=2] [peers=mugrid:PYTHON,fourier:PYTHON]

Samples with a seed, which repeat: `tissue` (cells along z with end walls, 25 voxels across, walls of 3), `foam` (closed cells of Voronoi, the
same), `grains` (a dense packing of spheres of 16 voxels by `lamella packing`, cemented by `lamella bridges` to a saturation of 40 %), `shells`
(spheres of 16 voxels that stand at random in a shell of cement of 2, which hardly touch: many hang on one neck). Each row is one run of `lamella stiffness` without the
error, from the raw file to the tensor; bytes are those of all arrays of the solve, over the voxels of the box. Writes elements-PART.csv.

peers=mugrid:PYTHON,fourier:PYTHON: elements-peers.py by these interpreters on volumes of 64 and 100 of each sample, and ours with one thread,
all to a residual of `tolerance`: conjugate gradients' own measure, 1e-4; ours to its square in energy. `./dev bench elements` runs it.
"""

import csv
import json
import pathlib
import resource
import shlex
import subprocess
import sys
import tempfile

import numpy as np

CELL = 25  # voxels
WALL = 3
MATERIALS = {"tissue": {1: (1e10, 0.3)}, "foam": {1: (2e9, 0.35)}, "grains": {1: (1e10, 0.25), 2: (4e10, 0.2)},
             "shells": {1: (1e10, 0.25), 2: (4e10, 0.2)}}
BARE = {0: "void"}


def nearest(size, points, reach):
    """Distances of voxels to the nearest and the second nearest of some points in a box that repeats."""
    first = np.full(size, np.inf, np.float32)
    second = np.full(size, np.inf, np.float32)
    for point in points:
        index, square = [], 0
        for axis, (n, p) in enumerate(zip(size, point)):
            at = np.arange(int(p) - reach, int(p) + reach + 1) if 2 * reach + 1 < n else np.arange(n)
            distance = (at + 0.5 - p + n / 2) % n - n / 2
            index.append(at % n)
            square = square + (distance.astype(np.float32) ** 2).reshape([-1 if a == axis else 1 for a in range(len(size))])
        window = np.ix_(*index)
        found, best, next_best = np.sqrt(square), first[window], second[window]
        second[window] = np.minimum(next_best, np.maximum(best, found))
        first[window] = np.minimum(best, found)
    return first, second


def spread(random, size, count, apart):
    """Points no two of which are nearer than `apart`, in a box that repeats."""
    points = np.empty((0, len(size)))
    while len(points) < count:
        point = random.random(len(size)) * size
        way = (points - point + np.divide(size, 2)) % size - np.divide(size, 2)
        if not len(points) or (way**2).sum(1).min() > apart**2:
            points = np.vstack([points, point])
    return points


def drawn(kind, n):
    """z by y by x."""
    random = np.random.default_rng(7)
    if kind == "tissue":
        plane = (n, n)
        points = spread(random, plane, max(2, round((n / CELL) ** 2)), 0.6 * CELL)
        first, second = nearest(plane, points, 2 * CELL)
        walls = second - first < WALL
        owner = nearest_owner(plane, points)
        ends = random.integers(0, 4 * CELL, len(points))
        z = np.arange(n)[:, None, None]
        period = min(n, 4 * CELL)
        return (walls[None] | ((z + ends[owner][None]) % period < WALL)).astype(np.uint8)
    box = (n, n, n)
    if kind == "foam":
        first, second = nearest(box, spread(random, box, max(2, round((n / CELL) ** 3)), 0.6 * CELL), 2 * CELL)
        return (second - first < WALL).astype(np.uint8)
    radius = 8
    first, _ = nearest(box, spread(random, box, round(0.33 * n**3 / (4 / 3 * np.pi * radius**3)), 2 * radius), 12)
    return np.where(first < radius, 2, np.where(first < radius + 2, 1, 0)).astype(np.uint8)


def nearest_owner(size, points):
    y, x = np.meshgrid(*(np.arange(n) + 0.5 for n in size), indexing="ij")
    best, owner = np.full(size, np.inf), np.zeros(size, int)
    for i, (p, q) in enumerate(points):
        dy, dx = (y - p + size[0] / 2) % size[0] - size[0] / 2, (x - q + size[1] / 2) % size[1] - size[1] / 2
        square = dy**2 + dx**2
        owner[square < best] = i
        best = np.minimum(best, square)
    return owner


def packed(program, n, work):
    """Spheres of 16 voxels in the mean, cemented."""
    count = max(30, round(0.64 * n**3 / (4 / 3 * np.pi * 8**3)))
    for words in (["packing", "--dimension", "3", "--count", count, "--aspect", "1", "--periodic", "-o", "grains.vtp"],
                  ["bridges", "grains.vtp", "--saturation", "40%", "--nodes", n, "-o", "grains.vti"],
                  ["convert", "grains.vti", "--array", "phase", "-o", "grains_u8.raw"]):
        done = subprocess.run([program, *map(str, words), "--quiet", "--overwrite"], cwd=work, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(done.stderr)
    about = json.loads(subprocess.run([program, "info", "grains.vti", "--json"], cwd=work, capture_output=True, text=True, check=True).stdout)
    return np.fromfile(work / "grains_u8.raw", np.uint8).reshape(about["size"][::-1])


def sample(kind, n, program=None, work=None):
    """Larger ones are tiles of 200."""
    if n > 200 and n % 200 == 0:
        return np.tile(sample(kind, 200, program, work), (n // 200,) * 3)
    return packed(program, n, work) if kind == "grains" else drawn(kind, n)


def cpu_of(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def solved(program, file, shape, materials, threads, *options):
    names = {number: f"p{number}" for number in materials}
    words = [program, "stiffness", str(file), "--raw-size", ",".join(map(str, shape)), "--threads", str(threads), "--no-error-estimate", "--json"]
    words += [word for number in (0, 1, 2) for word in ("--phase", f"{number}={names.get(number, BARE.get(number, 'void'))}")]
    words += ["--young", ",".join(f"{names[i]}={young!r}" for i, (young, _) in materials.items())]
    words += ["--poisson", ",".join(f"{names[i]}={poisson!r}" for i, (_, poisson) in materials.items())]
    done, cpu = cpu_of(words + list(options))
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout), cpu


class Table:
    def __init__(self, folder, part, columns):
        folder.mkdir(parents=True, exist_ok=True)
        self.file = open(folder / f"elements-{part}.csv", "w", newline="", encoding="utf-8")
        self.write = csv.writer(self.file, lineterminator="\n")
        self.write.writerow(columns)
        print(f"{part}: " + ", ".join(columns))

    def add(self, *row):
        self.write.writerow(row)
        self.file.flush()
        print("  " + ", ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in row), flush=True)


def row_of(found, cpu, voxels):
    iterations = found["iterations"] or [found["load"]["iterations"]]
    return [max(iterations), sum(iterations), found["setup_seconds"] + found["solve_seconds"] + found["load_seconds"], cpu, found["bytes"] / voxels,
            found["peak_memory_bytes"] / voxels]


COSTS = ["iterations_most", "iterations_all", "wall_seconds", "cpu_seconds", "bytes_a_voxel", "peak_a_voxel"]


def measure_sizes(keys, folder, work):
    table = Table(folder, "sizes", ["sample", "size", "solid", "loads", *COSTS, "young_x"])
    for kind in MATERIALS:
        for n in map(int, keys.get("size", "64,128,200,400").split(",")):
            phase = sample(kind, n, keys["lamella"], work)
            file = work / "volume_u8.raw"
            phase.tofile(file)
            one = n >= 400
            options = ["--no-tensor", "--mean-strain", "xx=1", "--no-displacement", "--no-strain", "--no-stress"] if one else []
            found, cpu = solved(keys["lamella"], file, phase.shape[::-1], MATERIALS[kind], keys.get("threads", 2), *options)
            young = None if one else found["constants"]["E_x"]["value"]
            table.add(kind, n, float((phase > 0).mean()), 1 if one else 6, *row_of(found, cpu, phase.size), young)


def measure_materials(keys, folder, work):
    """Poisson's ratios, contrasts both ways, sizes that do not halve."""
    table = Table(folder, "materials", ["sample", "size", "young_1", "young_2", "poisson", *COSTS])
    file = work / "volume_u8.raw"
    for n in (64, 75, 100, 199):
        phase = drawn("foam", n)
        phase.tofile(file)
        ratios = (0.0, 0.3, 0.4, 0.45, 0.49) if n == 100 else (0.3,)
        for poisson in ratios:
            found, cpu = solved(keys["lamella"], file, phase.shape[::-1], {1: (2e9, poisson)}, 2)
            table.add("foam, void", n, 2e9, 0.0, poisson, *row_of(found, cpu, phase.size))
    phase = drawn("foam", 100)
    phase.tofile(file)
    for soft in (1e-1, 1e-3, 1e-4, 1e-8):
        for wall, cell in ((1e9, 1e9 * soft), (1e9 * soft, 1e9)):
            found, cpu = solved(keys["lamella"], file, phase.shape[::-1], {1: (wall, 0.3), 0: (cell, 0.3)}, 2)
            table.add("foam, filled", 100, wall, cell, 0.3, *row_of(found, cpu, phase.size))


def measure_peers(keys, folder, work):
    table = Table(folder, "peers", ["sample", "size", "program", "c11", "c44", "iterations", "wall_seconds", "cpu_seconds", "peak_bytes"])
    file = work / "volume_u8.raw"
    for kind, materials in {**MATERIALS, "foam": {1: (2e9, 0.35), 0: (1e8, 0.3)}}.items():
        for n in map(int, keys.get("size", "64,100").split(",")):
            phase = sample(kind, n, keys["lamella"], work)
            phase.tofile(file)
            found, cpu = solved(keys["lamella"], file, phase.shape[::-1], materials, 1, "--tolerance", "1e-7")
            c = found["stiffness"]
            wall = found["setup_seconds"] + found["solve_seconds"]
            table.add(kind, n, "lamella", c[0][0] / 1e9, c[3][3] / 1e9, max(found["iterations"]), wall, cpu, found["peak_memory_bytes"])
            for peer in filter(None, keys.get("peers", "").split(",")):
                name, _, python = peer.partition(":")
                words = [python, str(pathlib.Path(__file__).with_name("elements-peers.py")), name, str(file), ",".join(map(str, phase.shape[::-1])), "1e-4"]
                words += [f"{i}={young / 1e9!r},{poisson!r}" for i, (young, poisson) in materials.items()]
                done, _ = cpu_of(words)
                if done.returncode != 0:
                    print(f"  {kind}, {n}: {name} failed: {done.stderr.strip().splitlines()[-1:]}", flush=True)
                    continue
                other = json.loads(done.stdout.strip().splitlines()[-1])
                c = other["stiffness"]
                table.add(kind, n, name, c[0][0], c[3][3], max(other["iterations"]), other["wall_seconds"], other["cpu_seconds"], other["peak_bytes"])


def main():
    keys = dict(word.partition("=")[::2] for word in sys.argv[1:])
    folder = pathlib.Path(keys.get("output", "results/bench-elements"))
    with tempfile.TemporaryDirectory() as work:
        for part in keys.get("part", "sizes,materials,peers").split(","):
            {"sizes": measure_sizes, "materials": measure_materials, "peers": measure_peers}[part](keys, folder, pathlib.Path(work))


if __name__ == "__main__":
    main()
