"""Cracks that run: a pulled plate whose crack branches, and Kalthoff and Winkler's plate struck between its notches.

    PYTHONPATH=build/python /usr/bin/python3 examples/dynamic-fracture/study.py

Writes to --output:
  branching.png, kalthoff.png  cracks over the mean stress at three times, the speed of their tips, the energies
  branching.vtp, kalthoff.vtp  the broken bonds in order
  branching.csv, kalthoff.csv  the history; speed-branching.csv, speed-kalthoff.csv: of the tip
"""

import argparse
import os
import pathlib
import sys

import lamella
import numpy as np
from matplotlib import pyplot as plt
from scipy.spatial import cKDTree

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import write_csv, write_figure  # noqa: E402

INK = "#222222"
COLOURS = {"kinetic": "#2b6ca3", "elastic": "#3a8f5c", "broken": "#b3382c", "supplied": "#777777"}
# Rayleigh's speed, stress that saturates the colours, time of the end, over which a tip's speed is taken; horizon, and
# nodes in it.
SCENES = {
    "branching": {"rayleigh": 3099, "stress": 4e6, "end": 43e-6, "window": 2e-6, "horizon": 1e-3, "ratio": 5},
    "kalthoff": {"rayleigh": 2836, "stress": 6e8, "end": 90e-6, "window": 5e-6, "horizon": 2e-3, "ratio": 5},
}
QUICK = {"branching": (1.5e-3, 3), "kalthoff": (5e-3, 3)}


def plate(horizon, ratio, length, height):
    """Spacing, and whole nodes of one phase; across the axis of symmetry an even number."""
    spacing = horizon / ratio
    return spacing, np.ones((2 * round(height / (2 * spacing)), round(length / spacing)), int)


def branching(horizon, ratio, share, times):
    """A notched glass plate, pulled at once by its long sides; three horizons along these never break. After Bobaru and
    Zhang, Int. J. Fract. 196 (2015) 59."""
    spacing, phase = plate(horizon, ratio, 0.1, 0.04)
    rim = 3 * ratio
    phase[:rim] = phase[-rim:] = 2
    notch = ((0, 0.02), (0.05, 0.02))
    return lamella.dynamics(
        lamella.from_array(phase, {1: "glass", 2: "rim"}, spacing), {"glass": 72e9, "rim": 72e9, "glass-rim": 72e9},
        2440, fracture_energy={"glass": 3.8}, horizon=ratio, notches=[notch],
        tractions={"y+": (0, 2e6), "y-": (0, -2e6)}, end_time=times[-1], at_times=times, step_share=share, stress=True)


def kalthoff(horizon, ratio, share, times):
    """A steel plate with two notches; the edge between them keeps its speed along them and is free across. Where a notch
    runs through nodes it gives way to its right: both away from the middle."""
    spacing, phase = plate(horizon, ratio, 0.1, 0.2)
    notches = [((0, 0.075), (0.05, 0.075)), ((0.05, 0.125), (0, 0.125))]
    struck = ((0, 0.075), ((ratio - 0.5) * spacing, 0.125), (16, None))
    return lamella.dynamics(
        lamella.from_array(phase, {1: "steel"}, spacing), {"steel": 191e9}, 8000, fracture_energy={"steel": 42408},
        continuum="plane-strain", horizon=ratio, notches=notches, boxes=[struck], end_time=times[-1], at_times=times,
        step_share=share, stress=True)


def crack_of(name, broken, spacing):
    """Broken bonds of the one crack whose tip is followed, and the direction in which it runs."""
    if name == "branching":
        return broken, np.array([1.0, 0.0])
    x, y = broken["position"].T
    upper = broken[(y > 0.125 - 1e-3 * spacing) & (x > 0.04)]
    if len(upper) < 10:
        return upper, np.array([0.0, 1.0])
    centred = upper["position"] - upper["position"].mean(axis=0)
    direction = np.linalg.svd(centred, full_matrices=False)[2][0]
    return upper, direction * np.sign(direction[1])


def tip_speeds(crack, direction, reach, window):
    """How far bonds have broken along a direction, each with another broken one within reach, and the slope of that over
    windows in time: times and speeds."""
    position = crack["position"] @ direction
    near = cKDTree(crack["position"]).query_pairs(reach, output_type="ndarray")
    joined = np.full(len(crack), np.inf)  # when a neighbour has broken too
    for a, b in (near.T, near.T[::-1]):
        np.minimum.at(joined, a, np.maximum(crack["time"][a], crack["time"][b]))
    counts = joined <= crack["time"]
    time, position = crack["time"][counts], np.maximum.accumulate(position[counts])
    if len(time) == 0:
        return np.empty(0), np.empty(0)
    first = np.concatenate([[True], np.diff(position) > 0])
    time, position = time[first], position[first]
    windows = ((time - time[0]) / window).astype(int)
    speeds = []
    for k in range(windows[-1] + 1):
        inside = windows == k
        moved = inside.sum() > 1 and np.ptp(time[inside]) > 0
        speeds.append(np.polyfit(time[inside] - time[0], position[inside], 1)[0] if moved else 0.0)
    return time[0] + (np.arange(len(speeds)) + 0.5) * window, np.array(speeds)


def show(axes, state, spacing, notches, limit):
    """Mean stress, blue for compression, with what is broken in black."""
    ny, nx = state.damage.shape
    extent = (0, 1e3 * nx * spacing, 0, 1e3 * ny * spacing)
    mean = (state.stress_component("xx") + state.stress_component("yy")) / 2
    image = axes.imshow(mean / 1e6, extent=extent, cmap="RdBu_r", vmin=-limit / 1e6, vmax=limit / 1e6,
                        interpolation="nearest")
    crack = np.zeros((ny, nx, 4))
    crack[:, :, 3] = np.clip(state.damage / 0.35, 0, 1)
    axes.imshow(crack, extent=extent, interpolation="nearest")
    for x, y in notches:
        axes.plot([0, x], [y, y], color="black", lw=1.2, solid_capstyle="butt")
    axes.set_title(f"{1e6 * state.time:.0f} µs", fontsize=9, color=INK)
    axes.set_xticks([0, extent[1]], ["0", f"{extent[1]:.0f}"])
    axes.set_yticks([0, extent[3]], ["0", f"{extent[3]:.0f}"])
    axes.tick_params(length=2, labelsize=7)
    return image


def curves(axes, result, speeds, scene):
    """Speed of the tip, and the energies."""
    left, right = axes
    left.plot(1e6 * speeds[0], speeds[1] / 1e3, "o-", ms=3, lw=1, color=INK)
    left.axhline(scene["rayleigh"] / 1e3, color="#b3382c", lw=1, ls="--")
    left.text(0.98, scene["rayleigh"] / 1e3, "Rayleigh", color="#b3382c", fontsize=8, ha="right", va="bottom",
              transform=left.get_yaxis_transform())
    left.set(ylim=(0, 1.18 * scene["rayleigh"] / 1e3), ylabel="speed of the tip [km/s]", xlabel="time [µs]")
    time = 1e6 * result.time
    energies = {name: result.energies[name] / result.energies["supplied"][-1] for name in COLOURS}
    below = -1.0
    for name, colour in sorted(COLOURS.items(), key=lambda item: energies[item[0]][-1]):
        right.plot(time, energies[name], color=colour, lw=1.2)
        below = max(energies[name][-1], below + 0.07)  # labels that do not overlap
        right.text(1.01 * time[-1], below, name, color=colour, fontsize=8, va="center")
    right.set(ylim=(0, 1.08), ylabel="energy, supplied = 1", xlabel="time [µs]")
    for a in axes:
        a.spines[["top", "right"]].set_visible(False)
        a.tick_params(labelsize=8)
        a.xaxis.label.set_size(9)
        a.yaxis.label.set_size(9)


def draw(name, result, speeds, target):
    scene = SCENES[name]
    notches = [(50, 20)] if name == "branching" else [(50, 75), (50, 125)]
    wide = name == "branching"
    figure = plt.figure(figsize=(9, 4.2) if wide else (9, 6.6), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(1.15, 1.3) if wide else (2.1, 1.2))
    panels = top.subplots(1, 3)
    for a, state in zip(panels, result.states[-3:]):
        image = show(a, state, result.spacing, notches, scene["stress"])
    panels[0].set_ylabel("mm", fontsize=8)
    bar = top.colorbar(image, ax=panels, shrink=0.8, pad=0.01, aspect=18)
    bar.set_label("mean stress [MPa]", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    curves(bottom.subplots(1, 2), result, speeds, scene)
    write_figure(figure, target, dpi=130)


def study(name, quick=False, share=0.4):
    """The run, and its tip's times and speeds."""
    scene = SCENES[name]
    horizon, ratio = QUICK[name] if quick else (scene["horizon"], scene["ratio"])
    times = scene["end"] * np.array([0.5, 0.75, 1])
    result = {"branching": branching, "kalthoff": kalthoff}[name](horizon, ratio, share, times)
    crack, direction = crack_of(name, result.broken, result.spacing)
    return result, tip_speeds(crack, direction, horizon, scene["window"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("results/dynamic-fracture"))
    parser.add_argument("--quick", action="store_true", help="coarse plates, some seconds")
    parser.add_argument("--share", type=float, default=0.4, help="step over the largest stable one")
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    for name, scene in SCENES.items():
        result, speeds = study(name, args.quick, args.share)
        fastest = speeds[1].max() if len(speeds[1]) else 0.0
        print(f"{name}: {len(result.broken)} bonds broken from {1e6 * result.broken['time'][0]:.1f} µs on; fastest tip "
              f"{fastest:.0f} m/s, {fastest / scene['rayleigh']:.2f} of Rayleigh's; energies off by "
              f"{result.energy_defect[-1]:.1e}; {result.steps} steps, {result.seconds['motion']:.1f} s")
        result.save_broken(args.output / f"{name}.vtp", overwrite=True)
        columns = {"time": result.time, **result.energies, "defect": result.energy_defect, "broken": result.broken_so_far}
        write_csv(args.output / f"{name}.csv", [dict(zip(columns, row)) for row in zip(*columns.values())])
        write_csv(args.output / f"speed-{name}.csv", [{"time": t, "speed": v} for t, v in zip(*speeds)])
        draw(name, result, speeds, args.output / f"{name}.png")


if __name__ == "__main__":
    main()
