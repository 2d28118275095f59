"""lamella stress-pdf: numbers, tables, phases; what is refused."""

import csv
import json
import math
import random
import unittest

from program import Case

NX, NY = 60, 50


def image(values, phases=True, cells=False, name="stress", components=6):
    """A .vti of the phases void and solid, in halves, with these stresses (as texts) along y."""
    nx, ny = (NX + 1, NY + 1) if cells else (NX, NY)
    zero = " 0" * (components - 2)
    tensors = "\n".join(f"0 {v}{zero}" if components > 1 else str(v) for v in values)
    phase = "\n".join(" ".join("0" if x < NX // 2 else "1" for x in range(NX)) for _ in range(NY))
    arrays = f'<DataArray type="Float64" Name="{name}" NumberOfComponents="{components}" format="ascii">{tensors}</DataArray>'
    if phases:
        arrays += f'<DataArray type="UInt8" Name="phase" format="ascii">{phase}</DataArray>'
    kind = "CellData" if cells else "PointData"
    return f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">
<ImageData WholeExtent="0 {nx - 1} 0 {ny - 1} 0 0" Origin="0 0 0" Spacing="1e-6 1e-6 1e-6">
<FieldData><Array type="String" Name="phase_names" NumberOfTuples="2" format="ascii">
118 111 105 100 0 115 111 108 105 100 0
</Array></FieldData>
<Piece Extent="0 {nx - 1} 0 {ny - 1} 0 0"><{kind}>{arrays}</{kind}></Piece></ImageData></VTKFile>""".encode()


def stresses(seed=1):
    """Exponential with a mean of 2e5, a tenth of it turned round at a fifth of the size; huge in the void."""
    law = random.Random(seed)
    values = []
    for node in range(NX * NY):
        value = law.expovariate(1 / 2e5)
        values.append(1e3 * value if node % NX < NX // 2 else -value / 5 if node % 10 == 0 else value)
    return values


class Stresses(Case):
    def setUp(self):
        super().setUp()
        self.values = stresses()
        self.write("s.vti", image(self.values))
        self.solid = [v for node, v in enumerate(self.values) if node % NX >= NX // 2]
        self.tensile = [v for v in self.solid if v > 0]

    def test_numbers(self):
        mean = sum(self.tensile) / len(self.tensile)
        found = self.works("stress-pdf", "s.vti", "--threshold", "1", "--reference", "1e5", "--json").json()
        self.assertEqual(found["count"], len(self.solid))
        self.assertAlmostEqual(found["mean_tensile"] / mean, 1, 12)
        compressive = [v for v in self.solid if v < 0]
        self.assertAlmostEqual(found["mean_compressive"] * len(compressive) / sum(compressive), 1, 12)
        self.assertAlmostEqual(found["compressive_share"], len(compressive) / len(self.solid), 12)
        tail = [v / mean - 1 for v in self.tensile if v > mean]
        self.assertEqual(found["tail"]["count"], len(tail))
        self.assertAlmostEqual(found["tail"]["theta"], len(tail) / sum(tail), 10)
        self.assertAlmostEqual(found["tail"]["theta_error"], found["tail"]["theta"] / math.sqrt(len(tail)), 10)
        self.assertLess(abs(found["tail"]["theta"] - 1), 3 * found["tail"]["theta_error"])  # an exponential law
        self.assertEqual([row["phase"] for row in found["phases"]], ["all", "solid"])
        self.assertAlmostEqual(found["phases"][1]["mean_tensile_over_reference"], mean / 1e5, 10)
        self.assertEqual(found["component"], "yy")
        for row in found["thresholds"]:
            self.assertLess(abs(row["theta"] - 1), 4 * row["theta_error"])
        text = self.works("stress-pdf", "s.vti").out
        self.assertIn("yy of stress, 1 500 values", text)
        self.assertIn("solid", text)

    def test_components_and_phases(self):
        found = self.works("stress-pdf", "s.vti", "--component", "von-mises", "--json").json()
        self.assertEqual(found["compressive_share"], 0)
        both = self.works("stress-pdf", "s.vti", "--phase", "void", "--phase", "solid", "--json").json()
        self.assertEqual(both["count"], NX * NY)
        self.assertEqual([row["count"] for row in both["phases"]], [NX * NY, NX * NY // 2, NX * NY // 2])

    def test_tables(self):
        self.works("stress-pdf", "s.vti", "-o", "d.csv", "--phases", "p.csv", "--thresholds", "t.csv",
                   "--bin-width", "0.25", "--range=-2,16")
        with open(self.path("d.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual((len(rows), float(rows[0]["stress_low"])), (72, -2))
        self.assertEqual([row["count"] for row in rows], [row["count_solid"] for row in rows])
        self.assertAlmostEqual(sum(0.25 * float(row["density"]) for row in rows), 1, 12)
        with open(self.path("d.csv.json"), encoding="utf-8") as file:
            record = json.load(file)
        self.assertEqual(record["columns"]["stress"]["unit"], "mean tensile stress")
        self.assertEqual(record["provenance"]["inputs"][0]["name"], "s.vti")
        with open(self.path("p.csv"), encoding="ascii") as file:
            self.assertEqual([row["phase"] for row in csv.DictReader(file)], ["all", "solid"])
        with open(self.path("t.csv"), encoding="ascii") as file:
            self.assertGreater(len(list(csv.DictReader(file))), 5)
        self.works("stress-pdf", "s.vti", "--csv", "again.csv", "--bin-width", "0.25", "--range=-2,16", "--threads", "3")
        with open(self.path("again.csv"), encoding="ascii") as file:
            self.assertEqual([row["count"] for row in csv.DictReader(file)], [row["count"] for row in rows])
        self.fails(7, "'d.csv' exists already", "--overwrite", "stress-pdf", "s.vti", "-o", "d.csv")

    def test_cells_scalars_and_no_phases(self):
        self.write("c.vti", image(self.values, phases=False, cells=True, name="yy", components=1))
        found = self.works("stress-pdf", "c.vti", "--array", "yy", "--json").json()
        self.assertEqual((found["count"], found["component"]), (NX * NY, "as it is"))
        self.assertEqual([row["phase"] for row in found["phases"]], ["all"])

    def test_what_cannot_be_done(self):
        run = ["stress-pdf", "s.vti"]
        self.fails(2, "component 'von-mizes' is none of its choices", "did you mean 'von-mises'?", *run, "--component", "von-mizes")
        self.fails(2, "threshold -1 is below 0", "0 or more", *run, "--threshold=-1")
        self.fails(2, "threshold 'x' is not a number", "write it as --threshold NUMBER", *run, "--threshold", "x")
        self.fails(2, "range 3 to 1 is empty", "lower end first", *run, "--range", "3,1")
        self.fails(2, "bin width 0 is not above 0", "a number above 0", *run, "--bin-width", "0")
        self.fails(2, "reference -1 is below 0", "0 or more", *run, "--reference=-1")
        self.fails(2, "--threads 0", "number of cores", *run, "--threads", "0")
        self.fails(2, "-o 'pdf.txt'", ".csv", *run, "-o", "pdf.txt")
        self.fails(3, "no array 'sigma'", "stress", *run, "--array", "sigma")
        self.fails(2, "'stone' is no phase", "void, solid", *run, "--phase", "stone")
        self.fails(2, "beyond the threshold of 99", "lower threshold", *run, "--threshold", "99")
        self.fails(3, "there is no file 'no.vti'", "check the name", "stress-pdf", "no.vti")
        self.write("n.vti", image([*self.values[:-1], "nan"]))
        self.fails(3, "1 stresses are not finite", "compute the field again", "stress-pdf", "n.vti")
        self.write("v.vti", image(self.values, components=3))
        self.fails(3, "'stress' has 3 components", "a stress has 6", "stress-pdf", "v.vti")
        self.write("z.vti", image([-1] * (NX * NY)))
        self.fails(3, "is above 0", "another component", "stress-pdf", "z.vti")


if __name__ == "__main__":
    unittest.main()
