"""Draws what the benchmark "packing-stability" found: a cell for each run, its colour and mark the verdict.

    /usr/bin/python3 benchmarks/packing-stability.py [output=FOLDER] [picture=FILE]

FOLDER holds packing-stability-ratio.csv, -friction.csv, -softness.csv, -aspect.csv, -loose.csv and -bridges.csv, or some of them (default:
results/bench-packing-stability); FILE is FOLDER/packing-stability.png unless told. `./dev bench packing-stability` runs it after the runs,
with the benchmark's keys: others are no concern of it.
"""

import numpy as np
from drawing import places, plt, rows_of, save
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D

# colours that differ in lightness too, and a mark each: no eye needs the hue
VERDICTS = {
    "right": ("#a9cfe8", None, "right"),
    "warned": ("#e69f00", "$!$", "off, and says so"),
    "refused": ("#c8c8c8", "_", "refused by name"),
    "wrong": ("#000000", "x", "wrong, and silent"),
}
NAMES = list(VERDICTS)
COLOURS = ListedColormap([colour for colour, _, _ in VERDICTS.values()])
STUDIES = {  # what rows and columns of a panel are
    "ratio": ("largest over smallest", "grains"),
    "friction": ("friction", "softness"),
    "softness": ("tolerance", "softness"),
    "aspect": ("aspect", "grains"),
    "loose": ("", "packing fraction"),
    "bridges": ("", ""),
}


def text(value):
    return f"{value:g}" if isinstance(value, float) else str(value)


def in_order(values):
    return list(dict.fromkeys(values))


def panel(axes, rows, title, study):
    """Cells of one study and panel. Bridges have one row of cells for each kind of setting, in the order of the runs."""
    across, up = in_order(row["column"] for row in rows), in_order(row["row"] for row in rows)
    if study == "bridges":
        across = range(max(sum(row["row"] == kind for row in rows) for kind in up))
    cells = np.full((len(up), len(across)), np.nan)
    count = dict.fromkeys(up, 0)
    for row in rows:
        column = count[row["row"]] if study == "bridges" else across.index(row["column"])
        count[row["row"]] += 1
        cells[up.index(row["row"]), column] = NAMES.index(row["verdict"])
        if study == "bridges":
            axes.text(column + 0.5, up.index(row["row"]) + 0.1, text(row["column"]), fontsize=5, ha="center", va="bottom", color="0.25")
    axes.pcolormesh(np.arange(len(across) + 1), np.arange(len(up) + 1), cells, cmap=COLOURS, vmin=-0.5, vmax=len(NAMES) - 0.5,
                    edgecolors="white", linewidth=0.5)
    for index, (_, mark, _) in enumerate(VERDICTS.values()):
        y, x = np.nonzero(cells == index)
        if mark and len(x):
            axes.scatter(x + 0.5, y + 0.6, marker=mark, s=12, linewidths=0.7, color="white" if NAMES[index] == "wrong" else "black")
    axes.set_yticks(np.arange(len(up)) + 0.5, [text(value) for value in up], fontsize=6)
    if study == "bridges":
        axes.set_xticks([])
    else:
        axes.set_xticks(np.arange(len(across)) + 0.5, [text(value) for value in across], fontsize=6, rotation=90)
    axes.tick_params(length=0)
    axes.set_title(title, fontsize=7, pad=2)


def main():
    folder, picture = places("packing-stability")
    tables = {study: rows_of(folder / f"packing-stability-{study}.csv") for study in STUDIES}
    groups = [(study, dimension, in_order(row["panel"] for row in rows if row["dimension"] == dimension))
              for study, rows in tables.items() for dimension in (2, 3)]
    places_of = [(study, dimension, name) for study, dimension, names in groups for name in names]
    if not places_of:
        print(f"  nothing drawn: {folder} has no table of a run")
        return
    columns = 6
    lines = -(-len(places_of) // columns)
    whole = plt.figure(figsize=(13, 1.75 * lines + 0.5), layout="constrained")
    legend, figure = whole.subfigures(2, 1, height_ratios=[0.4, 1.75 * lines])
    axes = figure.subplots(lines, columns, squeeze=False)
    for place in axes.flat:
        place.set_axis_off()
    for place, (study, dimension, name) in zip(axes.flat, places_of):
        place.set_axis_on()
        rows = [row for row in tables[study] if row["dimension"] == dimension and row["panel"] == name]
        head = f"{study}, {'disks' if dimension == 2 else 'spheres'}"
        panel(place, rows, head if name == study else f"{head}: {name}", study)
        place.set_ylabel(STUDIES[study][0], fontsize=6)
        place.set_xlabel(STUDIES[study][1], fontsize=6, labelpad=1)
    found = [row["verdict"] for rows in tables.values() for row in rows]
    handles = [Line2D([], [], linestyle="", marker="s", markersize=9, color=colour, label=f"{words} ({found.count(name)})")
               for name, (colour, _, words) in VERDICTS.items()]
    legend.legend(handles=handles, loc="center", ncols=len(handles), fontsize=9, frameon=False)
    save(whole, picture, dpi=110)


if __name__ == "__main__":
    main()
