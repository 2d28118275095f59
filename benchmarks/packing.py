"""Draws what the benchmark "packing" measured: error against processor time.

    /usr/bin/python3 benchmarks/packing.py [output=FOLDER] [picture=FILE]

FOLDER holds packing-softness.csv and packing-tolerance.csv (default: results/bench-packing); FILE is FOLDER/packing.png unless told.
`./dev bench packing` runs it after the measurements, with the benchmark's keys: others are no concern of it.
"""

from drawing import error_against_time, panels_of, places, rows_of, save


def curve(axes, rows, error, mark, label, value):
    """A line through the rows with an error, each with what it was run with beside it."""
    points = [(row["cpu_seconds"], abs(row[error]), row[value]) for row in rows if row[error]]
    if points:
        axes.plot([p[0] for p in points], [p[1] for p in points], mark, markersize=5, linewidth=0.8, label=label)
        for seconds, height, what in points:
            axes.annotate(f"{what:.0e}", (seconds, height), textcoords="offset points", xytext=(4, 3), fontsize=6, color="0.4")


def main():
    folder, picture = places("packing")
    soft, tolerance = (rows_of(folder / f"packing-{name}.csv") for name in ("softness", "tolerance"))
    if not (soft and tolerance):
        print(f"  nothing drawn: {folder} has no table of both softness and tolerance")
        return
    figure, axes = panels_of(3, (4.4, 4.0))
    for dimension, kind, mark in ((2, "disks", "o-"), (3, "spheres", "s-")):
        rows = [row for row in soft if row["dimension"] == dimension]
        curve(axes[0], rows, "fraction_error", mark, kind, "softness")
        curve(axes[1], rows, "excess_share", mark, kind, "softness")
    for friction, mark in ((0.0, "o-"), (0.3, "D-")):
        rows = [row for row in tolerance if row["friction"] == friction]
        curve(axes[2], rows, "unbalanced", mark, f"friction {friction:g}", "tolerance")
    error_against_time(axes[0], "packing fraction, against softness 1e-7")
    error_against_time(axes[1], "contacts beyond isostaticity, share of all")
    error_against_time(axes[2], "net force over contact force, by tolerance")
    save(figure, picture)


if __name__ == "__main__":
    main()
