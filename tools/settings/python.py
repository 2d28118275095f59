"""Makes lamella/_declared.py: what the keywords of the package's functions are called, and what is said of them."""

import math
import pathlib
import textwrap

HEAD = '''"""Made from the headers of the classes: their settings, by class, as _settings.py takes them:
keyword, setter, kind, types, default, words, columns, word of a command, hint of its type, docstring, what it counts with
(keyword of the other setting, its values, and how people say so), the last number of a vector where it is left out, and which of its parts may be. WITHOUT: keywords of bases that make no sense for a class."""

'''
HINTS = {"whole": "int", "number": "float", "switch": "bool", "choice": "str", "text": "str | None", "file": "Path | None"}


def hint(setting):
    if setting.kind == "list":
        if len(setting.types) == 1:
            return "Names | None" if setting.types[0] == "text" else "ArrayLike"
        if setting.types[0] == "text":
            return "Pairs | None" if setting.columns[:1] == ["Bonds"] else "Mapping | None"
        return "Sequence[ArrayLike]"
    if axes(setting):
        return "str"
    if setting.kind == "vector":
        return "Sequence[int]" if setting.types[0] == "whole" else "Sequence[float]"
    if setting.names:
        return "int | str"
    return "int" if setting.kind == "choice" and setting.choices[0].word.isdigit() else HINTS[setting.kind]


def axes(setting):
    """Three flags, one an axis."""
    return setting.kind == "vector" and setting.columns == ["x", "y", "z"] and (setting.range.low, setting.range.high) == (0, 1)


def default(setting):
    if setting.kind == "list":
        return () if setting.types[0] != "text" else None
    if setting.kind == "choice":
        word = next(choice.word for choice in setting.choices if choice.value == setting.default)
        return int(word) if word.isdigit() else word
    if axes(setting):
        return "".join(axis for axis, flag in zip("xyz", setting.default) if flag)
    if setting.kind in ("text", "file"):
        return setting.default or None
    return tuple(setting.default) if isinstance(setting.default, list) else setting.default


def lines(setting):
    """Rows of a docstring: the keyword, then what it does, under each other."""
    text = setting.text
    words = ", ".join(f'"{choice.word}"' for choice in setting.choices)
    if setting.choices and not all(choice.word.isdigit() for choice in setting.choices):
        text = f"{text} One of {words}."
    if setting.unit and f"[{setting.unit}]" not in text:
        text = f"{text.rstrip('.')} [{setting.unit}]."
    return textwrap.wrap(text, 116, initial_indent=f"{setting.keyword:<15} ", subsequent_indent=" " * 16)


def write(declarations, path):
    text = HEAD + "BASES = {\n" + "".join(f"    {name!r}: {kind.base!r},\n" for name, kind in declarations.classes.items()
                                        if kind.base in declarations.classes) + "}\n\nCLASSES = {\n"
    for name, kind in declarations.classes.items():
        text += f"    {name!r}: (\n"
        for setting in declarations.own(name):
            words = {choice.word: choice.value for choice in setting.choices} or {name: int(value) for value, name in setting.names} or None
            other = declarations.other(name, setting) if setting.when else None
            when = (other[0].keyword, tuple(other[1]), other[2]) if other else None
            row = (setting.keyword, setting.setter, "axes" if axes(setting) else setting.kind, setting.types, default(setting), words,
                   tuple(setting.columns), setting.word, hint(setting), lines(setting), when,
                   "same" if setting.rest == math.inf else setting.rest, setting.flat)
            text += f"        {row!r},\n"
        text += "    ),\n"
    text += "}\n\nWITHOUT = {\n"
    for name, kind in declarations.classes.items():
        if kind.without:
            bases = {setting.name: setting.keyword for setting in declarations.settings(kind.base)}
            text += f"    {name!r}: {tuple(bases[left] for left in kind.without)!r},\n"
    pathlib.Path(path).write_text(text + "}\n", encoding="utf-8")
