"""Pressed between platens: foams of closed cells by platens that slide, rub or hold, and softwood in space, radially and tangentially.

PYTHONPATH=build/python /usr/bin/python3 benchmarks/pressing.py study=platens [dimension=2|3]
PYTHONPATH=build/python /usr/bin/python3 benchmarks/pressing.py study=softwood [nodes=48]

Curves, points and a picture go to results/bench-pressing, or output=FOLDER; what is there is not run again. Processor times.
"""

import json
import pathlib
import sys
import time

import lamella
import numpy as np
from drawing import plt
from scipy import ndimage, spatial

FRICTIONS = (0, 0.05, 0.2, 0.5, None)  # None: the platens hold


def foam(nodes, cells, wall, dimension, seed=5):
    """Closed cells: Voronoi's of a grid of places moved at random; 1 where the solid is. Loose crumbs are removed.

    nodes, cells  along each axis
    wall          thickness [nodes]
    """
    chance = np.random.default_rng(seed)
    size = nodes / cells
    grid = np.stack(np.meshgrid(*[np.arange(-1, cells + 1)] * dimension, indexing="ij"), -1).reshape(-1, dimension)
    centres = (grid + 0.5 + chance.uniform(-0.3, 0.3, grid.shape)) * size
    at = np.stack(np.meshgrid(*[np.arange(nodes) + 0.5] * dimension, indexing="ij"), -1).reshape(-1, dimension)
    distance, which = spatial.cKDTree(centres).query(at, k=dimension + 2)
    across = np.linalg.norm(centres[which[:, 1:]] - centres[which[:, :1]], axis=-1)
    to_wall = np.min((distance[:, 1:] ** 2 - distance[:, :1] ** 2) / (2 * across), axis=1)  # from the plane between two
    solid = (to_wall < wall / 2).reshape([nodes] * dimension)
    parts, _ = ndimage.label(solid)
    sizes = np.bincount(parts.ravel())
    sizes[0] = 0
    return (parts == sizes.argmax()).astype(np.uint8)


def shape(points, axis):
    """Mean strains across the load in the middle third of the height, and in the tenths at the platens: how the points there have gone
    apart, by regression. And how far the upper tenth has gone beyond the lower one along x [m]."""
    moved = points["displacement"]
    start = points["positions"] - moved
    share = (start[:, axis] - start[:, axis].min()) / np.ptp(start[:, axis])

    def widened(there):
        return np.mean([np.polyfit(start[there, a], moved[there, a], 1)[0] for a in range(axis)])

    ends = np.mean([widened(share < 0.1), widened(share > 0.9)])
    return widened((share > 1 / 3) & (share < 2 / 3)), ends, moved[share > 0.9, 0].mean() - moved[share < 0.1, 0].mean()


def pressed(image, folder, name, **options):
    """Runs it unless its results are there, and returns them: a dictionary, and the points at 5 % and at the end."""
    kept = folder / f"{name}.json"
    if not kept.exists():
        begin = time.process_time()
        states = []
        result = lamella.compression(image, displacement=True, energy_density=True, at_strains=[0.05], on_step=states.append, **options)
        curve = {key: np.asarray(values).tolist() for key, values in result.curve.items()}
        facts = dict(curve=curve, seconds=time.process_time() - begin, quality=result.quality, warnings=list(result.warnings),
                     statistics=result.statistics)
        for state, when in zip(states, ("early", "end"), strict=True):
            np.savez_compressed(folder / f"{name}-{when}.npz", positions=state.positions, displacement=state.array("displacement"),
                                energy=state.array("energy_density"))
        kept.write_text(json.dumps(facts), encoding="utf-8")
    return json.loads(kept.read_text(encoding="utf-8")), [np.load(folder / f"{name}-{when}.npz") for when in ("early", "end")]


def at(curve, strain, column="stress"):
    return float(np.interp(strain, curve["strain"], curve[column]))


def draw(axes, points, spacing, thickness=None, size=0.7):
    """Points, or those of a slice through the middle, coloured by the logarithm of their energy.

    thickness  of the slice [spacings]; none: all points of a plane
    """
    x = points["positions"]
    shown = np.ones(len(x), bool) if thickness is None else np.abs(x[:, 1] - x[:, 1].mean()) < thickness * spacing
    up = 1 if thickness is None else 2
    energy = points["energy"][shown]
    axes.scatter(x[shown, 0], x[shown, up], c=np.log10(np.maximum(energy, energy.max() * 1e-4)), s=size, marker="s", cmap="viridis", linewidths=0)
    axes.set_aspect("equal")
    axes.set_axis_off()


def platens(folder, keys):
    dimension = int(keys.get("dimension", 2))
    nodes, cells, wall, end = (120, 10, 3, 0.3) if dimension == 2 else (32, 3, 2, 0.2)
    image = foam(nodes, cells, wall, dimension)
    print(f"foam of {cells} cells along each axis in {nodes} nodes, {image.mean():.3f} solid")
    sample = lamella.from_array(image, names=["void", "solid"], spacing=1e-5)
    _, picture = plt.subplots(2, 3, figsize=(9, 4.8))
    picture = picture.ravel()
    for axes, friction in zip(picture, FRICTIONS):
        name = f"foam-{dimension}-{'hold' if friction is None else friction}"
        rough = dict(grip=True) if friction is None else dict(platen_friction=friction)
        facts, states = pressed(sample, folder, name, axis="y" if dimension == 2 else "z", strain=end, sides="open", law="isotropic",
                                young=1e9, poisson=0.3, points_per_node=3 if dimension == 2 else 2, rows=60, **rough)
        curve = facts["curve"]
        stresses = " ".join(f"{at(curve, s) / 1e6:.3f}" for s in (0.02, 0.05, 0.1, 0.2, end))
        print(f"  {name}: stress at 2, 5, 10, 20 %, end {stresses} MPa; "
              f"{facts['statistics']['points']:.0f} points, {facts['statistics']['steps']:.0f} steps, {facts['seconds']:.0f} s; lost {curve['dissipated'][-1] / curve['work'][-1]:.3f};"
              f" kinetic {facts['quality']['energy_ratio']:.4f}, imbalance {facts['quality']['imbalance']:.3f}", flush=True)
        for when, points in zip(("at 5 %", "at the end"), states):
            middle, ends, leaning = shape(points, dimension - 1)
            print(f"    {when}: strain across {100 * middle:.2f} % in the middle, {100 * ends:.2f} % at the platens; leans by"
                  f" {leaning / (1e-5 * nodes):.3f} of the width")
        label = "holds" if friction is None else f"μ = {friction}"
        draw(axes, states[1], 1e-5, None if dimension == 2 else 1.5)
        axes.set(xlim=(-0.3e-5 * nodes, 1.3e-5 * nodes), ylim=(0, 1e-5 * nodes))
        axes.set_title(label)
        picture[-1].plot(100 * np.array(curve["strain"]), np.array(curve["stress"]) / 1e6, label=label)
    picture[-1].set(xlabel="strain [%]", ylabel="stress [MPa]")
    picture[-1].legend(loc="lower right", fontsize=8)
    plt.tight_layout()
    plt.savefig(folder / f"platens-{dimension}.png", dpi=130)


def softwood(folder, keys):
    """The walls' axis is the grain, along z; x is radial, y tangential. Walls that are elastic, and walls that yield at 100 MPa."""
    nodes = int(keys.get("nodes", 48))
    spacing = 118e-6 / nodes
    sample = lamella.softwood(size=(nodes, nodes, nodes // 4), spacing=spacing, solid_fraction=0.4, seed=3)
    grain = np.zeros((*sample.shape, 3), np.float32)
    grain[..., 2] = 1
    sample.set_array("axis", grain)
    _, picture = plt.subplots(2, 3, figsize=(11, 7.2))
    for row, (law, walls) in enumerate((("orthotropic", "elastic"), ("orthotropic-plastic", "yielding"))):
        last = picture[row, 2]
        for axes, axis, name in zip(picture[row], "xy", ("radially", "tangentially")):
            facts, (_, points) = pressed(sample, folder, f"softwood-{walls}-{axis}-{nodes}", axis=axis, strain=0.4, law=law, young=30e9,
                                         transverse=6.4e9, yield_stress=100e6, fit_platens=True, points_per_node=2, rows=80,
                                         most_speed=0.04)
            curve = {key: np.array(values) for key, values in facts["curve"].items()}
            print(f"{walls}, pressed {name}: {facts['statistics']['points']:.0f} points, {facts['statistics']['steps']:.0f} steps,"
                  f" {facts['seconds']:.0f} s")
            for strain in (0.01, 0.03, 0.05, 0.1, 0.2, 0.3, 0.4):
                print(f"  {strain}: {at(curve, strain) / 1e6:.2f} MPa, porosity {at(curve, strain, 'porosity'):.4f},"
                      f" sides {100 * at(curve, strain, 'lateral_strain'):.2f} %")
            flat = (curve["strain"] > 0.149) & (curve["strain"] < 0.251)
            found = lamella.compression_curve(curve["strain"], curve["stress"])
            print(f"  slope to 3 % {found.stiffness / 1e6:.0f} MPa; 15 to 25 %: {curve['stress'][flat].mean() / 1e6:.1f} MPa,"
                  f" tangent {np.polyfit(curve['strain'][flat], curve['stress'][flat], 1)[0] / 1e6:.0f} MPa;"
                  f" 30 to 40 %: {(at(curve, 0.4) - at(curve, 0.3)) / 0.1e6:.0f} MPa; missing: {found.missing}")
            shares = {key: float(curve[key][-1] / curve["work"][-1])
                      for key in ("elastic_energy", "kinetic_energy", "dissipated", "plastic_work")}
            print(f"  of the work: {shares}; {facts['quality']}; {facts['warnings']}", flush=True)
            x = points["positions"]
            slab = np.abs(x[:, 2] - x[:, 2].mean()) < spacing  # two layers of points
            draw(axes, {"positions": x[slab], "energy": points["energy"][slab]}, spacing, size=2)
            axes.set_title(f"{walls}, pressed {name}")
            last.plot(100 * curve["strain"], curve["stress"] / 1e6, label=name)
        last.set(xlabel="strain [%]", ylabel="stress [MPa]", title=f"{walls} walls")
        last.legend()
    plt.tight_layout()
    plt.savefig(folder / "softwood.png", dpi=110)


def main():
    keys = dict(argument.partition("=")[::2] for argument in sys.argv[1:])
    folder = pathlib.Path(keys.get("output", "results/bench-pressing"))
    folder.mkdir(parents=True, exist_ok=True)
    {"platens": platens, "softwood": softwood}[keys.get("study", "platens")](folder, keys)


if __name__ == "__main__":
    main()
