"""FluxMap, PoreFloodFill and StressPDF under pvbatch: whatever ParaView's pieces are, the numbers are those of one rank.

ranks.py RESULT.json [REFERENCE.json]
"""

import json
import math
import sys

import lamella
import paraview.simple as pv
from paraview import servermanager

lamella.load_plugin()

NUMBERS = (
    "effective_conductivity",
    "effective_from_flux",
    "mean_flux",
    "tortuosity",
    "tortuosity_factor",
    "streamline_tortuosity",
    "line_flux",
)
# 1e-10 is what the ranks of the solver agree to; fluxes and lines follow from fields solved to a balance of 1e-10,
# whose own error is up to the root of that.
TOLERANCE = {"effective_conductivity": 1e-10}


def run(size, sides):
    tissue = pv.MicrostructureSource(Size=size)
    heat = pv.SteadyDiffusion(Input=tissue, Direction="All", Sides=sides, Tolerance=1e-10)
    flux = pv.FluxMap(Input=heat, Direction="y", NumberOfStreamlines=30)
    flux.UpdatePipeline()
    data = servermanager.Fetch(flux).GetFieldData()
    result = {}
    for name in NUMBERS:
        array = data.GetArray(name)
        result[name] = [array.GetTuple1(i) for i in range(array.GetNumberOfTuples())]
    lines = servermanager.Fetch(flux, idx=1)
    cells = lines.GetCellData()
    lengths = {}
    for i in range(lines.GetNumberOfLines()):
        lengths[int(cells.GetArray("line").GetTuple1(i))] = cells.GetArray("length").GetTuple1(i)
    result["lengths"] = [lengths[line] for line in sorted(lengths)]
    return result


def pores(size, connectivity, periodic):
    fill = pv.PoreFloodFill(Input=pv.MicrostructureSource(Size=size), Connectivity=connectivity, Periodic=periodic)
    fill.UpdatePipeline()
    data = servermanager.Fetch(fill).GetFieldData()
    table = servermanager.Fetch(fill, idx=1)
    result = {name: [data.GetArray(name).GetTuple1(0)] for name in ("pore_count", "pore_largest", "porosity")}
    for name in ("size", "centre_x", "centre_y", "x_first", "y_last"):
        column = table.GetColumnByName(name)
        result[name] = [column.GetTuple1(i) for i in range(column.GetNumberOfTuples())]
    return result


def stresses(size):
    field = pv.Calculator(Input=pv.MicrostructureSource(Size=size), ResultArrayName="yy",
                          Function="1e4*(coordsX - 1e-5) + sin(3e5*coordsY)")
    pdf = pv.StressPDF(Input=field, StressArray=["POINTS", "yy"])
    pdf.UpdatePipeline()
    table = servermanager.Fetch(pdf)
    names = ("stress_count", "stress_mean_tensile", "stress_mean_compressive", "stress_theta", "stress_tail_distance")
    result = {name: [table.GetFieldData().GetArray(name).GetTuple1(0)] for name in names}
    count = table.GetColumnByName("count")
    result["count"] = [count.GetTuple1(i) for i in range(count.GetNumberOfTuples())]
    return result


def compare(found, expected):
    for case, numbers in expected.items():
        for name, values in numbers.items():
            scale = max(abs(value) for value in values if not math.isnan(value))
            assert len(found[case][name]) == len(values), (case, name)
            for a, b in zip(found[case][name], values):
                assert math.isnan(a) == math.isnan(b), (case, name)
                if not math.isnan(a):
                    error = abs(a - b) / scale
                    assert error <= TOLERANCE.get(name, 1e-7), f"{case} {name}: {a} is not {b} ({error:.1e})"


results = {
    "picture": run([130, 90, 1], "Insulated"),
    "periodic picture": run([90, 70, 1], "Periodic"),
    "volume": run([30, 24, 20], "Insulated"),
    "pores": pores([130, 90, 1], "8 (picture: and corners)", [0, 1, 0]),
    "pores of a volume": pores([60, 50, 40], "26 (volume: and corners)", [1, 0, 1]),
    "stresses": stresses([130, 90, 1]),
    "stresses in a volume": stresses([30, 24, 20]),
}
with open(sys.argv[1], "w", encoding="ascii") as file:
    json.dump(results, file)
if len(sys.argv) > 2:
    with open(sys.argv[2], encoding="ascii") as file:
        compare(results, json.load(file))
    print("the same numbers")
