"""Holds the tables of options in docs/commands against the program; with --write renews them.

option_tables.py PROGRAM FOLDER [--write]

A page says where the options of a group or of several stand, as the program's help groups them, and has each once:
<!-- options: Load, Breaking --> ... <!-- end of options -->
Commands with kinds, each with options of its own, share a page, which shows what it likes of them:
<!-- options of generate softwood: Sample --> ...
"""

import pathlib
import re
import subprocess
import sys

# Pages whose tables say more than one command's help: their options are held against the program by tests/cli/test_words.py.
BY_HAND = {"info", "run", "report", "convert"}
HEAD = "| option | default | meaning |\n|---|---|---|\n"
PLACE = re.compile(r"(<!-- options(?: of ([^>:]*))?: ([^>]*?) -->\n).*?(<!-- end of options -->)", re.DOTALL)


def tables(program):
    """{command: {group: rows}}"""
    text = subprocess.run([program, "--option-tables"], check=True, capture_output=True, text=True).stdout
    found = {}
    for command, groups in re.findall(r"^# (.+)\n((?:(?!# ).*\n)*)", text, re.MULTILINE):
        found[command] = dict(re.findall(r"^## (.+)\n((?:\|.*\n)*)", groups, re.MULTILINE))
    return found


def renewed(text, groups, others):
    """The page with its tables made anew, and the groups that it shows."""
    shown = []

    def table(place):
        names = [name.strip() for name in place[3].split(",")]
        if not place[2]:
            shown.extend(names)
        own = others[place[2]] if place[2] else groups
        return place[1] + HEAD + "".join(own.get(name, "") for name in names) + place[4]

    return PLACE.sub(table, text), shown


def main(program, folder, *more):
    wrong = []
    found = tables(program)
    for command, groups in found.items():
        page = pathlib.Path(folder) / f"{command}.md"
        if not page.exists() or command in BY_HAND:
            continue
        text = page.read_text(encoding="utf-8")
        made, shown = renewed(text, groups, found)
        if sorted(shown) != sorted(groups):
            wrong.append(f"{page.name} shows the options of {', '.join(sorted(shown)) or 'no group'}; "
                         f"the command has {', '.join(sorted(groups))}, each once")
        elif made != text and "--write" in more:
            page.write_text(made, encoding="utf-8")
        elif made != text:
            wrong.append(f"{page.name}: its options are not those of the program; renew them with --write")
    sys.exit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
