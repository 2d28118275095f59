"""A crack in a plate: strength against crack length, lattice and horizon, and what Griffith's theory makes of it.

    PYTHONPATH=build/python /usr/bin/python3 examples/griffith/study.py

A square plate of side 1 with a central crack of length 2a is pulled across it until it fails, one bond at a time: horizons of 2 to 8
spacings, 128 to 1024 nodes, four crack lengths, 140 runs, after section II C of Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102
(2020) 022906. Writes to --output:
  stress.png      stress around a short crack before the first break on four lattices (their figure 3)
  strength.png    strength against 1/Nx at one horizon (figure 4)
  cracks.png      strength on an endlessly fine lattice against 1/sqrt(pi a) (figure 5)
  toughness.png   measured over theoretical toughness against h/dx (figure 6), with and without corrections
  runs.csv        one row a run; horizons.csv: one row a horizon
"""

import concurrent.futures
import math
import os
import sys
import time

import lamella
import numpy as np
from matplotlib import pyplot as plt

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import chart, parser_of, write_csv, write_figure  # noqa: E402

HORIZONS = (2, 3, 4, 5, 6, 7, 8)
NODES = (128, 256, 512, 665, 1024)
CRACKS = (0.1, 0.05, 0.025, 0.0125)
YOUNG, CRITICAL = 1e9, 1e-3
# A square plate pulled at its ends: the stress intensity over that in an endless plate, at crack length over width (finite elements, 0.5 %)
PLATE = ((0.0, 0.2, 0.3, 0.4, 0.5), (1.0, 1.014, 1.044, 1.092, 1.167))


def stencil(horizon):
    """Bonds of a node, one of each pair, in spacings."""
    reach = range(-horizon, horizon + 1)
    return [(x, y) for x in reach for y in reach if 0 < x * x + y * y <= horizon**2 and (y > 0 or (y == 0 and x > 0))]


def rows_cut(horizon):
    """Bonds that a crack along x cuts for each spacing of its length."""
    return sum(y for _, y in stencil(horizon))


def lattice_moduli(horizon):
    """Young's modulus and fracture energy of the lattice over those of the continuum: sums over the stencil."""
    micromodulus = 9 / (math.pi * horizon**3)
    c11 = micromodulus * sum(x**4 / math.hypot(x, y) ** 3 for x, y in stencil(horizon))
    c22 = micromodulus * sum(y**4 / math.hypot(x, y) ** 3 for x, y in stencil(horizon))
    c12 = micromodulus * sum(x * x * y * y / math.hypot(x, y) ** 3 for x, y in stencil(horizon))
    energy = micromodulus * sum(0.5 * y * math.hypot(x, y) for x, y in stencil(horizon))
    return c22 - c12**2 / c11, energy / (9 * horizon / (4 * math.pi))


def placed(crack, nodes):
    """The nearest half length whose tips lie midway between two nodes, and the height of a row of bonds nearest to the middle.

    A tip elsewhere between two nodes cuts the same bonds or a few of the next column's: lattices would differ by that, too."""
    half = 0 if nodes % 2 == 0 else 0.5
    return (round(crack * nodes - half) + half) / nodes, 0.5 - half / nodes


def plate_factor(crack):
    return float(np.interp(2 * crack, *PLATE)) if 2 * crack > 0.2 else 1 + 0.014 * (crack / 0.1) ** 2


def plate(nodes):
    return lamella.from_array(np.zeros((nodes, nodes), np.uint8), ["plate"], spacing=1 / nodes)


def bonds_of(case):
    horizon, nodes, crack = case
    half, height = placed(crack, nodes)
    return dict(young={"plate": YOUNG}, critical_stretch={"plate": CRITICAL}, horizon=horizon,
                notches=[(0.5 - half, height, 0.5 + half, height)])


def growth(horizon):
    """Of a straight crack that grows by 24 spacings at both ends, the last 16 of them, over the lattice's fracture energy: what its bonds
    held, and what the plate gave off, were the load to follow every snap-back: the area between the rays of successive critical states.
    Only bonds across its plane can break."""
    nodes, cut = 256, rows_cut(horizon)
    phase = np.zeros((nodes, nodes), np.uint8)
    phase[: nodes // 2] = 1
    halves = lamella.from_array(phase, ["lower", "upper"], spacing=1 / nodes)
    bonds = bonds_of((horizon, nodes, 0.1))
    bonds.update(young=dict.fromkeys(("lower", "upper", "lower-upper"), YOUNG), critical_stretch={"lower-upper": CRITICAL})
    result = lamella.fracture(halves, rivals=False, stop=0.01, max_broken=2 * cut * 24, displacement=False, **bonds)
    part = slice(2 * cut * 8, 2 * cut * 24)
    lattice = sum(y * math.hypot(x, y) for x, y in stencil(horizon))
    held = np.sum(np.hypot(*result.broken["bond"][part].T)) * nodes / (2 * 16 * lattice)
    strain, stress = result.critical_strain[1:-1][part], result.critical_stress[1:-1][part]
    area = 0.5 * np.sum(stress[:-1] * strain[1:] - stress[1:] * strain[:-1]) * (1 - (2 * horizon - 1) / nodes)
    energy = lattice_moduli(horizon)[1] * 9 * YOUNG * horizon / nodes * CRITICAL**2 / (4 * math.pi)
    return {"horizon": horizon, "held": float(held), "released": float(area / (2 * 16 / nodes * energy))}


def strength(case):
    """A plate pulled until its crack has grown well beyond the peak."""
    horizon, nodes, crack = case
    half, _ = placed(crack, nodes)
    cut = rows_cut(horizon)
    begun, spent = time.perf_counter(), time.process_time()
    result = lamella.fracture(plate(nodes), rivals=False, stop=0.5, max_broken=2 * cut * (horizon + 4), displacement=False, **bonds_of(case))
    statistics = result.statistics
    energy = 9 * YOUNG * horizon / nodes * CRITICAL**2 / (4 * math.pi)
    return {
        "horizon": horizon, "nodes": nodes, "crack": crack, "half_length": half,
        "strength": result.peak_stress / math.sqrt(YOUNG * energy), "first_break": result.first_break_stress / math.sqrt(YOUNG * energy),
        "peak_broken": int(result._number("peak_broken")), "broken": len(result.broken), "modulus": result.modulus / YOUNG,
        "events": statistics["events"], "equilibria": statistics["equilibria"],
        "seconds": time.perf_counter() - begun, "cpu_seconds": time.process_time() - spent,
    }


def line_of(x, y):
    """Straight line through points: slope, value at 0, share of the variance that it explains."""
    slope, start = np.polyfit(x, y, 1)
    scatter = np.sum((y - start - slope * x) ** 2)
    return float(slope), float(start), float(1 - scatter / np.sum((y - np.mean(y)) ** 2))


def process_zone(rows):
    """1/σ² = π (a + β h)/(K F)² by least squares: K/Kth, β, and the root mean square of the relative differences in σ."""
    matrix = np.array([[math.pi * row["half_length"], math.pi * row["horizon"] / row["nodes"]] for row in rows])
    value = np.array([(row["strength"] * plate_factor(row["crack"])) ** -2 for row in rows])
    inverse, zone = np.linalg.lstsq(matrix / value[:, None], np.ones(len(rows)), rcond=None)[0]
    error = np.sqrt(value / (matrix @ [inverse, zone])) - 1
    return inverse**-0.5, zone / inverse, float(np.sqrt(np.mean(error**2)))


def analyse(rows):
    """One row a horizon; the lines of figure 4 in "lines": by crack 1/Nx, strength, line. Strengths are brought from the crack that the
    lattice has to the one asked for, as the process zone's fit has it."""
    horizons = []
    for horizon in sorted({row["horizon"] for row in rows}):
        mine = [row for row in rows if row["horizon"] == horizon]
        toughness, zone, scatter = process_zone(mine)
        lines = {}
        for crack in sorted({row["crack"] for row in mine}):
            of = sorted((row for row in mine if row["crack"] == crack), key=lambda row: row["nodes"])
            fine = np.array([1 / row["nodes"] for row in of])
            moved = [math.sqrt((row["half_length"] + zone * horizon / row["nodes"]) / (crack + zone * horizon / row["nodes"])) for row in of]
            value = np.array([row["strength"] for row in of]) * moved
            inverse = line_of(fine, value**-2.0)
            lines[crack] = (fine, value, line_of(fine, value), inverse[1] ** -0.5)
        cracks = np.array(list(lines))
        x = 1 / np.sqrt(math.pi * cracks)
        young, energy = lattice_moduli(horizon)
        lattice = math.sqrt(young * energy)
        linear = np.array([line[2][1] for line in lines.values()])
        limit = np.array([line[3] for line in lines.values()])
        horizons.append({
            "horizon": horizon, "bonds": 2 * len(stencil(horizon)), "runs": len(mine), "lattice_toughness": lattice, "lattice_energy": energy,
            "paper": line_of(x, linear)[0], "nominal": toughness, "fitted": toughness / lattice, "process_zone": zone, "scatter": scatter,
            "r2_least": min(line[2][2] for line in lines.values()), "lines": lines, "limit": limit,
        })
    return horizons


def draw_stress(horizon, crack, nodes, path):
    figure, axes = plt.subplots(1, len(nodes), figsize=(3.1 * len(nodes), 3.3), constrained_layout=True)
    for one, count, letter in zip(np.atleast_1d(axes), nodes, "abcd"):
        result = lamella.equilibrium(plate(count), stress=True, **bonds_of((horizon, count, crack)))
        stress = result.stress_component("yy") / result.effective_stress
        size = 3 * crack
        edge = slice(int((0.5 - size) * count), math.ceil((0.5 + size) * count))
        picture = one.imshow(stress[edge, edge], cmap="turbo", vmin=0, vmax=3, extent=[-3, 3, -3, 3], interpolation="nearest")
        one.set_title(f"({letter}) $N_x$ = {count}", fontsize=10)
        one.set_xlabel("$x/a$")
        if letter != "a":
            one.set_yticklabels([])
    figure.colorbar(picture, ax=axes, label="$\\sigma_{yy}$ over mean stress", extend="both", shrink=0.85)
    write_figure(figure, path, dpi=160)


def draw_strength(of, path):
    with chart(path, "1000 / $N_x$", "$\\sigma_c / K_{th}$") as axes:
        for (crack, (fine, value, (slope, start, r2), _)), marker in zip(of["lines"].items(), "osD^"):
            points = axes.plot(1000 * fine, value, marker, markersize=5, label=f"a = {crack:g}, $R^2$ = {r2:.3f}")[0]
            reach = np.array([0, fine.max()])
            axes.plot(1000 * reach, start + slope * reach, color=points.get_color(), linewidth=1)
        axes.set_title(f"h/δx = {of['horizon']}", fontsize=10)


def draw_cracks(horizons, path):
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.9, len(horizons)))
    with chart(path, "$1/\\sqrt{\\pi a}$", "$[\\sigma_c / K_{th}]$, $N_x \\to \\infty$") as axes:
        for of, colour in zip(horizons, colours):
            x = 1 / np.sqrt(math.pi * np.array(list(of["lines"])))
            slope, start, _ = line_of(x, of["limit"])
            axes.plot(x, of["limit"], "o", color=colour, markersize=5, label=f"h/δx = {of['horizon']}")
            reach = np.array([0, x.max()])
            axes.plot(reach, start + slope * reach, color=colour, linewidth=1)
        axes.plot([0, x.max()], [0, x.max()], "k--", linewidth=1, label="Griffith")


def draw_toughness(horizons, path):
    x = [of["horizon"] for of in horizons]
    with chart(path, "h/δx", "$K/K_{th}$", xlim=(None, None)) as axes:
        for key, marker, label in (("paper", "s:", "$\\sigma_c$ linear in $1/N_x$, as the paper"),
                                   ("nominal", "o-", "crack and process zone, plate's factor"), ("fitted", "D-", "and the lattice's own $K_{th}$")):
            axes.plot(x, [of[key] for of in horizons], marker, markersize=5, label=label)
        axes.axhline(1, color="k", linewidth=0.8, linestyle="--")


def main():
    parser = parser_of(__doc__, "results/griffith")
    parser.add_argument("--horizons", type=int, nargs="+", default=HORIZONS, metavar="H")
    parser.add_argument("--nodes", type=int, nargs="+", default=NODES, metavar="N", help="lattices, three at least")
    parser.add_argument("--cracks", type=float, nargs="+", default=CRACKS, metavar="A", help="half lengths, two at least")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="runs at a time (default: one a core)")
    parser.add_argument("--quick", action="store_true", help="horizons 3 and 6, 64 to 160 nodes, two cracks")
    options = parser.parse_args()
    if options.quick:
        options.horizons, options.nodes, options.cracks = (3, 6), (64, 96, 128, 160), (0.1, 0.05)
    if len(options.nodes) < 3 or len(options.cracks) < 2:
        parser.error("a line needs three lattices and two cracks")
    os.makedirs(options.output, exist_ok=True)
    cases = [(h, n, a) for h in options.horizons for n in options.nodes for a in options.cracks]
    cases.sort(key=lambda case: -((case[0] * case[1]) ** 2))  # long ones first
    begun = time.perf_counter()
    rows = []
    with concurrent.futures.ProcessPoolExecutor(options.workers) as pool:
        grown = [pool.submit(growth, horizon) for horizon in options.horizons]
        for row in pool.map(strength, cases):
            rows.append(row)
            print(f"\r{len(rows)} of {len(cases)} runs, {time.perf_counter() - begun:.0f} s", end="", flush=True)
        energies = {of["horizon"]: of for of in (future.result() for future in grown)}
    print()
    rows.sort(key=lambda row: (row["horizon"], row["nodes"], -row["crack"]))
    horizons = [{**of, **energies[of["horizon"]]} for of in analyse(rows)]
    write_csv(os.path.join(options.output, "runs.csv"), rows)
    write_csv(os.path.join(options.output, "horizons.csv"), [{k: v for k, v in of.items() if k not in ("lines", "limit")} for of in horizons])
    print(f"{'h/dx':>4} {'paper':>7} {'zone':>7} {'lattice':>7} {'zone/h':>7} {'scatter':>8} {'least R2':>8} {'held':>6} {'released':>8}")
    for of in horizons:
        print(f"{of['horizon']:>4} {of['paper']:>7.3f} {of['nominal']:>7.3f} {of['fitted']:>7.3f} "
              f"{of['process_zone']:>7.3f} {100 * of['scatter']:>6.2f} % {of['r2_least']:>8.4f} {of['held']:>6.3f} {of['released']:>8.3f}")
    shown = next((of for of in horizons if of["horizon"] == 3), horizons[0])
    draw_strength(shown, os.path.join(options.output, "strength.png"))
    draw_cracks(horizons, os.path.join(options.output, "cracks.png"))
    draw_toughness(horizons, os.path.join(options.output, "toughness.png"))
    few = [n for n in sorted(options.nodes) if n != 665][:4]
    draw_stress(max(h for h in options.horizons if h <= 6), min(options.cracks), few, os.path.join(options.output, "stress.png"))
    print(f"{len(rows)} runs in {time.perf_counter() - begun:.0f} s, {sum(row['cpu_seconds'] for row in rows):.0f} s CPU; files in {options.output}")


if __name__ == "__main__":
    main()
