#!/usr/bin/env python3
"""Prints what `lamella diffusion --json` found, each answer between its bounds.

Usage: table.py NAME=FILE.json...
"""

import json
import sys


def percent(share):
    return "unknown" if share is None else f"{100 * share:.2g} %"


def rows(name, result):
    """One row a direction: name, direction, series, Hashin and Shtrikman's lower, answer, their upper, parallel, estimated error."""
    bounds = result["bounds"]
    low, high = bounds["hashin_shtrikman"]
    for axis, value in result["effective"].items():
        numbers = (bounds["series"], low, value, high, bounds["parallel"])
        yield (name, axis, *(f"{number:.4f}" for number in numbers), percent(result["estimated_errors"][axis]))


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.strip())
    table = [("", "", "series", "HS lower", "answer", "HS upper", "parallel", "error")]
    for argument in sys.argv[1:]:
        name, _, path = argument.partition("=")
        with open(path, encoding="utf-8") as file:
            table.extend(rows(name, json.load(file)))
    widths = [max(len(row[column]) for row in table) for column in range(len(table[0]))]
    for row in table:
        cells = [text.ljust(width) if column < 2 else text.rjust(width)
                 for column, (text, width) in enumerate(zip(row, widths))]
        print("  " + "  ".join(cells).rstrip())
    print("\n  series and parallel bound every material of these phases; Hashin and Shtrikman (HS) isotropic media alone, and wood is none;"
          "\n  error: against the material, estimated from every second, third and fourth pixel")


if __name__ == "__main__":
    main()
