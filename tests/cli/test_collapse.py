"""lamella compression-curve and collapse-map: numbers, tables, what is refused."""

import csv
import json
import unittest

from program import Case


def curve(end=0.8, names="strain,stress", law=None):
    """200 MPa, flat at 4 MPa from 2 %, a parabola beyond 50 %."""
    rows = [names]
    for i in range(round(end * 1000) + 1):
        e = i * 1e-3
        stress = law(e) if law else min(2e8 * e, 4e6) + (4e8 * (e - 0.5) ** 2 if e > 0.5 else 0)
        rows.append(f"{e},{stress}")
    return ("\n".join(rows) + "\n").encode()


class Curve(Case):
    def test_numbers(self):
        self.write("c.csv", curve())
        found = self.works("compression-curve", "c.csv", "--stiffness-range", "0,0.015", "--plateau-range", "0.2,0.4",
                           "-o", "e.csv", "--json").json()
        self.assertAlmostEqual(found["stiffness"]["value"] / 2e8, 1, 9)
        self.assertEqual(found["stiffness"]["rows"], 16)
        self.assertAlmostEqual(found["yield"]["strain"], 0.022, 2)  # smoothed over 1 %
        self.assertIsNone(found["peak"])
        self.assertAlmostEqual(found["plateau"]["stress"] / 4e6, 1, 9)
        self.assertAlmostEqual(found["densification"]["strain"], 0.51, 2)
        self.assertEqual(len(found["missing"]), 1)
        self.assertEqual(found["files"], ["e.csv"])
        with open(self.path("e.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 801)
        self.assertAlmostEqual(float(rows[20]["absorbed_energy"]), 4e4, 3)
        with open(self.path("e.csv.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["columns"]["absorbed_energy"]["unit"], "J/m^3")
        self.fails(7, "'e.csv' exists already", "--overwrite", "compression-curve", "c.csv", "-o", "e.csv")

    def test_words(self):
        self.write("c.csv", curve(0.4, "eps,sigma"))
        text = self.works("compression-curve", "c.csv", "--strain", "eps", "--stress", "sigma").out
        self.assertIn("densification  none", text)
        self.assertIn("the efficiency does not fall before the curve ends", text)
        self.assertIn("plateau        none", text)

    def test_what_cannot_be_done(self):
        self.write("c.csv", curve())
        run = ["compression-curve", "c.csv"]
        self.fails(2, "stiffness range '0.03' is not 2 numbers", "--stiffness-range FROM,TO", *run, "--stiffness-range", "0.03")
        self.fails(2, "plateau range 0.4 to 0.2 is empty", "lower end first", *run, "--plateau-range", "0.4,0.2")
        self.fails(2, "offset -1 is below 0", "0 to below 1", *run, "--offset=-1")
        self.fails(2, "smoothing nan is not a number", "0 to 1", *run, "--smoothing", "nan")
        self.fails(2, "-o 'e.txt'", ".csv", *run, "-o", "e.txt")
        self.fails(2, "a window of 0.1 does not fit", "up to that of the range", *run, "--window", "0.1")
        self.fails(3, "lacks the column 'force'", "--strain and --stress", *run, "--stress", "force")
        self.fails(3, "there is no file 'no.csv'", "check the name", "compression-curve", "no.csv")
        bad = {
            b"strain,stress\n0,0\n0.1,1\n": ("a curve of 2 rows", "at least 3"),
            b"strain,stress\n0,0\n0.1,x\n0.2,2\n": ("has the text 'x' where a number belongs, in row 3", "0.0012"),
            b"strain,stress\n0,0\n0.1,nan\n0.2,2\n": ("stress nan in row 1", "leave such rows out"),
            b"strain,stress\n0,0\n0.2,1\n0.1,2\n": ("does not rise from 0.2 in row 1 to 0.1", "compression as positive"),
            b"strain,stress\n0,0\n1,1\n2,2\n": ("a strain of 1 in row 1", "0.48 for 48 %"),
            b"strain,stress\n0,0\n.1,-1\n.2,-2\n": ("do a work of", "positive numbers"),
            b"0,0\n0.1,1\n0.2,2\n": ("has no line of names", "--strain and --stress"),
            b"": ("is empty", ""),
        }
        for content, (message, hint) in bad.items():
            self.write("b.csv", content)
            self.fails(3, message, hint, "compression-curve", "b.csv")


NX, NY = 20, 8


def wall(x, y):
    return x % 6 < 2 or y < 2 or y >= 6


def image():
    phase = "\n".join(" ".join("1" if wall(x, y) else "0" for x in range(NX)) for y in range(NY))
    return f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">
<ImageData WholeExtent="0 {NX - 1} 0 {NY - 1} 0 0" Origin="5e-7 5e-7 0" Spacing="1e-6 1e-6 1e-6">
<FieldData><Array type="String" Name="phase_names" NumberOfTuples="2" format="ascii">
108 117 109 101 110 0 119 97 108 108 0
</Array></FieldData>
<Piece Extent="0 {NX - 1} 0 {NY - 1} 0 0"><PointData>
<DataArray type="UInt8" Name="phase" format="ascii">{phase}</DataArray>
</PointData></Piece></ImageData></VTKFile>""".encode()


def points(height, strain=None, name="id", drop=0):
    """A point a node of the wall, pressed along y; in an order that is not theirs."""
    places = [(x, y) for y in range(NY) for x in range(NX) if wall(x, y)]
    order = list(reversed(range(len(places))))[drop:]
    position = " ".join(f"{(places[i][0] + 0.5) * 1e-6} {height * (places[i][1] + 0.5) * 1e-6} 0" for i in order)
    ids = " ".join(map(str, order))
    gradient = f"1 0 0 {height} " * len(order)
    told = "" if strain is None else f"""<FieldData><DataArray type="Float64" Name="strain" NumberOfTuples="1" format="ascii">
{strain}</DataArray></FieldData>"""
    return f"""<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>{told}
<Piece NumberOfPoints="{len(order)}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{position}</DataArray></Points>
<PointData><DataArray type="UInt32" Name="{name}" format="ascii">{ids}</DataArray>
<DataArray type="Float64" Name="deformation_gradient" NumberOfComponents="4" format="ascii">{gradient}</DataArray></PointData>
</Piece></PolyData></VTKFile>""".encode()


class Map(Case):
    def setUp(self):
        super().setUp()
        self.write("t.vti", image())
        for strain in (0.3, 0.6):
            self.write(f"s{strain}.vtp", points(1 - strain, strain))

    def test_numbers(self):
        found = self.works("collapse-map", "t.vti", "s0.3.vtp", "s0.6.vtp", "-o", "m.vti", "--table", "l.csv",
                           "--states", "s.csv", "--json").json()
        self.assertEqual((found["lumens"], found["cut"], found["collapsed"]), (3, 0, 3))
        self.assertAlmostEqual(found["first_collapse_strain"], 0.5, 9)  # 0.7 at 0.3, 0.4 at 0.6
        self.assertAlmostEqual(found["ratio"], 0.4, 9)
        self.assertEqual([row["collapsed"] for row in found["states"]], [0, 3])
        self.assertEqual(found["files"], ["m.vti", "l.csv", "s.csv"])
        with open(self.path("l.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["lumen"] for row in rows], ["1", "2", "3"])
        self.assertAlmostEqual(float(rows[2]["collapse_strain"]), 0.5, 9)
        self.assertIn("collapse_strain", [array["name"] for array in self.info("m.vti")["point_arrays"]])
        text = self.works("collapse-map", "t.vti", "s0.3.vtp", "s0.6.vtp", "--share", "30%").out
        self.assertIn("3 lumens of 'lumen', 0 cut by the rim", text)
        self.assertIn("none collapsed", text)

    def test_strains_by_hand(self):
        self.write("n.vtp", points(0.25))
        found = self.works("collapse-map", "t.vti", "n.vtp", "--strains", "0.75", "--json").json()
        self.assertAlmostEqual(found["first_collapse_strain"], 0.5, 9)
        self.fails(3, "'n.vtp' does not tell its strain", "--strains", "collapse-map", "t.vti", "n.vtp")

    def test_what_cannot_be_done(self):
        run = ["collapse-map", "t.vti", "s0.3.vtp"]
        self.fails(2, "share 1.5 is not below 1", "above 0 and below 1", *run, "--share", "1.5")
        self.fails(2, "minimum size -1 is below 0", "0 or more", *run, "--minimum-size=-1")
        self.fails(2, "--strains gives 2 strains for 1 files", "one strain a file", *run, "--strains", "0.1,0.2")
        self.fails(2, "--strains '0.2,0.1' are not rising", "0.05,0.12", *run, "s0.6.vtp", "--strains", "0.2,0.1")
        self.fails(2, "-o 'm.png'", ".vti", *run, "-o", "m.png")
        self.fails(2, "POINTS is missing", "--help", "collapse-map", "t.vti")
        self.fails(2, "'resin' is no phase", "'lumen' and 'wall'", *run, "--lumen", "resin")
        self.fails(3, "all 3 lumens are smaller than 17 nodes", "smaller ones", *run, "--minimum-size", "17")
        self.fails(3, "there is no file 'no.vtp'", "check the name", "collapse-map", "t.vti", "no.vtp")
        self.fails(3, "holds no image", ".vti", "collapse-map", "s0.3.vtp", "s0.3.vtp")
        self.fails(3, "holds no material points", ".vtp", "collapse-map", "t.vti", "t.vti")
        self.fails(3, "a strain of 0.3 after one of 0.6", "rising strain", "collapse-map", "t.vti", "s0.6.vtp", "s0.3.vtp")
        self.write("b.vtp", points(1, 0.1, name="number"))
        self.fails(3, "no array 'id'", "deformation_gradient", "collapse-map", "t.vti", "b.vtp")
        self.write("d.vtp", points(1, 0.1, drop=1))
        self.fails(3, "111 points for 112 nodes of the wall", "all of them", "collapse-map", "t.vti", "d.vtp")


if __name__ == "__main__":
    unittest.main()
