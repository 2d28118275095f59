"""Does the segmentation error hold? Generated scans whose labels are known, segmented without a word, and what both conduct.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/segmentation-error.py [lamella=build/bin/lamella] [output=FOLDER] [seeds=6] [first=1]
                                                                              [size=240] [study=scans,volumes] [real=FOLDER]
                                                                              [quantities=conductivity] [material=no]

scans    `lamella generate softwood|hardwood --look … --truth`: every look, tissue, pixel and fault of SCANS below, each seed
volumes  those of grey-volumes.py

Of each: the conductivity of what was found with its segmentation error, and that of the labels of the same pixels, which is its truth; for
scans also the error of lattice and picture with it (the root of the squares), against labels on pixels a quarter as large. Walls conduct 1 and
lumens 0.023, or 0.01 and 1. With quantities=conductivity,stiffness also Young's moduli of walls around voids (nu 0.3, straight sides); with strength the peak stress
of walls between platens (bonds, horizon 3, three pixels cropped; without those small pixels); with material=no without those small pixels. Prints the tables of docs/benchmarks/segmentation.md and writes segmentation-error.csv.
"""

import csv
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import warnings

import lamella
import numpy as np

CONDUCTIVITIES = {"heat": {"lumen": 0.023, "wall": 1.0}, "vapour": {"lumen": 1.0, "wall": 0.01}}
LOOKS = ("magenta", "blue", "grey")
SCANS = {  # group: (tissue, solid fraction, pixel [um], options)
    "softwood": ("softwood", 0.4, 0.5, []),
    "latewood": ("softwood", 0.78, 0.5, []),
    "hardwood": ("hardwood", 0.4, 0.5, []),
    "pixels of 1 um": ("softwood", 0.4, 1.0, []),
    "pixels of 0.25 um": ("softwood", 0.5, 0.25, []),
    "blur of 0.2 um": ("softwood", 0.5, 0.5, ["--blur", "0.2um"]),
    "blur of 1 um": ("softwood", 0.5, 0.5, ["--blur", "1um"]),
    "noise of 6 %": ("softwood", 0.5, 0.5, ["--noise", "0.06"]),
    "light uneven by half": ("softwood", 0.5, 0.5, ["--uneven-light", "0.5"]),
    "faint rim": ("softwood", 0.5, 0.5, ["--rim", "0.4"]),
}


BORDERS = (0, 3)  # pixels that are cropped of what was segmented: a strip of wall along a side carries more than all others
DOUBTED = []  # scans that the segmentation warned of, left out


def solved(solid, names, conductivity, direction, **more):
    sample = lamella.from_array(np.ascontiguousarray(solid, np.uint8), names)
    return lamella.diffusion(sample, conductivity, direction=direction, field=False, flux=False, **more)


def run(program, *words):
    done = subprocess.run([program, *map(str, words), "--quiet", "--overwrite"], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr)


def walls_of(path):
    sample = lamella.Sample(lamella.read(str(path)))
    return np.asarray(sample) == list(sample.names).index("wall")


def scan_rows(keys, work):
    size, first = int(keys.get("size", 240)), int(keys.get("first", 1))
    program = keys.get("lamella", "build/bin/lamella")
    for group, (tissue, solid, pixel, options) in SCANS.items():
        for seed in range(first, first + int(keys.get("seeds", 6))):
            common = ["generate", tissue, "--solid-fraction", solid, "--seed", seed]
            fine = work / "fine.vti"
            if quantities(keys) != ["strength"]:
                run(program, *common, "--size", f"{4 * size},{4 * size}", "--pixel-size", f"{pixel / 4}um", "-o", fine)
                fine_walls = walls_of(fine)
            fines = {}
            for look in LOOKS:
                scan, labels = work / "scan.png", work / "labels.vti"
                run(program, *common, "--size", f"{size},{size}", "--pixel-size", f"{pixel}um", "--look", look, *options, "-o", scan,
                    "--truth", labels)  # fmt: skip
                with warnings.catch_warnings(record=True) as told:
                    warnings.simplefilter("always")
                    sample = lamella.read_picture(str(scan), segment=True)
                if any("lumen" in str(w.message) or "grey" in str(w.message) for w in told):
                    DOUBTED.append(f"{group}, {look} {seed}: {told[0].message}")
                    continue
                truth = walls_of(labels)
                if "strength" in quantities(keys):
                    yield from strength_rows(group, f"{look} {seed}", sample, truth)
                for border in BORDERS if "stiffness" in quantities(keys) else ():
                    if keys.get("material") == "no":
                        fines[border] = None
                    elif border not in fines:
                        fines[border] = stiff(cropped(fine_walls, 4 * border), ["lumen", "wall"], "wall", estimate_error=False).constants
                    yield from stiffness_rows(group, f"{look} {seed}", "xy", sample, truth, ["lumen", "wall"], border, fines[border])
                for quantity, conductivity in CONDUCTIVITIES.items() if "conductivity" in quantities(keys) else ():
                    for direction in "xy":
                        if (quantity, direction) not in fines:
                            result = solved(fine_walls, ["lumen", "wall"], conductivity, direction, estimate_error=False)
                            fines[quantity, direction] = result.effective["xy".index(direction)]["xy".index(direction)]
                        yield row_of(group, f"{look} {seed}", quantity, direction, sample, truth, ["lumen", "wall"], conductivity,
                                     fines[quantity, direction])  # fmt: skip


def quantities(keys):
    return keys.get("quantities", "conductivity").split(",")


def stiff(sample, names, solid, **more):
    if isinstance(sample, np.ndarray):
        sample = lamella.from_array(np.ascontiguousarray(sample, np.uint8), names)
    return lamella.stiffness(sample, {solid: 1e9}, sides="straight", **more)


def cropped(solid, border):
    inside = (slice(border, -border or None),) * solid.ndim
    return solid[inside]


def stiffness_rows(group, name, directions, sample, truth, names, border, material=None):
    doubt = sample.vtk.GetFieldData().GetArray("surface_doubt").GetValue(0)
    solid = cropped(np.asarray(sample) == list(sample.names).index(names[1]), border)
    found = stiff(solid, names, names[1], surface_doubt=doubt, estimate_error=material is not None)
    true = stiff(cropped(truth, border), names, names[1], estimate_error=False).constants
    for direction in directions:
        key = "E_" + direction
        value = found.constants[key]
        if not true[key] > 0:  # grains that do not touch
            continue
        yield {"group": f"E, {border} pixels cropped, {group}", "case": name, "quantity": key, "direction": direction, "found": solid.mean(),
               "true": truth.mean(), "value": value, "truth": true[key], "error": abs(value / true[key] - 1),
               "bar": found.segmentation_errors[key] / value, "doubt": doubt, "material": material and material[key],
               "total": material and found.total_errors[key] / value,
               "lattice": material and found.constants_errors[key] / value}  # fmt: skip


def strength_rows(group, name, sample, truth):
    doubt = sample.vtk.GetFieldData().GetArray("surface_doubt").GetValue(0)
    solid, true = (cropped(s, BORDERS[1]) for s in (np.asarray(sample) == list(sample.names).index("wall"), truth))
    for direction in "xy":
        try:
            found, right = (
                lamella.fracture(lamella.from_array(np.ascontiguousarray(s, np.uint8), ["lumen", "wall"]), {"wall": 1e9}, axis=direction,
                                 critical_stretch={"wall": 0.01}, stop=0.9, displacement=False, **more)
                for s, more in ((solid, {"surface_doubt": doubt}), (true, {})))  # fmt: skip
        except lamella.LamellaError as error:
            DOUBTED.append(f"{group}, {name}, {direction}: {error}")
            continue
        value = found.peak_stress
        yield {"group": f"strength, {group}", "case": name, "quantity": "strength", "direction": direction, "found": solid.mean(),
               "true": true.mean(), "value": value, "truth": right.peak_stress, "error": abs(value / right.peak_stress - 1),
               "bar": found.segmentation_error / value, "doubt": doubt, "material": None, "total": None, "lattice": None}  # fmt: skip


def row_of(group, name, quantity, direction, sample, truth, names, conductivity, material=None):
    at = "xyz".index(direction)
    found = lamella.diffusion(sample, conductivity, direction=direction, field=False, flux=False, segmentation_error=True,
                              estimate_error=material is not None)  # fmt: skip
    value = found.effective[at, at]
    true = solved(truth, names, conductivity, direction, estimate_error=False).effective[at, at]
    doubt = found.vtk.GetFieldData().GetArray("surface_doubt").GetValue(0)
    row = {"group": group, "case": name, "quantity": quantity, "direction": direction, "found": np.mean(np.asarray(sample) == 1),
           "true": truth.mean(), "value": value, "truth": true, "error": abs(value / true - 1), "bar": found.segmentation_error[direction],
           "doubt": doubt, "material": material, "total": None, "lattice": None}  # fmt: skip
    if material is not None:
        row["total"] = found.total_error[direction]
        row["lattice"] = found.estimated_error
    return row


def volume_rows(keys, work):
    place = importlib.util.spec_from_file_location("grey_volumes", pathlib.Path(__file__).with_name("grey-volumes.py"))
    grey = importlib.util.module_from_spec(place)
    place.loader.exec_module(grey)
    for name, solid, conductivity in grey.samples(80, keys.get("real", os.environ.get("LAMELLA_REAL_DATA", ""))):
        for scan, settings in grey.SCANS.items():
            path = work / "t_{0}x{0}x{0}_u8.raw".format(80)
            grey.tomogram(solid, *settings).tofile(path)
            sample = lamella.read_picture(str(path), grey.VOID_SOLID, segment=True)
            for border in BORDERS if "stiffness" in quantities(keys) else ():
                yield from stiffness_rows(name, scan, "xz", sample, solid, ["void", "solid"], border)
            for direction in "xz" if "conductivity" in quantities(keys) else ():
                yield row_of(name, scan, "", direction, sample, solid, ["void", "solid"], conductivity)


def table(rows, groups):
    print("| | cases | held | median bar | median error | doubt [pixels] | with lattice and picture: held | median bar |")
    print("|---|---|---|---|---|---|---|---|")
    for group in [*groups, "all"]:
        of = [r for r in rows if group in (r["group"], "all")]
        if not of:
            continue
        held = sum(r["error"] <= r["bar"] for r in of)
        whole = [r for r in of if r["material"] is not None]
        both = sum(abs(r["value"] / r["material"] - 1) <= r["total"] for r in whole)
        print(f"| {group} | {len(of)} | {held} ({100 * held / len(of):.0f} %) | {100 * np.median([r['bar'] for r in of]):.2f} % "
              f"| {100 * np.median([r['error'] for r in of]):.2f} % | {np.median([r['doubt'] for r in of]):.2f} | "
              + (f"{both} of {len(whole)} ({100 * both / len(whole):.0f} %) | {100 * np.median([r['total'] for r in whole]):.2f} % |" if whole else "| |"),
              flush=True)  # fmt: skip


def main():
    keys = dict(word.split("=", 1) for word in sys.argv[1:])
    folder = pathlib.Path(keys.get("output", "results/bench-segmentation-error"))
    folder.mkdir(parents=True, exist_ok=True)
    every = []
    with tempfile.TemporaryDirectory() as work:
        for study in keys.get("study", "scans,volumes").split(","):
            rows = list({"scans": scan_rows, "volumes": volume_rows}[study](keys, pathlib.Path(work)))
            print(f"\n{study}\n")
            table(rows, dict.fromkeys(r["group"] for r in rows))
            every += rows
            print("\n".join(["", *(f"left out: {line}" for line in DOUBTED)]))
            DOUBTED.clear()
    with open(folder / "segmentation-error.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, every[0])
        out.writeheader()
        out.writerows(every)


if __name__ == "__main__":
    main()
