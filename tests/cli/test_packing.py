"""lamella packing and lamella bridges: numbers, files, several seeds, and every mistake a user can make."""

import math
import os
import unittest

from program import Case

SMALL = ["--count", "60", "--softness", "1e-4"]
TABLE = b"x,z,r\n1,1,1\n3,1,1\n2,2.7320508,1\n"


class Packing(Case):
    def test_numbers(self):
        answer = self.works("packing", *SMALL, "--seed", "3", "--json").json()
        self.assertEqual(
            list(answer),
            ["seed", "dimension", "count", "box", "periodic", "packing_fraction", "aspect", "rattlers", "contacts",
             "wall_contacts", "coordination", "fabric", "stress", "fabric_anisotropy", "stress_anisotropy",
             "unbalanced_force", "pressure", "steps", "warnings", "files", "seconds", "version", "commit", "provenance"],
        )  # fmt: skip
        self.assertEqual((answer["count"], answer["seed"], answer["dimension"]), (60, 3, 2))
        # Disks jam between loose (0.76) and crystalline (0.907); walls make small packings looser.
        self.assertGreater(answer["packing_fraction"], 0.7)
        self.assertLess(answer["packing_fraction"], 0.9)
        self.assertAlmostEqual(answer["fabric"][0][0] + answer["fabric"][1][1], 1, places=12)
        self.assertAlmostEqual(answer["stress"][0][0], 1000, delta=1)
        self.assertAlmostEqual(answer["aspect"], 2, delta=0.05)
        self.assertEqual(answer["provenance"]["seed"], 3)
        self.assertIn("packing fraction", self.works("packing", *SMALL).out)
        self.assertEqual(self.works("packing", *SMALL, "--quiet").out, "")

    def test_files(self):
        self.works("packing", *SMALL, "-o", "g.vtp", "--contacts", "f.vtp", "--mean-diameter", "0.5mm")
        info = self.info("g.vtp")
        self.assertEqual(info["points"], 60)
        self.assertEqual(
            [array["name"] for array in info["point_arrays"]], ["radius", "diameter", "grain", "contacts", "rattler", "net_force", "normal_force"]
        )
        self.assertEqual(info["provenance"]["seed"], 1)
        forces = self.info("f.vtp")
        self.assertEqual(
            sorted(array["name"] for array in forces["cell_arrays"]),
            ["first", "force", "normal_force", "overlap", "second", "wall"],
        )
        self.assertEqual(next(a["unit"] for a in forces["cell_arrays"] if a["name"] == "force"), "N/m")
        # The same command, the same grains; as a table too, up to its box.
        self.works("packing", *SMALL, "-o", "g.csv", "--mean-diameter", "5e-4")
        with open(self.path("g.csv"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertEqual((lines[0], len(lines)), ("x,z,r", 61))
        radii = [float(line.split(",")[2]) for line in lines[1:]]
        self.assertAlmostEqual(2 * sum(radii) / 60, 5e-4, places=15)
        low, high = next(a["range"][0] for a in info["point_arrays"] if a["name"] == "radius")
        self.assertEqual((min(radii), max(radii)), (low, high))
        few = self.run_lamella("packing", "--dimension", "3", "--count", "40", "--aspect", "1", "--softness", "1e-3", "-o", "s.csv")
        self.assertEqual((few.code, "anisotropic" in few.err), (0, True))  # so few spheres have no better shape
        with open(self.path("s.csv"), encoding="utf-8") as file:
            self.assertEqual(file.readline(), "x,y,z,r\n")
        periodic = self.run_lamella("packing", *SMALL, "--periodic", "--packing-fraction", "60%", "-o", "p.csv")
        self.assertEqual(periodic.code, 0)
        self.assertIn("warning: a table does not tell that the box is periodic", periodic.err)

    def test_states(self):
        answer = self.works("packing", *SMALL, "--every", "200", "-o", "way.vtp", "--contacts", "f.vtp", "--json").json()
        states = [name for name in answer["files"] if name.startswith("way_")]
        self.assertGreater(len(states), 3)
        self.assertEqual(len(answer["files"]), 2 * len(states) + 2)  # the contacts of each, and two lists
        with open(self.path("way.pvd"), encoding="utf-8") as file:
            times = [float(line.split('timestep="')[1].split('"')[0]) for line in file if "timestep" in line]
        self.assertEqual((times[0], times), (0, sorted(times)))
        self.assertAlmostEqual(times[-1] / answer["steps"], 1, places=6)  # the last two may be of the same step
        self.assertEqual(self.info(states[-1])["points"], 60)
        # The end is what it is without states.
        plain = self.works("packing", *SMALL, "-o", "plain.vtp", "--json").json()
        for key in ("packing_fraction", "stress", "steps"):
            self.assertEqual(plain[key], answer[key])
        self.works("packing", *SMALL, "-o", "plain.csv")
        self.fails(2, "every -1 is below 0", "0 or more", "packing", "--every", "-1", "-o", "a.vtp")
        self.fails(2, "--every without a file to write to", "-o FILE.vtp", "packing", "--every", "100")
        self.fails(2, "--every with --seeds", "one --seed", "packing", "--every", "100", "--seeds", "1-2", "-o", "a_{seed}.vtp")
        self.fails(2, "-o 'a.csv': states are written as .vtp", "end the name in .vtp", "packing", "--every", "100", "-o", "a.csv")
        self.fails(7, "'way_000.vtp' exists already", "--overwrite", "packing", *SMALL, "--every", "200", "-o", "way.vtp")

    def test_what_falls_short_is_told(self):
        few = self.run_lamella("packing", "--count", "20", "--softness", "1e-5", "--json")
        self.assertEqual(few.code, 0)
        self.assertIn("warning: the aspect is ", few.err)  # so few disks have no shape near 2
        self.assertTrue(few.json()["warnings"])

    def test_seeds(self):
        answer = self.works("packing", *SMALL, "--seeds", "1-2,7", "--threads", "2", "-o", "p_{seed}.csv", "--json").json()
        self.assertEqual([sample["seed"] for sample in answer["samples"]], [1, 2, 7])
        self.assertEqual([sample["files"] for sample in answer["samples"]], [["p_1.csv"], ["p_2.csv"], ["p_7.csv"]])
        alone = self.works("packing", *SMALL, "--seed", "7", "-o", "alone.csv", "--json").json()
        self.assertEqual(alone["packing_fraction"], answer["samples"][2]["packing_fraction"])
        for one, other in (("p_7.csv", "alone.csv"), ("p_1.csv", "p_2.csv")):
            with open(self.path(one), "rb") as a, open(self.path(other), "rb") as b:
                self.assertEqual(a.read() == b.read(), other == "alone.csv")
        text = self.works("packing", *SMALL, "--seeds", "1,2").out
        self.assertIn("mean", text)

    def test_a_table_of_others(self):
        self.write("three.csv", TABLE)
        answer = self.works("packing", "--read", "three.csv", "--unit", "1mm", "-o", "t.vtp", "--json").json()
        self.assertEqual((answer["count"], answer["seed"], answer["contacts"]), (3, None, 3))  # held by each other and the box
        self.assertEqual([round(edge, 9) for edge in answer["box"]], [0.004, 0.003732051])
        self.assertEqual(answer["provenance"]["inputs"][0]["name"], "three.csv")
        boxed = self.works("packing", "--read", "three.csv", "--unit", "1mm", "--box", "4mm,8mm", "--json").json()
        self.assertAlmostEqual(boxed["packing_fraction"], 3 * math.pi / 32, places=12)
        self.write("tabs.txt", TABLE.replace(b",", b"\t"))
        self.assertEqual(self.works("packing", "--read", "tabs.txt", "--json").json()["count"], 3)

    def test_mistakes(self):
        def fails(message, hint, *words, code=2):
            self.fails(code, message, hint, "packing", *words)

        fails("3 grains", "10 to", "--count", "3")
        fails("dimension 4 is none of its choices", "one of 2, 3", "--dimension", "4")
        fails("--mean-diameter 'big' is not a length", "0.5um", "--mean-diameter", "big")
        fails("diameter ratio 20 is above 10", "1 to 10", "--diameter-ratio", "20")
        fails("sizes 'volumes' is none of its choices", "did you mean 'volume'?", "--sizes", "volumes")
        fails("aspect 9 is above 5", "0.2 to 5", "--aspect", "9")
        fails("friction -1 is below 0", "0 to 2", "--friction", "-1")
        fails("pressure 0 is not above 0", "a number above 0", "--pressure", "0")
        fails("softness 1 is above 0.01", "1e-07", "--softness", "1")
        fails("packing fraction 'much' is not a number", "SHARE", "--packing-fraction", "much")
        fails("packing fraction 2 is not below 1", "below 1", "--packing-fraction", "2")
        fails("the grains jam at a packing fraction of", "less", "--count", "60", "--packing-fraction", "0.95")
        fails("count 'ten' is not a number", "--count NUMBER", "--count", "ten")
        fails("--seed and --seeds contradict each other", "one of them", "--seed", "3", "--seeds", "1-4")
        fails("--seeds '4-1': '4-1' is no seed", "1-10", "--seeds", "4-1")
        fails("--seeds 'a': 'a' is no seed", "1-10", "--seeds", "a")
        fails("--seeds '1-99999' are too many", "10000", "--seeds", "1-99999")
        fails("--threads is for --seeds", "--seeds 1-10", "--threads", "2")
        fails("-o 'g.png' has no ending that can be written", ".vtp", "-o", "g.png")
        fails("--contacts 'f.csv' has no ending that can be written", ".vtp", "--contacts", "f.csv")
        fails("-o 'g.vtp' is one name for 3 packings", "pack_{seed}.vtp", "--seeds", "1-3", "-o", "g.vtp")
        fails("--unit is about a table", "--read", "--unit", "1mm")
        fails("--read takes a packing as it is, and --count makes one", "leave", "--read", "a.csv", "--count", "60")
        fails("--read takes a packing as it is, and --seeds makes one", "leave", "--read", "a.csv", "--seeds", "1-3")
        fails("--read is for tables", "lamella bridges", "--read", "a.vtp")
        fails("'--cuont' is not an option", "did you mean '--count'?", "--cuont", "60")
        self.write("g.vtp", b"precious")
        fails("'g.vtp' exists already", "--overwrite", *SMALL, "-o", "g.vtp", code=7)

    def test_bad_tables(self):
        def fails(text, message, hint, *words, code=3):
            self.write("t.csv", text)
            self.fails(code, message, hint, "packing", "--read", "t.csv", *words)

        self.fails(3, "there is no file 'nowhere.csv'", "check the name", "packing", "--read", "nowhere.csv")
        self.fails(3, "there is no file 'nowhere.csv'", "check the name", "bridges", "nowhere.csv")
        fails(b"", "'t.csv' is empty", "again")
        fails(b"\nx,z,r\n", "begins with an empty line", "names the columns")
        fails(b"x,z,r\n", "there are no grains", "at least one")
        fails(b"1,2,3\n", "has no line of names: it begins with '1', '2', '3'", "x,z,r or x,y,r for disks")
        fails(bytes(range(1, 200)) * 20, "is no table: its first line holds no names", "x,z,r or x,y,r for disks")
        fails(b"x,z,m\n1,2,3\n", "lacks the column r; separated by commas, it has 'x', 'z', 'm'", "x,z,r")
        fails(b"x:z:r\n1:2:3\n", "lacks the column y or z, r; separated by blanks, it has 'x:z:r'", "x,z,r")
        fails(b"x,z,r\n1,2,3\n1,two,3\n", "has the text 'two' where a number belongs, in row 3, column 'z'", "0.0012")
        fails(b"x;z;r\n1,5;2;3\n", "has a decimal comma: '1,5' in row 2, column 'x'", "decimal points, as in 1.5")
        fails(b"x,z,r\n1,2,\n", "has nothing in row 2, column 'r'", "every column")
        fails(b"x,z,r\n1,2\n", "has 3 columns, and 2 values in row 2", "for each name")
        fails(b"x,z,r\n3,2,1\n\n5,23,1\n6,24,1,7\n", "has 3 columns, and 4 values in row 5", "for each name")
        fails(b"x z  r\n1 2\n", "has 3 columns, and 2 values in row 2", "for each name")
        fails(b'x,name,z,r\n1,"a,\nb",2,3\n1,a,b,2,3\n', "has 4 columns, and 5 values in row 4", "for each name")
        fails(b"x,z,r\n1,1,0\n", "the radius of grain 1 is 0", "positive")
        fails(b"x,z,r\n1,1,1\n2,1,1\n", "grains 1 and 2 overlap", "diameters")
        fails(TABLE, "lies outside the box", "larger box", "--box", "2,2")
        fails(TABLE, "--unit 'inch' is not a length", "metres", "--unit", "inch", code=2)
        self.fails(3, "lies outside the box", "larger box", "bridges", "t.csv", "--box", "2,2")
        fails(TABLE, "box '3' is not 2 or 3 numbers", "--box X,Y[,Z]", "--box", "3", code=2)


class Bridges(Case):
    def setUp(self):
        super().setUp()
        self.works("packing", *SMALL, "-o", "g.vtp")

    def cements(self, *words):
        """On lattices so coarse there may be warnings."""
        result = self.run_lamella("bridges", *words)
        self.assertEqual(result.code, 0, result.err)
        return result

    def test_numbers(self):
        answer = self.cements("g.vtp", "--width", "0.7", "--nodes", "50", "--json").json()
        self.assertEqual(
            list(answer),
            ["file", "count", "size", "pixel_size", "width", "reach", "filled", "bridges", "grain_fraction",
             "matrix_fraction", "void_fraction", "saturation", "saturation_on_lattice", "phases", "files", "warnings", "seconds",
             "version", "commit", "provenance"],
        )  # fmt: skip
        self.assertEqual((answer["width"], answer["reach"], answer["size"][0]), (0.7, 1.1, 50))
        self.assertEqual([phase["name"] for phase in answer["phases"]], ["void", "matrix", "grain"])
        self.assertAlmostEqual(
            answer["saturation"],
            answer["matrix_fraction"] / (answer["matrix_fraction"] + answer["void_fraction"]),
            places=12,
        )
        # Of 50 × 100 nodes few lie on edges: the shares of the nodes are those of the geometry to a per cent or two.
        self.assertAlmostEqual(answer["saturation_on_lattice"], answer["saturation"], delta=0.03)
        self.assertEqual(answer["provenance"]["parameters"]["made_from"]["seed"], 1)
        text = self.cements("g.vtp", "--nodes", "50").out
        self.assertIn("saturation", text)
        self.assertIn("50 × ", text)

    def test_saturation_is_met(self):
        answer = self.cements("g.vtp", "--saturation", "40%", "--nodes", "40", "--json").json()
        self.assertAlmostEqual(answer["saturation"], 0.4, places=5)
        full = self.cements("g.vtp", "--filled", "--nodes", "40", "--json").json()
        self.assertEqual((full["saturation"], full["void_fraction"]), (1, 0))
        bare = self.cements("g.vtp", "--width", "0", "--nodes", "40", "--json").json()
        self.assertEqual(bare["matrix_fraction"], 0)

    def test_lattices(self):
        box = self.info("g.vtp")["field_data"]["box"]
        answer = self.cements("g.vtp", "--spacing", "50um", "--json").json()
        self.assertEqual(answer["size"][0], round(box[0] / 50e-6))
        thick = self.cements("g.vtp", "--spacing", "50um", "--platen", "0.5mm", "--json").json()
        self.assertAlmostEqual(thick["size"][1] - answer["size"][1], 2 * 0.5e-3 / 50e-6, delta=2)
        self.assertEqual(thick["saturation"], answer["saturation"])

    def test_what_is_written_goes_on(self):
        conductivities = []
        for name, value in (("void", 0.01), ("matrix", 0.2), ("grain", 1)):
            conductivities += ["--conductivity", f"{name}={value}"]
        effective = set()
        for name in ("b.vti", "b.png", "b.tif", "b.raw"):
            self.cements("g.vtp", "--nodes", "40", "-o", name)
            answer = self.works("diffusion", name, *conductivities, "--direction", "y", "--json").json()
            effective.add(answer["effective"]["y"])
        self.assertEqual(len(effective), 1)
        info = self.info("b.vti")
        self.assertEqual([array["name"] for array in info["point_arrays"]], ["phase", "grain"])
        self.assertEqual(info["field_data"]["width"], 0.5)
        self.works("snapshot", "b.vti", "-o", "b_drawn.png")
        self.works("snapshot", "g.vtp", "-o", "g_drawn.png")
        self.works("packing", *SMALL, "--contacts", "f.vtp")
        self.works("snapshot", "g.vtp", "--lines", "f.vtp", "-o", "f_drawn.png")
        self.assertGreater(os.path.getsize(self.path("f_drawn.png")), 5000)

    def test_spheres(self):
        self.run_lamella("packing", "--dimension", "3", "--count", "40", "--aspect", "1", "--softness", "1e-3", "-o", "s.vtp")
        answer = self.cements("s.vtp", "--nodes", "20", "-o", "s.vti", "--json").json()
        self.assertEqual(len(answer["size"]), 3)
        self.fails(2, "a PNG holds one picture", ".vti", "bridges", "s.vtp", "-o", "s.png")

    def test_mistakes(self):
        def fails(message, hint, *words, code=2):
            self.fails(code, message, hint, "bridges", *words)

        fails("FILE is missing", "see lamella bridges --help")
        fails("width and filled contradict each other", "one of", "g.vtp", "--width", "1", "--filled")
        fails("width and saturation contradict each other", "one of", "g.vtp", "--width", "1", "--saturation", "1%")
        fails("saturation and filled contradict each other", "one of", "g.vtp", "--filled", "--saturation", "1%")
        fails("nodes and spacing contradict each other", "one of", "g.vtp", "--nodes", "10", "--spacing", "1um")
        fails("width 3 is above 2", "0 to 2", "g.vtp", "--width", "3")
        fails("reach 0.5 is below 1", "1 to 2", "g.vtp", "--reach", "0.5")
        fails("saturation 1.5 is above 1", "0 to 1", "g.vtp", "--saturation", "1.5")
        fails("a saturation of 0.999 cannot be reached", "", "g.vtp", "--saturation", "0.999")
        fails("saturation 'wet' is not a number", "SHARE", "g.vtp", "--saturation", "wet")
        fails("nodes 1 is below 2", "2 or more", "g.vtp", "--nodes", "1")
        fails("spacing 1 makes 0 nodes across", "2 to 1000000", "g.vtp", "--spacing", "1m")
        fails("--platen 'thick' is not a length", "metres", "g.vtp", "--platen", "thick")
        fails("-o 'b.jpg' has no ending", "JPEG would blur", "g.vtp", "-o", "b.jpg")
        fails("--unit is for tables, and 'g.vtp' knows its lengths", "leave it out", "g.vtp", "--unit", "1mm")
        self.works("packing", *SMALL, "--contacts", "f.vtp")
        fails("'f.vtp': the points have no array 'radius'", "lamella packing", "f.vtp", code=3)
        self.cements("g.vtp", "--nodes", "20", "-o", "b.vti")
        fails("'b.vti' is an image, not a packing", "x,z,r", "b.vti", code=3)
        with open(self.path("g.vtp"), "rb") as file:
            data = file.read()
        self.write("cut.vtp", data[: len(data) // 2])
        fails("'cut.vtp' is a .vtp file that is damaged or cut short", "again", "cut.vtp", code=3)
        self.write("full.raw.json", b"precious")
        fails("'full.raw.json' exists already", "--overwrite", "g.vtp", "-o", "full.raw", code=7)


if __name__ == "__main__":
    unittest.main()
