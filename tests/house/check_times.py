#!/usr/bin/env python3
"""What a study takes stands in one place, "processor_seconds" of examples/*/paper.json; the pages that say it too say the same.

Usage: check_times.py SOURCES [--write]

A study's row in the table of examples/README.md, where it has one, has its time as "24 min of processor time"; so has the row of the paper, the
sum of its studies. Besides, a page of examples/ may say "24 min of processor time in all" of the one study or paper whose command it shows first; other
times on a page are its own. --write puts the numbers of paper.json there.
"""

import json
import pathlib
import re
import sys

sources = pathlib.Path(sys.argv[1]).resolve()
write = "--write" in sys.argv[2:]
examples = sources / "examples"
sys.path.append(str(examples))
sys.dont_write_bytecode = True
from papers import minutes  # noqa: E402

TIME = r"\d(?:[\d ]*\d)?\s(?:s|min)\s+of\s+processor\s+time"  # also across the end of a line
COMMAND = r"examples/([\w-]+/\w+\.py)"

seconds = {}
for path in sorted(examples.glob("*/paper.json")):
    paper = json.loads(path.read_text(encoding="utf-8"))
    seconds |= {study["script"]: study["processor_seconds"] for study in paper["studies"].values()}
    seconds[path.parent.name + "/run.py"] = sum(study["processor_seconds"] for study in paper["studies"].values())
said = {script: f"{minutes(time)} of processor time" for script, time in seconds.items()}

wrong, lacking, rows = [], [], set()


def mend(path, text, script, pattern):
    """The text with the time of a script where the pattern has another one."""
    for found in re.findall(pattern, text):
        found = " ".join(found.split())
        if not found.startswith(said[script]):
            wrong.append(f"{path.relative_to(sources)}: '{found}', and paper.json has {said[script]} for {script}")
    return re.sub(pattern, lambda match: re.sub(TIME, said[script], match[0]), text)


for path in sorted(examples.rglob("*.md")):
    text = path.read_text(encoding="utf-8")
    lines = text.split("\n")
    if path == examples / "README.md":
        for i, line in enumerate(lines):
            script = re.search(COMMAND + "`", line)
            if line.startswith("|") and script and script[1] in said:
                rows.add(script[1])
                if not re.search(TIME, line):
                    lacking.append(f"examples/README.md: the row of {script[1]} does not say '{said[script[1]]}'")
                lines[i] = mend(path, line, script[1], TIME)
        mended = "\n".join(lines)
    else:
        script = re.search(COMMAND, text)
        mended = mend(path, text, script[1], TIME + r"\s+in\s+all") if script and script[1] in said else text
    if write and mended != text:
        path.write_text(mended, encoding="utf-8")

lacking += [f"examples/README.md has no row of {script}" for script in said if script.endswith("/run.py") and script not in rows]
if wrong and not write:
    print("check_times.py SOURCES --write puts right:\n  " + "\n  ".join(wrong))
if lacking or (wrong and not write):
    sys.exit("\n  ".join(["FAILED", *lacking]))
print(f"{len(said)} times agree")
