"""Draws what the benchmark "diffusion-stability" found: a cell for each run, its colour and mark the verdict.

    /usr/bin/python3 benchmarks/diffusion-stability.py [output=FOLDER] [picture=FILE]

FOLDER holds diffusion-stability-stepping.csv, -long.csv, -steady.csv, -outlines.csv and -pictures.csv, or some of them (default:
results/bench-diffusion-stability); FILE is FOLDER/diffusion-stability.png unless told. `./dev bench diffusion-stability` runs it after the
runs, with the benchmark's keys: others are no concern of it.
"""

import csv

import numpy as np
from drawing import places, plt, rows_of, save
from matplotlib.colors import ListedColormap
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D

# colours that differ in lightness too, and a mark each: no eye needs the hue
VERDICTS = {
    "right": ("#a9cfe8", None, "right"),
    "slow": ("#f0e442", ".", "not at rest yet, and says so"),
    "warned": ("#e69f00", "$!$", "off, after a warning or by its own error bar"),
    "refused": ("#c8c8c8", "_", "refused by name"),
    "wrong": ("#000000", "x", "wrong, and silent"),
}
NAMES = list(VERDICTS)
COLOURS = ListedColormap([colour for colour, _, _ in VERDICTS.values()])
KINDS = {"stepping": "step", "long": "step", "steady": "steady"}


def power(value):
    """0, 1, 10, or a power of ten."""
    if value in (0, 1):
        return f"{value:g}"
    exponent = np.log10(value)
    return f"$10^{{{exponent:.0f}}}$" if abs(exponent - round(exponent)) < 1e-9 else f"{value:g}"


def in_order(rows, key):
    return list(dict.fromkeys(row[key] for row in rows))


def panel(axes, rows, columns):
    """One picture and method: contrasts upwards, what else differs to the right."""
    contrasts = sorted(in_order(rows, "contrast"))
    cells = np.full((len(contrasts), len(columns)), np.nan)
    for row in rows:
        cells[contrasts.index(row["contrast"]), columns.index(row["column"])] = NAMES.index(row["verdict"])
    axes.pcolormesh(np.arange(len(columns) + 1), np.arange(len(contrasts) + 1), cells, cmap=COLOURS, vmin=-0.5, vmax=len(NAMES) - 0.5,
                    edgecolors="white", linewidth=0.4)
    for index, (_, mark, _) in enumerate(VERDICTS.values()):
        y, x = np.nonzero(cells == index)
        if mark and len(x):
            axes.scatter(x + 0.5, y + 0.5, marker=mark, s=9, linewidths=0.7, color="white" if NAMES[index] == "wrong" else "black")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.tick_params(length=0, labelsize=6)
    return contrasts


def label_contrasts(axes, contrasts):
    axes.set_yticks(np.arange(len(contrasts)) + 0.5, [power(c) if i % 2 == 0 or c == 1 else "" for i, c in enumerate(contrasts)])


def label_columns(axes, labels):
    axes.set_xticks(np.arange(len(labels)) + 0.5, labels, rotation=90 if max(map(len, labels)) > 6 else 0)


def words(name):
    return name.upper() if name[:1] == "d" and name[1:2].isdigit() else name


def icon(axes, name, rows):
    """The picture itself, the second phase dark."""
    axes.set_axis_off()
    axes.set_title(name.replace(" ", "\n", 1), fontsize=7, pad=2)
    if rows:
        pixels = np.array([[int(pixel) for pixel in row] for row in rows.split("/")])
        axes.imshow(pixels, cmap="Greys", vmin=-0.35, vmax=1.2)
        high, wide = pixels.shape
        axes.add_patch(plt.Rectangle((-0.5, -0.5), wide, high, fill=False, edgecolor="0.3", linewidth=0.5))
        centre = ((wide - 1) / 2, (high - 1) / 2)  # pixels alike in all icons
        axes.set_xlim(centre[0] - 6, centre[0] + 6)
        axes.set_ylim(centre[1] + 4.5, centre[1] - 4.5)


def draw_lattices(figure, tables, pictures):
    """Rows: methods and lattices; columns: pictures."""
    rows = [dict(row, study=study) for study in KINDS for row in tables[study]]
    kinds = list(dict.fromkeys((KINDS[row["study"]], row["method"], row["lattice"]) for row in rows))
    across = in_order(rows, "picture")
    axes = figure.subplots(len(kinds) + 1, len(across), squeeze=False, gridspec_kw=dict(height_ratios=[0.9] + [1] * len(kinds)))
    for column, name in enumerate(across):
        icon(axes[0, column], name, pictures.get(name))
    for line, (kind, method, lattice) in enumerate(kinds, 1):
        last = line == len(kinds) or kinds[line][0] != kind
        for column, name in enumerate(across):
            place = axes[line, column]
            of = [row for row in rows if (KINDS[row["study"]], row["method"], row["lattice"], row["picture"]) == (kind, method, lattice, name)]
            if not of:
                place.set_axis_off()
                continue
            columns = in_order(of, "column")
            contrasts = panel(place, of, columns)
            if column == 0:
                label_contrasts(place, contrasts)
                place.set_ylabel(f"{method.upper() if kind == 'step' else method}\n{words(lattice)}", fontsize=8)
            if last and kind == "step":
                label_columns(place, [power(value) if k % 2 == 0 else "" for k, value in enumerate(columns)])
                place.set_xlabel("τ − ½", fontsize=7, labelpad=1)
            elif last:
                short = {"insulated": "ins.", "periodic": "per.", "multigrid": "MG", "algebraic-multigrid": "AMG"}
                label_columns(place, [" ".join(short.get(word, word) for word in text.split()) for text in columns])


def draw_outlines(figure, rows):
    across = in_order(rows, "picture")
    axes = figure.subplots(1, len(across), squeeze=False)[0]
    for place, name in zip(axes, across):
        of = [row for row in rows if row["picture"] == name]
        columns = in_order(of, "column")
        contrasts = panel(place, of, columns)
        label_columns(place, [f"{value:g}" for value in columns])
        place.set_title(name, fontsize=7, pad=2)
        place.set_xlabel("nodes across", fontsize=7, labelpad=1)
        if place is axes[0]:
            label_contrasts(place, contrasts)
            place.set_ylabel("outlines\nD2Q5", fontsize=8)


def main():
    folder, picture = places("diffusion-stability")
    tables = {study: rows_of(folder / f"diffusion-stability-{study}.csv") for study in (*KINDS, "outlines")}
    if not any(tables.values()):
        print(f"  nothing drawn: {folder} has no table of a run")
        return
    with open(folder / "diffusion-stability-pictures.csv", newline="", encoding="utf-8") as file:
        pictures = {row["picture"]: row["rows"] for row in csv.DictReader(file)}
    lattices = len({(row["method"], row["lattice"]) for study in KINDS for row in tables[study]})
    heights = [0.35, 0.9 + 0.95 * lattices if lattices else 0, 1.6 if tables["outlines"] else 0]
    figure = plt.figure(figsize=(13, sum(heights)), layout="constrained")
    legend, *parts = figure.subfigures(sum(map(bool, heights)), 1, height_ratios=[height for height in heights if height])
    if heights[1]:
        draw_lattices(parts[0], tables, pictures)
        parts[0].supylabel("first phase (light) over second (dark)", fontsize=9)
    if heights[2]:
        draw_outlines(parts[-1], tables["outlines"])
        parts[-1].supylabel("lumen over wall", fontsize=9)
    found = [row["verdict"] for rows in tables.values() for row in rows]
    handles = []
    for name, (colour, mark, text) in VERDICTS.items():
        square = Line2D([], [], linestyle="", marker="s", markersize=10, color=colour)
        inside = Line2D([], [], linestyle="", marker=mark or "", markersize=5, color="white" if name == "wrong" else "black")
        handles.append(((square, inside), f"{text} ({found.count(name)})"))
    legend.legend(*zip(*handles), loc="center", ncols=len(handles), fontsize=9, frameon=False, handler_map={tuple: HandlerTuple(ndivide=1)})
    save(figure, picture, dpi=110)


if __name__ == "__main__":
    main()
