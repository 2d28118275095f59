"""Do the intervals of `lamella fit` hold? Tissues of many seeds, walls of known conductivity or moduli, effective values measured with normal errors of 2 %.

fit.py lamella=PROGRAM [cases=100] [seed=2026] [part=diffusion|stiffness|moisture|moist-stiffness|pictures]
"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def answer(program, *words):
    code, out, err = run(program, *words, "--json")
    if code != 0:
        sys.exit(f"{' '.join(map(str, words))}: {err}")
    return json.loads(out)


def tally(rows, name):
    held = [r["held"] for r in rows]
    widths = sorted(r["width"] for r in rows)
    off = sorted(r["off"] for r in rows)
    solves = [r["solves"] for r in rows]
    print(f"{name}: {sum(held)} of {len(held)} intervals hold ({100 * sum(held) / len(held):.0f} %); half width {100 * widths[len(widths) // 2]:.1f} % and error "
          f"{100 * off[len(off) // 2]:.1f} % in the median; solves {sorted(solves)[len(solves) // 2]} in the median, {max(solves)} at most", flush=True)


def noisy(rng, value, share=0.02):
    return value * (1 + share * rng.gauss(0, 1)), 1.959964 * share * value


def rows_of(fitted, truths):
    rows = []
    for name, truth in truths.items():
        found = fitted["unknown"][name]
        rows.append({"held": found["low"] <= truth <= found["high"], "width": abs((found["high"] - found["value"]) / found["value"]), "off": abs(found["value"] / truth - 1), "solves": fitted["solves"]})
    return rows


def diffusion(program, cases, rng, work):
    rows = []
    for _ in range(cases):
        sample = work / "tissue.vti"
        answer(program, "generate", "softwood", "--size", f"{rng.randint(70, 130)},{rng.randint(70, 130)}", "--solid-fraction", f"{rng.uniform(0.25, 0.6):.3f}", "--seed", rng.randint(1, 10**6),
               "-o", sample, "--overwrite")
        wall = 10 ** rng.uniform(-1, 1)
        axis = rng.choice("xy")
        truth = answer(program, "diffusion", sample, "--conductivity", f"lumen=0.026,wall={wall!r}", "--direction", axis, "--no-error-estimate")["effective"][axis]
        value, half = noisy(rng, truth)
        fitted = answer(program, "fit", "diffusion", sample, "--conductivity", "lumen=0.026", "--unknown", "wall", "--measured", f"{axis}={value!r}±{half!r}", "--direction", axis, "--no-error-estimate")
        rows += rows_of(fitted, {"conductivity:wall": wall})
    tally(rows, "conductivity of the wall, from one direction")


def stiffness(program, cases, rng, work):
    both = {"young:wall": [], "young-across:wall": []}
    refused = 0
    done = 0
    while done < cases:
        labels, sample = work / "labels.png", work / "tissue.vti"
        answer(program, "generate", "softwood", "--size", f"{rng.randint(80, 120)},{rng.randint(80, 120)}", "--solid-fraction", f"{rng.uniform(0.35, 0.7):.3f}", "--seed", rng.randint(1, 10**6),
               "-o", labels, "--overwrite")
        answer(program, "micrograph", labels, "--lamella", "none", "-o", sample, "--overwrite")
        truths = {"young:wall": 8e9 * 2 ** rng.uniform(-1, 1)}
        truths["young-across:wall"] = truths["young:wall"] * rng.uniform(0.4, 1)
        material = [w for name, value in truths.items() for w in (f"--{name.split(':')[0]}", f"wall={value!r}")]
        material += ["--shear", f"wall={0.4 * truths['young:wall']!r}", "--poisson", "wall=0.3"]
        found = answer(program, "stiffness", sample, *material, "--no-error-estimate")["constants"]
        if min(found[name]["value"] or 0 for name in ("E_x", "E_y")) < 1e-3 * truths["young:wall"]:
            continue  # a piece that does not carry across its seam
        done += 1
        words = []
        for name in ("E_x", "E_y"):
            value, half = noisy(rng, found[name]["value"])
            words += ["--measured", f"{name}={value!r}±{half!r}"]
        code, out, err = run(program, "fit", "stiffness", sample, "--unknown", "young:wall", "--unknown", "young-across:wall", *words, *material[4:], "--no-error-estimate", "--json")
        if code != 0:
            if "not tell" not in err and "only together" not in err and "nothing fits" not in err:
                print(err.splitlines()[0], truths, words)
            refused += 1
            continue
        fitted = json.loads(out)
        for name, truth in truths.items():
            both[name] += rows_of(fitted, {name: truth})
    for name, rows in both.items():
        tally(rows, name)
    print(f"{refused} of {cases} refused: the measurements did not tell both")


def tissue(program, rng, sample):
    answer(program, "generate", "softwood", "--size", f"{rng.randint(70, 110)},{rng.randint(70, 110)}", "--solid-fraction", f"{rng.uniform(0.35, 0.6):.3f}", "--seed", rng.randint(1, 10**6),
           "-o", sample, "--overwrite")


def moisture(program, cases, rng, work):
    """A wall that conducts better the moister it is; one sample at three moistures."""
    both = {"conductivity:wall": [], "slope:conductivity:wall": []}
    for _ in range(cases):
        sample = work / "tissue.vti"
        tissue(program, rng, sample)
        truths = {"conductivity:wall": 10 ** rng.uniform(-1, 0.5)}
        truths["slope:conductivity:wall"] = truths["conductivity:wall"] * rng.uniform(1, 5)
        axis, dry = rng.choice("xy"), rng.choice((0, 0.05))
        words = []
        for at in (dry, dry + 0.1, dry + 0.2):
            wall = truths["conductivity:wall"] + truths["slope:conductivity:wall"] * at
            truth = answer(program, "diffusion", sample, "--conductivity", f"lumen=0.026,wall={wall!r}", "--direction", axis, "--no-error-estimate")["effective"][axis]
            value, half = noisy(rng, truth)
            words += ["--measured", f"{axis}@{at!r}={value!r}±{half!r}"]
        fitted = answer(program, "fit", "diffusion", sample, "--conductivity", "lumen=0.026", "--unknown", "wall", "--unknown", "slope:wall", *words, "--direction", axis, "--no-error-estimate")
        for name, truth in truths.items():
            both[name] += rows_of(fitted, {name: truth})
    for name, rows in both.items():
        tally(rows, f"{name}, one sample at three moistures")


def moist_stiffness(program, cases, rng, work):
    """A modulus that falls with moisture; two samples, each at its own."""
    both = {"young:wall": [], "slope:young:wall": []}
    done = 0
    while done < cases:
        samples = work / "first.vti", work / "second.vti"
        truths = {"young:wall": 8e9 * 2 ** rng.uniform(-1, 1)}
        truths["slope:young:wall"] = -truths["young:wall"] * rng.uniform(1, 3)
        words = []
        for which, sample in enumerate(samples):
            tissue(program, rng, sample)
            at = (0.03, 0.18)[which]
            young = truths["young:wall"] + truths["slope:young:wall"] * at
            found = answer(program, "stiffness", sample, "--young", f"wall={young!r}", "--no-error-estimate")["constants"]["E_x"]["value"] or 0
            if found < 1e-3 * young:
                break  # a piece that does not carry across its seam
            value, half = noisy(rng, found)
            words += ["--measured", f"{which + 1}/E_x@{at!r}={value!r}±{half!r}"]
        else:
            done += 1
            fitted = answer(program, "fit", "stiffness", samples[0], "--also", samples[1], "--unknown", "young:wall", "--unknown", "slope:young:wall", *words, "--no-error-estimate")
            for name, truth in truths.items():
                both[name] += rows_of(fitted, {name: truth})
    for name, rows in both.items():
        tally(rows, f"{name}, two samples, each at its own moisture")


def pictures(program, cases, rng, work):
    """The same with the error of lattice and picture: what is measured is of the tissue with pixels a quarter as large; measured to 0.2 %."""
    both = {"conductivity:wall": [], "slope:conductivity:wall": []}
    for _ in range(cases):
        fine, coarse = work / "fine.vti", work / "coarse.vti"
        n, solid, seed = rng.randint(60, 100), f"{rng.uniform(0.35, 0.6):.3f}", rng.randint(1, 10**6)
        for sample, nodes, pixel in ((fine, 4 * n, "0.25um"), (coarse, n, "1um")):
            answer(program, "generate", "softwood", "--size", f"{nodes},{nodes}", "--pixel-size", pixel, "--solid-fraction", solid, "--seed", seed, "-o", sample, "--overwrite")
        truths = {"conductivity:wall": 10 ** rng.uniform(-1, 0.5)}
        truths["slope:conductivity:wall"] = truths["conductivity:wall"] * rng.uniform(1, 5)
        words = []
        for at in (0, 0.05, 0.1, 0.15, 0.2):
            wall = truths["conductivity:wall"] + truths["slope:conductivity:wall"] * at
            truth = answer(program, "diffusion", fine, "--conductivity", f"lumen=0.026,wall={wall!r}", "--no-error-estimate")["effective"]
            for axis in "xy":
                value, half = noisy(rng, truth[axis], 0.001)
                words += ["--measured", f"{axis}@{at!r}={value!r}±{half!r}"]
        fitted = answer(program, "fit", "diffusion", coarse, "--conductivity", "lumen=0.026", "--unknown", "wall", "--unknown", "slope:wall", *words)
        for name, truth in truths.items():
            both[name] += rows_of(fitted, {name: truth})
    for name, rows in both.items():
        tally(rows, f"{name}, x and y at five moistures, with lattice and picture")


def main():
    keys = dict(word.split("=", 1) for word in sys.argv[1:])
    rng = random.Random(int(keys.get("seed", 2026)))
    cases = int(keys.get("cases", 100))
    with tempfile.TemporaryDirectory() as folder:
        for part in keys.get("part", "diffusion,stiffness").split(","):
            {"diffusion": diffusion, "stiffness": stiffness, "moisture": moisture, "moist-stiffness": moist_stiffness, "pictures": pictures}[part](keys["lamella"], cases, rng, pathlib.Path(folder))


if __name__ == "__main__":
    main()
