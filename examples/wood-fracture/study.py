"""Notched wood pulled apart: does the crack lead from the notch to the far side, within the middle lamella?

    PYTHONPATH=build/python /usr/bin/python3 examples/wood-fracture/study.py

Earlywood and latewood with the solid fractions of Perré, Almeida, Ayouz and Frank, Ann. For. Sci. 73 (2016) 147, latewood with as many points,
earlywood with a quarter of them (--earlywood 1: as many), five seeds each, pulled along y (tangentially) from a notch at the left until nearly
nothing holds, one bond at a time; after their section 4.3. A middle lamella at least as thick as a bond is long (h = 4 dx), a quarter as tough as the
walls; as stiff as they are, which the paper does not say. With LAMELLA_REAL_DATA the outlines of spruce latewood of Ferrara and Wittel, too. Writes
to --output:
  NAME.png      a tissue's first sample in successive steps: stress along the load blue below 0, green at 0, red above, broken bonds black (their
                figures 16 and 17); in the last one the way from the notch to the far side yellow
  curves.png    stress against strain of these samples
  samples.csv   one row a sample; tissues.csv: one a tissue
"""

import concurrent.futures
import os
import sys
import time

import lamella
import numpy as np
from lamella import LamellaError
from matplotlib import pyplot as plt
from matplotlib.colors import LinearSegmentedColormap
from vtkmodules.vtkCommonCore import vtkLogger

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import chart, draw_bonds, parser_of, write_csv, write_figure  # noqa: E402
from crack import way_from_notch  # noqa: E402

HORIZON = 4
YOUNG, TOUGHNESS = 10e9, 4e5  # Pa, Pa √m of the walls
WALL, LAMELLA, GRIP = "wall", "middle lamella", "grip"
STATES = tuple(round(50 * 2 ** (i / 2)) for i in range(24))  # numbers of broken bonds at which fields are kept
PAPER = LinearSegmentedColormap.from_list("paper", ["#1030c0", "#20a040", "#d01c1c"])
# The paper's solid fractions and, within 1 %, its points of the walls: 216 494 and 109 055. Pixels of 0.5 µm, radial by tangential
GENERATED = {"earlywood": ((900, 600), dict(solid_fraction=0.40)), "latewood": ((432, 324), dict(solid_fraction=0.78, ring_position=(1, 1)))}
# Outlines; window [micrometres]: low x, low y, high x, high y, y the radial direction; spacing for as many points [micrometres]
REAL = {
    "spruce-earlywood": ("spruce_EW_polygons.json.gz", (65, 25, 410, 375), 0.334),
    "spruce-latewood": ("spruce_LW_polygons.json.gz", (40, 15, 370, 240), 0.635),
}


def turned(image):
    """The same with rows and columns exchanged."""
    other = lamella.from_array(np.ascontiguousarray(image.phase[::-1].T[::-1]), image.names, image.spacing, copy=True)
    other.set_array("grain", np.ascontiguousarray(image.array("grain")[::-1].T[::-1]))
    return other


def tissue(name, seed, options):
    """Outlines on a lattice with a middle lamella options.lamella spacings thick, the radial direction along x (--radial: along y)."""
    if name in REAL:
        file, window, spacing = REAL[name]
        middle = [(window[0] + window[2]) / 2, (window[1] + window[3]) / 2]
        half = [options.share * (window[2] - window[0]) / 2, options.share * (window[3] - window[1]) / 2]
        window = (middle[0] - half[0], middle[1] - half[1], middle[0] + half[0], middle[1] + half[1])
        outlines = lamella.read_polygons(os.path.join(os.environ["LAMELLA_REAL_DATA"], file), window=window)
    else:
        size, words = GENERATED[name]
        spacing = 0.5
        share = options.share * (options.earlywood if name == "earlywood" else 1)
        size = [round(share * nodes) for nodes in size]
        outlines = lamella.contours(lamella.softwood(size=size, spacing=spacing * 1e-6, seed=seed, ray_distance=options.rays * 1e-6, **words))
    spacing *= 1e-6
    image = outlines.lattice(spacing, lamella="growth", lamella_thickness=options.lamella * spacing, horizon=HORIZON)
    return turned(image) if (name in REAL) != options.radial else image


def notch_of(phase, spacing, share):
    """A cut from the left side, between the two rows of the middle third that have the most lamella over its length.

    phase   #rows by #columns with the bottom row first
    share   of the width; it goes on from there to the next column where a bond's length of lamella lies before its tip
    Of rows with as much lamella the one in the middle of those beside each other, nearest to half the height: a row that is there, never a mean of several.
    """
    high, wide = phase.shape
    length = max(1, round(share * wide))
    low = high // 3
    middle = (phase[low : high - low, :] == 2).astype(int)
    pairs = np.minimum(middle[:-1], middle[1:])  # lamella on both sides of the cut
    count = pairs[:, :length].sum(axis=1)
    best = np.flatnonzero(count == count.max())
    groups = np.split(best, np.flatnonzero(np.diff(best) > 1) + 1)
    row = min((int(group[len(group) // 2]) for group in groups), key=lambda one: abs(one - len(count) / 2))
    ahead = [column for column in range(length, wide - HORIZON) if pairs[row, column : column + HORIZON].all()]
    if not count.max() or not ahead:
        raise LamellaError("no middle lamella runs level where the notch is to be", "take a larger sample or another seed")
    height = (low + row + 1) * spacing
    return (-spacing, height, ahead[0] * spacing, height)


def notch_cuts(phase, spacing, notch):
    """Share of the notch's length with solid on both of its sides."""
    row, length = round(notch[1] / spacing), round(notch[2] / spacing)
    return float(np.mean((phase[row - 1, :length] != 0) & (phase[row, :length] != 0)))


def gripped(image, layers):
    """The same whose solid within so many layers of either platen is another phase, that never breaks."""
    phase = image.phase.copy()
    for rows in (phase[:layers], phase[-layers:]):
        rows[rows != 0] = 3
    other = lamella.from_array(phase, [*image.names, GRIP], image.spacing, copy=True)
    other.set_array("grain", image.array("grain").copy())
    return other


def torn(image, notch, options, **more):
    pairs = (WALL, LAMELLA, f"{WALL}-{LAMELLA}", f"{WALL}-{WALL}")  # the last one: walls of two cells
    young = dict.fromkeys(pairs, YOUNG)
    toughness = {pair: TOUGHNESS if pair == WALL else TOUGHNESS / options.ratio for pair in pairs}
    if options.grip:
        image = gripped(image, options.grip)
        young |= dict.fromkeys((GRIP, f"{GRIP}-{GRIP}", f"{WALL}-{GRIP}", f"{LAMELLA}-{GRIP}"), YOUNG)
    return lamella.fracture(image, young, toughness=toughness, horizon=HORIZON, notches=[notch] if notch else [], stop=options.stop,
                            rivals=options.rivals, smooth_platens=options.smooth, **more)


def pull(task):
    name, seed, drawn, options = task
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # of states asked for that lie beyond the end
    begun, spent = time.perf_counter(), time.process_time()
    image = tissue(name, seed, options)
    phase, spacing = image.phase[::-1].copy(), image.spacing
    high, wide = phase.shape
    notch = notch_of(phase, spacing, options.notch)
    result = torn(image, notch, options, **(dict(at_broken=STATES, stress=True) if drawn else {}), displacement=drawn)
    ran = time.process_time() - spent
    path = lamella.crack_path(result)
    crack = way_from_notch(path, phase, spacing, notch, HORIZON)
    states = []
    for state in result.states if drawn else ():
        states.append((state.imposed_strain, state.imposed_stress, state.broken_bonds, state.stress_component("yy")[::-1].astype(np.float32)))
    broken = result.broken
    in_wall = (broken["phases"] == 1).all(axis=1) & ~broken["between_grains"]
    edge = 2 * HORIZON * spacing
    at_platens = (broken["position"][:, 1] < edge) | (broken["position"][:, 1] > high * spacing - edge)
    row = {
        "sample": name, "seed": seed, "wide": wide, "high": high, "spacing": spacing, "points": int(np.sum(phase != 0)),
        "solid": float(np.mean(phase != 0)), "lamella": float(np.mean(phase == 2)), "notch": notch[2], "notch_cuts": notch_cuts(phase, spacing, notch),
        "modulus": result.modulus, "strength": result.peak_stress, "strain_at_peak": result.peak_strain, "broken": len(broken),
        "broken_in_walls": float(np.mean(in_wall)), "broken_at_platens": float(np.mean(at_platens)),
        "reaches": int(crack["reaches"]), "way": crack["length"], "way_in_lamella": crack["lamella"], "way_in_walls": crack["wall"],
        "way_in_voids": crack["void"], "way_in_solid": crack["solid"], "first": crack["first"], "order": crack["order"],
        "crack_length": path.length, "length_in_walls": path.shares.get(WALL, 0.0), "severed": path.severed, "end": result.end,
        "events": result.statistics["events"], "cpu_seconds_run": ran, "seconds": time.perf_counter() - begun,
    }
    return row, (result.strain, result.stress), (phase, spacing, notch, broken, states, crack["points"])


def chosen(states, shares=(1, 0.7, 0.4, 0)):
    """The state nearest to the peak, those after it nearest to shares of its stress, and the end."""
    stress = np.array([state[1] for state in states])
    peak = int(np.argmax(stress))
    picked = {peak + int(np.argmin(np.abs(stress[peak:] / stress[peak] - share))) for share in shares}
    return [states[i] for i in sorted(picked)]


def draw(phase, spacing, notch, broken, states, way, path):
    shown = chosen(states)
    high, wide = phase.shape
    figure, axes = plt.subplots(1, len(shown), figsize=(4.2 * len(shown), 4.2 * high / wide + 1), constrained_layout=True)
    extent = (0, wide * spacing * 1e6, 0, high * spacing * 1e6)
    reach = float(np.percentile(np.abs(states[0][3][phase != 0]), 98))
    for one, (strain, _, number, stress), letter in zip(np.atleast_1d(axes), shown, "abcd"):
        field = np.ma.masked_array(stress / reach, phase == 0)
        picture = one.imshow(field, origin="lower", extent=extent, cmap=PAPER, vmin=-1, vmax=1, interpolation="nearest")
        draw_bonds(one, broken[:number], 1e6, colors="black", linewidths=0.6)
        one.plot([0, notch[2] * 1e6], [notch[1] * 1e6] * 2, color="black", linewidth=1.6)
        one.set_xlim(extent[:2])
        one.set_ylim(extent[2:])
        one.set_title(f"({letter}) strain {100 * strain:.3g} %, {number} bonds", fontsize=9)
        one.set_xlabel("µm")
    if len(way):
        axes[-1].plot(*(way.T * 1e6), color="#ffd000", linewidth=0.7)
    figure.colorbar(picture, ax=axes, shrink=0.8, label=f"stress along the load over {reach / 1e6:.3g} MPa", extend="both")
    write_figure(figure, path, dpi=160)


def draw_curves(curves, path):
    with chart(path, "strain [%]", "stress [MPa]") as axes:
        for name, (strain, stress) in curves.items():
            axes.plot(100 * strain, stress / 1e6, linewidth=1.3, label=name)


def of_tissues(rows):
    """One row a tissue: in how many samples the crack leads from the notch to the far side, and where it runs there."""
    found = []
    for name in dict.fromkeys(row["sample"] for row in rows):
        mine = [row for row in rows if row["sample"] == name]
        through = [row for row in mine if row["reaches"]]
        mean = lambda key, some=through: float(np.mean([row[key] for row in some])) if some else np.nan  # noqa: E731
        found.append({"tissue": name, "samples": len(mine), "reach": len(through), "at_notch_first": sum(row["first"] < 0.1 for row in through),
                      "way_in_lamella": mean("way_in_lamella"), "least_in_lamella": min((row["way_in_lamella"] for row in through), default=np.nan),
                      "way_in_voids": mean("way_in_voids"), "way_in_solid": mean("way_in_solid"), "order": mean("order"),
                      "solid": mean("solid", mine), "points": round(mean("points", mine)), "strength": mean("strength", mine),
                      "broken_in_walls": mean("broken_in_walls", mine), "cpu_seconds": mean("cpu_seconds_run", mine)})
    return found


def tasks_of(options):
    names = options.samples or (*GENERATED, *(("spruce-latewood",) if os.environ.get("LAMELLA_REAL_DATA") else ()))
    for name in names:
        for seed in (0,) if name in REAL else options.seeds:
            yield name, seed, name in REAL or seed == options.seeds[0], options


def options_of(words=None):
    parser = parser_of(__doc__, "results/wood-fracture")
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3, 4, 5], help="of generated tissue; the first one is drawn (default: 1 to 5)")
    parser.add_argument("--share", type=float, default=1, help="of the windows' and pictures' sides (default: %(default)s)")
    parser.add_argument("--earlywood", type=float, default=0.5, help="the same of generated earlywood besides: 1 has the paper's points (default: %(default)s)")
    parser.add_argument("--notch", type=float, default=0.25, help="length over the width (default: %(default)s)")
    parser.add_argument("--ratio", type=float, default=4, help="toughness of the walls over the lamella's (default: %(default)s)")
    parser.add_argument("--lamella", type=float, default=HORIZON + 0.5, help="its thickness, spacings (default: %(default)s)")
    parser.add_argument("--radial", action="store_true", help="pull along the radial direction, not the tangential one")
    parser.add_argument("--smooth", action="store_true", help="platens along which the sample slips, not clamps")
    parser.add_argument("--grip", type=int, default=0, help="layers at either platen in which nothing breaks (default: %(default)s)")
    parser.add_argument("--rays", type=float, default=0, help="mean distance of the rays of generated tissue, micrometres (default: none)")
    parser.add_argument("--stop", type=float, default=0.05, help="end when the stress has fallen to this share of the peak")
    parser.add_argument("--rivals", action="store_true", help="look closer where two bonds are nearly as critical as each other")
    parser.add_argument("--samples", nargs="+", default=None, choices=(*GENERATED, *REAL), help="default: all but spruce-earlywood")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="samples at a time (default: one a core)")
    return parser.parse_args(words)


def main():
    options = options_of()
    os.makedirs(options.output, exist_ok=True)
    begun = time.perf_counter()
    rows, curves = [], {}
    print(f"{'sample':>18} {'nodes':>11} {'E':>9} {'strength':>10} {'broken':>7} {'in walls':>8} {'from notch to far side':>22} {'in lamella':>10} {'CPU':>7}")
    with concurrent.futures.ProcessPoolExecutor(options.workers) as pool:
        for row, curve, sample in pool.map(pull, tasks_of(options)):
            rows.append(row)
            if sample[4]:
                curves[row["sample"]] = curve
                draw(*sample, os.path.join(options.output, row["sample"] + ".png"))
            name = row["sample"] + (f" {row['seed']}" if row["seed"] else "")
            print(f"{name:>18} {row['wide']:>5} x {row['high']:>3} {row['modulus'] / 1e9:>5.2f} GPa {row['strength'] / 1e6:>6.2f} MPa {row['broken']:>7} "
                  f"{100 * row['broken_in_walls']:>6.2f} % {'yes' if row['reaches'] else 'no':>22} {100 * row['way_in_lamella']:>8.1f} % "
                  f"{row['cpu_seconds_run']:>5.0f} s", flush=True)
            write_csv(os.path.join(options.output, "samples.csv"), rows)
    write_csv(os.path.join(options.output, "tissues.csv"), of_tissues(rows))
    draw_curves(curves, os.path.join(options.output, "curves.png"))
    print(f"{len(rows)} samples in {time.perf_counter() - begun:.0f} s; files in {options.output}")


if __name__ == "__main__":
    main()
