"""Every figure of Frank, Radjai, Nezamabadi and Delenne 2020 that Lamella can make, on one page beside what the paper says.

    PYTHONPATH=build/python /usr/bin/python3 examples/frank-2020/run.py

Runs the studies of examples/ that make them, each once: a run that was interrupted goes on with the study that it was at. Writes to --output
a folder for each study and report.html, the page. paper.json says what the paper says, and which study makes what.
"""

import os
import sys

import numpy as np

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import papers  # noqa: E402
from papers import number, the_row  # noqa: E402


def column(table, name):
    return np.array([number(row[name]) for row in table])


def over(study, file, name, width, other):
    """A column's mean at one width of the bridges over that at another."""

    def ratio(tables):
        means = tables(study, file)
        return number(the_row(means, width=width)[name]) / number(the_row(means, width=other)[name])

    return ratio


def slopes(tables):
    """Slope of the strength over saturation from 0.4 to 0.9, over that from none to 0.4."""
    means = tables("strength", "fracture-means.csv")
    saturation, strength = (np.append(0.0, column(means, name)) for name in ("saturation", "strength"))
    none, low, high = np.interp((0.0, 0.4, 0.9), saturation, strength)
    return (high - low) / 0.5 / ((low - none) / 0.4)


def inside_grains(tables):
    """Broken bonds within grains of all that broke, in per cent."""
    samples = tables("strength", "fracture-samples.csv")
    broken = column(samples, "broken")
    return 100 * np.sum(broken * column(samples, "inside_grains")) / np.sum(broken)


def spread(values):
    """Mean and standard deviation."""
    return np.mean(values), np.std(values, ddof=1) if len(values) > 1 else np.nan


def first_break(tables):
    samples = tables("strength", "fracture-samples.csv")
    return spread(column(samples, "first_break") / column(samples, "strength"))


def aspect(tables):
    return spread(column(tables("grains", "packings.csv"), "aspect"))


DERIVED = {
    "runs": lambda tables: len(tables("griffith", "runs.csv")),
    "packings": lambda tables: len(tables("grains", "packings.csv")),
    "aspect": aspect,
    "pores_before": over("grains", "means.csv", "pores", 0.5, 0.25),
    "pores_middle": over("grains", "means.csv", "pores", 0.75, 0.5),
    "pores_after": over("grains", "means.csv", "pores", 1.25, 0.75),
    "largest_before": over("grains", "means.csv", "largest_area", 0.75, 0.25),
    "largest_after": over("grains", "means.csv", "largest_area", 1.25, 0.75),
    "mean_before": over("grains", "means.csv", "mean_area", 0.75, 0.25),
    "mean_after": over("grains", "means.csv", "mean_area", 1.25, 0.75),
    "stiffening": over("strength", "fracture-means.csv", "modulus", "filled", 0.25),
    "first_break": first_break,
    "inside_grains": inside_grains,
    "doubling": over("strength", "fracture-means.csv", "strength", "filled", 1),
    "levelling": slopes,
    "theta_before": over("stress", "stress-means.csv", "theta", 1, 0.25),
    "theta_after": over("stress", "stress-means.csv", "theta", "filled", 1),
}

if __name__ == "__main__":
    papers.main(__doc__, __file__, DERIVED)
