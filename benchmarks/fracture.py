"""Draws what the benchmark "fracture" measured: error against CPU time.

    /usr/bin/python3 benchmarks/fracture.py [output=FOLDER] [picture=FILE]

FOLDER holds fracture-strength.csv and fracture-toughness.csv (default: results/bench-fracture); FILE is FOLDER/fracture.png unless told.
`./dev bench fracture` runs it after the measurements, with the benchmark's keys: others are no concern of it.
"""

from drawing import error_against_time, panels_of, places, plt, rows_of, save

MARKERS = {"events": "o", "no rivals": "s", "accurate": "D", "batched": "^", "motion 30": "v", "motion 100": "P"}
LEAST = 1e-6  # of an error on a logarithmic axis


def draw(axes, rows, error, title, methods, joined=True):
    """One mark a run; lines join the lattices of one method and horizon."""
    colours = plt.get_cmap("viridis")
    for horizon in sorted({row["horizon"] for row in rows}):
        colour = colours(min(0.9, max(0.0, (horizon - 3) / 4)))
        for method in methods:
            of = sorted((row for row in rows if row["horizon"] == horizon and row["method"] == method), key=lambda row: row["nodes"])
            values = [(row["cpu_seconds"], max(abs(error(row)), LEAST)) for row in of if error(row) is not None]
            if values:
                axes.plot(*zip(*values), MARKERS[method], color=colour, markersize=5, linestyle="-" if joined else "", linewidth=0.8)
        axes.plot([], [], color=colour, label=f"h/δx = {horizon:g}")
    for method in methods:
        if any(row["method"] == method and error(row) is not None for row in rows):
            axes.plot([], [], MARKERS[method], color="0.4", markersize=5, label=method)
    error_against_time(axes, title)


def main():
    folder, picture = places("fracture")
    strength, toughness = (rows_of(folder / f"fracture-{name}.csv") for name in ("strength", "toughness"))
    if not (strength and toughness):
        print(f"  nothing drawn: {folder} has no table of both strength and toughness")
        return
    others = [name for name in MARKERS if name != "accurate"]
    figure, axes = panels_of(3, (4.33, 4.2))
    draw(axes[0], strength + toughness, lambda row: row["error_method"], "largest stress, against accurate", others, joined=False)
    finest = {row["horizon"]: max(other["nodes"] for other in strength if other["horizon"] == row["horizon"]) for row in strength}
    coarse = [row for row in strength if row["nodes"] < finest[row["horizon"]]]
    draw(axes[1], coarse, lambda row: row["error_lattice"], "strength of grains, against the finest lattice", list(MARKERS))
    few = ["events", "no rivals", "accurate", "motion 100"]
    draw(axes[2], toughness, lambda row: row["lattice"] - 1, "K of a plate, against the lattice's own", few)
    save(figure, picture)


if __name__ == "__main__":
    main()
