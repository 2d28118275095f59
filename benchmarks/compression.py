"""Draws what the benchmark "compression" measured: error against CPU time.

    /usr/bin/python3 benchmarks/compression.py [output=FOLDER] [picture=FILE]

FOLDER holds compression-motion.csv, compression-tissue.csv, compression-speed.csv, or some of them (default: results/bench-compression);
FILE is FOLDER/compression.png unless told. `./dev bench compression` runs it after the measurements, with the benchmark's keys: others are
no concern of it.
"""

import itertools

from drawing import error_against_time, panels_of, places, rows_of, save


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
    return "manufactured solution, displacement"


def tissue(axes, rows):
    best = min(rows, key=lambda row: (row["spacing"], -row["per_cell"]))
    curves(axes, rows, ("spacing",), lambda spacing: f"cells of {1e6 * spacing:.2f} µm", lambda row: abs(row["plateau"] / best["plateau"] - 1))
    return "earlywood's plateau, against the finest"


def speed(axes, rows):
    runs = [row for row in rows if row["start"] != "implicit"]
    slowest = max(runs, key=lambda row: row["cpu_seconds"])
    for row in runs:
        row["group"] = "controlled" if row["energy_ratio"] else f"{'at rest' if row['start'] == 'rest' else 'even start'}, one speed"
    curves(axes, runs, ("group",), str, lambda row: abs(row["slope"] / slowest["slope"] - 1))
    return "earlywood's first slope, against the slowest run"


def main():
    folder, picture = places("compression")
    panels = [(draw, rows_of(folder / f"compression-{draw.__name__}.csv")) for draw in (motion, tissue, speed)]
    panels = [(draw, rows) for draw, rows in panels if len(rows) > 1]  # one would be its own reference
    if not panels:
        print(f"  nothing drawn: {folder} has no table of two runs")
        return
    figure, axes = panels_of(len(panels), (4.5, 4.8))
    for place, (draw, rows) in zip(axes, panels):
        error_against_time(place, draw(place, rows), below=0.15)
    save(figure, picture)


if __name__ == "__main__":
    main()
