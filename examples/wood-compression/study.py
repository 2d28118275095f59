"""Wood pressed across the grain, from the first touch to densification, by material points.

    PYTHONPATH=build/python /usr/bin/python3 examples/wood-compression/study.py

Spruce earlywood and latewood and poplar, generated, and with LAMELLA_REAL_DATA the two spruce outlines of Ferrara and Wittel, pressed
radially and tangentially between platens, 9 points a pixel (--per 3, along each axis); walls 8 GPa along and 6.4 GPa across, sides that
stay straight without force; after section 4.2 of Perré, Almeida, Ayouz and Frank, Ann. For. Sci. 73 (2016) 147. Writes to --output:
  NAME.png      both curves and the radial test at three or four strains (their figures 13 and 14): points by the stress along the load
  NAME-collapse.png  which lumens give way in the radial test, and when; the load upwards as in NAME.png
  NAME-R.csv, NAME-T.csv  the curves
  stiffness.csv one row a sample and direction (their Table 1): implicit solve, regression over 0 to 3 %, plateau, densification
  poplar-lumens.csv  one row a kind of lumen (vessels, rays, fibres): when they give way in the radial test
--frames N keeps N pictures of each radial test besides, for a film: NAME-frame-000.png ...
"""

import concurrent.futures
import os
import sys
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt
from vtkmodules.vtkCommonCore import vtkLogger

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import parser_of, write_csv, write_figure  # noqa: E402

REAL = {  # outlines, window [micrometres]: low x, low y, high x, high y
    "spruce-earlywood": ("spruce_EW_polygons.json.gz", (100, 80, 266.5, 246.5)),
    "spruce-latewood": ("spruce_LW_polygons.json.gz", (70, 70, 140, 140)),
}
PIXEL = 1e-6  # of the generated ones
# At the paper's solid fractions, and as large as gives its numbers of points (216 494, 109 055, 174 384) at 9 a node of the wall
GENERATED = {
    "earlywood": (lamella.softwood, dict(size=(245, 245), solid_fraction=0.4, ray_distance=0)),
    "latewood": (lamella.softwood, dict(size=(125, 124), solid_fraction=0.78, ring_position=(1, 1), ray_distance=0)),
    "poplar": (lamella.hardwood, dict(size=(339, 339), solid_fraction=0.38)),
}
SPACINGS = {"poplar": 1.5e-6, **dict.fromkeys(REAL, 0.5e-6)}  # of the lattice; others 1 micrometre
SNAPSHOTS = {"poplar": (0.10, 0.20, 0.42)}
USUAL = (0.05, 0.12, 0.25, 0.48)
ENDS = {"latewood": 0.2, "spruce-latewood": 0.35}  # where hardly a lumen is left
END = 0.48
DIRECTIONS = {"R": "radial", "T": "tangential"}


def tissue(name, options):
    """Walls with their directions on a lattice, and which axis is radial."""
    spacing = SPACINGS.get(name, PIXEL) * options.coarser
    if name in REAL:
        file, window = REAL[name]
        outlines = lamella.read_polygons(os.path.join(os.environ["LAMELLA_REAL_DATA"], file), window=window)
        return outlines.lattice(spacing), "y"
    make, how = GENERATED[name]
    return lamella.contours(make(spacing=PIXEL, seed=options.seed, **how)).lattice(spacing), "x"


def number(value):
    """What a curve that ends early does not have."""
    return np.nan if value is None else value


def flattest(strain, stress, width=0.1):
    """Least slope of the curve over this width of strain [Pa], and its middle, between 2 and 45 %; NaN of a curve that ends before 45 %."""
    if strain[-1] < 0.45:
        return np.nan, np.nan
    starts = np.arange(0.02, 0.45 - width, 0.005)
    slopes = (np.interp(starts + width, strain, stress) - np.interp(starts, strain, stress)) / width
    least = int(np.argmin(slopes))
    return slopes[least], starts[least] + width / 2


def pressed(name, direction, options):
    """One test; what is drawn of it, and its row of the table."""
    begun = time.process_time()
    image, radial = tissue(name, options)
    axis = radial if direction == "R" else "xy".replace(radial, "")
    walls = dict(points_per_node=options.per, threads=options.threads)
    modulus = lamella.point_stiffness(image, **walls).constants[f"E_{axis}"]
    spent = time.process_time() - begun
    end = min(options.strain, ENDS.get(name, options.strain))
    strains = [strain for strain in SNAPSHOTS.get(name, USUAL) if strain <= end] if direction == "R" else []
    frames = list(np.linspace(0, end, options.frames + 1)[1:]) if direction == "R" else []
    kept = sorted({round(e, 6) for e in (*strains, *frames, *np.linspace(end / 12, end, 12))}) if direction == "R" else []
    result = lamella.compression(image, axis=axis, strain=end, energy_ratio=options.energy_ratio, at_strains=kept,
                                 deformation_gradient=True, stress=True, rows=max(60, round(500 * end)), **walls)
    result.save_curve(os.path.join(options.output, f"{name}-{direction}.csv"), overwrite=True)
    curve = lamella.compression_curve(result.strain, result.stress)
    row = dict(sample=name, direction=direction, solid=1 - result.curve["porosity"][0], points=result.statistics["points"],
               implicit_MPa=modulus / 1e6, slope_MPa=curve.stiffness / 1e6,
               flattest=flattest(result.strain, result.stress)[0] / curve.stiffness, plateau_MPa=number(curve.plateau_stress) / 1e6,
               densification=number(curve.densification), dissipated=result.curve["dissipated"][-1] / result.curve["work"][-1],
               energy_ratio=result.energy_ratio, steps=result.statistics["steps"],
               stiffness_s=round(spent, 2), total_s=round(time.process_time() - begun, 1))
    drawn = {"side": image.vtk.GetSpacing()[0] / options.per, "end": end}
    if direction == "R":
        shown = [state for state in result.states if any(abs(state.imposed_strain - e) < 1e-6 for e in strains)]
        drawn["states"] = [picture_of(state, axis) for state in shown]
        drawn["frames"] = [picture_of(state, axis) for state in result.states
                           if any(abs(state.imposed_strain - e) < 1e-6 for e in frames)]
        collapse = lamella.collapse_map(image, [state.vtk for state in result.states])
        drawn["collapse"] = upright(collapse.collapse_strain, axis).copy()
        drawn["open"] = upright(collapse.labels, axis) > 0
        if name == "poplar":
            shares = [lamella.collapse_map(image, state.vtk).table["ratio"] for state in shown]
            drawn["lumens"] = by_kind(collapse.table, dict(zip(strains, shares)), image.vtk.GetSpacing()[0])
    return row, result.strain.copy(), result.stress.copy(), drawn


def upright(picture, axis):
    """A picture, its top row first, with the load upwards as picture_of() has it: x to y, not turned, where that is the load."""
    return picture if axis == "y" else picture[::-1].T[::-1]


def by_kind(lumens, ratios, spacing):
    """One row a kind of lumen of poplar, loaded along x: their share, when they give way, what of their area is lost by these strains.

    Rays are at least 2.5 times as long, along x, as wide, and less than 15 micrometres wide; vessels otherwise larger than a circle of
    22 micrometres, other lumens fibres.
    """
    length, width = (lumens[f"{axis}_last"] - lumens[f"{axis}_first"] + 1 for axis in "xy")
    ray = (length >= 2.5 * width) & (width * spacing < 15e-6)
    vessel = ~ray & (lumens["equivalent_diameter"] > 22e-6)
    area, strain = lumens["area"], lumens["collapse_strain"]
    rows = []
    for name, chosen in (("vessels", vessel), ("rays", ray), ("fibres", ~ray & ~vessel), ("all", np.ones(len(area), bool))):
        gone = np.sort(np.where(np.isnan(strain[chosen]), np.inf, strain[chosen]))
        row = dict(kind=name, lumens=int(chosen.sum()), area_share=area[chosen].sum() / area.sum(), first=gone[0],
                   half_collapsed=gone[(len(gone) - 1) // 2])
        for strain_of, ratio in ratios.items():
            there = chosen & ~np.isnan(ratio)
            row[f"lost_at_{100 * strain_of:.0f}"] = 1 - (area * ratio)[there].sum() / area[there].sum()
        rows.append(row)
    return rows


def picture_of(state, axis):
    """Strain, places with the load upwards [m], and the stress along the load [Pa]."""
    places = np.asarray(state.positions)[:, :2]
    stress = state.array("stress")
    upwards = axis == "y"
    return (state.imposed_strain, places if upwards else places[:, ::-1], np.asarray(stress[:, 1 if upwards else 0]))


def show(axes, picture, width, height, limit, side):
    strain, places, stress = picture
    size = 1.5 * 72 * axes.get_position().width * axes.figure.get_figwidth() / width * side  # of a stretched point, in points of print
    axes.scatter(*(places * 1e6).T, c=np.clip(-stress / limit, -1, 1), cmap="RdBu_r", vmin=-1, vmax=1, s=size**2, marker="s",
                 linewidths=0, rasterized=True)
    axes.set_title(f"{100 * strain:.0f} %", fontsize=9)
    middle = 1e6 * (places[:, 0].min() + places[:, 0].max()) / 2
    axes.set_xlim(middle - width * 5.2e5, middle + width * 5.2e5)
    low = places[:, 1].min() * 1e6
    axes.set_ylim(low - 2, low + height * 1e6 + 2)
    axes.set_aspect("equal")
    axes.axis("off")


def draw(name, tests, options):
    """Curves of both directions beside the radial test's states."""
    _, _, _, drawn = tests["R"]
    states = drawn["states"]
    figure = plt.figure(figsize=(4.2 + 2.5 * len(states), 3.4))
    share = 4.2 / (4.2 + 2.5 * len(states))
    axes = figure.add_axes([0.19 * share, 0.15, 0.77 * share, 0.78])
    for (direction, (_, strain, stress, _)), style in zip(sorted(tests.items()), ("-", "--")):
        axes.plot(100 * strain, stress / 1e6, style, color="0.1", linewidth=1.2, label=DIRECTIONS[direction])
    axes.set_xlabel("strain [%]")
    axes.set_ylabel("stress [MPa]")
    axes.set_xlim(0, 100 * drawn["end"])
    middle = [np.interp(0.7 * drawn["end"], strain, stress) for _, strain, stress, _ in tests.values()]
    axes.set_ylim(0, 2.2 * max(middle) / 1e6)
    axes.legend(frameon=False, fontsize=9)
    width, height = (np.ptp(states[0][1][:, i]) for i in (0, 1))
    height /= 1 - states[0][0]
    limit = 2 * np.percentile(np.abs(states[len(states) // 2][2]), 75)
    each = (1 - share) / len(states)
    for k, picture in enumerate(states):
        show(figure.add_axes([share + k * each + 0.004, 0.02, each - 0.008, 0.86]), picture, width, height, limit, drawn["side"])
    write_figure(figure, os.path.join(options.output, f"{name}.png"), dpi=200)

    for k, picture in enumerate(drawn["frames"]):
        figure = plt.figure(figsize=(5, 5.2))
        show(figure.add_axes([0.01, 0.01, 0.98, 0.92]), picture, width, height, limit, drawn["side"])
        write_figure(figure, os.path.join(options.output, f"{name}-frame-{k:03d}.png"), dpi=160)

    if "lumens" in drawn:
        write_csv(os.path.join(options.output, f"{name}-lumens.csv"), drawn["lumens"])
    figure, axes = plt.subplots(figsize=(5, 4.2), constrained_layout=True)
    axes.imshow(np.where(drawn["open"], 0.85, 1), cmap="gray", vmin=0, vmax=1, interpolation="nearest")
    shown = axes.imshow(100 * drawn["collapse"], cmap="viridis", vmin=0, vmax=100 * drawn["end"], interpolation="nearest")
    axes.axis("off")
    axes.set_title("strain at which a lumen has lost half of its area [%]; grey: never", fontsize=9)
    figure.colorbar(shown, ax=axes, shrink=0.85)
    write_figure(figure, os.path.join(options.output, f"{name}-collapse.png"), dpi=160)


def main():
    parser = parser_of(__doc__, "results/wood-compression")
    parser.add_argument("--coarser", type=float, default=1, help="lattice's spacing, over the study's (default: %(default)s)")
    parser.add_argument("--per", type=int, default=3, help="points along each axis in a pixel (default: %(default)s; with 2, walls tear that fold)")
    parser.add_argument("--strain", type=float, default=END, help="to end at, where a sample has lumens left (default: %(default)s)")
    parser.add_argument("--energy-ratio", type=float, default=0.01, help="kinetic over elastic energy allowed (default: %(default)s)")
    parser.add_argument("--only", nargs="+", help="these samples alone")
    parser.add_argument("--frames", type=int, default=0, help="pictures of each radial test, for a film (default: none)")
    parser.add_argument("--seed", type=int, default=1, help="of the generated ones (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=1, help="of one test; tests run side by side (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="tests at once (default: all cores)")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # thin walls are warned of; the table says how many points there are
    names = [*GENERATED, *(REAL if os.environ.get("LAMELLA_REAL_DATA") else ())]
    if options.only:
        names = [name for name in names if name in options.only]
    if not names:
        parser.error(f"none of {', '.join(options.only)}: there are {', '.join([*GENERATED, *REAL])}; the last two want LAMELLA_REAL_DATA")
    rows = []
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        jobs = {name: {d: pool.submit(pressed, name, d, options) for d in DIRECTIONS} for name in names}
        for name, of in jobs.items():
            tests = {direction: job.result() for direction, job in of.items()}
            draw(name, tests, options)
            for row, *_ in tests.values():
                rows.append(row)
                print("  ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()), flush=True)
    write_csv(os.path.join(options.output, "stiffness.csv"), rows)
    print(f"pictures and tables: {options.output}")


if __name__ == "__main__":
    main()
