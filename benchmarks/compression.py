"""Draws what the benchmark "compression" measured: error against CPU time.

    /usr/bin/python3 benchmarks/compression.py [output=FOLDER] [picture=FILE]

FOLDER holds compression-motion.csv, compression-tissue.csv, compression-speed.csv, or some of them (default: results/bench-compression);
FILE is FOLDER/compression.png unless told. `./dev bench compression` runs it after the measurements, with the benchmark's keys: others are
no concern of it.
"""

import csv
import itertools
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def number(text):
    try:
        return float(text)
    except ValueError:
        return text or None


def rows_of(path):
    with open(path, newline="") as file:
        return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]


def curves(axes, rows, keys, label, error):
    """A line through the rows that agree in ``keys``; ``error`` may have none to give."""
    marks = itertools.cycle("osD^vP*X")
    kinds = list(dict.fromkeys(tuple(row[key] for key in keys) for row in rows))
    for kind in kinds:
        of = [(row["cpu_seconds"], error(row)) for row in rows if tuple(row[key] for key in keys) == kind]
        of = sorted(pair for pair in of if pair[1])
        if of:
            axes.plot(*zip(*of), marker=next(marks), markersize=5, linewidth=0.8, label=label(*kind))


def motion(axes, rows):
    least = min(row["amplitude"] for row in rows)
    curves(axes, [row for row in rows if row["amplitude"] == least], ("shape", "transfer", "per_cell"),
           lambda shape, transfer, per: f"{shape}, {transfer}, {per:g} a cell", lambda row: row["error"])
    axes.set_title("manufactured solution, displacement", fontsize=10)


def tissue(axes, rows):
    best = min(rows, key=lambda row: (row["spacing"], -row["per_cell"]))
    curves(axes, rows, ("spacing",), lambda spacing: f"cells of {1e6 * spacing:.2f} µm", lambda row: abs(row["plateau"] / best["plateau"] - 1))
    axes.set_title("earlywood's plateau, against the finest", fontsize=10)


def speed(axes, rows):
    runs = [row for row in rows if row["start"] != "implicit"]
    slowest = max(runs, key=lambda row: row["cpu_seconds"])
    for row in runs:
        row["group"] = "controlled" if row["energy_ratio"] else f"{'at rest' if row['start'] == 'rest' else 'even start'}, one speed"
    curves(axes, runs, ("group",), str, lambda row: abs(row["slope"] / slowest["slope"] - 1))
    axes.set_title("earlywood's first slope, against the slowest run", fontsize=10)


def main():
    keys = dict(argument.partition("=")[::2] for argument in sys.argv[1:])
    folder = pathlib.Path(keys.get("output", "results/bench-compression"))
    picture = pathlib.Path(keys.get("picture", folder / "compression.png"))
    panels = [(draw, folder / f"compression-{draw.__name__}.csv") for draw in (motion, tissue, speed)]
    panels = [(draw, rows_of(table)) for draw, table in panels if table.exists()]
    panels = [(draw, rows) for draw, rows in panels if len(rows) > 1]  # one would be its own reference
    if not panels:
        print(f"  nothing drawn: {folder} has no table of two runs")
        return
    figure, axes = plt.subplots(1, len(panels), figsize=(4.5 * len(panels), 4.8), constrained_layout=True, squeeze=False)
    for place, (draw, rows) in zip(axes[0], panels):
        draw(place, rows)
        place.set_xscale("log")
        place.set_yscale("log")
        place.set_xlabel("CPU time [s]")
        place.legend(fontsize=7, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.15))
    axes[0][0].set_ylabel("relative error")
    figure.savefig(picture, dpi=130)
    print(f"  written: {picture}")


if __name__ == "__main__":
    main()
