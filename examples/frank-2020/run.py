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


def slope(part):
    """Of the strength over saturation, on straight lines between measured points: 0 from the least saturation to 0.4, 1 from there to 0.9."""

    def between(tables):
        means = tables("strength", "fracture-means.csv")
        saturation, strength = column(means, "saturation"), column(means, "strength")
        low, high = ((saturation[0], 0.4), (0.4, 0.9))[part]
        return float(np.diff(np.interp((low, high), saturation, strength))[0] / (high - low))

    return between


def theta_slope(width, other):
    """Of the tails' rate over saturation between two widths of the bridges."""

    def between(tables):
        low, high = (the_row(tables("stress", "stress-means.csv"), width=one) for one in (width, other))
        return (number(high["theta"]) - number(low["theta"])) / (number(high["saturation"]) - number(low["saturation"]))

    return between


def bond_exponent(tables):
    """Exponent of the power law through the numbers of bonds of a node; a run of one horizon has none."""
    table = [row for row in tables("griffith", "horizons.csv") if number(row["horizon"]) <= 6]
    return np.polyfit(np.log(column(table, "horizon")), np.log(column(table, "bonds")), 1)[0] if len(table) > 1 else np.nan


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


def of_packings(name):
    return lambda tables: spread(column(tables("grains", "packings.csv"), name))


DERIVED = {
    "runs": lambda tables: len(tables("griffith", "runs.csv")),
    "packings": lambda tables: len(tables("grains", "packings.csv")),
    "bond_exponent": bond_exponent,
    "aspect": of_packings("aspect"),
    "contact_anisotropy": of_packings("fabric_anisotropy"),
    "force_anisotropy": of_packings("stress_anisotropy"),
    "pores_fall": over("grains", "means.csv", "pores", 0.25, 1.25),
    "mean_area_fall": over("grains", "means.csv", "mean_area", 0.25, 1.25),
    "largest_area_fall": over("grains", "means.csv", "largest_area", 0.25, 1.25),
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
    "slope_low": slope(0),
    "slope_middle": slope(1),
    "theta_low": theta_slope(0.25, 0.75),
    "theta_middle": theta_slope(0.75, 1),
    "theta_high": theta_slope(1, "filled"),
}

if __name__ == "__main__":
    papers.main(__doc__, __file__, DERIVED)
