"""Every figure of Perré, Almeida, Ayouz and Frank 2016 that Lamella can make, on one page beside what the paper says.

    PYTHONPATH=build/python /usr/bin/python3 examples/perre-2016/run.py

Runs the studies of examples/ that make them, each once: a run that was interrupted goes on with the study that it was at. With
LAMELLA_REAL_DATA real outlines of spruce as well. Writes to --output a folder for each study and report.html, the page. paper.json says what
the paper says, and which study makes what.
"""

import os
import sys

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import papers  # noqa: E402
from papers import number, rows_where, the_row  # noqa: E402


def seconds_a_value(quantity):
    def mean(tables):
        times = [number(row["seconds"]) for row in rows_where(tables("diffusion", "values.csv"), quantity=quantity)]
        return sum(times) / len(times)

    return mean


def stiffness_ratio(sample):
    """Radial over tangential, by the implicit solve."""

    def ratio(tables):
        radial, tangential = (the_row(tables("compression", "stiffness.csv"), sample=sample, direction=way) for way in "RT")
        return number(radial["implicit_MPa"]) / number(tangential["implicit_MPa"])

    return ratio


def longest_test(tables):
    return max(number(row["total_s"]) for row in tables("compression", "stiffness.csv")) / 60


def reach(tissue):
    """In how many of a hundred samples the crack leads from the notch to the other side."""
    return lambda tables: 100 * number((row := the_row(tables("fracture", "tissues.csv"), tissue=tissue))["reach"]) / number(row["samples"])


DERIVED = {
    "heat_seconds": seconds_a_value("heat"),
    "vapour_seconds": seconds_a_value("vapour"),
    "earlywood_stiffness_ratio": stiffness_ratio("earlywood"),
    "latewood_stiffness_ratio": stiffness_ratio("latewood"),
    "poplar_stiffness_ratio": stiffness_ratio("poplar"),
    "longest_test": longest_test,
    "earlywood_reach": reach("earlywood"),
    "latewood_reach": reach("latewood"),
}

if __name__ == "__main__":
    papers.main(__doc__, __file__, DERIVED)
