#!/usr/bin/env python3
"""Every relative link and picture in the Markdown files leads to a file that git knows.

Usage: check_links.py SOURCES
"""

import pathlib
import re
import subprocess
import sys

sources = pathlib.Path(sys.argv[1]).resolve()
listed = subprocess.run(["git", "-c", f"safe.directory={sources}", "-C", sources, "ls-files"], capture_output=True, text=True)
if listed.returncode:
    print("not a clone of the repository: skipped")
    sys.exit(77)
known = set(listed.stdout.split("\n"))
folders = {str(parent) for name in known for parent in pathlib.PurePosixPath(name).parents}
broken = []
for name in sorted(known):
    if not name.endswith(".md"):
        continue
    text = (sources / name).read_text(encoding="utf-8")
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"\w+:|#", target):
            continue
        path = (sources / name).parent / target.split("#")[0]
        relative = str(path.resolve().relative_to(sources))
        if relative not in known and relative not in folders:
            broken.append(f"{name}: {target}")
if broken:
    sys.exit("FAILED, these lead nowhere:\n  " + "\n  ".join(broken))
print("all links lead somewhere")
