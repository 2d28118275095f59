"""Random settings over all solvers: contrasts, sizes and shapes at the edge of sense and beyond.

  random_settings.py lamella=PROGRAM [count=2000] [seed=1] [only=SOLVER] [number=N] [jobs=1] [table=FILE.csv]

A setting has a number; number and seed give the same files and options anywhere. Each ends as one of

  right      the answer agrees with another computation, or with bounds and balances that must hold
  warned     so it does, and the program says what is doubtful
  refused    one line that says why, a hint, and an exit code from 2 to 7
  wrong      all else: it crashes, takes too long, says nan, or an answer is none and nothing says so
"""

import collections
import concurrent.futures
import csv
import sys
import tempfile
import traceback

import bonds
import conduction
import elements
import grains
import points
from settings import Fault, Refused, Setting

SOLVERS = {  # and how many of a hundred settings
    "diffusion": (conduction.diffusion, 17),
    "transient": (conduction.transient, 8),
    "outlines": (conduction.outlines, 8),
    "stiffness": (elements.stiffness, 9),
    "bond-stiffness": (bonds.stiffness, 8),
    "equilibrium": (bonds.equilibrium, 10),
    "fracture": (bonds.fracture, 8),
    "dynamics": (bonds.dynamics, 8),
    "compression": (points.compression, 10),
    "packing": (grains.packing, 5),
    "bridges": (grains.bridges, 4),
    "pore-flood-fill": (grains.pore_flood_fill, 5),
}
ORDER = [name for name, (_, share) in SOLVERS.items() for _ in range(share)]


def judge(program, seed, number, only):
    """@returns number, solver, outcome, what is to be said of it, the last command, what it was held against"""
    name = only or ORDER[number * 37 % len(ORDER)]
    with tempfile.TemporaryDirectory(prefix="lamella-setting-") as folder:
        setting = Setting(program, folder, seed, number)
        said, outcome = "", "right"
        try:
            SOLVERS[name][0](setting)
        except Refused as refusal:
            outcome, said = "refused", f"{refusal.code}: {refusal}"
        except Fault as fault:
            setting.faults.append(str(fault))
        except Exception:  # a fault in the judge, or an answer that is not what the pages say
            setting.faults.append(traceback.format_exc(limit=-2))
        if setting.faults:
            outcome, said = "wrong", "; ".join(setting.faults)
        elif outcome == "right" and setting.warnings:
            outcome, said = "warned", setting.warnings[0]
        return number, name, outcome, said, setting.commands[-1:], setting.reference


def main():
    keys = dict(word.partition("=")[::2] for word in sys.argv[1:])
    program, seed, count = keys["lamella"], int(keys.get("seed", 1)), int(keys.get("count", 2000))
    only = keys.get("only", "")
    if only and only not in SOLVERS:
        sys.exit(f"error: no solver '{only}'\nhint: one of {', '.join(SOLVERS)}")
    numbers = [int(keys["number"])] if "number" in keys else range(count)
    counts = collections.Counter()
    against = collections.defaultdict(collections.Counter)
    rows = []
    with concurrent.futures.ProcessPoolExecutor(int(keys.get("jobs", 1))) as pool:
        for row in pool.map(judge, *zip(*[(program, seed, n, only) for n in numbers])):
            number, name, outcome, said, command, reference = row
            counts[name, outcome] += 1
            if outcome in ("right", "warned"):
                against[name].update(set(reference))
            rows.append([number, name, outcome, said, *command])
            if outcome == "wrong" or "number" in keys:
                print(f"{outcome}: setting {number} of seed {seed}, {name}: {said}\n  {' '.join(command)}", flush=True)
    if "table" in keys:
        with open(keys["table"], "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([["number", "solver", "outcome", "said", "command"], *rows])
    outcomes = ["right", "warned", "refused", "wrong"]
    print("| solver | " + " | ".join(outcomes) + " | held against |\n|" + "---|" * 6)
    for name in SOLVERS:
        if any(counts[name, outcome] for outcome in outcomes):
            print(f"| {name} | " + " | ".join(str(counts[name, o]) for o in outcomes) + " | "
                  + ", ".join(f"{what} {n}" for what, n in against[name].most_common()) + " |")
    print("| all | " + " | ".join(str(sum(counts[name, o] for name in SOLVERS)) for o in outcomes) + " | |")
    return 1 if any(outcome == "wrong" for _, outcome in counts) else 0


if __name__ == "__main__":
    sys.exit(main())
