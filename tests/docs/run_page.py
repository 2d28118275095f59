#!/usr/bin/env python3
"""Runs the examples of a page of the documentation, and compares what it shows as output with what comes out.

Usage: run_page.py SOURCES BUILD PAGE [--slow] [--write] [--times] [--keep FOLDER]

The page's blocks run in order in a folder of their own, in one shell and one Python, as its reader would run them at the top of a
clone after ./dev build: build/, data/, examples/ and docs/ are there, and lamella is found. Fails where a command fails, or one whose shown
output begins with "error:" does not, and where output is not what the page says: see compare.py. Marks on the page, and what they
mean: pages.py. --slow runs what is marked so as well; --write puts
outputs on the page right, in place of failing.
"""

import argparse
import dataclasses
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
from compare import difference  # noqa: E402
from pages import Block, blocks, commands, console  # noqa: E402

DEV = """#!/bin/sh
# In place of ./dev: everything is built already.
case $1 in
  build) ;;
  demo) # two pages begin with it: made once for a program
    lamella=$(command -v lamella)
    made=build/tests/docs/made/demo-$(stat -L -c %Y "$lamella")-$(cksum < examples/demo/run.sh | cut -d' ' -f1)
    if [ ! -d "$made" ]; then
      mkdir -p build/tests/docs/made
      new=$(mktemp -d build/tests/docs/made/new.XXXXXX)
      LAMELLA=$lamella examples/demo/run.sh > "$new/said" || { cat "$new/said"; rm -rf "$new"; exit 1; }
      sed -i "s|$(pwd -P)|@HERE@|g" "$new/said"
      mv results/demo "$new/demo"
      mv -T "$new" "$made" 2> /dev/null || rm -rf "$new" # another page's test was sooner
    fi
    mkdir -p results && cp -r "$made/demo" results/ && sed "s|@HERE@|$(pwd -P)|g" "$made/said" ;;
  *) echo "error: this is a test of the pages: mark the block" >&2; exit 1 ;;
esac
"""

# Runs each piece of code that it is handed (its length, then its text) and says how that went.
PYTHON = """
import os, sys, traceback
names = {"__name__": "__main__"}
source, answer = os.fdopen(int(sys.argv[1]), "rb"), os.fdopen(int(sys.argv[2]), "wb")
while line := source.readline():
    size, where = line.decode().split(" ", 1)
    failed = 0
    try:
        exec(compile(source.read(int(size)).decode(), where.strip(), "exec"), names)
    except BaseException:
        traceback.print_exc()
        failed = 1
    sys.stdout.flush()
    sys.stderr.flush()
    answer.write(b"%d\\n" % failed)
    answer.flush()
os._exit(0)
"""


class Failure(Exception):
    pass


class Shell:
    """One bash for all commands of a page."""

    def __init__(self, folder, environment):
        self.folder, self.environment = folder, environment
        self.output = folder.parent / "output"
        read, write = os.pipe()
        self.process = subprocess.Popen(
            ["bash", "--noprofile", "--norc"], cwd=folder, stdin=subprocess.PIPE, pass_fds=[write], env=environment,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        self.status, self.number = os.fdopen(read), write
        self.tell("set -o pipefail")

    def tell(self, text):
        self.process.stdin.write((text + "\n").encode())
        self.process.stdin.flush()

    def run(self, command):
        """(exit code, what it printed)"""
        self.tell(f"{{\n{command}\n}} </dev/null >'{self.output}' 2>&1 {self.number}>&-; printf '%s %s\\n' $? \"$PWD\" >&{self.number}")
        line = self.status.readline()
        if not line:
            return 2, "bash did not understand this"
        code, self.folder = line.rstrip("\n").split(" ", 1)
        return int(code), self.output.read_text(encoding="utf-8", errors="replace")

    def end(self):
        self.process.stdin.close()
        self.process.wait()
        self.status.close()


class Python:
    """One Python for all blocks of a page, begun where the shell is by then."""

    def __init__(self, interpreter, shell, environment):
        self.output = shell.output
        self.out = open(self.output, "ab")
        source, self.source = os.pipe()
        self.answer, answer = os.pipe()
        self.process = subprocess.Popen(
            [interpreter, "-c", PYTHON, str(source), str(answer)] if "pvpython" not in interpreter else
            [interpreter, self.script(shell), str(source), str(answer)],
            cwd=shell.folder, stdin=subprocess.DEVNULL, stdout=self.out, stderr=self.out, pass_fds=[source, answer], env=environment)
        os.close(source)
        os.close(answer)
        self.answer = os.fdopen(self.answer)

    @staticmethod
    def script(shell):
        path = shell.output.parent / "blocks.py"
        path.write_text(PYTHON, encoding="utf-8")
        return str(path)

    def run(self, code, where):
        self.out.truncate(0)
        code = code.encode()
        os.write(self.source, f"{len(code)} {where}\n".encode() + code)
        answer = self.answer.readline()
        text = self.output.read_text(encoding="utf-8", errors="replace")
        return (int(answer) if answer else 1), text

    def end(self):
        os.close(self.source)
        self.process.wait()
        self.answer.close()
        self.out.close()


def readable(folder):
    """ParaView on a current Debian 12 cannot read appended data."""
    for path in folder.rglob("*.vt[ip]"):
        if not path.is_symlink() and b"<AppendedData" in path.read_bytes():
            raise Failure(f"{path.name} has appended data, which ParaView on a current Debian 12 cannot read")


def rewritten(shown, printed):
    """What a page shows of an output, from another output: as many lines before and after what is left out."""
    lines = printed.rstrip("\n").split("\n")
    before, mark, after = shown.rstrip("\n").partition("\n…\n" if not shown.startswith("…\n") else "…\n")
    if mark:
        first, last = len(before.split("\n")) if before else 0, len(after.split("\n"))
        lines = lines[:first] + ["…"] + lines[len(lines) - last :]
    return "\n".join(line.rstrip() for line in lines) + "\n"


@dataclasses.dataclass
class Printed:
    """What one command, or block of Python, did."""

    block: Block
    command: str
    code: int
    output: str
    expected: int = 0


class Run:
    def __init__(self, page, text, slow, folder, build):
        self.page, self.slow, self.folder = page, slow, folder
        self.blocks = blocks(text)
        self.run, self.compared, self.left_out, self.wrong = 0, 0, [], []
        self.times = False
        self.put_right = {}  # by line of the page: what is printed now
        self.environment = dict(
            os.environ, PATH=f"{build / 'bin'}{os.pathsep}{os.environ['PATH']}", PYTHONPATH=str(build / "python"),
            COLUMNS="120", MPLBACKEND="Agg", PYTHONDONTWRITEBYTECODE="1", OMPI_ALLOW_RUN_AS_ROOT="1",
            OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1",
            OMPI_MCA_hwloc_base_binding_policy="none", OMPI_MCA_mpi_yield_when_idle="1")
        self.shell = Shell(folder, self.environment)
        self.python = None
        self.printed, self.shown = [], False  # since the last output on the page; whether there was one

    def fault(self, block, text):
        self.wrong.append(f"{self.page}:{block.line}: {text}")

    def judge(self):
        """The exit codes, once it has been seen which outputs are errors."""
        for one in self.printed:
            if one.code != one.expected:
                wanted = "it should fail, as the page says" if one.expected < 0 else f"exit code {one.code}, not {one.expected}"
                if one.expected >= 0 or one.code == 0:
                    self.fault(one.block, f"{wanted}:\n$ {one.command}\n{one.output[-3000:]}")
        self.printed, self.shown = [], False

    def compare(self, block, printed):
        """An output: that of one of these commands."""
        self.compared += 1
        self.shown = True
        share = float(block.marks["within"]) / 100 if "within" in block.marks else None
        told = [difference(block.text, one.output, str(self.folder), share) for one in printed]
        if not told:
            self.fault(block, "the output of no command")
            return
        best, (_, differs) = min(zip(printed, told), key=lambda pair: pair[1][0])
        if differs:
            self.put_right[block.line] = rewritten(block.text, best.output)
            self.fault(block, f"this is not what is printed by\n$ {best.command}\n{differs}")
        if re.match(r"(error:|\w*Error: )", block.text) and not best.expected:
            best.expected = -1  # anything but 0

    def commands(self, block):
        shown = console(block.text) if block.kind == "console" else [(c, "") for c in commands(block.text)]
        for i, (command, output) in enumerate(shown):
            ends = int(block.marks.get("ends with", 0)) if i + 1 == len(shown) else 0
            began = time.monotonic()
            self.printed.append(Printed(block, command, *self.shell.run(command), ends))
            if self.times:
                print(f"{time.monotonic() - began:7.2f} s  {command}", flush=True)
            if output.strip() and "not compared" not in block.marks:
                self.compare(dataclasses.replace(block, text=output), self.printed[-1:])

    def code(self, block):
        if self.python is None:
            everything = "".join(b.text for b in self.blocks if b.kind == "python")
            interpreter = "pvpython" if "paraview.simple" in everything else os.environ.get("LAMELLA_PYTHON", "/usr/bin/python3")
            self.python = Python(shutil.which(interpreter), self.shell, self.environment)
        self.printed.append(Printed(block, "(Python)", *self.python.run(block.text, f"{self.page}:{block.line}")))

    def go(self):
        left_out = False  # whether the commands before this block were not run
        for block in self.blocks:
            reason = block.marks.get("not run") or (not self.slow and "slow" in block.marks and "slow: " + block.marks["slow"])
            if reason:
                self.left_out.append(f"{self.page}:{block.line}: {reason}")
                left_out = True
            elif block.kind == "file":
                pathlib.Path(self.shell.folder, block.name).write_text(block.text, encoding="utf-8")
            elif block.kind in ("sh", "console", "python"):
                if self.shown:
                    self.judge()
                (self.code if block.kind == "python" else self.commands)(block)
                self.run += 1
                left_out = False
            elif block.kind == "output" and not left_out and "not compared" not in block.marks:
                self.compare(block, self.printed)
        self.judge()
        self.shell.end()
        if self.python:
            self.python.end()
        readable(self.folder)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("sources", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("page")
    parser.add_argument("--slow", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path, help="leave what was made in this folder")
    parser.add_argument("--times", action="store_true", help="say how long each command takes, by the clock")
    parser.add_argument("--write", action="store_true", help="put outputs that differ right on the page")
    options = parser.parse_args()
    sources, build = options.sources.resolve(), options.build.resolve()

    with tempfile.TemporaryDirectory(prefix="lamella-page-") as temporary:
        folder = options.keep.resolve() / "page" if options.keep else pathlib.Path(temporary, "page")
        folder.mkdir(parents=True)
        (folder / "build").symlink_to(build)
        for name in ("data", "docs", "tests", "packages.txt"):
            (folder / name).symlink_to(sources / name)
        # a copy: scripts look for build/ beside it
        shutil.copytree(sources / "examples", folder / "examples", ignore=shutil.ignore_patterns("images", "__pycache__"))
        (folder / "dev").write_text(DEV, encoding="utf-8")
        (folder / "dev").chmod(0o755)
        run = Run(options.page, (sources / options.page).read_text(encoding="utf-8"), options.slow, folder, build)
        run.times = options.times
        run.go()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{options.page}: {run.run} blocks run, {run.compared} outputs compared, {len(run.left_out)} not run; "
          f"{used.ru_utime + used.ru_stime:.1f} s of processor time")
    if options.write and run.put_right:
        page = sources / options.page
        lines = page.read_text(encoding="utf-8").split("\n")
        for line, text in sorted(run.put_right.items(), reverse=True):
            end = next(i for i in range(line, len(lines)) if lines[i].strip() == "```")
            lines[line:end] = text.rstrip("\n").split("\n")
        page.write_text("\n".join(lines), encoding="utf-8")
    for line in run.left_out:
        print("  not run: " + line)
    if run.wrong:
        sys.exit("FAILED:\n" + "\n\n".join(run.wrong))


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"FAILED: {failure}")
