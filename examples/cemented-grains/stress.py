"""Stress in cemented grains pulled apart: maps, means, distributions and their exponential tails.

    PYTHONPATH=build/python /usr/bin/python3 examples/cemented-grains/stress.py

The samples of study.py between two plates of grain material, pulled by 1.62 % of the strain at which the matrix breaks: one
linear solve each, after section V of Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102 (2020) 022906. Writes to --output:
  stress-maps.png     vertical stress at six saturations (their figure 15)
  stress-means.png    mean tensile and compressive stress against saturation (figure 16)
  stress-pdf.png      probability densities, all samples together (figure 17)
  stress-theta.png    rate of the exponential tails against saturation (figure 18), and how the threshold matters
  stress-samples.csv  one row a sample and width, with what each step took; stress-means.csv: means and deviations
  stress-density.csv  the densities, stress-thresholds.csv: theta against the threshold
"""

import argparse
import concurrent.futures
import math
import os
import sys
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from study import FILLED, WIDTHS, bridged, means_of, middle, panel
from vtkmodules.vtkCommonCore import vtkLogger

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import write_csv, write_figure  # noqa: E402

HORIZON = 3
E_MATRIX = 1e9  # Pa; all results are ratios
RATIO = 4  # of the grains' Young's modulus and toughness to the matrix's
CRITICAL = 1e-3  # elongation at which bonds break: the same in all, as both ratios are
STRAIN = 1.62e-2 * CRITICAL  # the matrix breaks at a strain of CRITICAL
BIN = 0.05  # of the densities, in mean tensile stresses
SHARES = (0.2, 0.1, 0.05)  # of the tensile stresses that are the tail; the middle one is what is shown
ALL = (*WIDTHS, FILLED)
NAMES = ("mean_tensile", "mean_compressive", "compressive_over_tensile", "compressive_share", "tensile_grain",
         "tensile_matrix", "compressive_grain", "compressive_matrix", "modulus", "theta", "theta_error", "threshold",
         "distance", *(f"theta_{share:g}" for share in SHARES))


def pulled(image):
    """Equilibrium with bonds between two grains, and between grain and matrix, like those of the matrix."""
    young = {pair: E_MATRIX for pair in ("matrix", "matrix-grain", "grain-grain")}
    young["grain"] = RATIO * E_MATRIX
    return lamella.equilibrium(image, young, critical_stretch=dict.fromkeys(young, CRITICAL), horizon=HORIZON,
                               strain=STRAIN, platen_layers=HORIZON, stress=True)


def pure_matrix(shape, spacing):
    """Mean vertical stress in a box of matrix at the same strain, between the platens."""
    phase = np.zeros(shape, np.uint8)
    image = lamella.from_array(phase, ["matrix"], spacing=spacing)
    result = lamella.equilibrium(image, {"matrix": E_MATRIX}, horizon=HORIZON, strain=STRAIN, platen_layers=HORIZON,
                                 stress=True)
    return lamella.stress_pdf(result).phases["all"]["mean"]


def row_of(image, result, pdf, reference):
    """The numbers of one sample; stresses over that of the pure matrix."""
    phases = {"matrix": None, **pdf.phases}
    all_ = phases["all"]
    row = {
        "saturation": image.saturation,
        "nodes": all_["count"],
        "mean_tensile": all_["mean_tensile"] / reference,
        "mean_compressive": all_["mean_compressive"] / reference,
        "compressive_over_tensile": -all_["mean_compressive"] / all_["mean_tensile"],
        "compressive_share": all_["compressive_share"],
        "modulus": result.effective_modulus / (reference / STRAIN),
        "theta": pdf.theta,
        "theta_error": pdf.theta_error,
        "threshold": pdf.threshold,
        "distance": pdf.distance,
        "iterations": result.iterations,
    }
    for name in ("grain", "matrix"):
        row["tensile_" + name] = phases[name]["mean_tensile"] / reference
        row["compressive_" + name] = phases[name]["mean_compressive"] / reference
    table = pdf.thresholds
    for share in SHARES:
        nearest = np.argmin(np.abs(table["tail_share"] - share))
        row[f"theta_{share:g}"] = float(table["theta"][nearest])
    return row


def measure(task):
    """All widths of one packing: rows of numbers, densities, thresholds, and of the first packing the maps."""
    seed, options = task
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # warnings are counted below
    packing = lamella.packing(count=options.count, seed=seed)
    platen = HORIZON * packing.box[0] / options.nodes
    rows, densities, thresholds, maps = [], [], [], []
    reference = None
    for width in ALL:
        start = time.perf_counter()
        image = bridged(packing, width, options.nodes, platen)
        made = time.perf_counter()
        if reference is None:
            reference = pure_matrix(image.shape, image.spacing)
        begun = time.perf_counter()
        result = pulled(image)
        solved = time.perf_counter()
        pdf = lamella.stress_pdf(result, bin_width=BIN, tail_share=SHARES[1])
        row = {"seed": seed, "width": width, **row_of(image, result, pdf, reference)}
        row.update(seconds_sample=made - start, seconds_solve=solved - begun, seconds_statistics=time.perf_counter() - solved,
                   warnings=len(result.warnings))
        rows.append(row)
        density = pdf.density
        densities.append((width, np.rint(density["stress_low"] / BIN).astype(int), density["density"]))
        table = pdf.thresholds
        thresholds.extend({"seed": seed, "width": width, **{key: table[key][i] for key in table}}
                          for i in range(len(table["theta"])))
        if seed == 1:
            window = middle(image, 0.5)
            stress = result.stress_component("yy")[::-1][window] / pdf.mean_tensile
            maps.append((image.saturation, image.spacing, np.where(image.phase[::-1][window] == 0, np.nan, stress)))
    grain = 2 * float(np.mean(packing.radii))
    return rows, densities, thresholds, (grain, maps)


def mean_densities(densities, samples):
    """By width: left ends of the bins and the mean density of the samples there; bins without values count as 0."""
    result = {}
    for width in ALL:
        mine = [(bins, values) for of, bins, values in densities if of == width]
        first = min(bins[0] for bins, _ in mine)
        last = max(bins[-1] for bins, _ in mine)
        total = np.zeros(last - first + 1)
        for bins, values in mine:
            total[bins - first] += values / samples
        result[width] = (BIN * np.arange(first, last + 1), total)
    return result


def draw_maps(grain, maps, path, highest=2.5):
    figure, axes = plt.subplots(1, len(maps), figsize=(16, 2.9), gridspec_kw={"wspace": 0.05})
    colours, norm = plt.get_cmap("jet").copy(), Normalize(0, highest)
    colours.set_bad("white")
    for one, (saturation, spacing, stress) in zip(axes, maps):
        panel(one, colours(norm(np.ma.masked_invalid(stress))), spacing, grain if one is axes[0] else None)
        one.set_title(f"S = {saturation:.2f}", fontsize=11)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, fraction=0.011, pad=0.01, extend="both")
    bar.set_label("vertical stress / mean tensile")
    write_figure(figure, path, dpi=150, bbox_inches="tight")


def errors(axes, means, name, label, marker, factor=1.0, **more):
    column = lambda key: [factor * row[key] for row in means]  # noqa: E731
    axes.errorbar([row["saturation"] for row in means], column(name), xerr=[row["saturation_deviation"] for row in means],
                  yerr=np.abs(column(name + "_deviation")), marker=marker, capsize=3, linewidth=1, markersize=5, label=label,
                  **more)


def draw_means(means, path):
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.8), gridspec_kw={"wspace": 0.3})
    for one, kind, factor in zip(axes, ("tensile", "compressive"), (1, -1)):
        errors(one, means, "mean_" + kind, "all", "o", factor, color="black")
        errors(one, means, kind + "_grain", "grains", "s", factor, color="#c05621")
        errors(one, means, kind + "_matrix", "matrix", "^", factor, color="#2b6cb0")
        one.set_xlabel("saturation, S")
        one.set_ylabel(("mean tensile" if kind == "tensile" else "− mean compressive") + " stress / pure matrix's")
        one.set_ylim(bottom=0)
    axes[0].axhline(1, color="grey", linewidth=0.8, linestyle=":")
    axes[0].legend(frameon=False)
    write_figure(figure, path, dpi=150, bbox_inches="tight")


def draw_densities(densities, means, path):
    figure, axes = plt.subplots(figsize=(6.4, 4.6))
    for i, row in enumerate(means):
        low, density = densities[row["width"]]
        x = low + BIN / 2
        shown = density > 0
        colour = plt.get_cmap("viridis")(0.92 * i / (len(means) - 1))
        axes.plot(x[shown], density[shown], "o", markersize=2.5, color=colour, label=f"S = {row['saturation']:.2f}")
        start = SHARES[1] * (1 - row["compressive_share"]) * row["theta"]  # the law holds as many as the tail
        ends = np.array([row["threshold"], row["threshold"] + math.log(start / 1e-4) / row["theta"]])
        axes.plot(ends, start * np.exp(-row["theta"] * (ends - ends[0])), color=colour, linewidth=1)
    axes.set_yscale("log")
    axes.set_xlim(-1, 6)
    axes.set_ylim(1e-4, 5)
    axes.set_xlabel("vertical stress / mean tensile")
    axes.set_ylabel("probability density")
    axes.legend(frameon=False, markerscale=2.5)
    write_figure(figure, path, dpi=150, bbox_inches="tight")


def draw_theta(means, path):
    figure, axes = plt.subplots(figsize=(5.2, 4))
    for share, marker, colour in zip(SHARES, "^ov", ("#2b6cb0", "black", "#c05621")):
        name = "theta" if share == SHARES[1] else f"theta_{share:g}"
        errors(axes, means, name, f"largest {100 * share:g} %", marker, color=colour)
    axes.set_xlabel("saturation, S")
    axes.set_ylabel("θ")
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, title="tail")
    write_figure(figure, path, dpi=150, bbox_inches="tight")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=10, help="packings, seeds from 1 on [10]")
    parser.add_argument("--count", type=int, default=400, help="disks in each [400]")
    parser.add_argument("--nodes", type=int, default=512, help="nodes across [512]")
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="samples at once [all processors]")
    parser.add_argument("--output", default="results/cemented-grains", help="folder [results/cemented-grains]")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    there = lambda name: os.path.join(options.output, "stress-" + name)  # noqa: E731

    start = time.perf_counter()
    rows, densities, thresholds, first = [], [], [], None
    tasks = [(seed, options) for seed in range(1, options.samples + 1)]
    with concurrent.futures.ProcessPoolExecutor(options.processes) as pool:
        for done, (sample, of_sample, tails, maps) in enumerate(pool.map(measure, tasks), 1):
            rows.extend(sample)
            densities.extend(of_sample)
            thresholds.extend(tails)
            first = first or maps
            print(f"{done} of {len(tasks)} packings, {time.perf_counter() - start:.0f} s", flush=True)
    means = means_of(rows, NAMES)
    together = mean_densities(densities, options.samples)
    write_csv(there("samples.csv"), rows)
    write_csv(there("means.csv"), means)
    write_csv(there("thresholds.csv"), thresholds)
    write_csv(there("density.csv"), [{"width": width, "stress_low": round(float(x), 6), "density": float(y)}
                                     for width, (low, density) in together.items() for x, y in zip(low, density)])
    draw_maps(*first, there("maps.png"))
    draw_means(means, there("means.png"))
    draw_densities(together, means, there("pdf.png"))
    draw_theta(means, there("theta.png"))

    print(f"{'S':>6} {'mean tensile':>16} {'compressive/tensile':>20} {'theta':>15} {'its error':>10} {'beyond':>7} "
          f"{'distance':>9}")
    for row in means:
        print(f"{row['saturation']:>6.3f} {row['mean_tensile']:>8.3f} ±{row['mean_tensile_deviation']:6.3f} "
              f"{row['compressive_over_tensile']:>12.4f} ±{row['compressive_over_tensile_deviation']:6.4f} "
              f"{row['theta']:>8.3f} ±{row['theta_deviation']:5.3f} {row['theta_error']:>10.3f} {row['threshold']:>7.2f} "
              f"{row['distance']:>9.3f}")
    spent = {name: sum(row["seconds_" + name] for row in rows) for name in ("sample", "solve", "statistics")}
    print(f"{len(rows)} solves in {time.perf_counter() - start:.0f} s with {options.processes} processes; of all processes: "
          + ", ".join(f"{name} {seconds:.0f} s" for name, seconds in spent.items())
          + f"; {sum(row['warnings'] > 0 for row in rows)} samples with a phase thinner than the horizon")
    print(f"files in {options.output}")


if __name__ == "__main__":
    main()
