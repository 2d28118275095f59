"""The same cemented grains pulled apart by LAMMPS and by Lamella: strength, and bonds that broke, node by node.

    /usr/bin/python3 examples/dynamic-fracture/lammps.py

Needs the program lmp with the package PERI: on Debian `apt-get install --no-install-recommends lammps`. The benchmark
damped-strength (`./dev bench damped-strength` builds it) makes the sample and pulls it; this script writes what LAMMPS
reads, runs it with the same step from the same velocities, and compares. Writes to --output, with the cracks of all
three in cracks-SEED.png.

LAMMPS gives every pair of atom types a stiffness and a critical elongation, but takes the larger of a node's critical
elongations for all its bonds: a valid check where all are equal. Bonds between two grains are softer than within one, so
each grain gets one of a few types, no two alike where a bond joins them.
"""

import argparse
import csv
import pathlib
import shutil
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import ListedColormap

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = HERE.parents[1] / "build" / "bin" / "benchmarks" / "damped-strength"


def grain_types(nodes, reach):
    """Type of every node: 1 matrix, 2 grains without a number, 3 on the colours of the others."""
    shape = nodes["x"].max() + 1, nodes["y"].max() + 1
    grain = np.zeros((shape[1], shape[0]), int)
    grain[nodes["y"], nodes["x"]] = np.where(nodes["phase"] == 2, nodes["grain"], 0)
    touching = set()
    for dy in range(reach + 1):
        for dx in range(-reach, reach + 1):
            if 0 < dx * dx + dy * dy <= reach * reach:
                a = grain[: shape[1] - dy, max(0, -dx) : shape[0] - max(0, dx)]
                b = grain[dy:, max(0, dx) : shape[0] - max(0, -dx)]
                apart = (a != b) & (a != 0) & (b != 0)
                touching |= {(min(p), max(p)) for p in zip(a[apart].tolist(), b[apart].tolist())}
    colours = {}
    for g in sorted(set(grain[grain != 0].tolist())):
        taken = {colours[q] for p in touching if g in p for q in p if q in colours}
        colours[g] = next(c for c in range(1, len(touching) + 2) if c not in taken)
    types = np.where(nodes["phase"] == 1, 1, 2)
    numbered = (nodes["phase"] == 2) & (nodes["grain"] != 0)
    types[numbered] = [2 + colours[g] for g in nodes["grain"][numbered]]
    return types


def write_input(folder, nodes, types, s, steps):
    """Data and input files. LAMMPS sums force densities: k of a bond over the fifth power of the spacing."""
    dx = s["spacing"]
    size = np.array([nodes["x"].max() + 1, nodes["y"].max() + 1])
    solid = nodes["phase"] > 0
    with open(folder / "data", "w", encoding="ascii") as out:
        out.write(f"cemented grains\n\n{solid.sum()} atoms\n{types.max()} atom types\n\n")
        for axis, n in zip("xy", size):
            out.write(f"{-5 * dx:.9g} {(n + 5) * dx:.9g} {axis}lo {axis}hi\n")
        out.write(f"{-5 * dx:.9g} {5 * dx:.9g} zlo zhi\n\nAtoms\n\n")
        for i in np.flatnonzero(solid):
            out.write(f"{i + 1} {types[i]} {dx**3:.17g} {s['density']:.17g} "
                      f"{(nodes['x'][i] + 0.5) * dx:.17g} {(nodes['y'][i] + 0.5) * dx:.17g} 0\n")
        out.write("\nVelocities\n\n")
        for i in np.flatnonzero(solid):
            out.write(f"{i + 1} {nodes['vx'][i]:.17g} {nodes['vy'][i]:.17g} 0\n")
    pairs = []
    for a in range(1, types.max() + 1):
        for b in range(a, types.max() + 1):
            stiff = a == b > 1 or (a == 2 and b > 2)
            k = s["stiff"] if stiff else s["soft"]
            pairs.append(f"pair_coeff {a} {b} {k / dx**5:.17g} {(s['horizon'] + 1e-3) * dx:.9g} {s['stretch']:.17g} 0")
    low, high = s["layers"] * dx, (size[1] - s["layers"]) * dx
    # A lattice constant near 0: else LAMMPS weakens the bonds within half of one from the horizon, and pushes near
    # nodes apart.
    (folder / "in").write_text(f"""units si
boundary f f f
atom_style peri
atom_modify map array
lattice sc {1e-6 * dx:.9g}
read_data data
neighbor {0.3 * dx:.9g} bin
pair_style peri/pmb
{chr(10).join(pairs)}
region low block INF INF INF {low:.9g} INF INF units box
region high block INF INF {high:.9g} INF INF INF units box
group low region low
group high region high
group free subtract all low high
fix move all nve
fix drag free viscous {s["viscosity"] / dx**2:.17g}
fix low low setforce 0 0 0
fix high high setforce 0 0 0
compute damage all damage/atom
timestep {s["step"]:.17g}
thermo 10
thermo_style custom step f_low[2] f_high[2]
thermo_modify format float %.9g
dump damage all custom {steps} damage.* id c_damage
dump_modify damage sort id format float %.9g
run {steps}
""", encoding="ascii")


def read_csv(path):
    with open(path, newline="", encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    return rows


def peak_of(log, nodes, s):
    """Largest mean pull on both platens, from what LAMMPS prints every ten steps."""
    width = (nodes["x"].max() + 1) * s["spacing"]
    stress = []
    for line in open(log, encoding="ascii"):
        words = line.split()
        if len(words) == 3 and words[0].isdigit():
            stress.append((float(words[1]) - float(words[2])) / 2 * s["spacing"] ** 2 / width)
    return max(stress)


def draw(nodes, broken, target):
    """Nodes that lost bonds, black, over the phases: strict, damped motion, LAMMPS."""
    shape = nodes["y"].max() + 1, nodes["x"].max() + 1
    figure, axes = plt.subplots(1, len(broken), figsize=(2.2 * len(broken), 4.6), layout="constrained")
    for a, (name, ends) in zip(axes, broken.items()):
        a.imshow(nodes["phase"].reshape(shape), origin="lower", cmap=ListedColormap(["white", "#e8d5b0", "#9fb4c7"]),
                 vmin=0, vmax=2, interpolation="nearest")
        crack = np.zeros((*shape, 4))
        crack[:, :, 3] = np.clip(ends / np.maximum(1, nodes["bonds"]) / 0.3, 0, 1).reshape(shape)
        a.imshow(crack, origin="lower", interpolation="nearest")
        a.set_title(name, fontsize=9)
        a.set_axis_off()
    figure.savefig(target, dpi=130)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("results/dynamic-fracture/lammps"))
    parser.add_argument("--nodes", type=int, default=48, help="across the sample")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--saturation", type=float, default=0.5)
    parser.add_argument("--transits", type=float, default=30, help="of a wave until the peak")
    parser.add_argument("--damping", type=float, default=0.1)
    args = parser.parse_args()
    if shutil.which("lmp") is None:
        sys.exit("error: there is no program lmp\nhint: on Debian: apt-get install --no-install-recommends lammps")
    if not PROGRAM.exists():
        sys.exit("error: the benchmarks are not built\nhint: ./dev bench damped-strength builds this one")
    print(f"{'seed':>4} {'Lamella [Pa]':>13} {'LAMMPS':>9} {'broken ends':>11} {'LAMMPS':>7} {'in common':>9} "
          f"{'strict':>7} {'in common':>9}")
    for seed in args.seeds:
        folder = args.output / f"seed-{seed}"
        subprocess.run([PROGRAM, "kind=aggregate", f"nx={args.nodes}", "grains=24", f"seed={seed}", "tau=0", "jump=0",
                        f"saturation={args.saturation}", f"transits={args.transits}", f"damping={args.damping}",
                        f"export={folder}"], check=True, stdout=subprocess.DEVNULL)
        rows = read_csv(folder / "nodes.csv")
        nodes = {key: np.array([float(r[key]) if key[0] == "v" else int(r[key]) for r in rows]) for key in rows[0]}
        settings = {r["name"]: float(r["value"]) for r in read_csv(folder / "settings.csv")}
        # Half as long again: its stress may fall a little later.
        steps = int(1.5 * settings["steps"])
        write_input(folder, nodes, grain_types(nodes, int(settings["horizon"])), settings, steps)
        subprocess.run(["lmp", "-in", "in", "-log", "log", "-screen", "none"], cwd=folder, check=True)
        peak = peak_of(folder / "log", nodes, settings)
        damage = np.loadtxt(folder / f"damage.{steps}", skiprows=9)
        broken = np.zeros(len(rows))
        ids = damage[:, 0].astype(int) - 1
        broken[ids] = np.rint(damage[:, 1] * nodes["bonds"][ids])
        motion, strict = nodes["broken_motion"], nodes["broken_strict"]
        draw(nodes, {"quasi-static, strict": strict, "damped motion": motion, "LAMMPS": broken},
             args.output / f"cracks-{seed}.png")
        print(f"{seed:>4} {settings['peak']:>13.6g} {100 * (peak / settings['peak'] - 1):>+8.3f}% {motion.sum():>11} "
              f"{broken.sum():>7.0f} {100 * np.minimum(motion, broken).sum() / motion.sum():>8.1f}% {strict.sum():>7} "
              f"{100 * np.minimum(strict, broken).sum() / strict.sum():>8.1f}%")


if __name__ == "__main__":
    main()
