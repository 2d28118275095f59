"""Whether a page shows what a command prints.

Lines must be the same, but for

- white space: runs of it count as one space, and empty lines as none;
- `…`: on a line of its own it stands for any lines, elsewhere for any words;
- what no two runs have in common: times, memory, rates, versions, dates, and the folder the test runs in;
- numbers: they agree to the digits that the page shows, to one unit of the last of them; whole numbers exactly, but for
  one above 1e5 whose last digits happened to be zeros (136710 beside 136710.1), one above 1e5 with a unit behind it, whose
  last digit depends on the processor (1775403 Pa), and
  counts of iterations and steps, which may differ by one in ten. Below 1e-5 numbers are what round-off leaves of 0 or what a
  tolerance leaves of a residual, and only have to be below that. `within` says how far apart they may be instead.
"""

import difflib
import re

NUMBER = re.compile(r"(?<![\w.])[-−+]?\d{1,3}(?: \d{3})+(?![\d.])|(?<![\w])[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\d])")
SMALL = 1e-5
COUNTS = re.compile(r"\b(?:iterations|steps|iteration|events?, strict)\b")
UNIT = re.compile(r" (?:Pa|N|J|W)\b")

MASKS = (
    (re.compile(r"\d+(?:\.\d+)?(?:e[-+]\d+)? (?:s|ms|µs|min|h)(?=[\s,;:.)]|$)"), "<time>"),
    (re.compile(r"\d[\d ]*(?:\.\d+)? (?:bytes|[kMG]i?B)\b"), "<memory>"),
    (re.compile(r"\d[\d.]*(?: million| billion)? (?:points|updates|nodes) a second"), "<rate>"),
    (re.compile(r"\blamella \d+\.\d+\.\d+\S*(?: \(.*\))?"), "<version>"),
    (re.compile(r"\b\d{4}-\d\d-\d\d(?:T[\d:]+Z?)?"), "<date>"),
    (re.compile(r"(?<![.\w])(?=\w*[a-f])[0-9a-f]{12,64}(?:-dirty)?\b"), "<hash>"),
    (re.compile(r"\b\d+ threads?\b"), "<threads>"),
    (re.compile(r"^\[[#.]*\].*$"), ""),  # a progress bar
)


def masked(text, folder=""):
    """Lines of words, without what no two runs have in common."""
    if folder:
        text = text.replace(folder + "/", "").replace(folder, ".")
    found = []
    for line in text.replace("\u202f", " ").replace("\u00a0", " ").split("\n"):
        line = line.split("\r")[-1]
        for pattern, word in MASKS:
            line = pattern.sub(word, line)
        line = " ".join(line.split())
        if line:
            found.append(line)
    return found


def value(text):
    return float(text.replace("−", "-").replace(" ", ""))


def last_place(text):
    """One unit of the last digit shown; 0 of a whole number."""
    mantissa, _, exponent = text.replace(" ", "").partition("e")
    places = len(mantissa.partition(".")[2])
    if not places and not exponent:
        return 0
    return 10 ** (int(exponent or 0) - places)


def same_number(shown, found, share, count, measured):
    a, b = value(shown), value(found)
    if abs(a) < SMALL and abs(b) < SMALL and a * b != 0 or a == b:
        return True
    if share is not None:
        return abs(a - b) <= share * max(abs(a), abs(b)) + last_place(shown)
    if count:
        return abs(a - b) <= max(1, 0.1 * abs(a))
    place = last_place(shown) or (last_place(found) or measured if abs(a) > 1e5 else 0)
    return abs(a - b) <= 1.000001 * place


def same_line(shown, found, share=None):
    pattern, numbers = "", []
    position = 0
    for match in re.finditer(NUMBER.pattern + "|…", shown):
        pattern += re.escape(shown[position:match.start()])
        if match[0] == "…":
            pattern += ".*"
        else:
            pattern += f"({NUMBER.pattern})"
            behind = shown[match.end(): match.end() + 20]
            numbers.append((match[0], bool(COUNTS.search(behind)), bool(UNIT.match(behind))))
        position = match.end()
    # aligned columns may have room or none before a number of another length
    pattern = (pattern + re.escape(shown[position:])).replace(r"\ ", r"\s*")
    got = re.fullmatch(pattern, found)
    return bool(got) and all(same_number(a, b, share, count, unit) for (a, count, unit), b in zip(numbers, got.groups()))


def difference(shown, printed, folder="", share=None):
    """(how much of it differs, 0 … 1, what differs as text): (0, "") where a page shows what was printed."""
    want, have = masked(shown, folder), masked(printed, folder)
    # reach: at which lines of what was printed the lines so far can end
    reach = {0}
    for line in want:
        if line == "…":
            reach = set(range(min(reach), len(have) + 1)) if reach else reach
        else:
            reach = {i + 1 for i in reach if i < len(have) and same_line(line, have[i], share)}
        if not reach:
            break
    if len(have) in reach:
        return 0, ""
    lines = difflib.unified_diff(want, have, "the page", "the command", lineterm="", n=1)
    return 1 - difflib.SequenceMatcher(None, " ".join(want).split(), " ".join(have).split()).ratio(), "\n".join(lines)
