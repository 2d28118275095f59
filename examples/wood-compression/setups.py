"""What a plateau depends on: earlywood and poplar pressed with one thing at a time changed.

    PYTHONPATH=build/python /usr/bin/python3 examples/wood-compression/setups.py

The tissues of study.py on coarser lattices, pressed radially and tangentially to 55 %: walls that are isotropic or yield, other
sides, platens that grip, other lattices, a slower test, thinner walls. Perré and others 2016 (section 4.2) find their stresses and
elastic domain "higher than expected" and name boundary conditions, elastic walls and the grid. Writes to --output:
  setups.csv    a row a set-up and direction: stiffness, yield, the flattest tangent, plateau, densification
  TISSUE-SETUP-DIRECTION.csv  the curves; one that is there is not computed again
  TISSUE.png    the curves that differ most
"""

import concurrent.futures
import csv
import os
import sys
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt
from vtkmodules.vtkCommonCore import vtkLogger

sys.path[:0] = [os.path.dirname(os.path.abspath(__file__)), os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")]
import study  # noqa: E402
from common import parser_of, write_csv, write_figure  # noqa: E402

END = 0.55
# tissue: sample of study.py, its edge [nodes of 1 micrometre], spacing of the lattice, points along each axis in a node
TISSUES = {
    "earlywood": ("earlywood", 245, 2e-6, 3),
    "earlywood-part": ("earlywood", 120, 2e-6, 2),
    "poplar": ("poplar", 226, 1.5e-6, 3),
    "poplar-part": ("poplar", 150, 1.5e-6, 2),
}
STRAIN = dict(law="isotropic", plane="plane-strain")
# Walls that yield take 14 times as long a step (no fused kernels): their speed is set, and "fast" is what it does to elastic ones
FAST = dict(first_speed=1e-2, least_speed=1e-2, most_speed=1e-2)
YIELDS = dict(law="plastic", plane="plane-strain", **FAST)
# tissue: {name: (what is changed of the tissue, of the lattice, of the test)}
COMMON = {
    "usual": ({}, {}, {}),
    "isotropic": ({}, {}, dict(law="isotropic")),
    "plane-strain": ({}, {}, STRAIN),
    "open": ({}, {}, dict(sides="open")),
    "periodic": ({}, {}, dict(sides="periodic")),
    "fixed": ({}, {}, dict(sides="fixed")),
    "grip": ({}, {}, dict(grip=True)),
}
YIELDING = {
    "fast": ({}, {}, {**STRAIN, **FAST}),
    "yield-400": ({}, {}, dict(YIELDS, yield_stress=400e6)),
    "yield-200": ({}, {}, dict(YIELDS, yield_stress=200e6)),
}
SETUPS = {
    "earlywood": {**COMMON, "fine": ({}, dict(spacing=1.5e-6), {})},
    "earlywood-part": {
        **COMMON,
        **YIELDING,
        "fine": ({}, dict(spacing=1e-6), {}),
    },
    "poplar": {name: COMMON[name] for name in ("usual", "open", "grip")} | {"no-rays": (dict(ray_distance=0), {}, {})},
    "poplar-part": {
        **{name: COMMON[name] for name in ("usual", "open")},
        **YIELDING,
        "yield-200-slower": ({}, {}, dict(YIELDS, yield_stress=200e6, first_speed=3e-3, least_speed=3e-3, most_speed=3e-3)),
    },
}


SHOWN = {
    "usual": ("elastic, sides straight", dict(color="0.1")),
    "open": ("sides open", dict(color="0.1", linestyle=":")),
    "fixed": ("sides fixed", dict(color="0.1", linestyle="-.")),
    "grip": ("platens that grip", dict(color="0.1", linestyle="--")),
    "yield-400": ("walls yield at 400 MPa", dict(color="tab:orange")),
    "yield-200": ("walls yield at 200 MPa", dict(color="tab:red")),
}


def tissue(name, changes, lattice):
    """Walls with their directions on a lattice, and the points along each axis in a node."""
    sample, edge, spacing, per = TISSUES[name]
    make, how = study.GENERATED[sample]
    how = {**how, **changes, "size": (edge, edge)}
    return lamella.contours(make(spacing=study.PIXEL, seed=1, **how)).lattice(lattice.get("spacing", spacing)), per


def pressed(name, setup, direction, options):
    """One test: its row of the table. What it computed last time is read."""
    changes, lattice, how = SETUPS[name][setup]
    path = os.path.join(options.output, f"{name}-{setup}-{direction}.csv")
    row_path = path[:-4] + ".row"
    if os.path.exists(row_path):
        with open(row_path, newline="", encoding="utf-8") as file:
            return next(csv.DictReader(file))
    begun = time.process_time()
    image, per = tissue(name, changes, lattice)
    axis = "x" if direction == "R" else "y"
    walls = {key: value for key, value in how.items() if key in ("law", "plane")}
    elastic = {**walls, "law": "isotropic"} if walls.get("law") == "plastic" else walls
    modulus = np.nan if "sides" in how or "grip" in how else lamella.point_stiffness(image, points_per_node=per, **elastic).constants[f"E_{axis}"]
    result = lamella.compression(image, axis=axis, strain=END, points_per_node=per, rows=275, displacement=False, **{"energy_ratio": 0.01, **how})
    result.save_curve(path, overwrite=True)
    curve = lamella.compression_curve(result.strain, result.stress)
    slope, at = study.flattest(result.strain, result.stress)
    low = result.strain <= 0.48 + 1e-9
    early = lamella.compression_curve(result.strain[low], result.stress[low])
    at_yield = curve.yield_point or (np.nan, np.nan)
    row = dict(tissue=name, setup=setup, direction=direction, solid=round(1 - result.curve["porosity"][0], 4),
               points=result.statistics["points"], implicit_MPa=modulus / 1e6, slope_MPa=curve.stiffness / 1e6, yield_strain=at_yield[0],
               yield_MPa=at_yield[1] / 1e6, flattest=slope / curve.stiffness, flattest_at=at,
               plateau_MPa=study.number(curve.plateau_stress) / 1e6, densification=study.number(curve.densification),
               found_by_48=int(early.densification is not None), stress_at_25_MPa=np.interp(0.25, result.strain, result.stress) / 1e6,
               stress_at_48_MPa=np.interp(0.48, result.strain, result.stress) / 1e6,
               dissipated=result.curve["dissipated"][-1] / result.curve["work"][-1], energy_ratio=result.energy_ratio,
               imbalance=result.quality["imbalance"], steps=result.statistics["steps"], seconds=round(time.process_time() - begun, 1))
    write_csv(row_path, [row])
    return row


def draw(name, options):
    """Curves of both directions: elastic walls between several sides, walls that yield."""
    figure, both = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True, constrained_layout=True)
    for axes, way in zip(both, "RT"):
        for setup, (label, style) in SHOWN.items():
            path = os.path.join(options.output, f"{name}-{setup}-{way}.csv")
            if os.path.exists(path):
                strain, stress = np.genfromtxt(path, delimiter=",", skip_header=1, usecols=(0, 1), unpack=True)
                axes.plot(100 * strain, stress / 1e6, label=label, linewidth=1.2, **style)
        axes.set_title(study.DIRECTIONS[way], fontsize=10)
        axes.set_xlabel("strain [%]")
        axes.set_xlim(0, 100 * END)
        axes.set_ylim(0, 400)
    both[0].set_ylabel("stress [MPa]")
    both[0].legend(frameon=False, fontsize=9)
    write_figure(figure, os.path.join(options.output, f"{name}.png"), dpi=160)


def main():
    parser = parser_of(__doc__, "results/wood-compression-setups")
    parser.add_argument("--tissues", nargs="+", default=list(SETUPS), choices=list(SETUPS))
    parser.add_argument("--only", nargs="+", help="these set-ups alone")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="tests at once (default: all cores)")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    wanted = [(name, setup, way) for name in options.tissues for setup in SETUPS[name] for way in "RT"
              if not options.only or setup in options.only]
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        jobs = [pool.submit(pressed, *one, options) for one in wanted]
        rows = []
        for job in jobs:
            rows.append(job.result())
            print("  ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in rows[-1].items()), flush=True)
    write_csv(os.path.join(options.output, "setups.csv"), rows)
    for name in options.tissues:
        draw(name, options)
    print(f"tables and pictures: {options.output}")


if __name__ == "__main__":
    main()
