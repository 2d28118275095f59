"""Walls of material points that are pressed: judged by bounds, by what a full block does, and run against implicit solve; walls that yield by
limit analysis."""

import math

import numpy as np

from settings import Sample, random_nodes

NAMES = ["void", "wall", "beta", "gamma"]


def compression(setting):
    still = setting.chance(0.6)
    dimension = 2 if still and setting.chance(0.6) or not still and setting.chance(0.8) else 3
    nodes = random_nodes(setting, dimension, least=setting.one_of(1, 2, 4), most=(12, 5) if still else (8, 4), phases=setting.one_of(1, 2, 2, 3))
    if setting.chance(0.6):
        nodes = (nodes + 1) % 4  # walls without voids, or more of them
    sample = Sample(setting, nodes)
    widest = setting.one_of(0.3, 2, 6, 24)
    young = [0.0, *(setting.magnitude(-widest / 2, widest / 2) * 1e9 for _ in range(3))]
    poisson = setting.one_of(0.0, 0.2, 0.3, 0.3, 0.45, 0.49, 0.499)
    sides = setting.one_of("straight", "open", "fixed", "periodic")
    plane = setting.one_of("plane-stress", "plane-strain")
    words = ["compression", *sample.words(NAMES, pixel=repr(setting.magnitude(-9, 0)))]
    for phase in sample.present:
        if phase:
            words += ["--young", f"{NAMES[phase]}={young[phase]!r}"]
    words += ["--poisson", poisson, "--sides", sides]
    words += ["--plane", plane] if dimension == 2 else []
    words += ["--fit-platens"] if setting.chance(0.5) else []
    e = np.array(young)[nodes]
    # no arrangement of walls is stiffer than all of them side by side with their sides held
    held = (1 / (1 - poisson**2) if dimension == 2 and plane == "plane-stress" else (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)))
    stiffest = e.max() * held
    if still:
        words.insert(2, "--stiffness-only")
        answer = setting.lamella(*words)
        setting.against("bounds")
        constants = answer["constants"]
        for name, constant in constants.items():
            value = constant["value"] if isinstance(constant, dict) else constant
            if name.startswith("E_"):
                setting.between(value, 0, stiffest, name, slack=1e-6)
                if (nodes == nodes.flat[0]).all() and sides == "open":
                    setting.against("a full block")
                    exact = young[nodes.flat[0]] / (1 - poisson**2 if dimension == 2 and plane == "plane-strain" else 1)
                    setting.near(value, exact, 1e-4, name)
        return
    limit = None
    walls = [young[phase] for phase in sample.present if phase]
    if walls and (dimension == 3 or plane == "plane-strain") and setting.chance(0.7):
        limit = setting.magnitude(-4, -1) * setting.one_of(*walls)
        words += ["--law", "plastic", "--yield", repr(limit)]
    strain = setting.magnitude(-3, -0.6)
    words += ["--strain", repr(strain)]
    words += ["--axis", setting.one_of(*"xyz"[:dimension])]
    answer = setting.lamella(*words)
    curve = answer["curve"]
    setting.must(len(curve) > 0, "no curve")
    excuse = "kinetic|platens|step|density|across"
    for row in curve:
        setting.must(all(v is None or math.isfinite(v) for v in row.values()), f"a row {row}")
    # Stresses of walls that stiffen as they are crushed: a factor for finite strains and the barrier.
    top = max(row["stress"] for row in curve)
    setting.should(top <= stiffest * strain * 2 * math.exp(3 * strain) / (1 - strain) ** 3,
                   f"a stress of {top} at a strain of {strain} of walls of {stiffest}", excuse)
    if limit is not None:
        flowed, lost, work = (curve[-1][key] for key in ("plastic_work", "dissipated", "work"))
        setting.must(min(row["plastic_work"] for row in curve) >= 0, "plastic work below 0")
        setting.should(flowed <= lost + 0.01 * abs(work), f"a plastic work of {flowed} of {lost} that is lost", excuse)
    if limit is not None and sides in ("open", "straight"):
        # Of an even flow that keeps volume the stress does no more work than walls take that all yield: forces of a body at rest. Their volume
        # at the start counts, as Kirchhoff's stress is what yields. Vibrations of 1 % of the elastic energy are 10 % of the stress, so it is
        # the mean over the second half of the strain.
        setting.against("limit analysis")
        rows = [row for row in curve if row["strain"] >= strain / 2]
        stress = np.mean([row["stress"] for row in rows])
        most = np.mean([(1 if answer["plane"] == "space" else 2 / math.sqrt(3)) * limit * (1 - curve[0]["porosity"]) / (1 - row["strain"])
                        for row in rows])
        setting.should(stress <= 1.05 * most, f"a mean stress of {stress} where walls that all yield bear {most}", excuse)
    setting.should(answer["worst_energy_ratio"] is None or answer["worst_energy_ratio"] < 0.1,
                   f"kinetic energy {answer['worst_energy_ratio']}", excuse)
    setting.against("bounds")
