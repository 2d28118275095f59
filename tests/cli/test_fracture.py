"""lamella fracture: numbers, files, states, several ranks, interruption; what is refused."""

import csv
import os
import re
import resource
import signal
import subprocess
import time
import unittest

import pictures
from program import PROGRAM, Case

STRIP = ["fracture", "strip.png", "--phase", "255=stone", "--phase", "100=glue", "--young", "stone=2e9", "--young",
         "glue=1e9", "--like", "glue-stone=glue"]
BREAKS = ["--critical-stretch", "stone=0.01", "--critical-stretch", "glue=0.002"]


class Fracture(Case):
    def setUp(self):
        super().setUp()
        # a layer of glue across, slightly inclined
        rows = [[100 if abs(y - 20 - x // 10) < 3 else 255 for x in range(30)] for y in range(44)]
        self.write("strip.png", pictures.png(rows, pixels_per_metre=100000))

    def test_numbers(self):
        found = self.works(*STRIP, *BREAKS, "--json").json()
        self.assertEqual((found["end"], found["method"], found["breaking"]), ("stress-fell", "events", "strict"))
        self.assertEqual((found["load"], found["axis"], found["compression"]), ("stretch", "y", False))
        self.assertEqual(found["broken"], sum(found["broken_by_pair"].values()))
        self.assertEqual(found["broken"], found["statistics"]["events"])
        self.assertLessEqual(set(found["broken_by_pair"]), {"glue", "glue-stone"})
        self.assertGreaterEqual(found["peak_stress"], found["first_break"]["stress"])
        self.assertAlmostEqual(found["first_break"]["stress"] / found["first_break"]["strain"] / found["effective_modulus"],
                               1, places=5)
        self.assertIn("glue", found["first_break"]["phases"])
        self.assertEqual(len(found["states"]), 1)
        self.assertLessEqual(found["states"][0]["stress"], 0.05 * found["peak_stress"])
        self.assertEqual(found["statistics"]["states_seconds"] < 0.1, True)  # no fields without a file
        checked = self.works(*STRIP, *BREAKS, "--method", "accurate", "--json").json()
        self.assertAlmostEqual(checked["peak_stress"] / found["peak_stress"], 1, places=3)
        self.assertAlmostEqual(checked["broken_energy"] / found["broken_energy"], 1, delta=0.02)
        batched = self.works(*STRIP, *BREAKS, "--breaking", "batched", "--json").json()
        self.assertEqual(batched["method"], "accurate")
        self.assertLess(batched["statistics"]["events"], batched["broken"])

    def test_a_cell_that_bursts(self):
        squares = [[(x - 19.5) ** 2 + (y - 19.5) ** 2 for x in range(40)] for y in range(40)]
        ring = [[0 if r < 9**2 else 255 if r < 15**2 else 128 for r in row] for row in squares]
        self.write("ring.png", pictures.png(ring, pixels_per_metre=100000))
        cell = ["fracture", "ring.png", "--phase", "255=wall,0=lumen,128=air", "--young", "wall=2e9", "--critical-stretch",
                "wall=0.01", "--pressure-in", "lumen", "--load", "pressure"]  # fmt: skip
        found = self.works(*cell, "--json").json()
        self.assertEqual((found["load"], found["method"], found["suction"]), ("pressure", "accurate", False))
        self.assertGreater(found["broken"], 20)
        self.assertGreaterEqual(found["peak_stress"], found["first_break"]["stress"])
        # of the same sample, by the same solver
        linear = self.works("equilibrium", *cell[1:], "--json").json()
        self.assertAlmostEqual(found["first_break"]["stress"] / linear["first_break"]["stress"], 1, places=5)
        self.assertAlmostEqual(found["effective_modulus"] / linear["effective_modulus"], 1, places=5)
        sucked = self.works(*cell, "--suction", "--max-broken", "1", "--json").json()
        self.assertTrue(sucked["suction"])
        self.assertIn("suction", self.works(*cell, "--suction", "--max-broken", "1").out)
        self.fails(2, "a pressure with local corrections", "accurate", *cell, "--method", "events")
        self.fails(2, "compression of a sample under a pressure", "suction", *cell, "--compression")
        self.fails(2, "a window error of a sample under a pressure", "leave it out", *cell, "--window-error")
        self.fails(2, "suction", "load pressure", *cell[:-4], "--suction")

    def test_cracks_that_close(self):
        # through the upper stone from side to side; 22 rows of 30 micrometres
        notched = [*STRIP, *BREAKS, "--compression", "--notch", "0,360um,150um,360um", "--max-broken", "3", "--json"]
        whole = self.works(*STRIP, *BREAKS, "--compression", "--max-broken", "3", "--json").json()
        cut = self.works(*notched).json()
        closed = self.works(*notched, "--contact").json()
        self.assertEqual((cut["contact"], closed["contact"], closed["method"]), (False, True, "accurate"))
        self.assertLess(cut["effective_modulus"], 0.9 * whole["effective_modulus"])
        self.assertAlmostEqual(closed["effective_modulus"] / whole["effective_modulus"], 1, places=2)  # steep bonds open
        self.assertIn("cracks close", self.works(*notched[:-1], "--contact").out)
        self.fails(2, "contact of cracks with local corrections", "accurate", *notched, "--contact", "--method", "events")
        self.fails(2, "a sensitivity of a sample whose notches close", "the notches", *notched, "--contact", "--sensitivity")
        self.fails(2, "contact of cracks under a pressure", "by platens", *STRIP, *BREAKS, "--contact", "--load", "pressure")

    def test_cycles(self):
        turns = [*STRIP, *BREAKS, "--turning-points", "3e-3,-3e-3", "--cycles", "2"]
        self.assertIsNone(self.works(*STRIP, *BREAKS, "--json").json()["branches"])
        found = self.works(*turns, "--contact", "--curve", "c.csv", "--json").json()
        self.assertEqual((found["end"], found["method"]), ("last-turn", "accurate"))
        branches = found["branches"]
        self.assertEqual([branch["to"] for branch in branches], [3e-3, -3e-3] * 2)
        self.assertEqual(sum(branch["broken"] for branch in branches), found["broken"])
        self.assertGreater(branches[0]["released"], 0)
        self.assertLess(branches[2]["modulus"], 0.1 * branches[1]["modulus"])  # pulled it is soft, pressed stiff
        self.assertAlmostEqual(found["trough_stress"] / min(branch["stress"] for branch in branches), 1, places=9)
        with open(self.path("c.csv"), newline="", encoding="utf-8") as file:
            strains = [float(row["strain"]) for row in csv.DictReader(file)]
        self.assertEqual((strains[0], min(strains), strains[-1]), (0, -3e-3, -3e-3))
        self.assertIn("branch to strain", self.works(*turns).out)
        self.fails(2, "2 cycles without turning points", "the strains", *STRIP, *BREAKS, "--cycles", "2")
        self.fails(2, "turning points and a largest strain", "leave the latter out", *turns, "--max-strain", "0.01")
        self.fails(2, "raised in steps", "leave the steps out", *turns, "--strain-step", "1e-4")
        self.fails(2, "turns round with local corrections", "accurate", *turns, "--method", "events")
        self.fails(2, "a load that turns round", "leave the window", *turns, "--window-error")
        self.fails(2, "a sensitivity of the first break under a load that turns", "leave the sensitivity", *turns, "--sensitivity")
        self.fails(2, "where it is already", "differ", *STRIP, *BREAKS, "--turning-points", "1e-3,1e-3")
        self.fails(2, "states at strains", "broken bonds", *turns, "--at-strain", "1e-3", "-o", "s.vti")

    def test_surfaces_that_lie_elsewhere(self):
        self.write("cell.png", pictures.png([[0 if (x - 20) ** 2 + (y - 22) ** 2 < 100 else 255 for x in range(40)] for y in range(44)],
                                            pixels_per_metre=100000))  # fmt: skip
        cell = ["fracture", "cell.png", "--phase", "0=lumen,255=stone", "--young", "stone=2e9", "--critical-stretch", "stone=0.01"]
        plain = self.works(*cell, "--json").json()
        self.assertEqual([plain[key] for key in ("surface_doubt", "segmentation_errors", "total_errors")], [None] * 3)
        found = self.works(*cell, "--surface-doubt", "0.1", "--json").json()
        self.assertEqual((found["peak_stress"], found["surface_doubt"], found["total_errors"]), (plain["peak_stress"], 0.1, None))
        # Walls of ten pixels beside the lumen: 1 % by 0.1 of a pixel, three times that at the weakest place; a hole's edge bears more.
        self.assertTrue(0.02 < found["segmentation_errors"]["strength"] < 0.1, found["segmentation_errors"])
        both = self.works(*cell, "--surface-doubt", "0.1", "--window-error", "--json").json()
        parts = [both["segmentation_errors"]["strength"], both["window_errors"]["strength"]["error"]]
        self.assertAlmostEqual(both["total_errors"]["strength"], sum(part**2 for part in parts) ** 0.5, places=9)
        self.assertRegex(self.works(*cell, "--surface-doubt", "0.1").out, "surfaces within 0.1 pixels .* of the peak open; rough")
        self.fails(2, "nothing tells how far surfaces may lie", "give the doubt in pixels", *cell, "--segmentation-error")
        self.fails(2, "without a surface between solid and void", "leave it out", *STRIP, *BREAKS, "--surface-doubt", "0.1")
        words = [*cell, "--surface-doubt", "0.1", "--method", "accurate", "--tolerance", "1e-8", "--json"]
        one, several = self.works(*words).json(), self.run_lamella(*words, ranks=2).json()
        self.assertAlmostEqual(several["segmentation_errors"]["strength"] / one["segmentation_errors"]["strength"], 1, delta=1e-4)

    def test_what_the_materials_do_to_the_first_break(self):
        found = self.works(*STRIP, *BREAKS[:2], "--critical-stretch", "glue=0.002±0.0001", "--json").json()
        relative = found["relative_sensitivity"]["first_break_stress"]
        self.assertAlmostEqual(relative["young:stone"] + relative["young:glue"], 1, places=4)  # all stiffnesses together
        self.assertAlmostEqual(relative["critical-stretch:glue"], 1, places=6)
        self.assertEqual(relative["critical-stretch:stone"], 0)
        self.assertAlmostEqual(found["input_errors"]["first_break_stress"], 0.05, places=6)
        plain = self.works(*STRIP, *BREAKS, "--json").json()
        self.assertEqual(found["peak_stress"], plain["peak_stress"])
        self.assertIsNone(plain["sensitivity"])
        squeezed = self.works(*STRIP, *BREAKS, "--compression", "--max-broken", "1", "--sensitivity", "--json").json()
        squeezed = squeezed["sensitivity"]["first_break_stress"]
        self.assertGreater(squeezed["critical-stretch:glue"] + squeezed["critical-stretch:stone"], 0)  # counts as positive
        self.assertIn("1 % more changes that stress by", self.works(*STRIP, *BREAKS, "--sensitivity").out)

    def test_how_far_it_speaks_for_others(self):
        found = self.works(*STRIP, *BREAKS, "--window-error", "--json").json()
        plain = self.works(*STRIP, *BREAKS, "--json").json()
        self.assertEqual((plain["window_errors"], plain["size_effect"]), (None, None))
        self.assertEqual(found["peak_stress"], plain["peak_stress"])
        window = found["window_errors"]["strength"]
        self.assertLess(window["low"], found["peak_stress"])
        self.assertAlmostEqual(window["high"] - found["peak_stress"], window["error"] * found["peak_stress"], delta=1e-6 * window["high"])
        # What windows of a third have is what they have alone: the middle one, of all glue's layer 30 / 3 wide.
        self.assertLess(found["size_effect"]["exponent"], 0)
        self.assertGreater(found["size_effect"]["weibull_modulus"], 0)
        self.assertIn("samples of this size have in the mean", self.works(*STRIP, *BREAKS, "--window-error").out)
        # Windows are one rank's each; the sample's own peak is that of the accurate method on several.
        checked = self.works(*STRIP, *BREAKS, "--window-error", "--method", "accurate", "--json").json()
        several = self.run_lamella(*STRIP, *BREAKS, "--window-error", "--method", "accurate", "--json", ranks=2).json()
        for key in ("high", "deviation"):
            self.assertAlmostEqual(several["window_errors"]["strength"][key] / checked["window_errors"]["strength"][key], 1, delta=1e-4)
        self.assertAlmostEqual(several["size_effect"]["weibull_modulus"] / checked["size_effect"]["weibull_modulus"], 1, delta=1e-9)
        self.fails(2, "a notch, which is no part", "leave the notch", *STRIP, *BREAKS, "--window-error", "--notch", "0,100um,50um,100um")

    def test_energy_of_a_crack(self):
        # with four neighbours a node, one bond a column crosses: 30 bonds of half of k s0² δx, k = 9 E/(π h³) δx⁴
        rows = [[100 if y < 22 else 255 for _ in range(30)] for y in range(44)]
        self.write("two.png", pictures.png(rows, pixels_per_metre=100000))
        found = self.run_lamella("fracture", "two.png", "--phase", "100=a", "--phase", "255=b", "--young", "a=1e9", "--young",
                                 "b=1e9", "--young", "a-b=1e9", "--critical-stretch", "a-b=1e-3", "--horizon", "1", "--stop", "0", "--json").json()
        self.assertEqual((found["end"], found["broken"]), ("severed", 30))
        self.assertAlmostEqual(found["broken_energy"] / (30 * 0.5 * 9e9 / 3.141592653589793 * 1e-5 * 1e-6 * 1e-5), 1, places=9)

    def test_table(self):
        text = self.works(*STRIP, *BREAKS, "--stats").out
        for words in ("modulus", "first break at", "peak at", "end at", "the stress fell to the share of the peak",
                      "energy in them", "events, strict", "rises of the load", "local corrections", "came loose"):
            self.assertIn(words, text)
        text = self.works(*STRIP, *BREAKS, "--compression", "--max-broken", "5").out
        self.assertIn("positive in compression", text)
        self.assertNotIn("rises of the load", text)

    def test_files(self):
        words = [*STRIP, *BREAKS]
        states = ["--at-strain", "1e-4", "--at-broken", "10,20", "--at-broken", "30", "--stress"]
        out = self.works(*words, *states, "-o", "s.vti", "--broken", "b.vtp", "--curve", "c.csv").out
        names = ["s_000.vti", "s_001.vti", "s_002.vti", "s_003.vti", "s_004.vti", "s.pvd", "b.vtp", "c.csv"]
        for name in names:
            self.assertIn("wrote " + name, out)
        self.assertEqual(sorted(os.listdir(self.folder)), sorted([*names, "c.csv.json", "strip.png"]))
        with open(self.path("s.pvd"), encoding="utf-8") as file:
            sets = re.findall(r'timestep="([^"]+)" part="0" file="([^"]+)"', file.read())
        self.assertEqual([name for _, name in sets], names[:5])
        times = [float(value) for value, _ in sets]
        self.assertEqual(times[0], 1e-4)
        self.assertEqual(times, sorted(set(times)))
        arrays = [array["name"] for array in self.info("s_002.vti")["point_arrays"]]
        self.assertEqual(arrays, ["phase", "damage", "broken", "displacement", "stress"])
        arrays = [array["name"] for array in self.info("b.vtp")["point_arrays"]]
        self.assertEqual(arrays, ["event", "strain", "critical_strain", "stress", "bond", "phases", "between_grains"])
        self.works("snapshot", "s_002.vti", "--array", "damage", "-o", "d.png")
        with open(self.path("c.csv"), encoding="utf-8") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        self.assertEqual((rows[0]["strain"], rows[0]["stress"]), (0, 0))
        self.assertTrue(all(a["strain"] <= b["strain"] for a, b in zip(rows, rows[1:])))
        found = self.works(*words, *states, "-o", "s.vti", "--overwrite", "--json").json()
        self.assertEqual([state["broken"] for state in found["states"]], [0, 10, 20, 30, found["broken"]])
        self.assertEqual([state["file"] for state in found["states"]], names[:5])
        self.assertEqual(max(row["stress"] for row in rows), found["peak_stress"])
        self.assertEqual(rows[-1]["broken"], found["broken"])
        # one state, one file; a result is a sample
        self.works(*words, "-o", "end.vti", "--quiet")
        again = self.works(STRIP[0], "end.vti", *STRIP[6:], *BREAKS, "--json").json()
        self.assertEqual(again["peak_stress"], found["peak_stress"])

    def test_states_beyond_the_end(self):
        result = self.run_lamella(*STRIP, *BREAKS, "--at-strain", "0.5", "-o", "s.vti", "--json")
        self.assertEqual(result.code, 0)
        self.assertIn("warning: 1 of the states asked for lie beyond the end", result.err)
        self.assertEqual([state["file"] for state in result.json()["states"]], ["s_000.vti"])
        self.assertEqual(sorted(os.listdir(self.folder)), ["s.pvd", "s_000.vti", "strip.png"])

    def test_limits(self):
        found = self.works(*STRIP, *BREAKS, "--max-strain", "1e-4", "--json").json()
        self.assertEqual((found["end"], found["broken"], found["first_break"]), ("maximum-strain", 0, None))
        self.assertAlmostEqual(found["peak_stress"] / found["effective_modulus"], 1e-4)
        found = self.works(*STRIP, *BREAKS, "--max-broken", "7", "--json").json()
        self.assertEqual((found["end"], found["broken"]), ("maximum-broken", 7))
        half = self.works(*STRIP, *BREAKS, "--stop", "50%", "--json").json()
        self.assertEqual(half["end"], "stress-fell")
        notched = self.works(*STRIP, *BREAKS, "--notch", "0,205um,100um,205um", "--json").json()
        self.assertLess(notched["peak_stress"], half["peak_stress"])

    def test_ranks_change_nothing(self):
        words = [*STRIP, *BREAKS, "--max-broken", "40", "--json"]
        one = self.run_lamella(*words).json()
        two = self.run_lamella(*words, ranks=2).json()
        self.assertEqual((two["ranks"], two["method"]), (2, "events"))
        for key in ("broken_by_pair", "peak_stress", "peak_strain", "effective_modulus"):
            self.assertEqual(two[key], one[key])
        self.assertAlmostEqual(two["broken_energy"] / one["broken_energy"], 1, places=12)  # a sum over the ranks' bonds
        words = [*words, "--tolerance", "1e-9", "--method", "accurate"]
        one = self.run_lamella(*words).json()
        two = self.run_lamella(*words, ranks=2).json()
        self.assertEqual((two["ranks"], two["method"]), (2, "accurate"))
        self.assertEqual(two["broken_by_pair"], one["broken_by_pair"])
        # residuals of 1e-9 leave some 1e-8 of elongations
        self.assertAlmostEqual(two["peak_stress"] / one["peak_stress"], 1, places=6)
        self.assertAlmostEqual(two["broken_energy"] / one["broken_energy"], 1, places=9)
        # each equilibrium stops at the tolerance, on another way: the same bonds, strains within some ten times it
        loose = [*STRIP, *BREAKS, "--max-broken", "10", "--method", "accurate", "--json"]
        one = self.run_lamella(*loose, "--broken", "one.vtp").json()
        two = self.run_lamella(*loose, "--broken", "two.vtp", ranks=2).json()
        self.assertEqual(two["broken_by_pair"], one["broken_by_pair"])
        self.assertAlmostEqual(two["peak_strain"] / one["peak_strain"], 1, delta=1e-4)
        places = []
        for name in ["one", "two"]:
            self.works("convert", name + ".vtp", "-o", name + ".csv", "--quiet")
            with open(self.path(name + ".csv"), encoding="utf-8") as file:
                places.append([(row["x"], row["y"]) for row in csv.DictReader(file)])
        self.assertEqual(places[0], places[1])

    def test_interrupted(self):
        big = [[100 if abs(y - 150 - x // 10) < 3 else 255 for x in range(200)] for y in range(300)]
        self.write("big.png", pictures.png(big))
        words = [PROGRAM, *STRIP, *BREAKS, "--method", "accurate", "-o", "s.vti", "--curve", "c.csv"]
        words[2] = "big.png"
        with subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            while len(os.listdir(self.folder)) < 5 and run.poll() is None:
                time.sleep(0.02)
            time.sleep(1)  # in the midst of it
            run.send_signal(signal.SIGINT)
            out, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130, err)
        self.assertEqual(out, b"")
        self.assertEqual(sorted(os.listdir(self.folder)), ["big.png", "strip.png"])

    def test_a_full_disk(self):
        # a limit on the size of files stops a write half-way; no file appears, not those that were whole either
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        good = [*STRIP, *BREAKS]
        for files in (["-o", "s.vti"], ["-o", "s.vti", "--at-broken", "5"], ["--broken", "b.vtp", "--max-broken", "400"],
                      ["--curve", "c.csv"], ["--max-broken", "2", "--broken", "b.vtp", "-o", "s.vti"]):
            self.fails(7, "File too large", "", *good, *files, preexec_fn=limit)

    def test_what_cannot_be_done(self):
        good = [*STRIP, *BREAKS]
        self.fails(2, "nothing can break", "pairs of phases that are to break", *STRIP)
        self.fails(2, "the critical stretch of glue is 0", "", *STRIP, "--critical-stretch", "glue=0")
        self.fails(2, "the critical stretch of glue is -0.001", "", *STRIP, "--critical-stretch", "glue=-1e-3")
        self.fails(2, "the toughness of glue is nan", "", *STRIP, "--toughness", "glue=nan")
        self.fails(2, "load 'traction' is none of its choices", "stretch", *good, "--load", "traction")
        self.fails(2, "load 'sheer'", "did you mean 'shear'?", *good, "--load", "sheer")
        self.fails(2, "lateral ratio counts only with load biaxial", "leave lateral ratio out", *good, "--lateral-ratio", "1")
        self.fails(2, "stop 'half' is not a number", "--stop SHARE", *good, "--stop", "half")
        self.fails(2, "stop 1 is not below 1", "below 1", *good, "--stop", "100%")
        self.fails(2, "max strain -1 is below 0", "0 or more", *good, "--max-strain=-1")
        self.fails(2, "strain step -1 is below 0", "0 or more", *good, "--strain-step=-1")
        self.fails(2, "strain step nan is not a number", "0 or more", *good, "--strain-step=nan")
        for step in ["1e-300", "1e308"]:
            self.fails(2, "the strain cannot be raised in steps of %s" % step.replace("e308", "e+308"), "between 1e-09 and 1", *good,
                       "--strain-step", step)
        self.fails(2, "max broken -1 is below 0", "", *good, "--max-broken=-1")
        self.fails(2, "at broken '1.5' is not a whole number", "", *good, "--at-broken", "1.5", "-o", "s.vti")
        self.fails(2, "at strain 'x' is not a number", "", *good, "--at-strain", "1e-3,x", "-o", "s.vti")
        self.fails(2, "--at-strain without a file", "-o FILE.vti", *good, "--at-strain", "1e-3")
        self.fails(2, "--stress without a file", "-o FILE.vti", *good, "--stress")
        self.fails(2, "-o 'a.png': the fields are written as .vti", "--broken", *good, "-o", "a.png")
        self.fails(2, "--broken 'b.csv': broken bonds are written as .vtp", "", *good, "--broken", "b.csv")
        self.fails(2, "--curve 'c.txt': tables are written as .csv", "", *good, "--curve", "c.txt")
        self.fails(2, "tolerance 1 is above 0.1", "1e-12 to 0.1", *good, "--tolerance", "1")
        self.fails(2, "a tolerance of 0.01 for fracture", "1e-6", *good, "--tolerance", "0.01")
        self.fails(2, "'--large-strains' is not an option of lamella fracture", "lamella equilibrium", *good, "--large-strains")
        self.fails(2, "batches of bonds cannot be broken with local corrections", "accurate", *good, "--breaking", "batched",
                   "--method", "events")
        self.fails(2, "local corrections of a periodic sample", "accurate", *good, "--periodic", "x", "--method", "events")
        self.fails(2, "two platens of 22 layers leave nothing", "", *good, "--platen-layers", "22")
        half = [[0] * 20 if 20 <= y < 30 else [255] * 20 for y in range(50)]
        self.write("apart.png", pictures.png(half))
        self.fails(4, "no piece of the sample reaches from one platen to the other along y: it is in 2 pieces",
                   "longer horizon", "fracture", "apart.png", "--phase", "0=void", "--phase", "255=stone", "--young", "stone=1",
                   "--critical-stretch", "stone=1e-3")
        hinges = [[255 * (x == 8 + y % 2) for x in range(20)] if 20 <= y < 30 else [255] * 20 for y in range(50)]
        self.write("hinges.png", pictures.png(hinges))
        self.fails(3, "the sample carries too little for a strength at a tolerance of 1e-06", "hinges", "fracture", "hinges.png",
                   "--phase", "0=void", "--phase", "255=stone", "--young", "stone=1", "--critical-stretch", "stone=1e-3",
                   "--horizon", "1.5")
        self.works(*good, "--max-broken", "3", "-o", "s.vti", "--at-broken", "1", "--quiet")
        self.fails(7, "'s_000.vti' exists already", "--overwrite", *good, "-o", "s.vti", "--at-broken", "1")


if __name__ == "__main__":
    unittest.main()
