"""Draws what the benchmark "equilibrium" measured: error of the modulus against processor time.

    /usr/bin/python3 benchmarks/equilibrium.py [output=FOLDER] [picture=FILE]

FOLDER holds equilibrium-accuracy.csv (default: results/bench-equilibrium); FILE is FOLDER/equilibrium.png unless told.
`./dev bench equilibrium` runs it after the measurements, with the benchmark's keys: others are no concern of it.
"""

from drawing import error_against_time, front, panels_of, places, plt, rows_of, save

FORMS = {("continuum", "no"): ("v", ":"), ("continuum", "yes"): ("^", ":"), ("lattice", "no"): ("s", "--"), ("lattice", "yes"): ("o", "-")}
LEAST = 1e-4  # of an error on a logarithmic axis


def main():
    folder, picture = places("equilibrium")
    rows = rows_of(folder / "equilibrium-accuracy.csv")
    if not rows:
        print(f"  nothing drawn: {folder} has no table of accuracy")
        return
    cells = list(dict.fromkeys((row["cell"], row["solid"]) for row in rows))
    figure, axes = panels_of(len(cells), (3.7, 4.6))
    colours = plt.get_cmap("viridis")
    for place, (cell, solid) in zip(axes, cells):
        here = [row for row in rows if (row["cell"], row["solid"]) == (cell, solid)]
        for horizon in sorted({row["horizon"] for row in here}):
            colour = colours((horizon - 2) / 3.4)
            for form, (mark, line) in FORMS.items():
                of = [row for row in here if row["horizon"] == horizon and (row["micromodulus"], row["surface_correction"]) == form]
                of.sort(key=lambda row: row["nodes"])
                place.plot([row["cpu_seconds"] for row in of], [max(abs(row["error"]), LEAST) for row in of], mark + line, color=colour,
                           markersize=4, linewidth=0.8)
            place.plot([], [], color=colour, label=f"h/δx = {horizon:g}")
        for (modulus, corrected), (mark, line) in FORMS.items():
            label = f"{modulus}{', corrected' if corrected == 'yes' else ''}"
            place.plot([], [], mark + line, color="0.4", markersize=4, linewidth=0.8, label=label)
        best = front([(row["cpu_seconds"], max(abs(row["error"]), LEAST)) for row in here])
        place.plot(*zip(*best), color="0.75", linewidth=4, zorder=0, label="none is as fast and errs less")
        kind = "round holes" if cell == "holes" else "honeycomb"
        error_against_time(place, f"{kind}, solid {solid:g}", below=0.14)
    save(figure, picture)


if __name__ == "__main__":
    main()
