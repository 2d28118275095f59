"""What the studies share: options, tables, charts, broken bonds. They find it in the folder above their own."""

import argparse
import contextlib
import csv
import json
import os

import matplotlib

matplotlib.use("Agg")
import numpy as np  # noqa: E402
from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402


def parser_of(doc, output):
    """Options of a study: its first line, and the folder that it writes to."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--output", default=output, help="folder for pictures and tables (default: %(default)s)")
    return parser


def paper_numbers(paper, figure):
    """What a paper says in a figure, by what it says it for: the numbers that examples/PAPER/paper.json has with an "at"."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), paper, "paper.json"), encoding="utf-8") as file:
        figures = {one["number"]: one for one in json.load(file)["figures"]}
    return {row["at"]: row["paper"] for row in figures[figure]["comparison"] if "at" in row}


def write_csv(path, rows):
    """One row a dictionary, all with the keys of the first."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def write_figure(figure, path, **options):
    figure.savefig(path, **options)
    plt.close(figure)


@contextlib.contextmanager
def chart(path, xlabel, ylabel, xlim=(0, None), dpi=160):
    """Axes to draw curves on; with their labels and a legend they become the file ``path``. y begins at 0."""
    figure, axes = plt.subplots(figsize=(5.4, 4), constrained_layout=True)
    yield axes
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.set_xlim(*xlim)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=9)
    write_figure(figure, path, dpi=dpi)


def draw_bonds(axes, broken, scale=1.0, low=(0.0, 0.0), **style):
    """Broken bonds as lines, their places in metres by a factor, less ``low``."""
    start = (broken["position"] - broken["bond"] / 2) * scale - low
    axes.add_collection(LineCollection(np.stack([start, start + broken["bond"] * scale], axis=1), **style))
