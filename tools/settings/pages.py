"""Writes the tables of settings into the pages of docs/filters: between the lines

    <!-- settings: vtkX vtkY -->
    <!-- end of settings -->

stand, of the class that the page is named after, the settings that these classes declare.
"""

import math
import pathlib
import re

from headers import HeaderError

BLOCK = re.compile(r"<!-- settings: ([\w ]+) -->\n.*?<!-- end of settings -->\n", re.DOTALL)


def number(value):
    """As people write it: 1e-8, 0.3, -1."""
    text = f"{value:g}" if float(f"{value:g}") == value else repr(value)
    return re.sub(r"e([+-])0*(\d)", lambda found: "e" + found[1].replace("+", "") + found[2], text)


def limits(setting):
    """What a number can be."""
    if setting.choices:
        return ", ".join(choice.word for choice in setting.choices)
    low, high = setting.range.low, setting.range.high
    if setting.kind == "switch" or not (math.isfinite(low) or math.isfinite(high)):
        return ""
    above = f"above {number(low)}" if setting.range.low_open else number(low)
    if not math.isfinite(high):
        return above if setting.range.low_open else f"{above} or more"
    below = f"below {number(high)}" if setting.range.high_open else number(high)
    return f"{above}, up to {below}" if setting.range.low_open else f"{above} to {below}"


def default(setting):
    if setting.kind == "list":
        return "none"
    if setting.kind == "choice":
        word = next(choice.word for choice in setting.choices if choice.value == setting.default)
        return word + (f"; {setting.panel} in a panel" if setting.panel else "")
    if setting.kind == "switch":
        return ("on" if setting.default else "off") + (f"; {setting.panel} in a panel" if setting.panel else "")
    if setting.kind == "vector":
        return ", ".join(map(number, setting.default or ())) or "none"
    return number(setting.default) if setting.kind in ("whole", "number") else setting.default or "none"


def text(setting):
    """What it does, its unit, and what its words mean where they do not say so themselves."""
    told = setting.text.rstrip(".").replace("^2", "²").replace("^3", "³")
    unit = f" [{setting.unit}]" if setting.unit and f"[{setting.unit}]" not in told else ""
    meanings = "; ".join(f"{choice.word}: {choice.text}" for choice in setting.choices if choice.text)
    return (told + unit + (f". {meanings[0].upper()}{meanings[1:]}" if meanings else "")).replace("|", "\\|")


def table(declarations, name, owners):
    rows = ["| property | in Python | default | | |", "|---|---|---|---|---|"]
    for setting in declarations.settings(name):
        if setting.owner in owners:
            rows.append(f"| {setting.name} | `{setting.keyword}` | {default(setting)} | {limits(setting)} | {text(setting)} |")
    return "\n".join(rows) + "\n"


def written(declarations, path):
    """The page with its tables as the headers have them."""
    name = "vtk" + path.stem

    def block(found):
        unknown = [owner for owner in found[1].split() if owner not in declarations.classes]
        if unknown:
            raise HeaderError(f"{path}: there is no class {unknown[0]}")
        return f"<!-- settings: {found[1]} -->\n{table(declarations, name, found[1].split())}<!-- end of settings -->\n"

    return BLOCK.sub(block, path.read_text(encoding="utf-8"))


def write(declarations, folder):
    for path in sorted(pathlib.Path(folder).glob("*.md")):
        page = written(declarations, path)
        if page != path.read_text(encoding="utf-8"):
            path.write_text(page, encoding="utf-8")
