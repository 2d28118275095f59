"""Heat and water vapour across the grain of wood: conductivity and diffusivity against density, and where the flux runs.

    PYTHONPATH=build/python /usr/bin/python3 examples/wood-diffusion/study.py

Generated earlywood, latewood and poplar with walls of several thicknesses, and with LAMELLA_REAL_DATA windows of the two spruce outlines of
Ferrara and Wittel, radially (R) and tangentially (T), between insulated sides; after section 4.1 of Perré, Almeida, Ayouz and Frank, Ann. For.
Sci. 73 (2016) 147. Heat: wall 1, air 0.023 W/(m K). Vapour: wall 0.004, air 1 (over that in air). Writes to --output:
  conductivity.png, diffusivity.png  both against the solid fraction between series and parallel (their figures 11 and 12, latewood enlarged)
  ratio.png                          radial over tangential
  heat-arrows.png                    temperature in colour and heat flux as arrows (their figure 10)
  heat.png, vapour.png, NAME.png     fields with lines along the flux
  values.csv                         one row a sample, quantity and direction, with its error; tissues.csv: one a tissue
  walls.csv                          what it changes when walls conduct differently along and across (--walls alone makes nothing else)
"""

import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, ".."))
from common import parser_of, write_csv, write_figure  # noqa: E402

PROGRAM = os.environ.get("LAMELLA_PROGRAM", os.path.join(HERE, "..", "..", "build", "bin", "lamella"))
CONDUCTIVITY = {"heat": {"lumen": 0.023, "wall": 1.0}, "vapour": {"lumen": 1.0, "wall": 0.004}}
SPACING = 0.5  # micrometres
# generator, edge [micrometres], solid fractions, the first of which is the paper's
GENERATED = {
    "earlywood": (lamella.softwood, 200, (0.40, 0.20, 0.30, 0.50), dict(ray_distance=0)),
    "latewood": (lamella.softwood, 200, (0.78, 0.60, 0.70, 0.85), dict(ray_distance=0, ring_position=(0.8, 1.0))),
    "poplar": (lamella.hardwood, 400, (0.38, 0.28, 0.33, 0.45), dict(ray_distance=95e-6)),
}
REAL = {  # outlines; windows [micrometres]: low x, low y, high x, high y. The radial direction is y
    "spruce earlywood": ("spruce_EW_polygons.json.gz", [(x, y, x + 170, y + 170) for y in (25, 205) for x in (65, 240)]),
    "spruce latewood": ("spruce_LW_polygons.json.gz", [(x, y, x + 110, y + 110) for y in (15, 130) for x in (40, 150, 260)]),
}
DRAWN = {"earlywood": 150, "latewood": 120, "poplar": 200}  # edges of the samples whose fields are drawn [micrometres]
# Cell walls conduct twice as well along their fibrils as across (Siau, Wood and Fiber 1 (1970) 302: 21 against 10.5e-4 cal/(cm s K)). Fibrils
# at 20 degrees to the cell's axis, as the paper's section 4.2 has them, leave 1 + sin^2 20 = 1.117 along the wall in a cross-section.
WALLS = {"fibrils at 20°": (1.117, 1.0), "1.2 to 0.8": (1.2, 0.8), "0.8 to 1.2": (0.8, 1.2)}
# colours that colour-blind eyes tell apart (Okabe and Ito)
STYLE = {"earlywood": ("#009e73", "o"), "latewood": ("#d55e00", "s"), "poplar": ("#0072b2", "^"), "spruce earlywood": ("#56b4e9", "D"),
         "spruce latewood": ("#e69f00", "v")}
NAMES = {"earlywood": "softwood, earlywood", "latewood": "softwood, latewood", "poplar": "poplar", "spruce earlywood": "real spruce, earlywood",
         "spruce latewood": "real spruce, latewood"}


def samples(options):
    """What there is to measure: tissue, its number, solid fraction aimed at, window."""
    for name, (_, _, fractions, _) in GENERATED.items():
        for fraction in fractions[: options.fractions]:
            for seed in range(1, options.seeds + 1):
                yield name, seed, fraction, None
    if os.environ.get("LAMELLA_REAL_DATA"):
        for name, (_, windows) in REAL.items():
            for number, window in enumerate(windows[: options.windows], 1):
                yield name, number, None, window


def outlines_of(name, number, fraction, window, options, edge=None):
    """Outlines of the lumens, and the axis along the radial direction."""
    if name in REAL:
        return lamella.read_polygons(os.path.join(os.environ["LAMELLA_REAL_DATA"], REAL[name][0]), window=window), "y"
    make, usual, _, how = GENERATED[name]
    nodes = round(options.share * (edge or usual) / options.spacing)
    return lamella.contours(make(size=(nodes, nodes), spacing=options.spacing * 1e-6, solid_fraction=fraction, seed=number, **how)), "x"


def bounds(solid, conductivity):
    """Series, Hashin and Shtrikman's lower and upper one (of isotropic media), parallel; of two phases in the plane."""
    wall, lumen = conductivity["wall"], conductivity["lumen"]
    series = 1 / (solid / wall + (1 - solid) / lumen)
    parallel = solid * wall + (1 - solid) * lumen
    of = [a + share / (1 / (b - a) + (1 - share) / (2 * a)) for a, b, share in ((wall, lumen, 1 - solid), (lumen, wall, solid))]
    return series, min(of), max(of), parallel


def rooms(radial, tangential, solid, conductivity):
    """How far a pair of conductivities lies within the sharp bounds of two phases in the plane, anisotropic ones included: two numbers, 0 on
    a bound and negative beyond it. Lurie and Cherkaev, Proc. R. Soc. Edinburgh A 99 (1984) 71; Tartar 1985. A box between insulated sides,
    mirrored at them, is a cell of a periodic medium whose axes are those of the box, so they hold for its two values."""
    low, high = sorted(conductivity.values())
    series, _, _, parallel = bounds(solid, conductivity)
    pair = np.array([radial, tangential])
    below = 1 / (series - low) + 1 / (parallel - low)
    above = 1 / (high - series) + 1 / (high - parallel)
    return 1 - np.sum(1 / (pair - low)) / below, 1 - np.sum(1 / (high - pair)) / above


def measure(task):
    """Rows of one sample: two quantities in two directions."""
    (name, number, fraction, window), options = task
    begun = time.process_time()
    outlines, radial = outlines_of(name, number, fraction, window, options)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        file = outlines.save(os.path.join(folder, "outlines.json.gz"))
        spent = time.process_time() - begun
        for quantity, conductivity in CONDUCTIVITY.items():
            words = [f"{phase}={value}" for phase, value in conductivity.items()]
            before = os.times().children_user
            text = subprocess.run([PROGRAM, "micrograph", file, "--spacing", f"{options.spacing}um", "--lamella", "none", "--conductivity",
                                   ",".join(words), "--json"], check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout
            answer = json.loads(text)
            solid = answer["wall_fraction"]
            series, lower, upper, parallel = bounds(solid, conductivity)
            for direction, axis in (("R", radial), ("T", "xy".replace(radial, ""))):
                solved = answer["diffusion"]["axes"][axis]
                rows.append(dict(
                    tissue=name, sample=number, solid=solid, quantity=quantity, direction=direction, value=solved["value"], error=solved["error"],
                    share=(solved["value"] - series) / (parallel - series), series=series, hashin_shtrikman_lower=lower,
                    hashin_shtrikman_upper=upper, parallel=parallel, nodes=solved["fine"]["nodes"], nodes_across_wall=answer["lattice"]["nodes_across_wall"]["median"],
                    seconds=round(spent / 4 + (os.times().children_user - before) / 2, 3)))
    return rows


def pick(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def pairs(rows, quantity):
    """Radial and tangential row of each sample."""
    return list(zip(pick(rows, quantity=quantity, direction="R"), pick(rows, quantity=quantity, direction="T")))


def summary(rows):
    """A row a tissue, at the solid fraction that comes first: means over its samples, and their scatter."""
    table = []
    for name in dict.fromkeys(row["tissue"] for row in rows):
        of = pick(rows, tissue=name)
        if name in GENERATED:
            of = [row for row in of if abs(row["solid"] - GENERATED[name][2][0]) < 0.02]
        row = dict(tissue=name, samples=len({r["sample"] for r in of}), solid=float(np.mean([r["solid"] for r in of])))
        for quantity, conductivity in CONDUCTIVITY.items():
            couples = pairs(of, quantity)
            radial, tangential = (np.array([couple[i]["value"] for couple in couples]) for i in (0, 1))
            for direction, values in (("R", radial), ("T", tangential)):
                row[f"{quantity}_{direction}"] = values.mean()
                row[f"{quantity}_{direction}_scatter"] = values.std(ddof=1) if len(values) > 1 else 0.0
                row[f"{quantity}_{direction}_share"] = np.mean([r["share"] for r in pick(of, quantity=quantity, direction=direction)])
            row[f"{quantity}_ratio"] = np.mean(radial / tangential)
            row[f"{quantity}_ratio_low"], row[f"{quantity}_ratio_high"] = np.min(radial / tangential), np.max(radial / tangential)
            row[f"{quantity}_room_above"] = np.mean([rooms(r["value"], t["value"], r["solid"], conductivity)[1] for r, t in couples])
        row["error"] = max(r["error"] / r["value"] for r in of)
        table.append(row)
    return table


def draw_bounds(axes, conductivity):
    solid = np.linspace(0, 1, 1001)
    series, lower, upper, parallel = (np.array(curve) for curve in zip(*(bounds(s, conductivity) for s in solid)))
    axes.plot(solid, parallel, color="0.1", linewidth=1.1)
    axes.plot(solid, series, "--", color="0.1", linewidth=1.1)
    axes.fill_between(solid, lower, upper, color="0.9", linewidth=0)


def draw_points(axes, rows, quantity, size=24):
    """Full marks: radial; open ones: tangential."""
    for name in dict.fromkeys(row["tissue"] for row in rows):
        colour, mark = STYLE[name]
        for direction, look in (("R", dict(s=1.3 * size, facecolors=colour, edgecolors="white", linewidths=0.5)),
                                ("T", dict(s=size, facecolors="white", edgecolors=colour, linewidths=0.9))):
            of = pick(rows, tissue=name, quantity=quantity, direction=direction)
            axes.scatter([r["solid"] for r in of], [r["value"] for r in of], marker=mark, zorder=3, **look)


def keys_of(tissues):
    """A legend's entries of tissues."""
    return [Line2D([], [], linestyle="", marker=STYLE[name][1], color=STYLE[name][0], markersize=5, label=NAMES[name]) for name in tissues]


def keys_of_values(tissues):
    """With the bounds, and what full and open marks mean."""
    line = lambda style, label: Line2D([], [], linestyle=style, color="0.1", linewidth=1.1, label=label)  # noqa: E731
    look = lambda face, label: Line2D([], [], linestyle="", marker="o", color="0.4", markerfacecolor=face, markersize=5, label=label)  # noqa: E731
    return [line("-", "parallel"), line("--", "series"), Patch(color="0.9", label="Hashin–Shtrikman, of\nisotropic media"), look("0.4", "radial"),
            look("white", "tangential"), *keys_of(tissues)]


def with_legend_below(panels, size, below):
    """A figure, its panels side by side, and the part below them for a legend. @param size of the panels, below it [inches]"""
    figure = plt.figure(figsize=(size[0], size[1] + below), layout="constrained")
    above, legend = figure.subfigures(2, 1, height_ratios=[size[1], below])
    return figure, above.subplots(1, panels, squeeze=False)[0], legend


def draw_values(rows, quantity, path):
    """The paper's figure 11 or 12."""
    conductivity = CONDUCTIVITY[quantity]
    panels = 1 if quantity == "heat" else 2
    figure, axes, legend = with_legend_below(panels, (5.2 if panels == 1 else 9.6, 4.5), 1.1 if panels == 1 else 0.6)
    for place in axes:
        draw_bounds(place, conductivity)
        draw_points(place, rows, quantity)
        place.set_xlim(0, 1)
        place.set_xlabel("solid fraction")
    axes[0].set_ylim(0, 1)
    if quantity == "heat":
        axes[0].set_ylabel("conductivity over that of the walls, $k/k_\\mathrm{wall}$")
    else:
        draw_late(axes[0], rows, quantity)
        values = [row["value"] for row in pick(rows, quantity=quantity)]
        axes[1].set_yscale("log")
        axes[1].set_title("(b) the same, logarithmic", fontsize=10, loc="left")
        axes[0].set_title("(a)", fontsize=10, loc="left")
        axes[1].set_ylim(0.8 * min(values), 2 * max(values))
        ticks = (0.004, 0.006, 0.01, 0.02, 0.04, 0.08)
        axes[1].set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        axes[1].minorticks_off()
        axes[0].set_ylabel("diffusivity over that in air, $D/D_\\mathrm{air}$")
    keys = keys_of_values(dict.fromkeys(row["tissue"] for row in rows))
    legend.legend(handles=keys, loc="center", ncols=2 if panels == 1 else 5, frameon=False, fontsize=8)
    write_figure(figure, path, dpi=200)


def draw_late(axes, rows, quantity):
    """Latewood enlarged."""
    late = [row for row in pick(rows, quantity=quantity) if "latewood" in row["tissue"]]
    solid, values = [row["solid"] for row in late], [row["value"] for row in late]
    box = [0.52, 0.54, 0.45, 0.36]
    axes.add_patch(plt.Rectangle((box[0] - 0.15, box[1] - 0.08), box[2] + 0.17, box[3] + 0.15, facecolor="white", edgecolor="0.7", linewidth=0.6,
                                 transform=axes.transAxes, zorder=4))  # behind the numbers, too
    inset = axes.inset_axes(box, zorder=5)
    draw_bounds(inset, CONDUCTIVITY[quantity])
    draw_points(inset, late, quantity, size=16)
    inset.set_xlim(min(solid) - 0.03, max(solid) + 0.03)
    inset.set_ylim(0.003, 1.12 * max(values))
    inset.tick_params(labelsize=8)
    inset.set_title("latewood", fontsize=9, pad=3)


def draw_ratio(rows, path):
    figure, axes, legend = with_legend_below(2, (8.6, 3.4), 0.3)
    axes[1].sharey(axes[0])
    for axis, letter, quantity in zip(axes, "ab", CONDUCTIVITY):
        axis.axhline(1, color="0.6", linewidth=0.8)
        for name in dict.fromkeys(row["tissue"] for row in rows):
            colour, mark = STYLE[name]
            of = pairs(pick(rows, tissue=name), quantity)
            axis.scatter([r["solid"] for r, _ in of], [r["value"] / t["value"] for r, t in of], s=26, marker=mark, facecolors=colour,
                         edgecolors="white", linewidths=0.4)
        axis.set_xlim(0, 1)
        axis.set_yscale("log")
        axis.set_yticks([0.6, 0.8, 1, 1.25, 1.6, 2], labels=["0.6", "0.8", "1", "1.25", "1.6", "2"])
        axis.minorticks_off()
        axis.set_xlabel("solid fraction")
        axis.set_title(f"({letter}) {quantity}", fontsize=10, loc="left")
    axes[0].set_ylabel("radial over tangential")
    legend.legend(handles=keys_of(dict.fromkeys(row["tissue"] for row in rows)), loc="center", ncols=5, frameon=False, fontsize=8)
    write_figure(figure, path, dpi=200)


def field(name, fraction, window, direction, quantity, options):
    """Field and flux of one sample with the flux from left to right (R) or top to bottom (T), radial across; and its walls."""
    outlines, radial = outlines_of(name, 1, fraction, window, options, DRAWN.get(name))
    image = outlines.lattice(options.spacing * 1e-6)
    axis = radial if direction == "R" else "xy".replace(radial, "")
    kind = "temperature" if quantity == "heat" else "concentration"
    solved = lamella.diffusion(image, CONDUCTIVITY[quantity], direction=axis, quantity=kind, tolerance=1e-6)
    value, flux, walls = solved.fields[kind], solved.fields["flux"][..., :2], image.phase != 0
    if radial == "y":  # radial upwards in the file: turned so that it runs across, from the left
        value, walls = value.T, walls.T
        flux = flux.transpose(1, 0, 2)[..., ::-1] * (-1, -1)
    return value, flux, walls


def show_field(axes, value, flux, walls, spacing):
    """Colours for the field, a little paler in the lumens, and lines along the flux that are as wide as it is strong."""
    high, wide = value.shape
    extent = (0, wide * spacing, 0, high * spacing)
    x, y = ((np.arange(n) + 0.5) * spacing for n in (wide, high))
    picture = axes.imshow(value, cmap="RdYlBu_r", vmin=0, vmax=1, extent=extent, interpolation="nearest", rasterized=True)
    axes.contourf(x, y, walls[::-1].astype(float), levels=[-1, 0.5], colors="white", alpha=0.3)
    axes.contour(x, y, walls[::-1].astype(float), levels=[0.5], colors="0.3", linewidths=0.6)
    u, v = flux[::-1, :, 0], flux[::-1, :, 1]
    strength = np.hypot(u, v)
    width = np.clip(strength / np.percentile(strength, 95), 0, 1)
    axes.streamplot(x, y, u, v, density=1.8, color="black", linewidth=0.15 + 0.9 * width, arrowsize=0.6)
    axes.set_xlim(extent[:2])
    axes.set_ylim(extent[2:])
    axes.set_xticks([])
    axes.set_yticks([])
    return picture


def scale_bar(axes, wide):
    """About a quarter of the picture, in a round number of micrometres."""
    length = max(n for n in (10, 20, 50, 100, 200) if n <= wide / 3)
    box = dict(facecolor="white", edgecolor="none", alpha=0.85, boxstyle="square,pad=0.25")
    left, low = 0.05 * wide, 0.045 * wide
    axes.text(left + length / 2, low + 0.035 * wide, f"{length} µm", ha="center", va="bottom", fontsize=8, bbox=box, zorder=6)
    axes.plot([left, left + length], [low + 0.018 * wide] * 2, color="black", linewidth=2.5, solid_capstyle="butt", zorder=7)


def draw_fields(cases, quantity, path, options):
    """Rows: both directions; columns: samples, each (name, fraction, window)."""
    figure, axes = plt.subplots(2, len(cases), figsize=(3.5 * len(cases) + 0.6, 7.1), squeeze=False, constrained_layout=True)
    letters = iter("abcdef")
    for row, direction in enumerate("RT"):
        for column, (name, fraction, window) in enumerate(cases):
            value, flux, walls = field(name, fraction, window, direction, quantity, options)
            place = axes[row, column]
            picture = show_field(place, value, flux, walls, options.spacing)
            scale_bar(place, walls.shape[1] * options.spacing)
            title = f"{NAMES[name]}, solid fraction {np.mean(walls):.2f}" if row == 0 else ""
            place.set_title(f"({next(letters)}) {title}", fontsize=9, loc="left")
    for row, direction in enumerate(("radial flux, from the left", "tangential flux, from the top")):
        axes[row, 0].set_ylabel(direction, fontsize=10)
    label = "temperature" if quantity == "heat" else "concentration"
    figure.colorbar(picture, ax=axes, shrink=0.5, label=f"{label}, 1 at the inlet and 0 at the outlet")
    write_figure(figure, path, dpi=125)


def draw_arrows(path, options):
    """Earlywood's temperature and heat flux, radially, as lamella snapshot draws them."""
    outlines, axis = outlines_of("earlywood", 1, GENERATED["earlywood"][2][0], None, options, DRAWN["earlywood"])
    solved = lamella.diffusion(outlines.lattice(options.spacing * 1e-6), CONDUCTIVITY["heat"], direction=axis, tolerance=1e-6)
    with tempfile.TemporaryDirectory() as folder:
        file = solved.save(os.path.join(folder, "heat.vti"))
        subprocess.run([PROGRAM, "snapshot", file, "--preset", "temperature", "--overlay", "arrows", "--overlay-count", "50", "--size", "1000,900",
                        "-o", path, "--overwrite", "--quiet"], check=True)


def extrapolated(lattices, conductivity, radial):
    """R and T of a lattice of twice the spacing and of a finer one, 2 fine - coarse, and the error bar."""
    both = []
    for image in lattices:
        k = lamella.diffusion(image, conductivity, field=False, flux=False).effective
        both.append(np.array([k[0, 0], k[1, 1]] if radial == "x" else [k[1, 1], k[0, 0]]))
    return 2 * both[1] - both[0], np.abs(both[1] - both[0])


def measure_walls(options):
    """How much it matters that walls conduct differently along and across: a row a tissue, quantity and kind of wall."""
    rows = []
    for name, (_, _, fractions, _) in GENERATED.items():
        outlines, radial = outlines_of(name, 1, fractions[0], None, options)
        lattices = [outlines.lattice(spacing * 1e-6) for spacing in (2 * options.spacing, options.spacing)]
        for quantity, conductivity in CONDUCTIVITY.items():
            wall = conductivity["wall"]
            plain, _ = extrapolated(lattices, conductivity, radial)
            for kind, factors in WALLS.items():
                walls = {**conductivity, "wall": tuple(wall * factor for factor in factors)}
                (r, t), (r_error, t_error) = extrapolated(lattices, walls, radial)
                rows.append(dict(tissue=name, quantity=quantity, walls=kind, R=r, T=t, R_error=r_error, T_error=t_error,
                                 R_change=r / plain[0] - 1, T_change=t / plain[1] - 1, ratio=r / t, plain_ratio=plain[0] / plain[1]))
    return rows


def study(options):
    """Everything but the fields and the walls; returns the rows."""
    tasks = [(sample, options) for sample in samples(options)]
    if options.jobs == 1:
        measured = list(map(measure, tasks))
    else:
        with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
            measured = list(pool.map(measure, tasks))
    rows = [row for of in measured for row in of]
    there = lambda file: os.path.join(options.output, file)  # noqa: E731
    write_csv(there("values.csv"), rows)
    write_csv(there("tissues.csv"), summary(rows))
    draw_values(rows, "heat", there("conductivity.png"))
    draw_values(rows, "vapour", there("diffusivity.png"))
    draw_ratio(rows, there("ratio.png"))
    return rows


def main():
    parser = parser_of(__doc__, "results/wood-diffusion")
    parser.add_argument("--spacing", type=float, default=SPACING, help="of the finer lattice, micrometres (default: %(default)s)")
    parser.add_argument("--share", type=float, default=1, help="of the generated samples' edges (default: %(default)s)")
    parser.add_argument("--seeds", type=int, default=3, help="samples of each generated tissue and solid fraction (default: %(default)s)")
    parser.add_argument("--fractions", type=int, default=4, help="solid fractions of each generated tissue (default: %(default)s)")
    parser.add_argument("--windows", type=int, default=6, help="most windows of each real one (default: %(default)s)")
    parser.add_argument("--walls", action="store_true", help="only the table of walls that conduct differently along and across")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="samples at once (default: all cores)")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    begun = time.perf_counter()
    walls = measure_walls(options)
    write_csv(os.path.join(options.output, "walls.csv"), walls)
    for row in walls:
        print("  ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()), flush=True)
    if options.walls:
        return
    rows = study(options)
    for row in summary(rows):
        print("  ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()), flush=True)
    there = lambda file: os.path.join(options.output, file)  # noqa: E731
    draw_arrows(there("heat-arrows.png"), options)
    cases = [(name, of[2][0], None) for name, of in GENERATED.items()]
    for quantity in CONDUCTIVITY:
        draw_fields(cases, quantity, there(f"{quantity}.png"), options)
    if os.environ.get("LAMELLA_REAL_DATA"):
        for quantity in CONDUCTIVITY:
            real = [(name, None, windows[0]) for name, (_, windows) in REAL.items()]
            draw_fields(real, quantity, there(f"spruce-{quantity}.png"), options)
    print(f"{len(rows)} values, {sum(os.times()[:4]):.0f} s of processor time, {time.perf_counter() - begun:.0f} s; pictures and tables: {options.output}")


if __name__ == "__main__":
    main()
