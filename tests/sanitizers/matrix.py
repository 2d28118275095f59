"""Every solver in 3D, of many sizes, horizons, threads and ranks: nothing is read or written where nothing is.

  matrix.py lamella=PROGRAM [sizes=20,21,...] [horizons=2,3,4,5] [only=SOLVER] [minutes=M] [skip=N] [ranks=1,2,3]
            [threads=1,2] [all=1] [wrap="valgrind ..."]

The program is to be built with sanitizers (./dev sanitizers does that). The least even and the least odd size are run at
every horizon, number of threads and ranks, each other size once, all of these in turn; all=1: with all of them.
Tolerances are loose and steps few: what is looked at is where a solver reads and writes, not what comes out. What takes
little comes first; minutes=M, or Ctrl-C, ends it and says what is left; skip=N goes on after the first N runs.
"""

import collections
import functools
import itertools
import os
import pathlib
import re
import resource
import shlex
import subprocess
import sys
import tempfile
import time

import numpy as np

LARGE, BAR = 32, 4
SIZES = [20, 21, 27, 31, 32, 40, 41, 47, 48, 52, 63, 64, 80, 81, 95, 96]
# what a sanitizer or an assertion says
FAULT = re.compile(r"runtime error:|ERROR: AddressSanitizer|WARNING: ThreadSanitizer|Assertion|Invalid (?:read|write)|SUMMARY: \w+Sanitizer")

BONDS = ["--young", "wall=1e9", "--void", "void", "--pixel-size", "1um"]
BREAK = [*BONDS, "--critical-stretch", "wall=1e-3"]
DENSITY = ["--density", "1000"]


@functools.cache
def nodes(n, periodic):
    """Two phases whose interfaces lie everywhere, a third of them void; whole where platens hold it. Large cubes are a
    frame of bars from border to border, with pinholes: few nodes that are not void, but in all of the cube."""
    where = np.indices((n, n, n))
    if n < LARGE:
        solid = sum(np.sin((2 + a) * 2 * np.pi * (x + a) / n) for a, x in enumerate(where)) > -0.6
        if not periodic:
            solid[:6] = solid[-6:] = True
    else:
        starts = np.round(np.linspace(0, n - BAR, 3 + n // 64)).astype(int)
        across = np.isin(np.arange(n), starts[:, None] + np.arange(BAR)).astype(int)
        solid = sum(across[x] for x in where) >= 2
        solid &= np.random.default_rng(n).random(solid.shape) > 0.02
    return np.where(solid, 255, 0).astype(np.uint8)


def sample(folder, n, periodic):
    name = f"{'cell' if periodic else 'sample'}_{n}x{n}x{n}_u8.raw"
    path = pathlib.Path(folder) / name
    if not path.exists():
        path.write_bytes(nodes(n, periodic).tobytes())
    return [name, "--phase", "255=wall", "--phase", "0=void"]


def bonds(command, *words, cost, mpi=True, horizons=True, periodic=False):
    """@param cost processor time of 1000 nodes that are not void at a horizon of 3, with sanitizers and without the start. [s]"""
    return {"words": lambda folder, n, h: [command, *sample(folder, n, periodic), *words, *(["--horizon", h] if horizons else [])],
            "mpi": mpi, "horizons": horizons, "periodic": periodic, "cost": cost}


SOLVERS = {
    "diffusion": bonds("diffusion", "--conductivity", "wall=1", "--conductivity", "void=1e-3", "--direction", "x",
                       "--method", "multigrid", "--tolerance", "1e-2", "--no-error-estimate", horizons=False, cost=0.01),
    "diffusion, lean": bonds("diffusion", "--conductivity", "wall=1", "--conductivity", "void=0.3", "--direction", "y", "--method",
                             "lean-multigrid", "--tolerance", "1e-2", "--no-error-estimate", horizons=False, cost=0.02),
    "diffusion, pieces": bonds("diffusion", "--conductivity", "wall=1", "--conductivity", "void=0", "--direction", "z", "--method",
                               "piece-multigrid", "--tolerance", "1e-2", "--no-error-estimate", horizons=False, cost=0.02),
    "diffusion, elements": bonds("diffusion", "--conductivity", "wall=1", "--conductivity", "void=0", "--direction", "x", "--lattice", "q1",
                                 "--tolerance", "1e-2", "--no-error-estimate", horizons=False, mpi=False, cost=0.05),
    "diffusion, algebraic": bonds("diffusion", "--conductivity", "wall=1", "--conductivity", "void=0", "--direction", "z",
                                  "--method", "algebraic-multigrid", "--tolerance", "1e-2", "--no-error-estimate", horizons=False, cost=0.02),
    "diffusion, periodic D3Q19": bonds("diffusion", "--conductivity", "wall=1", "--conductivity", "void=0.1", "--direction", "y", "--lattice",
                                       "d3q19", "--sides", "periodic", "--tolerance", "1e-1", "--no-error-estimate", horizons=False, cost=0.02),
    "transient": bonds("transient", "--pixel-size", "1um", "--diffusivity", "wall=1e-9", "--diffusivity", "void=2e-9",
                       "--direction", "x", "--end-time", "4e-3", "--frames", "2", horizons=False, cost=0.01),
    "stiffness": bonds("stiffness", "--young", "wall=1e9", "--tolerance", "1e-2", "--mean-strain", "xx=0.01", periodic=True, horizons=False,
                       cost=0.05),
    "bond-stiffness": bonds("bond-stiffness", *BONDS, "--tolerance", "0.1", "--no-error-estimate", periodic=True, cost=0.55),
    "equilibrium": bonds("equilibrium", *BONDS, "--strain", "1e-3", "--tolerance", "0.1", cost=0.14),
    "equilibrium, periodic shear": bonds("equilibrium", *BONDS, "--strain", "1e-3", "--tolerance", "0.1", "--periodic", "x", "--load", "shear",
                                         "--surface-correction", cost=0.22),
    "fracture": bonds("fracture", *BREAK, "--max-broken", "2", "--tolerance", "1e-5", cost=0.25),
    "dynamics": bonds("dynamics", *BREAK, *DENSITY, "--end-time", "4e-9", "--strain-rate", "1e5", cost=0.3),
    "compression, moduli": bonds("compression", "--young", "1e9", "--poisson", "0.3", *DENSITY, "--pixel-size", "1um",
                                 "--stiffness-only", mpi=False, horizons=False, cost=2.4),
    "compression": bonds("compression", "--young", "1e9", "--poisson", "0.3", *DENSITY, "--pixel-size", "1um",
                         "--strain", "STRAIN", "--rows", "5", "--first-speed", "2e-3", "--least-speed", "1e-3", horizons=False, cost=1),
    "pore-flood-fill": bonds("pore-flood-fill", horizons=False, cost=0.01),
}


def cost(name, size, horizon, ranks):
    """Processor time about, with sanitizers. [s]"""
    solver = SOLVERS[name]
    return 0.5 * ranks + solver["cost"] * np.count_nonzero(nodes(size, solver["periodic"])) / 1000 * (horizon / 3 if horizon else 1)**3


def cases(keys):
    """Cheap ones first, so that a run which is cut short has seen most of them."""
    numbers = lambda key, default: [int(n) for n in str(keys.get(key, default)).split(",")]  # noqa: E731
    sizes = numbers("sizes", ",".join(map(str, SIZES)))
    whole = {min(size for size in sizes if size % 2 == parity) for parity in {size % 2 for size in sizes}}
    chosen = []
    for name, solver in SOLVERS.items():
        if not name.startswith(keys.get("only", "")):
            continue
        settings = list(itertools.product(numbers("horizons", "2,3,4,5") if solver["horizons"] else [0], numbers("threads", "1,2"),
                                          numbers("ranks", "1,2,3") if solver["mpi"] else [1]))
        turn = 0
        for size in sizes:
            if "all" in keys or size in whole:
                chosen += [(name, size, *setting) for setting in settings]
            else:  # a stride that meets all of 24, 6 or 2, and changes horizons, threads and ranks from one size to the next
                chosen.append((name, size, *settings[turn % len(settings)]))
                turn += 7
    return sorted(chosen, key=lambda case: cost(*case[:3], case[4]))


def run(program, folder, case, wrap):
    """@returns outcome, what is to be said of it, processor time"""
    name, size, horizon, threads, ranks = case
    words = [str(word) for word in SOLVERS[name]["words"](folder, size, horizon)]
    # some dozen steps, whatever the size: 0.02 of a pixel, by platens that do not slow down further
    words = [{"STRAIN": f"{0.02 / size:.3g}"}.get(word, word) for word in words]
    command = [program, *words, "--threads", str(threads), "--quiet"]
    if wrap:
        command = [*shlex.split(wrap), *command]
    if ranks > 1:
        command = ["mpiexec", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), *command]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    text = done.stderr + done.stdout
    error = next((line for line in text.splitlines() if line.startswith("error: ")), None)
    if FAULT.search(text) or (done.returncode != 0 and error is None):  # what says nothing of its own did not refuse
        return "fault", " ".join(command) + "\n" + text[-6000:], used
    if done.returncode != 0:
        return "refused", f"{' '.join(command)}: {error}", used
    return "clean", "", used


def main():
    keys = dict(word.partition("=")[::2] for word in sys.argv[1:])
    program = os.path.abspath(keys["lamella"])
    end = time.monotonic() + 60 * float(keys.get("minutes", "inf"))
    os.environ.setdefault("ASAN_OPTIONS", "detect_leaks=0")
    os.environ.setdefault("UBSAN_OPTIONS", "print_stacktrace=1:halt_on_error=1")
    os.environ.update(OMP_WAIT_POLICY="PASSIVE", OPENBLAS_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                      OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_mpi_yield_when_idle="1",
                      OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_MCA_smsc="^cma")
    counts, times, sizes, left = collections.Counter(), collections.Counter(), collections.defaultdict(set), 0
    with tempfile.TemporaryDirectory(prefix="lamella-matrix-") as folder:
        chosen = cases(keys)
        for number, case in enumerate(chosen):
            if number < int(keys.get("skip", 0)):
                continue
            if time.monotonic() > end:
                left = len(chosen) - number
                break
            try:
                outcome, said, used = run(program, folder, case, keys.get("wrap", ""))
            except KeyboardInterrupt:
                left = len(chosen) - number
                break
            counts[case[0], outcome] += 1
            times[case[0]] += used
            sizes[case[0]].add(case[1])
            if outcome != "clean" or "verbose" in keys:
                print("{}: {}, {}³, horizon {}, {} threads, {} ranks: {:.1f} s {}".format(outcome, *case, used, said), flush=True)
    print("| solver | sizes | clean | refused | faults | processor time [s] |\n|---|---|---|---|---|---|")
    for name in SOLVERS:
        if sizes[name]:
            print(f"| {name} | {min(sizes[name])} to {max(sizes[name])} | {counts[name, 'clean']} | {counts[name, 'refused']} | "
                  f"{counts[name, 'fault']} | {times[name]:.0f} |")
    if left:
        print(f"{left} of {len(chosen)} not run: no time was left; go on with skip={len(chosen) - left}")
    return 1 if any(outcome == "fault" for _, outcome in counts) else 0


if __name__ == "__main__":
    sys.exit(main())
