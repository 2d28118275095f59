"""lamella crack-path: paths, tables, fragments; what is refused."""

import csv
import json
import math
import unittest

from program import Case

SIZE = 48
SPACING = 1e-6
SLOPE = math.tan(math.radians(15))


def below(x, y):
    """Which side of the crack a node is on."""
    return y < 20.3 + SLOPE * x


def phase(x):
    return 1 + x // 12 % 2


def broken():
    """Bonds of horizon 2 that a straight crack cuts: first node, step."""
    steps = [(1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (0, 2)]
    return [
        (x, y, a, b)
        for y in range(SIZE)
        for x in range(SIZE)
        for a, b in steps
        if 0 <= x + a < SIZE and y + b < SIZE and below(x, y) != below(x + a, y + b)
    ]


def array(kind, name, components, values):
    text = " ".join(str(v) for v in values)
    return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">{text}</DataArray>'


def poly_data(bonds, leave_out=()):
    """The .vtp of broken bonds."""
    half = SPACING / 2
    places = [v for x, y, a, b in bonds for v in ((x + a / 2) * SPACING + half, (y + b / 2) * SPACING + half, 0)]
    points = {
        "bond": ("Float64", 3, [v for _, _, a, b in bonds for v in (a * SPACING, b * SPACING, 0)]),
        "event": ("Int64", 1, range(1, len(bonds) + 1)),
        "strain": ("Float64", 1, [1e-3 * (i + 1) / len(bonds) for i in range(len(bonds))]),
        "phases": ("UInt8", 2, [v for x, _, a, _ in bonds for v in sorted((phase(x), phase(x + a)))]),
        "between_grains": ("UInt8", 1, [0] * len(bonds)),
    }
    fields = {
        "spacing": [SPACING] * 3,
        "lattice_size": [SIZE, SIZE, 1],
        "lattice_origin": [half, half, 0],
        "horizon": [2],
    }
    names = " ".join(str(c) for name in ("void", "wall", "lamella") for c in (*name.encode(), 0))
    data = "".join(array(kind, name, n, v) for name, (kind, n, v) in points.items() if name not in leave_out)
    field = "".join(
        f'<DataArray type="Float64" Name="{name}" NumberOfTuples="{len(v)}" format="ascii">'
        + " ".join(str(x) for x in v)
        + "</DataArray>"
        for name, v in fields.items()
        if name not in leave_out
    )
    ids = " ".join(str(i) for i in range(len(bonds)))
    ends = " ".join(str(i + 1) for i in range(len(bonds)))
    return f"""<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>
<FieldData>{field}<Array type="String" Name="phase_names" NumberOfTuples="3" format="ascii">{names}</Array></FieldData>
<Piece NumberOfPoints="{len(bonds)}" NumberOfVerts="{len(bonds)}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
<PointData>{data}</PointData>
<Points>{array("Float64", "Points", 3, places)}</Points>
<Verts>{array("Int64", "connectivity", 1, ids.split())}{array("Int64", "offsets", 1, ends.split())}</Verts>
</Piece></PolyData></VTKFile>""".encode()


def image(size=SIZE):
    names = " ".join(str(c) for name in ("void", "wall", "lamella") for c in (*name.encode(), 0))
    nodes = array("UInt8", "phase", 1, [phase(x) for _ in range(size) for x in range(size)])
    return f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">
<ImageData WholeExtent="0 {size - 1} 0 {size - 1} 0 0" Origin="{SPACING / 2} {SPACING / 2} 0" Spacing="1e-6 1e-6 1e-6">
<FieldData><Array type="String" Name="phase_names" NumberOfTuples="3" format="ascii">{names}</Array></FieldData>
<Piece Extent="0 {size - 1} 0 {size - 1} 0 0"><PointData>{nodes}</PointData></Piece></ImageData></VTKFile>""".encode()


class Cracks(Case):
    def setUp(self):
        super().setUp()
        self.bonds = broken()
        self.write("b.vtp", poly_data(self.bonds))
        self.write("s.vti", image())

    def test_numbers(self):
        found = self.works("crack-path", "b.vtp", "--phases", "s.vti", "--json").json()
        length = SIZE * SPACING / math.cos(math.radians(15))
        self.assertEqual(found["broken_bonds"], len(self.bonds))
        self.assertEqual(found["cracks"], 1)
        self.assertAlmostEqual(found["length"] / length, 1, 2)
        self.assertAlmostEqual(found["angle"], 15, 0)
        self.assertEqual(found["main"]["through"], ["x"])
        # bonds broke from the left to the right
        main = found["main"]
        self.assertAlmostEqual(main["start"]["x"], 0, 12)
        self.assertAlmostEqual(main["tip"]["x"], SIZE * SPACING, 12)  # on the side itself
        self.assertAlmostEqual(main["tip"]["y"] / SPACING, 20.3 + SLOPE * (SIZE - 0.5) + 0.5, delta=0.5)
        self.assertAlmostEqual(main["extension"], found["length"], 12)
        self.assertEqual(set(found["through"]), {"x"})
        self.assertAlmostEqual(found["through"]["x"]["tortuosity"], 1, 3)
        self.assertAlmostEqual(found["counted_length"] / length, 1, 1)
        self.assertEqual(found["fragments"]["count"], 2)
        self.assertEqual(found["fragments"]["severed"], ["y"])
        (path,) = found["paths"]
        self.assertEqual({path["begin_x"], path["end_x"]}, {main["start"]["x"], main["tip"]["x"]})
        self.assertEqual((path["begins_at"], path["ends_at"]), ("side", "side"))
        self.assertAlmostEqual(path["tortuosity"], 1, 3)
        pairs = {row["pair"]: row for row in found["pairs"]}
        self.assertEqual(set(pairs), {"wall", "lamella", "wall-lamella"})
        self.assertAlmostEqual(sum(row["share"] for row in pairs.values()), 1)
        self.assertEqual(sum(row["bonds"] for row in pairs.values()), len(self.bonds))
        self.assertEqual(found["provenance"]["inputs"][0]["name"], "b.vtp")

    def test_without_an_image(self):
        found = self.works("crack-path", "b.vtp", "--json").json()
        self.assertNotIn("fragments", found)
        self.assertEqual(found["cracks"], 1)

    def test_files(self):
        run = self.works("crack-path", "b.vtp", "--phases", "s.vti", "-o", "p.vtp", "--table", "p.csv", "--pairs", "q.csv",
                         "--growth", "g.csv", "--fragments", "f.csv", "--image", "f.vti")
        for name in ("p.vtp", "p.csv", "q.csv", "g.csv", "f.csv", "f.vti"):
            self.assertIn("wrote " + name, run.out)
        with open(self.path("p.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 1)
        self.assertAlmostEqual(float(rows[0]["share_wall"]) + float(rows[0]["share_lamella"])
                               + float(rows[0]["share_wall-lamella"]), 1)
        with open(self.path("p.csv.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["columns"]["length"]["unit"], "m")
        with open(self.path("g.csv"), encoding="utf-8") as file:
            grown = [float(row["length"]) for row in csv.DictReader(file)]
        self.assertEqual(grown, sorted(grown))
        info = self.works("info", "f.vti", "--json").json()
        self.assertIn("fragment", json.dumps(info))
        self.fails(7, "exists", "--overwrite", "crack-path", "b.vtp", "-o", "p.vtp")
        self.works("crack-path", "b.vtp", "-o", "p.vtp", "--overwrite", "--quiet")

    def test_refused(self):
        self.write("no.vtp", poly_data(self.bonds, ["bond"]))
        self.write("lost.vtp", poly_data(self.bonds, ["lattice_size"]))
        self.write("small.vti", image(20))
        for code, message, hint, *words in (
            (3, "no array 'bond'", "lamella fracture", "no.vtp"),
            (3, "do not tell their lattice", "lamella fracture", "lost.vtp"),
            (3, "not on the lattice", "the image that was broken", "b.vtp", "--phases", "small.vti"),
            (3, "holds no broken bonds", "lamella fracture", "s.vti"),
            (3, "holds no image", "the image that was broken", "b.vtp", "--phases", "b.vtp"),
            (3, "missing.vtp", "", "missing.vtp"),
            (2, "minimum length nan is not a number", "-1 or more", "b.vtp", "--minimum-length", "nan"),
            (2, "minimum length -3 is below -1", "-1 or more", "b.vtp", "--minimum-length=-3"),
            (2, "horizon 12 is above 8", "0 to 8", "b.vtp", "--horizon", "12"),
            (2, "longer than the horizon", "give the horizon", "b.vtp", "--horizon", "1"),
            (2, "--image needs the image", "--phases IMAGE.vti", "b.vtp", "--image", "f.vti"),
            (2, "p.csv", "end the name in .vtp", "b.vtp", "-o", "p.csv"),
        ):
            self.fails(code, message, hint, "crack-path", *words)

    def test_no_crack(self):
        self.write("none.vtp", poly_data([]))
        run = self.run_lamella("crack-path", "none.vtp")
        self.assertEqual(run.code, 0, run.err)
        self.assertIn("no broken bond", run.err)


if __name__ == "__main__":
    unittest.main()
