#!/usr/bin/env python3
"""Runs docs/tutorial.md as its reader would: every shell block, in order, in one shell.

Usage: check_tutorial.py SOURCES BUILD

Left out: the block that builds (./dev), and the section about the reader's own pictures, which are not here. Blocks of
Python are saved under the name that the line before them gives, as `name.py`.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile


def blocks(text):
    """(language, content, the text before it) of each fenced block."""
    position = 0
    for match in re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        yield match[1], match[2], text[position:match.start()]
        position = match.end()


def main():
    sources, build = map(pathlib.Path, sys.argv[1:])
    text = (sources / "docs" / "tutorial.md").read_text(encoding="utf-8")
    text = text[: text.index("## 7. Your own picture")]
    script, files, count = ["set -euo pipefail"], {}, 0
    for language, content, before in blocks(text):
        if language == "python":
            files[re.findall(r"`(\w+\.py)`", before)[-1]] = content
        elif language == "sh" and "./dev" not in content:
            script.append(content)
            count += 1
    assert count >= 5, f"only {count} blocks found: is the tutorial written as this test expects?"

    with tempfile.TemporaryDirectory() as folder:
        os.symlink(build, os.path.join(folder, "build"))
        work = pathlib.Path(folder, "results", "tutorial")
        work.mkdir(parents=True)
        for name, content in files.items():
            (work / name).write_text(content, encoding="utf-8")
        environment = dict(os.environ, PATH=f"{build / 'bin'}{os.pathsep}{os.environ['PATH']}")
        run = subprocess.run(["bash", "-c", "\n".join(script)], cwd=folder, env=environment, text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        print(run.stdout)
        made = sorted(path.name for path in work.iterdir())
        print("made:", *made)
        for name in made:
            if name.endswith((".vti", ".vtp")) and b"<AppendedData" in (work / name).read_bytes():
                sys.exit(f"FAILED: {name} has appended data, which ParaView on a current Debian 12 cannot read")
        missing = {"tissue.png", "heat.vti", "heat.png"} - set(made)
        if run.returncode or missing:
            sys.exit(f"FAILED: exit {run.returncode}, not made: {missing or 'nothing'}")


if __name__ == "__main__":
    main()
