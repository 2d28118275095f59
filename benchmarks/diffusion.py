"""Draws what the benchmark "diffusion" measured: error against processor time.

    /usr/bin/python3 benchmarks/diffusion.py [output=FOLDER] [picture=FILE]

FOLDER holds diffusion-heat.csv, diffusion-vapour.csv, diffusion-spheres.csv, or some of them (default: results/bench-diffusion); FILE is
FOLDER/diffusion.png unless told. `./dev bench diffusion` runs it after the measurements, with the benchmark's keys: others are no concern
of it.
"""

from drawing import error_against_time, front, panels_of, places, rows_of, save

TITLES = {
    "heat": "heat: disks 0.023 in 1",
    "vapour": "vapour: disks 1 in 0.004",
    "spheres": "spheres 10 in 1",
}
STYLES = {  # of a method: colour, marker
    "BGK stepping tau 1": ("tab:red", "v"),
    "BGK stepping tau 5": ("tab:orange", "^"),
    "TRT stepping": ("tab:purple", "s"),
    "steady": ("tab:blue", "o"),
    "pixels extrapolated": ("tab:cyan", "x"),
    "outlines": ("tab:green", "D"),
    "outlines extrapolated": ("k", "*"),
    "scipy CG": ("0.45", "P"),
    "scipy LU": ("0.65", "<"),
    "petsc AMG": ("tab:brown", "X"),
}
PEERS = ("scipy", "petsc")  # drawn with dots
DIAGONAL = ("d2q9", "d3q19")  # drawn with broken lines


def draw(axes, rows):
    points = [(row["cpu_seconds"], abs(row["error"])) for row in rows]
    for seconds, error in front(points):
        axes.plot(seconds, error, "o", color="gold", markersize=13, zorder=0)
    for method, stencil in dict.fromkeys((row["method"], row["stencil"]) for row in rows):
        of = [(row["cpu_seconds"], abs(row["error"])) for row in rows if (row["method"], row["stencil"]) == (method, stencil)]
        colour, marker = STYLES[method]
        diagonal = stencil in DIAGONAL
        line = ":" if method.startswith(PEERS) else "--" if diagonal else "-"
        axes.plot(*zip(*of), color=colour, marker=marker, markersize=5, linewidth=0.8, linestyle=line,
                  markerfacecolor="none" if diagonal else colour, label=f"{method}, {stencil.upper()}")


def main():
    folder, picture = places("diffusion")
    panels = {scene: rows_of(folder / f"diffusion-{scene}.csv") for scene in TITLES}
    panels = {scene: rows for scene, rows in panels.items() if rows}
    if not panels:
        print(f"  nothing drawn: {folder} has no table of a run")
        return
    figure, axes = panels_of(len(panels), (4.8, 5.4))
    for place, (scene, rows) in zip(axes, panels.items()):
        draw(place, rows)
        error_against_time(place, TITLES[scene], below=0.12)
    save(figure, picture, dpi=110)


if __name__ == "__main__":
    main()
