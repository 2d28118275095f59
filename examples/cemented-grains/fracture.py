"""Cemented grains pulled apart: stress-strain curves, crack paths, strength against saturation.

    PYTHONPATH=build/python /usr/bin/python3 examples/cemented-grains/fracture.py

The samples of study.py between two plates of grain material, pulled until the stress has fallen to 5 % of its peak, one bond at a time:
ten packings, six widths of the bridges and filled, after section IV of Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102 (2020)
022906. Grains are four times as stiff and as tough as the matrix, so all bonds break at one elongation. Writes to --output:
  fracture-curves.png     stress against strain, one packing (their figure 12)
  fracture-cracks.png     crack paths at two saturations, inside samples with their ends cut off (figure 13)
  fracture-strength.png   strength against saturation (figure 14)
  fracture-samples.csv    one row a sample; fracture-means.csv: means and deviations
"""

import concurrent.futures
import csv
import functools
import math
import os
import sys
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt
from ends import without_ends
from stress import CRITICAL, E_MATRIX, HORIZON, RATIO
from study import COLOURS, FILLED, WIDTHS, bridged, means_of, panel
from vtkmodules.vtkCommonCore import vtkLogger

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import chart, draw_bonds, paper_numbers, parser_of, write_csv, write_figure  # noqa: E402

MATRIX, GRAIN = 1, 2  # phases
THICK = 16  # layers of nodes of a plate to which grains are bridged, of which the outer HORIZON are held; else all that are held
ALL = (0.1, *WIDTHS, FILLED)
SHOWN = (0.5, 0.75)  # widths whose cracks are drawn, of samples whose plates hold whatever lies there:
HELD = 1.5  # mean diameters are cut off at both ends
UNIT = E_MATRIX * CRITICAL  # strength of a matrix without flaws [Pa]
NAMES = ("strength", "first_break", "modulus", "peak_broken", "broken", "inside_grains", "between_grains", "interface", "events",
         "seconds", "cpu_seconds")
PAPER = paper_numbers("frank-2020", "Figure 14")  # strength by saturation, the text's two


def torn(image, **options):
    """Bonds between two grains, and between grain and matrix, are like those of the matrix."""
    young = {pair: E_MATRIX for pair in ("matrix", "matrix-grain", "grain-grain")}
    young["grain"] = RATIO * E_MATRIX
    return lamella.fracture(image, young, critical_stretch=dict.fromkeys(young, CRITICAL), horizon=HORIZON, platen_layers=HORIZON,
                            displacement=False, **options)


def share_of(broken, low, high, between):
    phases = broken["phases"]
    return float(np.mean((phases[:, 0] == low) & (phases[:, 1] == high) & (broken["between_grains"] == between)))


@functools.lru_cache(maxsize=1)
def packing_of(count, seed):
    return lamella.packing(count=count, seed=seed)


def measure(task):
    """One failure: its row of numbers, and of the first packing its curve and, where plates hold what lies there, its crack."""
    seed, width, options = task
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    packing = packing_of(options.count, seed)
    layers = THICK if options.wall_bridges else HORIZON + (1 if options.smooth else 0)
    image = bridged(packing, width, options.nodes, layers * packing.box[0] / options.nodes, wall_bridges=options.wall_bridges)
    begun, spent = time.perf_counter(), time.process_time()
    result = torn(image, rivals=options.rivals, smooth_platens=options.smooth, method=options.method, breaking=options.breaking)
    broken = result.broken
    row = {
        "seed": seed, "width": width, "saturation": image.saturation, "strength": result.peak_stress / UNIT,
        "first_break": result.first_break_stress / UNIT, "modulus": result.modulus / E_MATRIX,
        "peak_broken": int(np.searchsorted(broken["strain"], result.peak_strain)), "broken": len(broken),
        "inside_grains": share_of(broken, GRAIN, GRAIN, False), "between_grains": share_of(broken, GRAIN, GRAIN, True),
        "interface": share_of(broken, MATRIX, GRAIN, False) + share_of(broken, MATRIX, GRAIN, True),
        "events": result.statistics["events"], "seconds": time.perf_counter() - begun, "cpu_seconds": time.process_time() - spent,
        "end": result.end,
    }
    if seed != 1:
        return row, None, None
    curve = (image.saturation, result.strain / CRITICAL, result.stress / UNIT)
    if width not in SHOWN:
        return row, curve, None
    diameter = 2 * float(np.mean(packing.radii))
    held = without_ends(image, HELD * diameter)
    broken = torn(held, rivals=options.rivals, method=options.method, breaking=options.breaking).broken
    bottom = round(held.vtk.GetBounds()[2] / image.spacing - 0.5)  # layers cut off there
    return row, curve, (image.saturation, image.spacing, held.phase[::-1], bottom, broken, diameter)


def slopes(means):
    """Mean slope of strength over saturation from the least that was measured to 0.4, and from there to 0.9, on straight lines between measured
    points; NaN without points on both sides."""
    saturation = [mean["saturation"] for mean in means]
    strength = [mean["strength"] for mean in means]
    low, middle, high = np.interp((saturation[0], 0.4, 0.9), saturation, strength, right=math.nan)
    return float((middle - low) / (0.4 - saturation[0])) if saturation[0] < 0.4 else math.nan, float((high - middle) / 0.5)


def draw_curves(curves, path):
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.92, len(curves)))
    with chart(path, "strain over $s_0$", "stress over $E_M s_0$", dpi=200) as axes:
        for (saturation, strain, stress), colour in zip(curves, colours):
            axes.plot(strain, stress, color=colour, linewidth=1.4, label=f"S = {saturation:.2f}")


def draw_cracks(cracks, path):
    figure, axes = plt.subplots(1, len(cracks), figsize=(4.2 * len(cracks), 4.4), constrained_layout=True)
    for one, (saturation, spacing, phase, bottom, broken, diameter), letter in zip(np.atleast_1d(axes), cracks, "ab"):
        high, wide = phase.shape
        low = int(np.clip(np.median(broken["position"][:, 1]) / spacing - bottom - wide / 2, 0, high - wide))
        panel(one, COLOURS(phase[low : low + wide]), spacing, diameter if letter == "a" else None)
        draw_bonds(one, broken, low=(0, (bottom + low) * spacing), colors="#d01c1c", linewidths=0.5)
        one.set_title(f"({letter}) S = {saturation:.2f}", fontsize=11)
    write_figure(figure, path, dpi=200, bbox_inches="tight")


def means_beside(path):
    if not path:
        return []
    with open(path, newline="") as file:
        return [{name: float(row[name]) for name in ("saturation", "strength", "strength_deviation")} for row in csv.DictReader(file)]


def draw_strength(means, beside, path):
    saturation = [mean["saturation"] for mean in means]
    with chart(path, "saturation S", "stress over $E_M s_0$", xlim=(0, 1.03), dpi=200) as axes:
        axes.errorbar(saturation, [mean["strength"] for mean in means], yerr=[mean["strength_deviation"] for mean in means], fmt="o-",
                      capsize=3, color="#1f4e9c", label="strength")
        if beside:
            axes.errorbar([mean["saturation"] for mean in beside], [mean["strength"] for mean in beside],
                          yerr=[mean["strength_deviation"] for mean in beside], fmt="D-", markersize=5, capsize=3, color="#c77f1a",
                          label="strength, the other run")
        axes.plot(saturation, [mean["first_break"] for mean in means], "s--", markersize=4, color="#888888", label="first break")
        axes.plot(list(PAPER), list(PAPER.values()), "*", markersize=11, color="#d01c1c", label="paper, in its text")


def main():
    parser = parser_of(__doc__, "results/cemented-grains")
    parser.add_argument("--samples", type=int, default=10, help="packings (default: %(default)s)")
    parser.add_argument("--count", type=int, default=400, help="grains of a packing (default: %(default)s)")
    parser.add_argument("--nodes", type=int, default=256, help="nodes across (default: %(default)s)")
    parser.add_argument("--method", default="auto", choices=("auto", "events", "accurate"))
    parser.add_argument("--breaking", default="strict", choices=("strict", "batched"))
    parser.add_argument("--wall-bridges", action="store_true", help="grains are bridged to the plates, and these are thicker")
    parser.add_argument("--smooth", action="store_true",
                        help="plates slip across the load, and have one layer of nodes more than is moved")
    parser.add_argument("--beside", metavar="CSV", help="means of another run to draw with the strengths")
    parser.add_argument("--rivals", action="store_true", help="look closer where two bonds are nearly as critical as each other")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="samples at a time (default: one a core)")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    begun = time.perf_counter()
    tasks = [(seed + 1, width, options) for seed in range(options.samples) for width in ALL]
    parts = []
    with concurrent.futures.ProcessPoolExecutor(options.workers) as pool:
        for part in pool.map(measure, tasks):
            parts.append(part)
            print(f"\r{len(parts)} of {len(tasks)} samples, {time.perf_counter() - begun:.0f} s", end="", flush=True)
    rows = [row for row, _, _ in parts]
    curves = [curve for _, curve, _ in parts if curve]
    cracks = [crack for _, _, crack in parts if crack]
    print()
    means = means_of(rows, NAMES)
    write_csv(os.path.join(options.output, "fracture-samples.csv"), rows)
    write_csv(os.path.join(options.output, "fracture-means.csv"), means)
    print(f"{'width':>7} {'S':>6} {'strength':>16} {'first':>6} {'E':>6} {'broken':>7} {'in grains':>9} {'ms/event':>8}")
    for mean in means:
        print(f"{mean['width']:>7} {mean['saturation']:>6.3f} {mean['strength']:>7.3f} ± {mean['strength_deviation']:>5.3f} "
              f"{mean['first_break']:>6.3f} {mean['modulus']:>6.3f} {mean['broken']:>7.0f} {100 * mean['inside_grains']:>7.2f} % "
              f"{1e3 * mean['cpu_seconds'] / max(1.0, mean['events']):>8.2f}")
    rising, level = slopes(means)
    print(f"slope of the strength over S: {rising:.3f} from {means[0]['saturation']:.3f} to 0.4, {level:.3f} from there to 0.9")
    draw_curves(curves, os.path.join(options.output, "fracture-curves.png"))
    if cracks:
        draw_cracks(cracks, os.path.join(options.output, "fracture-cracks.png"))
    draw_strength(means, means_beside(options.beside), os.path.join(options.output, "fracture-strength.png"))
    cpu = math.fsum(row["cpu_seconds"] for row in rows)
    print(f"{len(rows)} samples in {time.perf_counter() - begun:.0f} s, {cpu:.0f} s CPU; files in {options.output}")


if __name__ == "__main__":
    main()
