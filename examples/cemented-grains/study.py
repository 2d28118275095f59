"""Cemented grains: how the space between packed disks fills with matrix, and what pores are left.

    PYTHONPATH=build/python /usr/bin/python3 examples/cemented-grains/study.py

Ten packings of 400 disks, bridged at five widths and filled, as the samples of Frank, Radjai, Nezamabadi and Delenne, Phys.
Rev. E 102 (2020) 022906, section III. Writes to --output:
  bridges.png       three widths of the bridges (their figure 7)
  saturation.png    saturation against width (figure 8)
  pores.png         the pores of five samples, coloured by their area (figure 9)
  pore-number.png   number of pores against saturation (figure 10)
  pore-area.png     mean and largest pore against saturation (figure 11)
  samples.csv       one row a packing and width; means.csv: means and standard deviations
  packings.csv      one row a packing
"""

import argparse
import concurrent.futures
import os
import statistics
import sys

import lamella
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, LogNorm

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import paper_numbers, write_csv, write_figure  # noqa: E402

WIDTHS = (0.25, 0.5, 0.75, 1.0, 1.25)
FILLED = "filled"
NAMES = ("pores", "mean_area", "largest_area")
PAPER = paper_numbers("frank-2020", "Figure 8")  # saturations of its captions by the width that we take them for
COLOURS = ListedColormap(["#ffffff", "#e3a857", "#4a5568"])  # void, matrix, grain
SOLID = ListedColormap(["#eeeeee", "#cccccc"])  # matrix, grain


def bridged(packing, width, nodes, platen=0.0, wall_bridges=False):
    amount = {"filled": True} if width == FILLED else {"width": width}
    return lamella.bridges(packing, nodes_across=nodes, platen=platen, wall_bridges=wall_bridges, **amount)


def pores_of(image, minimum):
    """Number, mean and largest area of the pores in pixels; none at all in a filled sample."""
    if not np.any(image.phase == 0):
        return 0, 0.0, 0
    pores = lamella.pore_flood_fill(image, phase="void", connectivity=4, minimum_size=minimum)
    return pores.count, pores.mean, pores.largest


def measure(task):
    """All widths of one packing: rows of numbers. One process, one thread."""
    seed, options = task
    packing = lamella.packing(count=options.count, seed=seed)
    about = {
        "seed": seed,
        "packing_fraction": packing.packing_fraction,
        "rattlers": int(packing.rattlers.sum()),
        "coordination": packing.coordination,
        "aspect": packing.box[-1] / packing.box[0],
        "fabric_anisotropy": packing.fabric_anisotropy,
        "stress_anisotropy": packing.stress_anisotropy,
        "unbalanced_force": packing.unbalanced_force,
    }
    grain = float(np.mean(np.pi * np.asarray(packing.radii) ** 2))  # m^2
    rows = []
    for width in (*WIDTHS, FILLED):
        image = bridged(packing, width, options.nodes)
        pixel = image.spacing**2 / grain  # area of a pixel in mean grains
        smallest = max(1, round(options.smallest / pixel))
        count, mean, largest = pores_of(image, smallest)
        rows.append(
            {
                "seed": seed,
                "width": width,
                "saturation": image.saturation,
                "pores": count,
                "mean_area": mean * pixel,
                "largest_area": largest * pixel,
            }
        )
    return about, rows


def means_of(rows, names=NAMES):
    """Means and standard deviations over the packings, one row a width."""
    means = []
    for width in dict.fromkeys(row["width"] for row in rows):
        mine = [row for row in rows if row["width"] == width]
        mean = {"width": width, "samples": len(mine)}
        for name in ("saturation", *names):
            values = [row[name] for row in mine]
            mean[name] = statistics.fmean(values)
            mean[name + "_deviation"] = statistics.stdev(values) if len(values) > 1 else 0.0
        means.append(mean)
    return means


def panel(axes, colours, spacing, diameter=None):
    """A picture of RGB values; with a diameter, a bar of two of them below it."""
    high, wide = colours.shape[:2]
    axes.imshow(colours, origin="lower", interpolation="antialiased", extent=(0, wide * spacing, 0, high * spacing))
    axes.set_xlim(0, wide * spacing)
    axes.set_ylim(0, high * spacing)
    axes.axis("off")
    if diameter:
        below = -0.04 * high * spacing
        axes.plot([0, 2 * diameter], [below] * 2, color="black", linewidth=3, clip_on=False, solid_capstyle="butt")
        axes.text(0, 1.6 * below, "2 mean diameters", ha="left", va="top", fontsize=9)


def middle(image, share):
    """The middle of a sample, as wide as high, of an array whose rows go up."""
    high, wide = image.phase.shape
    edge = int(share * wide)
    y = (high - edge) // 2
    x = (wide - edge) // 2
    return np.s_[y : y + edge, x : x + edge]


def draw_bridges(packing, nodes, path):
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.6))
    for one, width, letter in zip(axes, (0.25, 0.5, 0.75), "abc"):
        image = bridged(packing, width, nodes)
        colours = COLOURS(image.phase[::-1][middle(image, 0.5)])
        panel(one, colours, image.spacing, 2 * np.mean(packing.radii) if letter == "a" else None)
        one.set_title(f"({letter}) α = {width:g}, S = {image.saturation:.2f}", fontsize=11)
    write_figure(figure, path, dpi=200, bbox_inches="tight")


def draw_pores(packing, nodes, path):
    grain = float(np.mean(np.pi * np.asarray(packing.radii) ** 2))
    figure, axes = plt.subplots(1, 5, figsize=(14, 3.2))
    norm, colour_map = LogNorm(1e-3, 1), plt.get_cmap("viridis")
    for one, width in zip(axes, WIDTHS):
        image = bridged(packing, width, nodes)
        pores = lamella.pore_flood_fill(image, phase="void", connectivity=4)
        window = middle(image, 0.6)
        area = pores.sizes[::-1][window] * image.spacing**2 / grain
        colours = SOLID(np.maximum(image.phase[::-1][window], 1) - 1)
        inside = np.isfinite(area)
        colours[inside] = colour_map(norm(area[inside]))
        panel(one, colours, image.spacing, 2 * np.mean(packing.radii) if one is axes[0] else None)
        one.set_title(f"S = {image.saturation:.2f}", fontsize=11)
    bar = figure.colorbar(ScalarMappable(norm, colour_map), ax=axes, fraction=0.012, pad=0.01, extend="both")
    bar.set_label("pore area / mean grain area")
    write_figure(figure, path, dpi=200, bbox_inches="tight")


def draw_curve(path, x, y, names, xlabel, ylabel, log=False, extra=None):
    figure, axes = plt.subplots(figsize=(4.6, 3.6))
    for (values, deviations), name, marker in zip(y, names, "os^"):
        axes.errorbar(x[0], values, xerr=x[1], yerr=deviations, marker=marker, capsize=3, linewidth=1, markersize=5, label=name)
    if extra:
        axes.plot(*extra[:2], "x", color="black", markersize=7, label=extra[2])
    if log:
        axes.set_yscale("log")
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    if len(names) > 1 or extra:
        axes.legend(frameon=False)
    write_figure(figure, path, dpi=150, bbox_inches="tight")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=10, help="packings, seeds from 1 on [10]")
    parser.add_argument("--count", type=int, default=400, help="disks in each [400]")
    parser.add_argument("--nodes", type=int, default=800, help="nodes across [800]")
    parser.add_argument("--smallest", type=float, default=2e-4, help="least pore area in mean grain areas [2e-4]")
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="samples at once [all processors]")
    parser.add_argument("--output", default="results/cemented-grains", help="folder [results/cemented-grains]")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    there = lambda name: os.path.join(options.output, name)  # noqa: E731

    about, rows = [], []
    tasks = [(seed, options) for seed in range(1, options.samples + 1)]
    with concurrent.futures.ProcessPoolExecutor(options.processes) as pool:
        for done, (packing, sample) in enumerate(pool.map(measure, tasks), 1):
            about.append(packing)
            rows.extend(sample)
            print(f"{done} of {len(tasks)} packings", flush=True)
    means = means_of(rows)
    write_csv(there("packings.csv"), about)
    write_csv(there("samples.csv"), rows)
    write_csv(there("means.csv"), means)

    bridges = means[:-1]
    column = lambda name, of=means: [row[name] for row in of]  # noqa: E731
    both = lambda name, of=means: (column(name, of), column(name + "_deviation", of))  # noqa: E731
    draw_curve(there("saturation.png"), (column("width", bridges), None), [both("saturation", bridges)],
               [f"{options.samples} packings"], "width of the bridges, α", "saturation, S",
               extra=(list(PAPER), list(PAPER.values()), "S of Frank et al. 2020,\nat α as we infer"))
    draw_curve(there("pore-number.png"), both("saturation"), [both("pores")], ["pores"], "saturation, S",
               "pores in a sample")
    draw_curve(there("pore-area.png"), both("saturation", bridges), [both("mean_area", bridges), both("largest_area", bridges)],
               ["mean", "largest"], "saturation, S", "pore area / mean grain area", log=True)
    first = lamella.packing(count=options.count, seed=1)
    draw_bridges(first, 2 * options.nodes, there("bridges.png"))
    draw_pores(first, 2 * options.nodes, there("pores.png"))

    print(f"{'width':>7} {'S':>16} {'pores':>16} {'mean area':>20} {'largest area':>20}   (areas in mean grains)")
    for row in means:
        print(f"{row['width']!s:>7} {row['saturation']:>8.4f} ±{row['saturation_deviation']:6.4f} "
              f"{row['pores']:>9.1f} ±{row['pores_deviation']:5.1f} "
              f"{row['mean_area']:>11.5f} ±{row['mean_area_deviation']:7.5f} "
              f"{row['largest_area']:>11.4f} ±{row['largest_area_deviation']:7.4f}")
    print(f"files in {options.output}")


if __name__ == "__main__":
    main()
