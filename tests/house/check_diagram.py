"""Holds every include against the arrows of the diagram in docs/architecture.md: what uses what it has no arrow to fails.

check_diagram.py SOURCES
"""

import pathlib
import re
import sys

NODE = re.compile(r'^\s*(\w+)\["([\w/]+?)/?(?:<br>| · )', re.MULTILINE)
ARROW = re.compile(r"^\s*([\w &]+?) --> ([\w &]+?)\s*$", re.MULTILINE)
INCLUDE = re.compile(r'^\s*#include "([^"]+)"', re.MULTILINE)
SOURCES = (".h", ".hpp", ".cpp", ".cxx")


def diagram(text):
    """{node: folder} and the arrows, pairs of nodes."""
    drawn = re.search(r"```mermaid\n(.*?)```", text, re.DOTALL)[1]
    folders = {}
    for node, folder in NODE.findall(drawn):
        inner = not folder.startswith(("tools", "pvplugin", "solvers", "filters"))
        folders[node] = f"solvers/{folder}" if inner else folder
    arrows = set()
    for left, right in ARROW.findall(drawn):
        arrows |= {(a.strip(), b.strip()) for a in left.split("&") for b in right.split("&")}
    return folders, arrows


def owner(path, folders):
    """The node whose folder is the nearest above a file; None: none is."""
    at = path.as_posix()
    found = [node for node, folder in folders.items() if at.startswith(folder + "/")]
    return max(found, key=lambda node: len(folders[node]), default=None)


def resolve(name, file, root):
    """What an include names, in the tree."""
    folders = [file.parent, *(root / name for name in ("solvers", "filters", "filters/rendering", "tools", "tools/vtk"))]
    for folder in folders + sorted((root / "solvers/vtk").glob("*/")):
        if (folder / name).is_file():
            return (folder / name).resolve()
    return None


def main(root):
    root = pathlib.Path(root).resolve()
    folders, arrows = diagram((root / "docs/architecture.md").read_text(encoding="utf-8"))
    used, faults = set(), {}
    for folder in ("solvers", "filters", "tools"):
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in SOURCES:
                continue
            user = owner(file.relative_to(root), folders)
            for name in INCLUDE.findall(file.read_text(encoding="utf-8")):
                target = resolve(name, file, root)
                what = owner(target.relative_to(root), folders) if target else None
                if user and what and user != what:
                    used.add((user, what))
                    if (user, what) not in arrows:
                        faults.setdefault((user, what), f"{file.relative_to(root)} includes {name}")
    wrong = [f"{user} uses {what}, and there is no arrow: {where}" for (user, what), where in sorted(faults.items())]
    sources = {node for node, folder in folders.items() if not folder.startswith(("tools/python", "pvplugin"))}
    wrong += [f"the arrow from {user} to {what} stands for nothing" for user, what in sorted(arrows - used)
              if user in sources and what in sources]
    sys.exit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
