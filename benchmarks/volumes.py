"""Draws what the benchmark "volumes" measured: error against processor time, of ours and of other programs.

    /usr/bin/python3 benchmarks/volumes.py [output=FOLDER] [picture=FILE]

FOLDER holds volumes-spheres.csv and volumes-pores.csv, or one of them (default: results/bench-volumes); FILE is FOLDER/volumes.png unless told.
The error of a size is drawn as the largest of that size and all larger ones that the method reached, for the last size with the one before: a
single small one is a change of sign.
Says whose points lie below our own front. `./dev bench volumes` runs it after the measurements.
"""

from drawing import error_against_time, front, panels_of, places, rows_of, save

TITLES = {
    "spheres": "spheres 10 in 1",
    "pores": "pores 1 between spheres that insulate",
}
OURS = {  # of a method: colour, marker
    "voxels": ("tab:blue", "o"),
    "voxels extrapolated": ("tab:cyan", "x"),
    "shares": ("tab:green", "D"),
    "shares extrapolated": ("k", "*"),
}
PEERS = {
    "OpenPNM": ("0.6", "<"),
    "OpenPNM AMG": ("tab:brown", "X"),
    "PoreSpy": ("tab:purple", "s"),
    "PuMA": ("tab:red", "P"),
    "TauFactor": ("tab:orange", "^"),
}
FITTED = " fitted"  # drawn hollow


def for_good(rows, method):
    """(seconds, error) by size, the error with those of larger sizes."""
    of = sorted((row for row in rows if row["method"] == method), key=lambda row: row["nodes"])
    errors = [abs(row["error"]) for row in of]
    return [(row["cpu_seconds"], max(errors[min(i, len(of) - 2) :] if i else errors)) for i, row in enumerate(of)]


def draw(axes, scene, rows):
    ours = front([point for method in OURS for point in for_good(rows, method)])
    axes.plot(*zip(*ours), "o", color="gold", markersize=13, zorder=0)
    for method, (colour, marker) in OURS.items():
        axes.plot(*zip(*for_good(rows, method)), color=colour, marker=marker, markersize=5, linewidth=0.8, label=method)
    for method in dict.fromkeys(row["method"] for row in rows):
        peer = method.removesuffix(FITTED)
        if peer not in PEERS:
            continue
        colour, marker = PEERS[peer]
        points = for_good(rows, method)
        axes.plot(*zip(*points), color=colour, marker=marker, markersize=5, linewidth=0.8, linestyle=":",
                  markerfacecolor="none" if method != peer else colour, label=method)
        below = [point for point in points if not any(seconds <= point[0] and error <= point[1] for seconds, error in ours)]
        for seconds, error in below:
            print(f"  {scene}: {method} lies below our front, {error:.2g} in {seconds:.3g} s")


def main():
    folder, picture = places("volumes")
    panels = {scene: rows_of(folder / f"volumes-{scene}.csv") for scene in TITLES}
    panels = {scene: rows for scene, rows in panels.items() if rows}
    if not panels:
        print(f"  nothing drawn: {folder} has no table of a run")
        return
    figure, axes = panels_of(len(panels), (5.2, 5.4))
    for place, (scene, rows) in zip(axes, panels.items()):
        draw(place, scene, rows)
        error_against_time(place, TITLES[scene], below=0.12)
    save(figure, picture, dpi=110)


if __name__ == "__main__":
    main()
