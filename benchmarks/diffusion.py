"""Draws what the benchmark "diffusion" measured: error against processor time.

    /usr/bin/python3 benchmarks/diffusion.py [output=FOLDER] [picture=FILE]

FOLDER holds diffusion-heat.csv, diffusion-vapour.csv, diffusion-spheres.csv, or some of them (default: results/bench-diffusion); FILE is
FOLDER/diffusion.png unless told. `./dev bench diffusion` runs it after the measurements, with the benchmark's keys: others are no concern
of it.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from compression import rows_of  # noqa: E402

TITLES = {
    "heat": "heat: disks 0.023 in 1",
    "vapour": "vapour: disks 1 in 0.004",
    "spheres": "spheres 10 in 1",
}
STYLES = {  # of a method: colour, marker
    "BGK stepping tau 1": ("tab:red", "v"),
    "BGK stepping tau 5": ("tab:orange", "^"),
    "TRT stepping": ("tab:purple", "s"),
    "steady": ("tab:blue", "o"),
    "pixels extrapolated": ("tab:cyan", "x"),
    "outlines": ("tab:green", "D"),
    "outlines extrapolated": ("k", "*"),
}
DIAGONAL = ("d2q9", "d3q19")  # drawn with broken lines


def front(points):
    """The points below which no other is: none as fast errs less."""
    best = []
    for seconds, error in sorted(points):
        if not best or error < best[-1][1]:
            best.append((seconds, error))
    return best


def draw(axes, rows):
    points = [(row["cpu_seconds"], abs(row["error"])) for row in rows]
    for seconds, error in front(points):
        axes.plot(seconds, error, "o", color="gold", markersize=13, zorder=0)
    for method, stencil in dict.fromkeys((row["method"], row["stencil"]) for row in rows):
        of = [(row["cpu_seconds"], abs(row["error"])) for row in rows if (row["method"], row["stencil"]) == (method, stencil)]
        colour, marker = STYLES[method]
        diagonal = stencil in DIAGONAL
        axes.plot(*zip(*of), color=colour, marker=marker, markersize=5, linewidth=0.8, linestyle="--" if diagonal else "-",
                  markerfacecolor="none" if diagonal else colour, label=f"{method}, {stencil.upper()}")


def main():
    keys = dict(argument.partition("=")[::2] for argument in sys.argv[1:])
    folder = pathlib.Path(keys.get("output", "results/bench-diffusion"))
    picture = pathlib.Path(keys.get("picture", folder / "diffusion.png"))
    tables = {scene: folder / f"diffusion-{scene}.csv" for scene in TITLES}
    panels = {scene: rows_of(table) for scene, table in tables.items() if table.exists()}
    panels = {scene: rows for scene, rows in panels.items() if rows}
    if not panels:
        print(f"  nothing drawn: {folder} has no table of a run")
        return
    figure, axes = plt.subplots(1, len(panels), figsize=(4.8 * len(panels), 5.4), constrained_layout=True, squeeze=False)
    for place, (scene, rows) in zip(axes[0], panels.items()):
        draw(place, rows)
        place.set_xscale("log")
        place.set_yscale("log")
        place.set_title(TITLES[scene], fontsize=10)
        place.set_xlabel("processor time [s]")
        place.legend(fontsize=7, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.12))
    axes[0][0].set_ylabel("relative error")
    figure.savefig(picture, dpi=110)
    print(f"  written: {picture}")


if __name__ == "__main__":
    main()
