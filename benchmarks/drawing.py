"""What the benchmarks' drawings share: words of the command line, tables, axes of error against time."""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def places(bench):
    """Folder of the tables and file of the picture, by output=FOLDER and picture=FILE; other words are the benchmark's."""
    keys = dict(argument.partition("=")[::2] for argument in sys.argv[1:])
    folder = pathlib.Path(keys.get("output", f"results/bench-{bench}"))
    return folder, pathlib.Path(keys.get("picture", folder / f"{bench}.png"))


def number(text):
    try:
        return float(text)
    except ValueError:
        return text or None


def rows_of(path):
    """Of a table: numbers where they are, None where there is nothing; no row where there is no table."""
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]


def front(points):
    """The points below which no other is: none as fast errs less. Of the same error to 1 % the faster counts."""
    best = []
    for seconds, error in sorted(points):
        if not best or error < 0.99 * best[-1][1]:
            best.append((seconds, error))
    return best


def panels_of(count, size):
    """A figure of panels side by side. @param size of each, inches"""
    figure, axes = plt.subplots(1, count, figsize=(size[0] * count, size[1]), constrained_layout=True, squeeze=False)
    axes[0][0].set_ylabel("relative error")
    return figure, axes[0]


def error_against_time(axes, title, below=None):
    """Axes and legend of a panel that has its curves. @param below place of the legend under the panel, share of its height"""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("processor time [s]")
    axes.set_title(title, fontsize=10)
    if below is None:
        axes.legend(fontsize=7)
    else:
        axes.legend(fontsize=7, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -below))


def save(figure, picture, dpi=130):
    figure.savefig(picture, dpi=dpi)
    print(f"  written: {picture}")
