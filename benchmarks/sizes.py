"""Draws what the benchmark "sizes" measured: processor time a node against the nodes along a side.

    /usr/bin/python3 benchmarks/sizes.py [output=FOLDER] [picture=FILE]

FOLDER holds sizes-diffusion.csv, sizes-bonds.csv and sizes-bonds-3d.csv (default: results/bench-sizes), each as far as it was
measured; FILE is FOLDER/sizes.png unless told. `./dev bench sizes` runs it after the measurements, with the benchmark's keys:
others are no concern of it.
"""

import statistics

from drawing import panels_of, places, rows_of, save

TITLES = {"diffusion": "diffusion, periodic volumes", "bonds": "bonds, pictures", "bonds-3d": "bonds, volumes"}


def main():
    folder, picture = places("sizes")
    tables = {name: rows_of(folder / f"sizes-{name}.csv") for name in TITLES}
    tables = {name: rows for name, rows in tables.items() if rows}
    if not tables:
        print(f"  nothing drawn: {folder} has no table of sizes")
        return
    figure, panels = panels_of(len(tables), (4.4, 3.4))
    for axes, (name, rows) in zip(panels, tables.items()):
        sides = [row["nodes_a_side"] for row in rows]
        costs = [row["cpu_microseconds_a_node"] for row in rows]
        middle = statistics.median(costs)
        for odd, mark, label in ((0, "o", "even"), (1, "D", "odd")):
            chosen = [(n, c) for n, c in zip(sides, costs) if n % 2 == odd]
            if chosen:
                axes.plot(*zip(*chosen), mark, markersize=4, label=label)
        axes.axhline(middle, color="0.6", linewidth=0.8)
        axes.axhline(1.5 * middle, color="0.6", linewidth=0.8, linestyle=":", label="1.5 of the median")
        axes.set_ylim(0, 1.1 * max(*costs, 1.5 * middle))
        axes.set_xlabel("nodes along a side")
        axes.set_title(TITLES[name], fontsize=10)
        axes.legend(fontsize=7)
    panels[0].set_ylabel("processor time a node [µs]")
    save(figure, picture)


if __name__ == "__main__":
    main()
