"""lamella transient: heating, the end at rest, files, several ranks; what is doubtful and what is refused."""

import json
import unittest

import pictures
from program import Case

LAYERS = ["transient", "layers.png", "--phase", "0=slow", "--phase", "255=fast", "--pixel-size", "1um",
          "--diffusivity", "slow=1e-8", "--diffusivity", "fast=1e-7"]


class Transient(Case):
    def setUp(self):
        super().setUp()
        self.write("layers.png", pictures.png([[0 if y < 8 else 255] * 24 for y in range(16)]))

    def test_comes_to_rest_in_layers(self):
        found = self.works(*LAYERS, "--direction", "y", "--end-time", "0.2", "--frames", "4", "--json").json()
        curve = found["curve"]
        # a pair of steps divides the interval
        for row, time in zip(curve, (0, 0.05, 0.1, 0.15, 0.2)):
            self.assertAlmostEqual(row["time"], time, places=14)
        self.assertEqual(curve[0]["mean_value"], 0)
        # in series, 2/(1/D1 + 1/D2) over 16 um: 0.2 s are some 30 of the slowest decay times
        flux = 2 / (1e8 + 1e7) / 16e-6
        self.assertAlmostEqual(curve[-1]["inlet_flux"] / flux, 1, places=9)
        self.assertAlmostEqual(curve[-1]["outlet_flux"] / flux, 1, places=9)
        # 1 at the top, 1/11 at the interface: the mean of two trapezia
        self.assertAlmostEqual(curve[-1]["mean_value"], (1 + 1 / 11 + 1 / 11) / 4, places=9)
        self.assertEqual((found["stepping"], found["lattice"], found["warning"]), ("trt", "d2q5", ""))
        self.assertEqual((found["stored_nodes"], found["skipped_nodes"]), (384, 0))

    def test_files(self):
        words = [*LAYERS, "--end-time", "1e-3", "--frames", "3", "--flux", "-o", "heat.vti", "--curve", "heat.csv"]
        self.assertIn("steps of", self.works(*words).out)
        with open(self.path("heat.pvd"), encoding="utf-8") as file:
            series = file.read()
        for k in range(4):
            self.assertIn("heat_%03d.vti" % k, series)
            told = self.info("heat_%03d.vti" % k)
            self.assertEqual(sorted(a["name"] for a in told["point_arrays"] if a["name"] != "phase"), ["flux", "temperature"])
        with open(self.path("heat.csv"), encoding="utf-8") as file:
            self.assertEqual(file.readline().strip(), "time,inlet_flux,outlet_flux,mean_value")
            self.assertEqual(len(file.readlines()), 4)
        with open(self.path("heat.csv.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["columns"]["inlet_flux"]["unit"], "m/s")
        self.fails(7, "heat_000.vti", "--overwrite", *words)

    def test_ranks_give_the_same(self):
        words = [*LAYERS, "--end-time", "1e-3", "--frames", "2", "--json"]
        one = self.works(*words).json()["curve"]
        two = self.run_lamella(*words, ranks=2)
        self.assertEqual(two.code, 0, two.err)
        for a, b in zip(one, two.json()["curve"]):
            for name, value in a.items():
                self.assertAlmostEqual(value, b[name], delta=1e-12 * abs(value))  # sums in another order

    def test_one_relaxation_time_warns(self):
        result = self.run_lamella(*LAYERS, "--end-time", "1e-3", "--stepping", "bgk", "--step", "1e-5", "--json")
        self.assertEqual(result.code, 0, result.err)
        self.assertIn("warning: ", result.err)
        self.assertIn("use trt", result.json()["warning"])

    def test_refuses(self):
        known = [*LAYERS, "--end-time", "1"]
        self.fails(2, "no --end-time was given", "in seconds", *LAYERS)
        self.fails(2, "--end-time '0'", "in seconds", *LAYERS, "--end-time", "0")
        self.fails(2, "--frames 0 is not", "until --end-time", *known, "--frames", "0")
        self.fails(2, "--values '1'", "such as 1,0", *known, "--values", "1")
        self.fails(2, "--diffusivity 'slow=-1'", "m²/s", *known, "--diffusivity", "slow=-1")
        self.fails(2, "--flux without a file", "-o FILE.vti", *known, "--flux")
        self.fails(2, "lattice d3q7 does not fit", "d2q5", *known, "--lattice", "d3q7")
        self.fails(2, "has no diffusivity", "give one to each phase", *LAYERS[:-2], "--end-time", "1")
        self.write("bare.png", pictures.png([[0] * 9] * 9))
        self.fails(2, "needs the size of a pixel", "--pixel-size", "transient", "bare.png", "--phase", "0=a",
                   "--diffusivity", "a=1", "--end-time", "1")


if __name__ == "__main__":
    unittest.main()
