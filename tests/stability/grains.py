"""Packings, bridges and pores: judged by counting again, on one's own, what the files hold."""

import csv
import itertools
import math

import numpy as np

from settings import NAMES, Refused, Sample, random_nodes


def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def packing(setting):
    dimension = setting.one_of(2, 2, 3)
    count = setting.one_of(setting.whole(1, 4), setting.whole(5, 40), setting.whole(40, 90))
    diameter = setting.magnitude(-9, 0)
    friction = setting.one_of(0, 0, 0.3, 2)
    softness = setting.magnitude(-8, -2) if setting.chance(0.4) else 1e-6
    words = ["packing", "--dimension", dimension, "--count", count, "--seed", setting.whole(0, 10**6), "-o", "grains.csv"]
    words += ["--mean-diameter", repr(diameter)]
    words += ["--diameter-ratio", repr(setting.one_of(1, 1.001, 2, setting.magnitude(0, 1)))]
    words += ["--sizes", setting.one_of("volume", "volume-share", "diameter")]
    words += ["--aspect", repr(setting.magnitude(-0.69, 0.69)) if setting.chance(0.5) else "2"]
    words += ["--periodic"] if setting.chance(0.3) else []
    words += ["--friction", friction] if friction else []
    words += ["--softness", repr(softness), "--pressure", repr(setting.magnitude(-6, 9))]
    fraction = setting.random.uniform(0.02, 0.8 if dimension == 2 else 0.6) if setting.chance(0.2) else None
    words += ["--packing-fraction", repr(fraction)] if fraction else []
    answer = setting.lamella(*words)
    rows = read_table(setting.folder / "grains.csv")
    axes = ("x", "z") if dimension == 2 else ("x", "y", "z")
    centres = np.array([[row[a] for a in axes] for row in rows])
    radii = np.array([row["r"] for row in rows])
    box = np.array(answer["box"])
    setting.must(len(rows) == count == answer["count"], f"{len(rows)} grains of {count}")
    setting.near(2 * radii.mean(), diameter, 1e-6, "the mean diameter")
    volume = (math.pi * radii**2).sum() if dimension == 2 else (4 / 3 * math.pi * radii**3).sum()
    setting.near(answer["packing_fraction"], volume / box.prod(), 1e-6, "the packing fraction")
    setting.against("the table")
    if fraction:
        setting.near(answer["packing_fraction"], fraction, 0.02, "the packing fraction as asked for")
    difference = centres[:, None] - centres[None]
    if "--periodic" in words:
        difference -= box * np.round(difference / box)
    else:
        setting.must((centres > 0).all() and (centres < box).all(), "a centre outside the box")
    distance = np.sqrt((difference**2).sum(-1))
    overlap = (radii[:, None] + radii[None] - distance)[np.triu_indices(count, 1)]
    worst = overlap.max() / diameter if overlap.size else 0
    # the mean overlap is about the softness; force chains and small grains carry some ten times the mean
    setting.should(worst <= 60 * softness + 1e-4, f"an overlap of {worst} diameters at a softness of {softness}", "overlap|soft|rest")
    setting.should(answer["unbalanced_force"] is None or answer["unbalanced_force"] <= 1e-3 or fraction,
                   f"an unbalanced force of {answer['unbalanced_force']}", "rest|balance|rattl|carr")
    setting.must(0 <= answer["rattlers"] <= count, f"{answer['rattlers']} rattlers of {count}")


def bridges(setting):
    dimension = setting.one_of(2, 2, 3)
    count = setting.whole(1, 12)
    size = np.array([setting.one_of(1.0, 1.0, setting.magnitude(-1, 1)) for _ in range(dimension)])
    centres, radii = [], []
    for _ in range(200):
        c = setting.random.uniform(0, size)
        r = setting.magnitude(-2.5, -0.4) * size.min()
        room = min([np.linalg.norm(c - q) - s for q, s in zip(centres, radii)] + [*c, *(size - c)])
        r = min(r, room) if room > 1e-3 * size.min() else 0
        if r > 0 and len(centres) < count:
            centres.append(c)
            radii.append(r if setting.chance(0.7) else r * 0.999)
    if not centres:
        centres, radii = [size / 2], [0.3 * size.min()]
    centres, radii = np.array(centres), np.array(radii)
    axes = ("x", "z") if dimension == 2 else ("x", "y", "z")
    lines = [",".join([*axes, "r"])] + [",".join(repr(float(v)) for v in [*c, r]) for c, r in zip(centres, radii)]
    (setting.folder / "grains.csv").write_text("\n".join(lines) + "\n")
    nodes = setting.one_of(1, 2, setting.whole(3, 60 if dimension == 2 else 24))
    words = ["bridges", "grains.csv", "--box", ",".join(repr(float(v)) for v in size), "--nodes", nodes, "-o", "lattice.raw"]
    kind = setting.one_of("width", "saturation", "filled")
    words += {"width": ["--width", repr(setting.random.uniform(0, 2))], "filled": ["--filled"],
              "saturation": ["--saturation", repr(setting.random.uniform(0, 1))]}[kind]
    words += ["--reach", repr(setting.random.uniform(1, 2))] if setting.chance(0.5) else []
    answer = setting.lamella(*words) if dimension == 3 else setting.lamella(*[w if w != "lattice.raw" else "lattice.vti" for w in words])
    setting.against("areas and volumes")
    grains = ((math.pi * radii**2).sum() if dimension == 2 else (4 / 3 * math.pi * radii**3).sum()) / size.prod()
    # its own areas are those of sections along lines, a fine lattice
    setting.near(answer["grain_fraction"], grains, 2e-3, "the grains' share", floor=1)
    total = answer["grain_fraction"] + answer["matrix_fraction"] + answer["void_fraction"]
    setting.near(total, 1, 1e-6, "the sum of the shares")
    phases = {phase["name"]: phase["fraction"] for phase in answer["phases"]}
    setting.near(sum(phases.values()), 1, 1e-9, "the sum of the phases")
    lattice = (answer["size"] + [1, 1])[:dimension]  # of one layer or row of nodes the last are left out
    spacing = answer["pixel_size"]
    where = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) * spacing for n in lattice], indexing="ij"), axis=-1)
    inside = np.zeros(where.shape[:-1], bool)
    for c, r in zip(centres, radii):
        inside |= ((where - c) ** 2).sum(-1) <= r * r
    setting.against("the lattice counted again")
    setting.near(phases.get("grain", 0), inside.mean(), 4 / inside.size**(1 - 1 / dimension) / 4 + 1e-9, "the grains' share of the nodes", floor=1)


def pore_flood_fill(setting):
    nodes = random_nodes(setting, most=(30, 10))
    sample = Sample(setting, nodes)
    phase = setting.one_of(*range(4))
    neighbours = setting.one_of(4, 8) if sample.dimension == 2 else setting.one_of(6, 18, 26)
    names = "xyz"[: sample.dimension]
    periodic = "".join(a for a in names if setting.chance(0.3))
    least = setting.one_of(1, 1, 3)
    words = ["pore-flood-fill", *sample.words(), "--fill", NAMES[phase], "--connectivity", neighbours, "--minimum-size", least]
    words += ["--periodic", periodic] if periodic else []
    words += ["--threads", "2"] if setting.chance(0.2) else []
    open_nodes = nodes == phase
    try:
        answer = setting.lamella(*words)
    except Refused as refusal:
        # a volume of one layer is a picture, with a picture's neighbours
        setting.must(refusal.code != 3 or not open_nodes.any() or nodes.shape[0] == 1, f"refused, and there are pores: {refusal}")
        raise
    d = sample.dimension
    reach = {4: 1, 8: 2, 6: 1, 18: 2, 26: 3}[neighbours]
    steps = [s for s in itertools.product((-1, 0, 1), repeat=d) if 0 < sum(map(abs, s)) <= reach]
    wrap = [names[d - 1 - a] in periodic for a in range(d)]
    left = set(zip(*map(lambda v: map(int, v), np.nonzero(open_nodes))))
    sizes = []
    while left:
        stack = [left.pop()]
        size = 0
        while stack:
            node = stack.pop()
            size += 1
            for step in steps:
                other = tuple((a + b) % n if w else a + b for a, b, n, w in zip(node, step, nodes.shape, wrap))
                if other in left:
                    left.discard(other)
                    stack.append(other)
        sizes.append(size)
    kept = [size for size in sizes if size >= least]
    setting.against("a flood of one's own")
    setting.must(answer["count"] == len(kept), f"{answer['count']} pores, and {len(kept)} are right")
    setting.must(answer["total"] == sum(kept), f"{answer['total']} nodes in pores, and {sum(kept)} are right")
    if kept:
        setting.must(answer["largest"] == max(kept), f"the largest has {answer['largest']}, and {max(kept)} is right")
    setting.near(answer["porosity"], open_nodes.mean(), 1e-12, "the porosity")
