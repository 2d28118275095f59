"""Stiffness of wood across the grain by three methods: elements, bonds and material points, on the same lattices.

    PYTHONPATH=build/python /usr/bin/python3 examples/wood-stiffness/study.py

The three tissues of wood-compression/study.py at the solid fractions of Perré, Almeida, Ayouz and Frank, Ann. For. Sci. 73 (2016) 147, on 400 by
400 nodes, and with LAMELLA_REAL_DATA the two spruce outlines of Ferrara and Wittel on their 333 by 333 and 280 by 280. Writes to --output:
  stiffness.csv  one row a tissue and direction: Young's moduli of walls of 8 GPa along and 6.4 GPa across, sides straight without force, by
                 elements with their error bar and by material points; of walls of 7.2 GPa in all directions, periodic, by elements and by bonds
  spruce.csv     the two spruces with platens that slip and free sides, whole pixels and 2 by 2 for each, beside finite elements of others
"""

import os
import sys
import time

import lamella
import numpy as np

sys.path[:0] = [os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", folder) for folder in ("wood-compression", "")]
import study as pressed  # noqa: E402
from common import parser_of, write_csv  # noqa: E402

NODES = 400
ALONG, ACROSS, SAME = 8e9, 6.4e9, 7.2e9
WALLS = ("wall",)
# Bilinear elements on the same pixels, isotropic walls, nu 1/3, plane stress, platens without friction, sides free, over the wall's modulus:
# another program's, on whole pixels and on 2 by 2 for each
LABELS = {"spruce-earlywood": "spruce_EW_labels_0.5um.png", "spruce-latewood": "spruce_LW_labels_0.5um.png"}
OTHERS = {"spruce-earlywood": {"R": (0.0501, 0.0492), "T": (0.0311, 0.0304)}, "spruce-latewood": {"R": (0.3224, 0.3202), "T": (0.3709, 0.3689)}}


def walls_of(_image, value):
    return dict.fromkeys(WALLS, value)  # names that the image does not know do no harm


def lattice(name, seed):
    """The tissue, and which axis is radial."""
    if name in pressed.REAL:
        return pressed.tissue(name, argparse_like(seed))
    make, how = pressed.GENERATED[name]
    outlines = lamella.contours(make(spacing=pressed.PIXEL, seed=seed, **how))
    return outlines.lattice(how["size"][0] * pressed.PIXEL / NODES), "x"


def argparse_like(seed):
    return type("Options", (), {"coarser": 1, "seed": seed})()


def timed(function, *values, **named):
    begun = time.perf_counter()
    found = function(*values, **named)
    return found, time.perf_counter() - begun


def compared(name, options):
    image, radial = lattice(name, options.seed)
    along, across, same = (walls_of(image, value) for value in (ALONG, ACROSS, SAME))
    threads = dict(threads=options.threads)
    elements, seconds = timed(lamella.stiffness, image, along, walls_of(image, 0.3), young_across=across, sides="straight", **threads)
    points, points_seconds = timed(lamella.point_stiffness, image, young=ALONG, transverse=ACROSS, **threads)
    plain, plain_seconds = timed(lamella.stiffness, image, same, walls_of(image, 1 / 3), **threads)
    bonds, bonds_seconds = timed(lamella.bond_stiffness, image, same, **threads)
    for direction in "RT":
        key = "E_" + (radial if direction == "R" else "xy".replace(radial, ""))
        yield dict(sample=name, direction=direction, nodes="x".join(map(str, image.vtk.GetDimensions()[:2])),
                   elements_MPa=elements.constants[key] / 1e6, bar_MPa=elements.constants_errors[key] / 1e6,
                   extrapolated_MPa=elements.constants_extrapolated[key] / 1e6, points_MPa=points.constants[key] / 1e6,
                   elements_s=round(seconds, 2), points_s=round(points_seconds, 2),
                   isotropic_elements_MPa=plain.constants[key] / 1e6, isotropic_bar_MPa=plain.constants_errors[key] / 1e6,
                   bonds_MPa=bonds.constants[key] / 1e6, bonds_bar_MPa=bonds.constants_errors[key] / 1e6,
                   isotropic_elements_s=round(plain_seconds, 2), bonds_s=round(bonds_seconds, 2))


def spruce(name, options):
    """Rows 20 to 419 and columns 100 to 499 of the label pictures, all that is solid one phase."""
    labels = lamella.read_picture(os.path.join(os.environ["LAMELLA_REAL_DATA"], LABELS[name]))
    solid = (labels.phase[20:420, 100:500] > 0).astype(np.uint8)  # the first phase is the lumens'
    for split in (1, 2):
        image = lamella.from_array(np.repeat(np.repeat(solid, split, 0), split, 1), ["lumen", "wall"])
        found = lamella.stiffness(image, {"wall": 1e9}, {"wall": 1 / 3}, sides="slip", estimate_error=split == 1, threads=options.threads)
        for direction, axis in (("R", "y"), ("T", "x")):
            bar = found.constants_errors["E_" + axis] / 1e9 if split == 1 else ""
            yield dict(sample=name, direction=direction, split=split, elements=found.constants["E_" + axis] / 1e9, bar=bar,
                       others=OTHERS[name][direction][0 if split == 1 else 1])


def main():
    parser = parser_of(__doc__, "results/wood-stiffness")
    parser.add_argument("--seed", type=int, default=1, help="of the generated tissues (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="(default: %(default)s)")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    real = list(pressed.REAL) if os.environ.get("LAMELLA_REAL_DATA") else []
    rows = []
    for name in (*pressed.GENERATED, *real):
        rows += compared(name, options)
        for row in rows[-2:]:
            print(", ".join(f"{key} {value:.5g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()), flush=True)
    write_csv(os.path.join(options.output, "stiffness.csv"), rows)
    rows = [row for name in real for row in spruce(name, options)]
    for row in rows:
        print(row, flush=True)
    if rows:
        write_csv(os.path.join(options.output, "spruce.csv"), rows)


if __name__ == "__main__":
    main()
