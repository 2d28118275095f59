"""lamella pore-flood-fill: numbers, tables, labels, on several ranks; what is refused."""

import csv
import json
import unittest

import pictures
from program import Case

#: the top row first; 0 is void: a pore of 3 in the upper left corner, one of 1, and two that touch by a corner
PICTURE = [
    [0, 0, 0, 255, 255, 255, 255, 255],
    [255, 255, 255, 255, 255, 255, 255, 255],
    [255, 255, 255, 255, 255, 0, 255, 255],
    [255, 255, 255, 255, 255, 255, 255, 255],
    [255, 0, 0, 255, 255, 255, 255, 255],
    [255, 255, 255, 0, 255, 255, 255, 255],
]
FILL = ["pore-flood-fill", "p.png", "--phase", "0=void", "--other", "solid"]


class Pores(Case):
    def setUp(self):
        super().setUp()
        self.write("p.png", pictures.png(PICTURE, pixels_per_metre=2000000))

    def test_numbers(self):
        found = self.works(*FILL, "--connectivity", "4", "--json").json()
        self.assertEqual(
            [found[key] for key in ("count", "largest", "mean", "total")], [4, 3, 7 / 4, 7])
        self.assertEqual(found["unit"], "pixels")
        self.assertAlmostEqual(found["porosity"], 7 / 48)
        self.assertEqual(found["phase"], "void")
        self.assertEqual(found["open"]["count"], 2)
        self.assertEqual(found["percolates"], [])
        self.assertEqual(found["largest_pore"]["window"], [0, 0, 3, 1])  # from the top, as --window
        self.assertEqual(found["largest_pore"]["touches"], ["left", "top"])
        self.assertAlmostEqual(found["largest_pore"]["equivalent_diameter"], 2 * (3 * 0.25e-12 / 3.14159265359) ** 0.5)
        self.assertEqual([c["count"] for c in found["distribution"]], [2, 2])
        corners = self.works(*FILL, "--connectivity", "8", "--json").json()
        self.assertEqual((corners["count"], corners["largest"]), (3, 3))
        one = self.works(*FILL, "--fill", "solid", "--json").json()
        self.assertEqual((one["count"], one["percolates"]), (1, ["x", "y"]))

    def test_the_largest_pore_is_where_its_window_says(self):
        window = self.works(*FILL, "--fill", "void", "--json").json()["largest_pore"]["window"]
        cut = self.works(*FILL, "--window", ",".join(map(str, window)), "--json").json()
        self.assertEqual((cut["count"], cut["total"], cut["porosity"]), (1, 3, 1))

    def test_periodic_and_minimum_size(self):
        found = self.works(*FILL, "--periodic", "xy", "--connectivity", "8", "--minimum-size", "2", "--json").json()
        # The corner pore goes on at the bottom, where the last pixel of the diagonal pair touches it by a corner.
        self.assertEqual((found["count"], found["largest"]), (1, 6))
        self.assertEqual(found["dropped"], {"count": 1, "total": 1})
        self.assertEqual(found["periodic"], ["x", "y"])
        result = self.run_lamella(*FILL, "--minimum-size", "9", "--json")
        self.assertEqual(result.code, 0)
        self.assertIn("warning: all 4 pores are smaller than 9", result.err)
        self.assertEqual(result.json()["count"], 0)

    def test_order(self):
        self.works(*FILL, "--no-sort-by-size", "-o", "p.csv")
        with open(self.path("p.csv"), encoding="ascii") as file:
            self.assertEqual([row["size"] for row in csv.DictReader(file)], ["1", "2", "1", "3"])  # from the bottom

    def test_table_labels_and_distribution(self):
        result = self.works(*FILL, "-o", "p.csv", "-o", "p.vti", "--distribution", "d.csv")
        self.assertIn("pores      4", result.out)
        self.assertIn("wrote p.vti", result.out)
        with open(self.path("p.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["pore"] for row in rows], ["1", "2", "3", "4"])
        self.assertEqual([row["size"] for row in rows], ["3", "2", "1", "1"])
        self.assertAlmostEqual(float(rows[0]["centre_y"]), 5.5 * 0.5e-6)  # y of the data points up
        self.assertEqual(rows[0]["touches_y_max"], "1")
        with open(self.path("p.csv.json"), encoding="utf-8") as file:
            record = json.load(file)
        self.assertEqual(record["columns"]["centre_y"]["unit"], "m")
        self.assertEqual(record["provenance"]["inputs"][0]["name"], "p.png")
        with open(self.path("d.csv"), encoding="ascii") as file:
            self.assertEqual([row["nodes"] for row in csv.DictReader(file)], ["2", "5"])
        labels = self.info("p.vti")
        self.assertEqual([array["name"] for array in labels["point_arrays"]], ["phase", "pore", "pore_size"])
        self.works("snapshot", "p.vti", "--preset", "pores", "-o", "p2.png")
        again = self.works("pore-flood-fill", "p.vti", "--json").json()
        self.assertEqual(again["count"], 4)
        self.fails(7, "'p.csv' exists already", "--overwrite", *FILL, "-o", "p.csv")
        self.works(*FILL, "-o", "p.csv", "--overwrite")

    def test_ranks_and_threads_change_nothing(self):
        self.works("generate", "softwood", "--size", "150,130", "-o", "t.png")
        once = ["--json", "--overwrite"]
        for words in [[], ["--connectivity", "8", "--periodic", "xy", "--fill", "wall"]]:
            one = self.works("pore-flood-fill", "t.png", *words, "-o", "1.csv", *once).json()
            three = self.works("pore-flood-fill", "t.png", *words, "-o", "3.csv", *once, ranks=3).json()
            many = self.works("pore-flood-fill", "t.png", *words, "-o", "t.csv", *once,
                              "--threads", "3").json()
            self.assertEqual(three["ranks"], 3)
            tables = []
            for name in ["1.csv", "3.csv", "t.csv"]:
                with open(self.path(name), "rb") as file:
                    tables.append(file.read())
            self.assertEqual(tables[0], tables[1])
            self.assertEqual(tables[0], tables[2])
            for key in ["count", "largest", "mean", "total", "open", "largest_pore", "distribution"]:
                self.assertEqual(one[key], three[key], key)
                self.assertEqual(one[key], many[key], key)

    def test_what_cannot_be_done(self):
        self.fails(3, "no node of the image is 'air'", "choose another phase", "pore-flood-fill", "p.png", "--phase",
                   "7=air", "--other", "solid")
        self.fails(2, "--fill names 'viod'", "did you mean 'void'?", *FILL, "--fill", "viod")
        self.fails(2, "--fill names 'stone'", "'void' and 'solid'", *FILL, "--fill", "stone")
        self.fails(2, "is called void", "black", "pore-flood-fill", "p.png",
                   "--phase", "0=black", "--phase", "255=white")
        self.fails(2, "connectivity 6", "4", *FILL, "--connectivity", "6")
        self.fails(2, "connectivity 5 is none of its choices", "18, 26", *FILL, "--connectivity", "5")
        self.fails(2, "minimum size -1 is below 0", "0 or more", *FILL, "--minimum-size=-1")
        self.fails(2, "periodic 'q' is not axes", "AXES", *FILL, "--periodic", "q")
        self.fails(2, "a picture is to be periodic along z", "leave z out", *FILL, "--periodic", "xz")
        self.fails(2, "-o 'a.txt': labels are written as .vti", "end the name", *FILL, "-o", "a.txt")
        self.fails(2, "--distribution 'a.txt'", ".csv", *FILL, "--distribution", "a.txt")
        self.fails(3, "'q.png'", "", "pore-flood-fill", "q.png", "--phase", "0=void")
        self.works("generate", "spheres", "--size", "12,12,12", "-o", "s.vti")
        self.fails(2, "connectivity 8", "6", "pore-flood-fill", "s.vti", "--fill",
                   "matrix", "--connectivity", "8")
        # Told once, although every rank sees it; mpirun adds words of its own.
        result = self.run_lamella("pore-flood-fill", "p.png", "--phase", "7=air", "--other", "solid", ranks=2)
        self.assertEqual(result.code, 3)
        self.assertEqual(result.err.count("error: no node of the image is 'air'"), 1, result.err)
        self.assertEqual(result.err.count("error: "), 1, result.err)


if __name__ == "__main__":
    unittest.main()
