"""What a page of the documentation shows: its fenced blocks, and the marks before them.

A mark is an HTML comment on a line of its own right before a block, which readers of the page do not see:

    <!-- not run: reason -->       nothing of the block is run; it is counted and listed
    <!-- slow: reason -->          run only by the test of label `slow`
    <!-- not compared: reason -->  what is shown as output is not compared
    <!-- within 20 %: reason -->   of an output: numbers may be so far apart
    <!-- ends with 8 -->           the exit code of the last command of the block, where it is not 0

Blocks of `sh` are commands, `python` is Python, `console` both commands (after `$ `) and what they print. `text`, or no
word at all, is the output of a command in the blocks before it. A block behind the words "save as `name`:" is a file.
"""

import dataclasses
import re

MARK = re.compile(r"<!-- (not run|slow|not compared|within|ends with)(?: ([\d.]+)(?: %)?)?(?:: ([^>]*?))? -->")
REFERENCE = re.compile(r"^<!-- reference: made by", re.MULTILINE)


@dataclasses.dataclass
class Block:
    line: int  # of the page, at which it begins
    kind: str  # sh, python, output, file, other
    text: str
    name: str = ""  # of a file
    marks: dict = dataclasses.field(default_factory=dict)


def blocks(page):
    """The blocks of a page's text, in order. What a program made (the reference of Python) is none."""
    found = []
    reference = REFERENCE.search(page)
    page = page[: reference.start()] if reference else page
    for match in re.finditer(r"^( *)```([\w-]*)\n(.*?)^ *```$", page, re.MULTILINE | re.DOTALL):
        before = page[: match.start()].rstrip("\n").split("\n")
        marks = {}
        while before and (mark := MARK.fullmatch(before[-1].strip())):
            marks[mark[1]] = mark[2] if mark[1] in ("within", "ends with") else mark[3]
            before.pop()
        words = " ".join(before[-2:]).rstrip()
        saved = re.search(r"[Ss]ave[sd]? (?:it |this )?as `([\w./-]+)`:$", words)
        kind = {"sh": "sh", "console": "console", "python": "python", "": "output", "text": "output"}.get(match[2], "other")
        if saved:
            kind = "file"
        text = re.sub(rf"^{match[1]}", "", match[3], flags=re.MULTILINE)
        found.append(Block(page[: match.start()].count("\n") + 1, kind, text, saved[1] if saved else "", marks))
    return found


def commands(text):
    """The commands of a shell block: lines that a backslash, a pipe or && goes on from belong together."""
    found, lines = [], []
    for line in text.split("\n"):
        if not lines and (not line.strip() or line.lstrip().startswith("#")):
            continue
        lines.append(line)
        if not re.search(r"(\\|&&|\|)\s*$", line):
            found.append("\n".join(lines))
            lines = []
    return found + (["\n".join(lines)] if lines else [])


def console(text):
    """(command, output) of a block that shows both."""
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]
    found = []
    for part in parts:
        lines = part.split("\n")
        end = 1
        while lines[end - 1].rstrip().endswith(("\\", "&&", "|")):
            end += 1
        found.append(("\n".join(lines[:end]), "\n".join(lines[end:])))
    return found
