"""A server of two ranks (mpirun pvserver) and a client: sources and filters run on the server, distributed, live, and their
numbers are those of one process.

server.py PVSERVER RANKS MPIRUN [FLAG...]
"""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time

import lamella
import numpy as np
import paraview.simple as pv
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

pvserver, ranks, *launcher = sys.argv[1:]


def numbers(source, name, port=0):
    array = servermanager.Fetch(source, idx=port).GetFieldData().GetArray(name)
    return vtk_to_numpy(array).ravel().copy()


def work():
    """What a user does: a chain, a changed number, another state. Returns the numbers, and those of the server's ranks."""
    lamella.load_plugin()
    tissue = pv.MicrostructureSource(Size=[90, 70, 1])
    heat = pv.SteadyDiffusion(Input=tissue, Direction="All", Tolerance=1e-10)
    pores = pv.PoreFloodFill(Input=tissue)
    walls = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
    torn = pv.BondFracture(Input=walls, Method="Accurate: all after each break", MaximumBroken=12, StatesAtBroken=[5],
                           Tolerance=1e-9)
    steps = pv.LatticeBoltzmann(Input=walls, EndTime=1e-7, NumberOfSteps=2)
    fit = pv.MaterialFit(Input=[tissue], Unknowns=["wall"], Measurements=["y=0.112+-0.003"])
    results = {}
    for proxy in (heat, pores, torn, steps, fit):
        proxy.UpdatePipeline()
    results["conductivity"] = numbers(heat, "effective_conductivity")
    results["pores"] = np.r_[numbers(pores, "pore_count"), numbers(pores, "pore_largest"), numbers(pores, "porosity")]
    results["strength"] = np.r_[numbers(torn, "peak_stress"), numbers(torn, "first_break_strain")]
    found = servermanager.Fetch(fit, idx=1)  # of the first rank alone
    results["fit"] = np.r_[numbers(fit, "fit_value"), numbers(fit, "fit_high"), found.GetNumberOfRows(), found.GetValueByName(0, "low").ToDouble()]
    results["field at the fit"] = np.r_[fit.PointData["temperature_y"].GetRange()]  # of all ranks
    bonds = servermanager.Fetch(torn, idx=1)
    results["broken"] = vtk_to_numpy(bonds.GetPoints().GetData()).copy()
    # A state of the way with its stress, for which nothing runs again on any rank.
    before = numbers(torn, "seconds")
    torn.State, torn.ComputeStress = 0, 1
    torn.UpdatePipeline()
    assert np.array_equal(numbers(torn, "seconds"), before), "another state runs the fracture again"
    results["broken bonds"] = numbers(torn, "broken_bonds")
    results["stress"] = np.ravel([torn.PointData["stress"].GetRange(component) for component in (0, 1, 3)])  # of all ranks
    torn.MaximumBroken = 8
    torn.UpdatePipeline()
    assert not np.array_equal(numbers(torn, "seconds"), before), "a changed number does not run the fracture again"
    results["fewer"] = numbers(torn, "total_broken")
    results["outlet flux"] = numbers(steps, "outlet_flux")
    # How the sample lies on the ranks.
    tissue.UpdatePipeline()
    return results, tissue.GetDataInformation().GetNumberOfPoints()


def free_port():
    with socket.socket() as found:
        found.bind(("localhost", 0))
        return found.getsockname()[1]


def wait_for(server, output):
    """Until the server listens."""
    for _ in range(600):
        with open(output, encoding="utf-8") as said:
            text = said.read()
        if "Accepting connection" in text:
            return
        if server.poll() is not None:
            sys.exit(f"pvserver ended: {text}")
        time.sleep(0.1)
    sys.exit(f"pvserver does not accept connections: {text}")


expected, points = work()
pv.Disconnect()
port = free_port()
# This process has started MPI for itself, and its environment says so: the server's ranks get the one that it was given.
with open("/proc/self/environ", encoding="utf-8") as given:
    environment = dict(entry.split("=", 1) for entry in given.read().split("\0") if "=" in entry)
with tempfile.TemporaryDirectory() as folder:
    output = os.path.join(folder, "output.txt")
    with open(output, "w", encoding="utf-8") as said:
        server = subprocess.Popen(
            [*launcher, pvserver, f"--server-port={port}", "--force-offscreen-rendering"], stdout=said, stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL, start_new_session=True, env=environment)
    try:
        wait_for(server, output)
        pv.Connect("localhost", port)
        assert servermanager.ActiveConnection.IsRemote()
        assert servermanager.ActiveConnection.GetNumberOfDataPartitions() == int(ranks)
        found, there = work()
        with open(output, encoding="utf-8") as said:
            text = said.read()
        assert "ERR|" not in text and "ERROR" not in text, text
        pv.Disconnect()
    finally:
        if server.poll() is None:
            os.killpg(server.pid, signal.SIGTERM)
            server.wait(60)
for name, values in expected.items():
    known = ~np.isnan(values)  # of a picture nothing is solved along z
    np.testing.assert_array_equal(known, ~np.isnan(found[name]))
    error = np.abs(found[name] - values)[known].max() / max(np.abs(values[known]).max(), 1e-300)
    print(f"{name}: differs by {error:.1e}")
    # Diffusion is solved to 1e-10 and lattice Boltzmann is the same to round-off; of fracture forces balance to 1e-9 of those
    # on the platens, and strengths and stresses follow with some tens of that.
    limit = {"conductivity": 1e-9, "outlet flux": 1e-12, "strength": 1e-6, "stress": 1e-6}
    assert error <= limit.get(name, 0), name
assert there >= points  # pieces share their rims
