"""Notched wood pulled apart: the crack keeps to the middle lamella.

    PYTHONPATH=build/python /usr/bin/python3 examples/wood-fracture/study.py

Earlywood and latewood with a middle lamella at least as thick as a bond is long (h = 4 dx), as stiff as the walls and a quarter as tough,
pulled along y from a notch at the left until nearly nothing holds, one bond at a time; after section 4.3 of Perré, Almeida, Ayouz and Frank,
Ann. For. Sci. 73 (2016) 117. Generated tissue, and with LAMELLA_REAL_DATA the two spruce outlines of Ferrara and Wittel. Writes to --output:
  NAME.png      four states: stress along the load blue below 0, green at 0, red above, the crack black (their figures 16 and 17)
  curves.png    stress against strain of all samples
  samples.csv   one row a sample
"""

import concurrent.futures
import os
import sys
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import LinearSegmentedColormap
from vtkmodules.vtkCommonCore import vtkLogger

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import chart, draw_bonds, parser_of, write_csv, write_figure  # noqa: E402

HORIZON = 4
YOUNG, TOUGHNESS, RATIO = 10e9, 4e5, 4  # Pa, Pa √m, of the walls over the lamella's
WALL, LAMELLA = "secondary wall", "middle lamella"
STATES = tuple(round(50 * 2 ** (i / 2)) for i in range(22))  # numbers of broken bonds at which fields are kept
PAPER = LinearSegmentedColormap.from_list("paper", ["#1030c0", "#20a040", "#d01c1c"])
REAL = {  # outlines, window [micrometres]: low x, low y, high x, high y
    "spruce-earlywood": ("spruce_EW_polygons.json.gz", (120, 120, 300, 300)),
    "spruce-latewood": ("spruce_LW_polygons.json.gz", (60, 60, 190, 190)),
}
GENERATED = {"earlywood": dict(solid_fraction=0.3), "latewood": dict(solid_fraction=0.6, ring_position=(0.6, 0.9), ray_distance=0)}


def tissue(name, options):
    """Outlines on a lattice with a middle lamella of HORIZON nodes at least."""
    spacing = options.spacing * 1e-6
    if name in REAL:
        file, window = REAL[name]
        middle = [(window[0] + window[2]) / 2, (window[1] + window[3]) / 2]
        half = options.share * (window[2] - window[0]) / 2
        window = (middle[0] - half, middle[1] - half, middle[0] + half, middle[1] + half)
        outlines = lamella.read_polygons(os.path.join(os.environ["LAMELLA_REAL_DATA"], file), window=window)
    else:
        nodes = round(options.share * options.size / 0.5)
        sample = lamella.softwood(size=(nodes, nodes), spacing=0.5e-6, seed=options.seed, **GENERATED[name])
        outlines = lamella.contours(sample)
    return outlines.lattice(spacing, lamella="growth", thickness=(HORIZON + 0.5) * spacing, horizon=HORIZON)


def notch_of(image, share):
    """A cut from the left side, along the middle lamella as far as one runs level there in the middle third of the height."""
    high, wide = image.phase.shape
    length = max(1, round(share * wide))
    low = high // 3
    rows = np.sum(image.phase[::-1][low : high - low, :length] == 2, axis=1)
    height = image.spacing * (low + float(np.mean(np.flatnonzero(rows == rows.max()))) + 0.5)
    return (-image.spacing, height, length * image.spacing, height)


def pull(task):
    name, options = task
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # of states asked for that lie beyond the end
    begun, spent = time.perf_counter(), time.process_time()
    image = tissue(name, options)
    high, wide = image.phase.shape
    pairs = (WALL, LAMELLA, f"{WALL}-{LAMELLA}", f"{WALL}-{WALL}")  # the last one: walls of two cells
    notch = notch_of(image, options.notch)
    toughness = {pair: TOUGHNESS if pair == WALL else TOUGHNESS / RATIO for pair in pairs}
    result = lamella.fracture(image, dict.fromkeys(pairs, YOUNG), toughness=toughness, horizon=HORIZON, notches=[notch], stop=options.stop,
                              rivals=options.rivals, at_broken=STATES, stress=True)
    ran = time.process_time() - spent
    path = lamella.crack_path(result)
    states = []
    for state in result.states:
        states.append((state.imposed_strain, state.imposed_stress, state.broken_bonds, state.stress_component("yy")[::-1].astype(np.float32)))
    broken = result.broken
    in_wall = (broken["phases"][:, 0] == broken["phases"][:, 1]) & ~broken["between_grains"]
    in_wall &= broken["phases"][:, 0] == 1
    row = {
        "sample": name, "wide": wide, "high": high, "spacing": image.spacing, "solid": float(np.mean(image.phase != 0)),
        "lamella": float(np.mean(image.phase == 2)), "modulus": result.modulus, "strength": result.peak_stress,
        "strain_at_peak": result.peak_strain, "broken": len(broken), "broken_in_walls": float(np.mean(in_wall)),
        "crack_length": path.length, "main_length": path.main_length,
        "length_in_walls": path.shares.get(WALL, 0.0), "events": result.statistics["events"], "end": result.end,
        "cpu_seconds_run": ran, "seconds": time.perf_counter() - begun,
    }
    return name, row, (result.strain, result.stress), (image.phase[::-1].copy(), image.spacing, notch, broken, states)


def chosen(states, shares=(1, 0.7, 0.4, 0)):
    """The state nearest to the peak, those after it nearest to shares of its stress, and the end."""
    stress = np.array([state[1] for state in states])
    peak = int(np.argmax(stress))
    picked = {peak + int(np.argmin(np.abs(stress[peak:] / stress[peak] - share))) for share in shares}
    return [states[i] for i in sorted(picked)]


def draw(phase, spacing, notch, broken, states, path):
    shown = chosen(states)
    figure, axes = plt.subplots(1, len(shown), figsize=(3.4 * len(shown), 3.9), constrained_layout=True)
    high, wide = phase.shape
    extent = (0, wide * spacing * 1e6, 0, high * spacing * 1e6)
    reach = float(np.percentile(np.abs(states[0][3][phase != 0]), 98))
    for one, (strain, _, number, stress), letter in zip(np.atleast_1d(axes), shown, "abcd"):
        field = np.ma.masked_array(stress / reach, phase == 0)
        picture = one.imshow(field, origin="lower", extent=extent, cmap=PAPER, vmin=-1, vmax=1, interpolation="nearest")
        draw_bonds(one, broken[:number], 1e6, colors="black", linewidths=0.6)
        one.plot([0, notch[2] * 1e6], [notch[1] * 1e6] * 2, color="black", linewidth=1.2)
        one.set_xlim(extent[:2])
        one.set_ylim(extent[2:])
        one.set_title(f"({letter}) strain {100 * strain:.3g} %, {number} bonds", fontsize=9)
        one.set_xlabel("µm")
    figure.colorbar(picture, ax=axes, shrink=0.8, label=f"stress along the load over {reach / 1e6:.3g} MPa", extend="both")
    write_figure(figure, path, dpi=160)


def draw_curves(curves, path):
    with chart(path, "strain [%]", "stress [MPa]") as axes:
        for name, (strain, stress) in curves.items():
            axes.plot(100 * strain, stress / 1e6, linewidth=1.3, label=name)


def main():
    parser = parser_of(__doc__, "results/wood-fracture")
    parser.add_argument("--spacing", type=float, default=0.3, help="of the lattice, micrometres (default: %(default)s)")
    parser.add_argument("--size", type=float, default=150, help="of generated tissue, micrometres (default: %(default)s)")
    parser.add_argument("--share", type=float, default=1, help="of the windows' and pictures' sides (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--notch", type=float, default=0.25, help="length over the width (default: %(default)s)")
    parser.add_argument("--stop", type=float, default=0.1, help="end when the stress has fallen to this share of the peak")
    parser.add_argument("--rivals", action="store_true", help="look closer where two bonds are nearly as critical as each other")
    parser.add_argument("--samples", nargs="+", default=None, choices=(*GENERATED, *REAL), help="default: all")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="samples at a time (default: one a core)")
    options = parser.parse_args()
    names = options.samples or (*GENERATED, *(REAL if os.environ.get("LAMELLA_REAL_DATA") else ()))
    os.makedirs(options.output, exist_ok=True)
    begun = time.perf_counter()
    rows, curves = [], {}
    print(f"{'sample':>16} {'nodes':>10} {'E':>9} {'strength':>10} {'broken':>7} {'bonds in walls':>14} {'length in walls':>15} {'CPU':>7}")
    with concurrent.futures.ProcessPoolExecutor(options.workers) as pool:
        for name, row, curve, sample in pool.map(pull, [(name, options) for name in names]):
            rows.append(row)
            curves[name] = curve
            draw(*sample, os.path.join(options.output, name + ".png"))
            print(f"{name:>16} {row['wide']:>4} x {row['high']:>3} {row['modulus'] / 1e9:>5.2f} GPa {row['strength'] / 1e6:>6.2f} MPa {row['broken']:>7} "
                  f"{100 * row['broken_in_walls']:>12.2f} % {100 * row['length_in_walls']:>13.2f} % {row['cpu_seconds_run']:>5.0f} s", flush=True)
    write_csv(os.path.join(options.output, "samples.csv"), rows)
    draw_curves(curves, os.path.join(options.output, "curves.png"))
    print(f"{len(rows)} samples in {time.perf_counter() - begun:.0f} s; files in {options.output}")


if __name__ == "__main__":
    main()
