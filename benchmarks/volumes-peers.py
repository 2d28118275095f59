"""Adds to the tables of the benchmark "volumes" what other programs take for the same voxels, where they are installed.

    /usr/bin/python3 benchmarks/volumes-peers.py [peers=PYTHON,PYTHON] [output=FOLDER] [limit=SECONDS] [quick]

PYTHON is an interpreter that has some of them, say of a virtual environment (`python3 -m venv FOLDER`, `FOLDER/bin/pip install openpnm porespy
taufactor`); each program is taken from the first that has it. Default: this one. PuMA is not in the Python registry, whose pumapy is
another program: build it from its sources, with numpy < 2.

  OpenPNM    a cubic network with pores on the two faces, one pore a voxel; its default solver (Pardiso), and its PyAMG one
  PoreSpy    tortuosity_fd: OpenPNM's network and PyAMG; one phase conducts
  PuMA       compute_thermal_conductivity, compute_continuum_tortuosity
  TauFactor  MultiPhaseSolver, and Solver where one phase conducts; on the processor

Each as it is by default, in a process of its own; processor time of one thread from the array of voxels to the value, after a run on 8³ voxels,
which loads and compiles. Where a program counts the length of the sample from voxel centre to voxel centre (PoreSpy, PuMA) or one voxel more
(MultiPhaseSolver), it also gets a sample a layer longer or shorter, which to it is the cell ("fitted"). A value that is not near that of our own
solver on a sample of that length ends the script. `limit` (30): no size that is expected to take longer. `./dev bench volumes` runs it after
volumes-lamella.py.
"""

import contextlib
import csv
import io
import json
import os
import subprocess
import sys
import tempfile
import warnings
from importlib import metadata

from timing import timed  # first: from here on one thread

import numpy as np
from spheres import CONDUCTIVITY, TRUTH, voxels

# --- in the peer's Python: functions of the voxels (flux along the first axis) to the relative conductivity -----------------------------


def openpnm(solver_name):
    import openpnm as op

    def solve(phase, high):
        k = np.where(phase, float(high), 1.0)
        net = op.network.Cubic(shape=k.shape, spacing=1.0)
        net.add_boundary_pores(["left", "right"])
        half = np.zeros(net.Np)  # resistance from a pore's middle to its wall; those on the faces have none
        half[: k.size] = 0.5 / k.ravel()
        material = op.phase.Phase(network=net)
        material["throat.thermal_conductance"] = 1 / half[net.conns].sum(axis=1)
        heat = op.algorithms.FourierConduction(network=net, phase=material)
        heat.set_value_BC(pores=net.pores("left_boundary"), values=1.0)
        heat.set_value_BC(pores=net.pores("right_boundary"), values=0.0)
        heat.run(solver=getattr(op.solvers, solver_name)() if solver_name else None)
        rate = heat.rate(pores=net.pores("left_boundary"))[0]
        op.Workspace().close_project(net.project)
        return rate * k.shape[0] / (k.shape[1] * k.shape[2])

    return solve


def porespy():
    import porespy as ps

    return lambda phase, high: 1 / ps.simulations.tortuosity_fd(phase == 0, axis=0).formation_factor


def puma():
    import pumapy

    def solve(phase, high):
        sample = pumapy.Workspace.from_array(phase.astype(np.uint16))
        if high == 0:
            return pumapy.compute_continuum_tortuosity(sample, (0, 0), "x", side_bc="p", display_iter=False)[1][0]
        of_phase = pumapy.IsotropicConductivityMap()
        of_phase.add_material((0, 0), 1.0)
        of_phase.add_material((1, 1), float(high))
        return pumapy.compute_thermal_conductivity(sample, of_phase, "x", side_bc="p", display_iter=False)[0][0]

    return solve


def taufactor():
    import taufactor as tau
    import torch

    torch.set_num_threads(1)

    def solve(phase, high):
        if high == 0:
            solver = tau.Solver(1 - phase, device="cpu")
        else:
            solver = tau.MultiPhaseSolver(phase + 1, cond={1: 1.0, 2: float(high)}, device="cpu")
        solver.solve(verbose=False)
        return float(np.ravel(solver.D_eff)[0])

    return solve


PEERS = {  # in the tables: package, how it solves, how its time grows at least with the voxels across (power)
    "OpenPNM": ("openpnm", lambda: openpnm(None), 5),
    "OpenPNM AMG": ("openpnm", lambda: openpnm("PyamgRugeStubenSolver"), 3),
    "PoreSpy": ("porespy", porespy, 3),
    "PuMA": ("pumapy", puma, 4),
    "TauFactor": ("taufactor", taufactor, 4),
}
RUNS = {  # by scene: the peer, and how many layers longer its sample is than it counts
    "spheres": {"OpenPNM": 0, "OpenPNM AMG": 0, "PuMA": 1, "TauFactor": -1},
    "pores": {"PoreSpy": 1, "PuMA": 1, "TauFactor": 0},
}
OURS = {0: "voxels", 1: "layer more", -1: "layer less"}


def measure(peer, scene, layers, limit, sizes):
    """Lines of JSON: version, then nodes, value and seconds of each size."""
    package, prepare, growth = PEERS[peer]
    lines = sys.stdout
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()), tempfile.TemporaryDirectory() as scratch:
        warnings.simplefilter("ignore")
        os.chdir(scratch)  # PuMA writes logs
        try:
            solve = prepare()
        except ImportError:
            return
        print(json.dumps(metadata.version(package)), file=lines)
        high = CONDUCTIVITY[scene]
        solve(voxels(8), high)
        last, before = 0, 1
        for n in sizes:
            if last * (n / before) ** growth > limit:
                break
            value, last = timed(solve, voxels(n, layers), high)
            before = n
            print(json.dumps([n, float(value), last]), file=lines, flush=True)
        os.chdir("/")


# --- in ours ---------------------------------------------------------------------------------------------------------------------------


def answers(pythons, *arguments):
    """Lines of the first interpreter that has the peer."""
    for python in pythons:
        command = [python, "-B", os.path.abspath(__file__), "measure", *map(str, arguments)]
        child = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        if child.returncode:  # what came before, such as smaller sizes, counts
            print(f"  {arguments[0]} ended with code {child.returncode}; by hand: {' '.join(command)}")
        if child.stdout:
            version, *lines = map(json.loads, child.stdout.splitlines())
            return version, lines
    return None, []


def near(value, ours, n, counted):
    """Whether a peer's value is that of our solver, but for when it stops and for half a layer: our faces lie beside, not in or between voxels."""
    return abs(value / ours - 1) < 2e-3 + (12 / n**2 if counted else 0)


def main():
    from drawing import places, rows_of  # matplotlib, which not every peer has

    keys = {key: value or "1" for key, _, value in (argument.partition("=") for argument in sys.argv[1:])}
    folder, _ = places("volumes")
    limit = float(keys.get("limit", 5 if "quick" in keys else 30))
    pythons = keys.get("peers", sys.executable).split(",")
    missing = set()
    for scene, peers in RUNS.items():
        table = folder / f"volumes-{scene}.csv"
        rows = rows_of(table)
        ours = {(row["method"], row["nodes"]): row["value"] for row in rows}
        sizes = sorted({int(n) for method, n in ours if method == "voxels"})
        done = {row["method"] for row in rows}
        for peer, counted in peers.items():
            for layers in sorted({0, counted}, key=abs):
                method = peer + (" fitted" if layers else "")
                if PEERS[peer][0] in missing or method in done or not sizes:
                    continue
                version, lines = answers(pythons, peer, scene, layers, limit, *sizes)
                if not version:
                    print(f"  not measured: {PEERS[peer][0]} is not installed; peers=PYTHON names a Python that has it")
                    missing.add(PEERS[peer][0])
                    continue
                print(f"{scene}: {method}, {PEERS[peer][0]} {version}")
                with open(table, "a", newline="", encoding="utf-8") as file:
                    write = csv.writer(file, lineterminator="\n")
                    for n, value, seconds in lines:
                        same = ours[OURS[layers - counted], n]
                        if not near(value, same, n, counted):
                            sys.exit(f"error: {method} gives {value:.8g} for {scene} of {n} voxels across, and our solver {same:.8g}")
                        error = value / TRUTH[scene] - 1
                        write.writerow([scene, method, n, value, error, seconds])
                        print(f"{method:20} {n:5}  {value:12.8f} {error:+10.2e} {seconds:10.4g}   from ours {value / same - 1:+9.1e}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["measure"]:
        measure(*sys.argv[2:4], int(sys.argv[4]), float(sys.argv[5]), list(map(int, sys.argv[6:])))
    else:
        main()
