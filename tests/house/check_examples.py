#!/usr/bin/env python3
"""Every script in examples/ that can be run is run by a test, at a small size and with no display.

Usage: check_examples.py SOURCES
"""

import pathlib
import re
import sys

ELSEWHERE = {
    "demo/table.py": "demo/run.sh runs it",
    "frank-2020/run.py": "tests/plugin/papers.py runs it",
    "perre-2016/run.py": "tests/plugin/papers.py runs it",
    "dynamic-fracture/lammps.py": "needs the program lmp, which nothing else does",
}

sources = pathlib.Path(sys.argv[1]).resolve()
tests = "\n".join(
    path.read_text(encoding="utf-8") for kind in ("CMakeLists.txt", "*.py", "*.sh") for path in (sources / "tests").rglob(kind)
    if path.resolve() != pathlib.Path(__file__).resolve())
missing = []
for script in sorted((sources / "examples").glob("*/*.py")):
    name = str(script.relative_to(sources / "examples"))
    folder, stem = script.parent.name, script.stem
    runs = re.search(r"__main__|^lamella\.load_plugin", script.read_text(encoding="utf-8"), re.MULTILINE)
    named = rf'{re.escape(folder)}/{stem}\b|load\("{re.escape(folder)}", "{stem}"\)'
    if runs and name not in ELSEWHERE and not re.search(named, tests) and not re.search(rf"{folder}/live_\$", tests):
        missing.append(name)
if missing:
    sys.exit("FAILED, no test runs: " + ", ".join(missing))
print("all examples are run")
