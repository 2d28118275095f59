"""Strength against saturation by what the paper leaves open: ends, bonds across voids, motion.

    PYTHONPATH=build/python /usr/bin/python3 examples/cemented-grains/setups.py

A packing of study.py, pulled as in fracture.py by each set-up of the list below, and by the damped motion and the rate that gives way of
appendix A (A1, A2) of Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102 (2020) 022906. Writes to --output:
  setups.png          strength against saturation by set-up, measured points only
  motion.png          the same, and stress against strain, by damped motion beside the quasi-static pull
  setups-samples.csv  one row a sample, written as they come; setups.csv: means, one row a set-up and width
  motion-curves.csv   the curves of motion.png
"""

import csv
import dataclasses
import math
import os
import sys
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt
from ends import without_ends
from fracture import HELD, PAPER, UNIT, packing_of
from stress import CRITICAL, E_MATRIX, HORIZON, RATIO
from study import FILLED, bridged, means_of
from vtkmodules.vtkCommonCore import vtkLogger

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import parser_of, write_csv, write_figure  # noqa: E402

WIDTHS = (0.25, 0.5, 1.0, FILLED)
DENSITY = 1000.0  # of all phases [kg/m3]; no strength depends on it at a given number of travel times
STOP = 0.3  # a pull ends when the stress has fallen to this share of its peak
DAMPING = 0.1  # of motion, over the least critical viscosity of the bonds: docs/benchmarks/dynamic-fracture.md
NAMES = ("strength", "first_break", "modulus", "before", "before_inside", "near_plates", "inside_grains", "broken", "cpu_seconds")


@dataclasses.dataclass(frozen=True)
class Setup:
    label: str
    ends: str = "touching"  # grains touch the plates; "bridged": matrix leads to thick plates; "cut": plates hold whatever lies 1.5 d inside
    slip: bool = False  # plates let the sample slip across the load
    cut_void_bonds: bool = False
    nodes: int = 128
    transits: float = 0.0  # damped motion: time to the strain of the first break, in travel times of a wave; 0: quasi-static


SETUPS = {
    "touching-slip": Setup("grains touch plates that slip", slip=True),
    "bridged-slip": Setup("matrix to the plates, slip", ends="bridged", slip=True),
    "cut-slip": Setup("ends cut off, slip", ends="cut", slip=True),
    "cut-slip-cut-bonds": Setup("ends cut off, slip, no bonds across voids", ends="cut", slip=True, cut_void_bonds=True),
    "touching-slip-cut-bonds": Setup("grains touch plates that slip, no bonds across voids", slip=True, cut_void_bonds=True),
    "motion": Setup("damped motion", slip=True, transits=30),
}


def sample_of(packing, width, setup):
    """The sample, its saturation, and layers that the plates hold."""
    layers = setup.nodes // 16 if setup.ends == "bridged" else HORIZON + (1 if setup.slip else 0)
    image = bridged(packing, width, setup.nodes, layers * packing.box[0] / setup.nodes, wall_bridges=setup.ends == "bridged")
    saturation = image.saturation
    if setup.ends == "cut":
        image = without_ends(image, HELD * 2 * float(np.mean(packing.radii)))
    return image, saturation


def pulled(image, setup):
    """The paper's bonds; the result of a quasi-static pull, and of motion where the set-up has it."""
    young = dict.fromkeys(("matrix", "matrix-grain", "grain-grain"), E_MATRIX) | {"grain": RATIO * E_MATRIX}
    bonds = dict(critical_stretch=dict.fromkeys(young, CRITICAL), horizon=HORIZON, cut_void_bonds=setup.cut_void_bonds, platen_layers=HORIZON,
                 smooth_platens=setup.slip, displacement=False, stop=STOP)
    still = lamella.fracture(image, young, rivals=False, **bonds)
    if not setup.transits:
        return still, None
    bounds = image.vtk.GetBounds()
    travel = (bounds[3] - bounds[2]) * math.sqrt(DENSITY / still.modulus)
    return still, lamella.dynamics(image, young, DENSITY, travel_times=setup.transits, tau=travel, damping=DAMPING, history_every=20, **bonds)


def row_of(image, result, diameter):
    """Numbers of a pull; ``near_plates``: share of the broken bonds within a mean diameter of a plate, ``before_inside``: bonds that broke
    before the peak and are not there."""
    broken = result.broken
    bounds = image.vtk.GetBounds()
    inside = (broken["position"][:, 1] > bounds[2] + diameter) & (broken["position"][:, 1] < bounds[3] - diameter)
    before = int(result._number("peak_broken"))
    grains = (broken["phases"][:, 0] == 2) & ~broken["between_grains"]
    return {"strength": result.peak_stress / UNIT, "before": before, "before_inside": int(np.sum(inside[:before])),
            "near_plates": float(np.mean(~inside)), "inside_grains": float(np.mean(grains)), "broken": len(broken)}


def measure(name, width, seed, count):
    """Rows of a sample, by the name of the set-up: motion has that of its quasi-static pull as well; and its curves."""
    setup = SETUPS[name]
    packing = packing_of(count, seed)
    image, saturation = sample_of(packing, width, setup)
    spent = time.process_time()
    still, moved = pulled(image, setup)
    rows, curves = [], []
    for result in (still, moved):
        if result is None:
            continue
        called = name if result is moved or moved is None else name + "-still"
        rows.append({"setup": called, "width": width, "seed": seed, "saturation": saturation,
                     "first_break": still.first_break_stress / UNIT, "modulus": still.modulus / E_MATRIX,
                     **row_of(image, result, 2 * float(np.mean(packing.radii))), "cpu_seconds": time.process_time() - spent})
        if moved is not None and seed == 1:
            curves += [{"setup": called, "width": width, "saturation": saturation, "strain": a / CRITICAL, "stress": b / UNIT}
                       for a, b in zip(result.strain, result.stress)]
    return rows, curves


def known_rows(path):
    """Rows of an earlier run, their numbers as numbers."""
    if not path or not os.path.isfile(path):
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: text if key == "setup" or text == FILLED else float(text) for key, text in row.items()} for row in csv.DictReader(file)]


def slope(means, width, other):
    """Of the strength over saturation between two measured widths of the bridges; NaN where one was not."""
    low, high = ([mean for mean in means if mean["width"] == one] for one in (width, other))
    return (high[0]["strength"] - low[0]["strength"]) / (high[0]["saturation"] - low[0]["saturation"]) if low and high else math.nan


def label_of(name):
    return SETUPS[name].label if name in SETUPS else "the same, quasi-static"


def errorbars(axes, means, marker, **style):
    axes.errorbar([mean["saturation"] for mean in means], [mean["strength"] for mean in means], yerr=[mean["strength_deviation"] for mean in means],
                  fmt=marker, capsize=2, markersize=4, linewidth=1, **style)


def finish(axes, legend=8):
    axes.plot(list(PAPER), list(PAPER.values()), "*", markersize=11, color="#d01c1c", label="paper, in its text")
    axes.set_xlabel("saturation S")
    axes.set_ylabel("strength over $E_M s_0$")
    axes.set_xlim(0, 1.03)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=legend)


def draw_setups(means, path):
    figure, axes = plt.subplots(figsize=(6.4, 5), constrained_layout=True)
    colours = plt.get_cmap("tab10")(np.arange(10))
    shown = [name for name in means if not name.startswith("motion")]
    for colour, marker, name in zip(colours, "osD^v<>pPX", shown):
        errorbars(axes, means[name], marker + "-", color=colour, label=label_of(name))
    finish(axes)
    write_figure(figure, path, dpi=200)


def draw_motion(means, curves, path):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), constrained_layout=True)
    widths = list(dict.fromkeys(row["width"] for row in sorted(curves, key=lambda row: row["saturation"])))
    for width, colour in zip(widths, plt.get_cmap("viridis")(np.linspace(0, 0.92, len(widths)))):
        for name, line in (("motion-still", "--"), ("motion", "-")):
            of = [row for row in curves if row["width"] == width and row["setup"] == name]
            left.plot([row["strain"] for row in of], [row["stress"] for row in of], line, color=colour, linewidth=1.2,
                      label=f"S = {of[0]['saturation']:.2f}" if name == "motion" else None)
    left.set_xlabel("strain over $s_0$")
    left.set_ylabel("stress over $E_M s_0$")
    left.set_xlim(0, None)
    left.set_ylim(bottom=0)
    left.legend(frameon=False, fontsize=8)
    errorbars(right, means["motion"], "o-", color="#1f4e9c", label=label_of("motion"))
    errorbars(right, means["motion-still"], "s--", color="#888888", label=label_of("motion-still"))
    finish(right, 9)
    write_figure(figure, path, dpi=200)


def main():
    parser = parser_of(__doc__, "results/cemented-grains")
    parser.add_argument("--only", nargs="+", choices=list(SETUPS), default=list(SETUPS), metavar="SETUP", help="of " + ", ".join(SETUPS))
    parser.add_argument("--samples", type=int, default=1, help="packings, seeds from 1 on (default: %(default)s)")
    parser.add_argument("--count", type=int, default=400, help="grains of a packing (default: %(default)s)")
    parser.add_argument("--widths", nargs="+", default=[str(width) for width in WIDTHS], help="of the bridges, and 'filled'")
    parser.add_argument("--coarse", type=int, metavar="NODES", help="all set-ups on so many nodes across")
    parser.add_argument("--known", metavar="CSV", help="setups-samples.csv of an earlier run: what it has is not run again")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    if options.coarse:
        SETUPS.update({name: dataclasses.replace(setup, nodes=options.coarse) for name, setup in SETUPS.items()})
    there = lambda name: os.path.join(options.output, name)  # noqa: E731
    rows, curves = known_rows(options.known), known_rows(options.known and os.path.join(os.path.dirname(options.known), "motion-curves.csv"))
    begun = time.perf_counter()
    for name in options.only:
        for width in (FILLED if word == FILLED else float(word) for word in options.widths):
            for seed in range(1, options.samples + 1):
                if any((row["setup"], row["width"], row["seed"]) == (name, width, seed) for row in rows):
                    continue
                new, lines = measure(name, width, seed, options.count)
                rows += new
                curves += lines
                write_csv(there("setups-samples.csv"), rows)
                if curves:
                    write_csv(there("motion-curves.csv"), curves)
                print(f"{name}, width {width}, seed {seed}: strength {new[-1]['strength']:.3f}; {time.perf_counter() - begun:.0f} s", flush=True)
    means = {}
    for name in dict.fromkeys(row["setup"] for row in rows):
        of = sorted((row for row in rows if row["setup"] == name), key=lambda row: row["saturation"])
        means[name] = means_of(of, NAMES)
        print(f"{label_of(name)}: " + ", ".join(f"{mean['strength']:.3f} at {mean['saturation']:.3f}" for mean in means[name]))
        print(f"    slope {slope(means[name], 0.25, 0.5):.2f} from width 0.25 to 0.5, {slope(means[name], 0.5, 1.0):.2f} to 1; near plates " +
              ", ".join(f"{100 * mean['near_plates']:.0f} %" for mean in means[name]))
    write_csv(there("setups.csv"), [{"setup": name, **mean} for name, of in means.items() for mean in of])
    draw_setups(means, there("setups.png"))
    if "motion" in means:
        draw_motion(means, curves, there("motion.png"))
    print(f"{len(rows)} samples, {math.fsum(row['cpu_seconds'] for row in rows):.0f} s CPU; files in {options.output}")


if __name__ == "__main__":
    main()
