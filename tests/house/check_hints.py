#!/usr/bin/env python3
"""What the numerics and the filters say names settings, not options: shell, Python and ParaView show the same words.

Usage: check_hints.py SOURCES
"""

import pathlib
import re
import sys

LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]*|\blamella [a-z-]+ +(?:--|-[a-z]\b|[A-Z])")


def options(text):
    """(line, option) of string literals; comments say what they like."""
    text = re.sub(r"/\*.*?\*/", lambda found: "\n" * found[0].count("\n"), text, flags=re.DOTALL)
    for number, line in enumerate(text.splitlines(), 1):
        parts = LITERAL.split(line)
        for i, part in enumerate(parts):
            if i % 2 == 0 and "//" in part:  # the rest is a comment
                break
            if i % 2 == 1:
                yield from ((number, found) for found in OPTION.findall(part))


# The check of the check.
assert list(options('throw Error("loosen --tolerance");')) == [(1, "--tolerance")]
assert list(options('a;\nwarn("see \\"lamella convert FILE\\"", "--phase {}=NAME");')) == [(2, "lamella convert F"), (2, "--phase")]
assert not list(options('i--; // "--window"\n/* "--lumen" */ text = "a larger tolerance"; // --method\nrow("--");\n"a -- b"'))

sources = pathlib.Path(sys.argv[1])
files = [path for folder in ("solvers", "filters") for path in sorted((sources / folder).rglob("*")) if re.fullmatch(r"\.(h|cpp|cxx)", path.suffix)]
if not files:
    sys.exit(f"no source found in {sources}")
found = [f"{path.relative_to(sources)}:{line}: {option}" for path in files for line, option in options(path.read_text(encoding="utf-8"))]
if found:
    sys.exit("FAILED, these name an option of a command; say it in the words of the setting:\n  " + "\n  ".join(found))
print(f"{len(files)} files name no option")
