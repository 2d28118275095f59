"""Does the window error of a part of real tissue hold the value of all of it? Early- and latewood of spruce, in halves and thirds along each axis.

    /usr/bin/python3 benchmarks/spruce-windows.py [lamella=build/bin/lamella] [real=FOLDER] (or LAMELLA_REAL_DATA)

Each part is a picture of its own, solved with insulated sides and its own window error. The whole picture is the truth, as far as one picture
is; parts of it are not independent of it, nor of each other. Prints the table of docs/benchmarks/window.md.
"""

import json
import os
import pathlib
import statistics
import struct
import subprocess
import sys

CONDUCTIVITIES = {"1 : 0.023": "lumen=0.023,wall=1", "0.004 : 1": "lumen=1,wall=0.004"}


def answer(program, *words):
    done = subprocess.run([program, "diffusion", *words, "--json"], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def size_of(png):
    return struct.unpack(">II", png.read_bytes()[16:24])


def main():
    keys = dict(word.split("=", 1) for word in sys.argv[1:])
    program = keys.get("lamella", "build/bin/lamella")
    real = keys.get("real", os.environ.get("LAMELLA_REAL_DATA"))
    if not real:
        sys.exit("the pictures of spruce are not known: give real=FOLDER")
    print("| | walls : lumens | parts | held | half width, median | off, median | all: x | y |\n|---|---|---|---|---|---|---|---|")
    for wood in ("EW", "LW"):
        picture = pathlib.Path(real) / f"spruce_{wood}_labels_0.5um.png"
        width, height = size_of(picture)
        for name, conductivity in CONDUCTIVITIES.items():
            words = [str(picture), "--pixel-size", "0.5um", "--phase", "0=lumen", "--other", "wall", "--conductivity", conductivity]
            words += ["--sides", "insulated", "--no-error-estimate", "--window-error"]
            whole = answer(program, *words)
            for parts in (2, 3):
                held, widths, errors = 0, [], []
                for place in range(parts * parts):
                    x, y = place % parts * (width // parts), place // parts * (height // parts)
                    part = answer(program, *words, "--window", f"{x},{y},{width // parts},{height // parts}")
                    for axis in "xy":
                        truth, window = whole["effective"][axis], part["window_errors"][axis]
                        held += window["low"] <= truth <= window["high"]
                        widths.append(50 * (window["high"] - window["low"]) / truth)
                        errors.append(100 * abs(part["effective"][axis] / truth - 1))
                spans = [f"{whole['effective'][a]:.4g} ({whole['window_errors'][a]['low']:.3g} to {whole['window_errors'][a]['high']:.3g})" for a in "xy"]
                kind = {"EW": "earlywood", "LW": "latewood"}[wood]
                print(f"| {kind} | {name} | {parts} × {parts} | {held} of {len(widths)} | {statistics.median(widths):.1f} % | {statistics.median(errors):.1f} % | {spans[0]} | {spans[1]} |", flush=True)


if __name__ == "__main__":
    main()
