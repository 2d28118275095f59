"""Cracks that run: a pulled plate whose crack branches, and Kalthoff and Winkler's plate struck between its notches.

    /usr/bin/python3 examples/dynamic-fracture/study.py

The benchmark dynamic-fracture (`./dev bench dynamic-fracture` builds it) computes, this script draws. Writes to --output:
  branching.png, kalthoff.png  cracks over the mean stress at three times, the speed of their tips, the energies
  branching/, kalthoff/        what was drawn: bonds.csv, tip.csv, speed.csv, energy.csv, frame-N.csv
"""

import argparse
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib import pyplot as plt

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = HERE.parents[1] / "build" / "bin" / "benchmarks" / "dynamic-fracture"
INK = "#222222"
COLOURS = {"kinetic": "#2b6ca3", "elastic": "#3a8f5c", "broken": "#b3382c", "supplied": "#777777"}
# Rayleigh's speed, stress that saturates the colours, frames.
SCENES = {
    "branching": {"rayleigh": 3099, "stress": 4e6, "times": (2, 3, 4), "horizon": 1e-3, "ratio": 5},
    "kalthoff": {"rayleigh": 2836, "stress": 6e8, "times": (2, 3, 4), "horizon": 2e-3, "ratio": 5},
}


def frame(path):
    """Header's time, and the columns as pictures."""
    with open(path, encoding="ascii") as file:
        words = file.readline().replace(",", " ").split()
        names = file.readline().strip().split(",")
    nx, ny, spacing, time = int(words[1]), int(words[3]), float(words[6]), float(words[9])
    values = np.loadtxt(path, delimiter=",", skiprows=2).reshape(ny, nx, len(names))
    return {n: values[:, :, k] for k, n in enumerate(names)} | {"spacing": spacing, "time": time}


def show(axes, f, notches, limit):
    """Mean stress, blue for compression, with what is broken in black."""
    ny, nx = f["damage"].shape
    extent = (0, 1e3 * nx * f["spacing"], 0, 1e3 * ny * f["spacing"])
    image = axes.imshow(f["mean_stress"] / 1e6, origin="lower", extent=extent, cmap="RdBu_r", vmin=-limit / 1e6,
                        vmax=limit / 1e6, interpolation="nearest")
    crack = np.zeros((ny, nx, 4))
    crack[:, :, 3] = np.clip(f["damage"] / 0.35, 0, 1)
    axes.imshow(crack, origin="lower", extent=extent, interpolation="nearest")
    for x, y in notches:
        axes.plot([0, x], [y, y], color="black", lw=1.2, solid_capstyle="butt")
    axes.set_title(f"{1e6 * f['time']:.0f} µs", fontsize=9, color=INK)
    axes.set_xticks([0, extent[1]], ["0", f"{extent[1]:.0f}"])
    axes.set_yticks([0, extent[3]], ["0", f"{extent[3]:.0f}"])
    axes.tick_params(length=2, labelsize=7)
    return image


def curves(axes, folder, scene):
    """Speed of the tip, and the energies."""
    speed = np.genfromtxt(folder / "speed.csv", delimiter=",", names=True)
    left, right = axes
    left.plot(1e6 * speed["time"], speed["speed"] / 1e3, "o-", ms=3, lw=1, color=INK)
    left.axhline(scene["rayleigh"] / 1e3, color="#b3382c", lw=1, ls="--")
    left.text(0.98, scene["rayleigh"] / 1e3, "Rayleigh", color="#b3382c", fontsize=8, ha="right", va="bottom",
              transform=left.get_yaxis_transform())
    left.set(ylim=(0, 1.18 * scene["rayleigh"] / 1e3), ylabel="speed of the tip [km/s]", xlabel="time [µs]")
    energy = np.genfromtxt(folder / "energy.csv", delimiter=",", names=True)
    scale = 1 / energy["supplied"][-1]
    below = -1.0
    for name, colour in sorted(COLOURS.items(), key=lambda item: energy[item[0]][-1]):
        right.plot(1e6 * energy["time"], scale * energy[name], color=colour, lw=1.2)
        below = max(scale * energy[name][-1], below + 0.07)  # labels that do not overlap
        right.text(1.01 * 1e6 * energy["time"][-1], below, name, color=colour, fontsize=8, va="center")
    right.set(ylim=(0, 1.08), ylabel="energy, supplied = 1", xlabel="time [µs]")
    for a in axes:
        a.spines[["top", "right"]].set_visible(False)
        a.tick_params(labelsize=8)
        a.xaxis.label.set_size(9)
        a.yaxis.label.set_size(9)


def draw(name, folder, target):
    scene = SCENES[name]
    notches = [(50, 20)] if name == "branching" else [(50, 75), (50, 125)]
    frames = [frame(folder / f"frame-{k}.csv") for k in scene["times"]]
    wide = name == "branching"
    figure = plt.figure(figsize=(9, 4.2) if wide else (9, 6.6), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(1.15, 1.3) if wide else (2.1, 1.2))
    panels = top.subplots(1, 3)
    for a, f in zip(panels, frames):
        image = show(a, f, notches, scene["stress"])
    panels[0].set_ylabel("mm", fontsize=8)
    bar = top.colorbar(image, ax=panels, shrink=0.8, pad=0.01, aspect=18)
    bar.set_label("mean stress [MPa]", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    curves(bottom.subplots(1, 2), folder, scene)
    figure.savefig(target, dpi=130)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("results/dynamic-fracture"))
    parser.add_argument("--quick", action="store_true", help="coarse plates, some seconds")
    parser.add_argument("--safety", type=float, default=0.4, help="step over the largest stable one")
    args = parser.parse_args()
    if not PROGRAM.exists():
        sys.exit("error: the benchmarks are not built\nhint: ./dev bench dynamic-fracture builds this one")
    for name, scene in SCENES.items():
        folder = args.output / name
        size = ["quick"] if args.quick else [f"horizon={scene['horizon']}", f"ratio={scene['ratio']}"]
        subprocess.run([PROGRAM, f"scene={name}", f"safety={args.safety}", "frames=4", f"out={folder}", *size],
                       check=True)
        draw(name, folder, args.output / f"{name}.png")


if __name__ == "__main__":
    main()
