#!/usr/bin/env python3
"""Volume, year and first page of the two papers are those of CITATION.cff wherever a file cites them.

Usage: check_citations.py SOURCES
"""

import pathlib
import re
import subprocess
import sys

sources = pathlib.Path(sys.argv[1]).resolve()
listed = subprocess.run(["git", "-c", f"safe.directory={sources}", "-C", sources, "ls-files", "-z"], capture_output=True, text=True)
if listed.returncode:
    print("not a clone of the repository: skipped")
    sys.exit(77)
papers = re.findall(r"volume: (\d+)\n +year: (\d+)\n +start: (\d+)", (sources / "CITATION.cff").read_text(encoding="utf-8"))
assert len(papers) == 2, papers
wrong, found = [], 0
for name in filter(None, listed.stdout.split("\0")):
    if not name.endswith((".md", ".py", ".h", ".cpp", ".cxx", ".json", ".xml", ".toml")) or not (sources / name).is_file():
        continue
    text = (sources / name).read_text(encoding="utf-8")
    for volume, year, start in papers:
        # as "73 (2016) 147", stars of Markdown and comments at the ends of lines between them
        for match in re.finditer(rf"\b{volume}\**[\s/*#]+\({year}\),?[\s/*#]+(\d+)", text):
            found += 1
            if match[1] != start:
                wrong.append(f"{name}: {' '.join(match[0].split())}; CITATION.cff has {start}")
if wrong:
    sys.exit("FAILED:\n  " + "\n  ".join(wrong))
assert found > 20, f"only {found} citations found: are they written as this test expects?"
print(f"{found} citations agree")
