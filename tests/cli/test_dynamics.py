"""lamella dynamics: numbers, files, states, several ranks, checkpoints, interruption; what is refused."""

import csv
import math
import os
import re
import signal
import subprocess
import time
import unittest

import pictures
from program import PROGRAM, Case, processor

STRIP = ["dynamics", "strip.png", "--phase", "255=stone", "--phase", "100=glue", "--young", "stone=2e9", "--young",
         "glue=1e9", "--like", "glue-stone=glue", "--density", "stone=2000", "--density", "glue=1000"]
BREAKS = ["--critical-stretch", "stone=0.01", "--critical-stretch", "glue=0.002"]


class Dynamics(Case):
    def setUp(self):
        super().setUp()
        # a layer of glue across, slightly inclined; 10 µm a pixel
        rows = [[100 if abs(y - 20 - x // 10) < 3 else 255 for x in range(30)] for y in range(44)]
        self.write("strip.png", pictures.png(rows, pixels_per_metre=100000))

    def test_a_pull(self):
        found = self.works(*STRIP, *BREAKS, "--damping", "0.1", "--step-share", "40%", "--json").json()
        self.assertEqual((found["end"], found["load"], found["axis"]), ("stress-fell", "stretch", "y"))
        self.assertEqual(found["broken"], sum(found["broken_by_pair"].values()))
        self.assertLessEqual(set(found["broken_by_pair"]), {"glue", "glue-stone"})
        energies = found["energies"]
        held = energies["kinetic"] + energies["elastic"] + energies["broken"] + energies["damped"]
        given = energies["supplied"] + energies["initial"]
        self.assertAlmostEqual((held - given) / max(map(abs, energies.values())), found["energy_defect"], places=12)
        self.assertLess(abs(found["energy_defect"]), 5e-3)  # second order in the step
        self.assertAlmostEqual(found["time_step"] / found["stable_step"], 0.4, places=12)
        self.assertAlmostEqual(found["small_strain_break"] / found["strain_rate"] / found["travel_time"], 30, places=6)
        self.assertAlmostEqual(
            found["travel_time"] / found["gauge_length"] / math.sqrt(found["mean_density"] / found["effective_modulus"]), 1, places=9)
        # within 5 % of quasi-static fracture, at 30 travel times
        words = STRIP[1:-4]
        strict = self.works("fracture", *words, *BREAKS, "--json").json()
        self.assertAlmostEqual(found["peak_stress"] / strict["peak_stress"], 1, delta=0.05)
        self.assertAlmostEqual(found["effective_modulus"] / strict["effective_modulus"], 1, places=4)

    def test_a_wave(self):
        # a side at V supplies ρ c V² a unit of area and time, c² = C₁₁/ρ; the lattice is within 6 % of E/(1 - ν²)
        self.write("bar.png", pictures.png([[255] * 150 for _ in range(8)]))
        c = math.sqrt(2e11 * 9 / 8 / 7800)
        found = self.works("dynamics", "bar.png", "--phase", "255=steel", "--pixel-size", "0.1mm", "--young", "steel=2e11",
                           "--density", "7800", "--periodic", "y", "--velocity", "x-=5,free", "--axis", "x",
                           "--end-time", 0.012 / c, "--json").json()
        self.assertEqual((found["end"], found["load"], found["broken"]), ("time", "sides", 0))
        self.assertIsNone(found["strain_rate"])
        self.assertIsNone(found["first_break_time"])
        expected = 7800 * c * 25 * 0.0008 * found["end_time"]
        self.assertAlmostEqual(found["energies"]["supplied"] / expected, 1, delta=0.08)

    def test_table(self):
        text = self.works(*STRIP, *BREAKS, "--start", "50%").out
        for words in ("stretch along y", "first break at", "peak at", "end at", "the stress fell to the share of the peak",
                      "kinetic", "supplied", "of the largest stable one"):
            self.assertIn(words, text)
        self.assertIn("sides and boxes", self.works(*STRIP, "--initial-velocity", "1,0", "--end-time", "1e-8").out)

    def test_files(self):
        words = [*STRIP, *BREAKS, "--velocity", "y+=0,40", "--velocity", "y-=0,-40", "--step-share", "20%", "--end-time", "4e-7"]
        out = self.works(*words, "--frames", "4", "--stress", "-o", "s.vti", "--broken", "b.vtp", "--curve", "c.csv").out
        names = ["s_000.vti", "s_001.vti", "s_002.vti", "s_003.vti", "s.pvd", "b.vtp", "c.csv"]
        for name in names:
            self.assertIn("wrote " + name, out)
        self.assertEqual(sorted(os.listdir(self.folder)), sorted([*names, "c.csv.json", "strip.png"]))
        with open(self.path("s.pvd"), encoding="utf-8") as file:
            sets = re.findall(r'timestep="([^"]+)" part="0" file="([^"]+)"', file.read())
        self.assertEqual([name for _, name in sets], names[:4])
        found = self.works(*words, "--frames", "4", "-o", "s.vti", "--overwrite", "--json").json()
        for k, (value, _) in enumerate(sets):
            self.assertAlmostEqual(float(value), (k + 1) * 1e-7, delta=found["time_step"])
            self.assertEqual(found["states"][k]["time"], float(value))
        arrays = [array["name"] for array in self.info("s_002.vti")["point_arrays"]]
        self.assertEqual(arrays, ["phase", "damage", "broken", "displacement", "velocity"])
        arrays = [array["name"] for array in self.info("b.vtp")["point_arrays"]]
        self.assertEqual(arrays, ["event", "step", "time", "energy", "bond", "phases", "between_grains"])
        with open(self.path("c.csv"), encoding="utf-8") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        self.assertEqual(rows[0]["time"], 0)
        self.assertEqual(rows[-1]["broken"], found["broken"])
        self.assertEqual(rows[-1]["kinetic_energy"], found["energies"]["kinetic"])
        self.works("snapshot", "s_003.vti", "--array", "damage", "-o", "d.png")
        self.works("crack-path", "b.vtp", "--json")

    def test_ranks_change_nothing(self):
        words = [*STRIP, *BREAKS, "--velocity", "y+=0,40", "--velocity", "y-=0,-40", "--step-share", "20%", "--end-time", "4e-7", "--json"]
        one = self.run_lamella(*words).json()
        two = self.run_lamella(*words, ranks=2).json()
        self.assertEqual(two["ranks"], 2)
        self.assertGreater(one["broken"], 20)
        self.assertEqual(two["broken_by_pair"], one["broken_by_pair"])
        self.assertAlmostEqual(two["energies"]["kinetic"] / one["energies"]["kinetic"], 1, places=9)

    def test_goes_on(self):
        words = [*STRIP, *BREAKS, "--checkpoint-every", "40"]
        whole = self.works(*words, "--broken", "a.vtp", "--curve", "a.csv", "--json").json()
        part = self.works(*words, "--max-broken", "20", "--checkpoint", "run.h5", "--json").json()
        self.assertEqual(part["last_checkpoint"] % 40, 0)
        self.assertGreater(part["last_checkpoint"], 0)
        again = self.works(*words, "--continue", "run.h5", "--curve", "b.csv", "--json").json()
        self.assertEqual(again["continued_at"], part["last_checkpoint"])
        for key in ("peak_stress", "broken", "energies", "end_time"):
            self.assertEqual(again[key], whole[key])
        with open(self.path("a.csv"), "rb") as a, open(self.path("b.csv"), "rb") as b:
            self.assertEqual(a.read(), b.read())
        self.fails(3, "is a checkpoint of another scene: step", "", *words, "--continue", "run.h5", "--step-share", "30%")

    def test_interrupted(self):
        big = [[100 if abs(y - 150 - x // 10) < 3 else 255 for x in range(200)] for y in range(300)]
        self.write("big.png", pictures.png(big, pixels_per_metre=100000))
        words = [PROGRAM, *STRIP, *BREAKS, "--travel-times", "3000", "--checkpoint", "run.h5", "--checkpoint-every", "50", "-o",
                 "s.vti"]
        words[2] = "big.png"
        with subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            while not os.path.exists(self.path("run.h5")) and run.poll() is None:
                time.sleep(0.05)
            run.send_signal(signal.SIGINT)
            _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130, err)
        self.assertIn("steps; go on from it with: ", err.decode())
        self.assertEqual(sorted(os.listdir(self.folder)), ["big.png", "run.h5", "strip.png"])

    def test_stopped_at_any_step(self):
        """No checkpoint is due for long: that of the step at which it is stopped. It goes on as if it had not been."""
        self.write("big.png", pictures.png([[100 if abs(y - 75 - x // 10) < 3 else 255 for x in range(100)] for y in range(150)],
                                           pixels_per_metre=100000))
        words = [STRIP[0], "big.png", *STRIP[2:], *BREAKS, "--velocity", "y+=0,2", "--velocity", "y-=0,-2", "--end-time", "1e-5", "--threads", "1",
                 "--at-broken", "50,51,1000,2000,3000", "--json"]
        whole = self.works(*words, "--curve", "a.csv", "-o", "a.vti").json()
        self.assertGreater(whole["broken"], 3000)
        for number in (signal.SIGTERM, signal.SIGINT):
            for moment in (0.4, 0.6, 0.9, 1.3, 2, 3, 4.5):  # of processor time; where it still sets up, later
                with subprocess.Popen([PROGRAM, *words, "--curve", "b.csv", "-o", "b.vti", "--checkpoint", "run.h5", "--overwrite"], cwd=self.folder,
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
                    while processor(run) < moment:
                        time.sleep(0.01)
                    before = processor(run)
                    os.kill(run.pid, number)  # Popen's own would collect it if it has ended
                    _, status, usage = os.wait4(run.pid, 0)
                    run.returncode = os.waitstatus_to_exitcode(status)
                    err = run.stderr.read()
                self.assertEqual(run.returncode, 128 + number, err)
                self.assertLess(usage.ru_utime + usage.ru_stime - before, 2)
                if os.path.exists(self.path("run.h5")):
                    break
            self.assertRegex(err, "interrupted at [0-9.e+-]+ %")
            self.assertRegex(err, "stands after [0-9]+ steps; go on from it with: ")
            result = self.run_lamella(*words, "--curve", "b.csv", "-o", "b.vti", "--overwrite", "--continue", "run.h5")
            self.assertEqual(result.code, 0, result.err)  # it may warn of states that lie before the checkpoint
            again = result.json()
            self.assertEqual(str(again["continued_at"]), re.search("after ([0-9]+) steps", err)[1])
            self.assertEqual(again["energies"], whole["energies"])
            self.assertEqual([state["broken"] for state in whole["states"]][again["states_before"]:], [state["broken"] for state in again["states"]])
            with open(self.path("a.csv"), "rb") as a, open(self.path("b.csv"), "rb") as b:
                self.assertEqual(a.read(), b.read())
            os.remove(self.path("run.h5"))

    def test_what_cannot_be_done(self):
        good = [*STRIP, *BREAKS]
        sides = [*STRIP, *BREAKS, "--end-time", "1e-7"]
        self.fails(2, "density 'thick' is not a number", "--density NUMBER", *good, "--density", "thick")
        self.fails(2, "density -1 is not above 0", "above 0", *good, "--density", "glue=-1")
        self.fails(2, "--density names 'glu', which is no phase", "did you mean 'glue'?", *good, "--density", "glu=1")
        self.fails(2, "--load 'sheer'", "did you mean 'shear'?", *good, "--load", "sheer")
        self.fails(2, "--velocity with --load stretch", "leave one", *sides, "--velocity", "y+=0,1", "--load", "stretch")
        self.fails(2, "--velocity 'top'", "x-", *sides, "--velocity", "top=0,1")
        self.fails(2, "'fast' is no number", "free", *sides, "--velocity", "y+=0,fast")
        self.fails(2, "has 1 numbers", "one along y", *sides, "--traction", "y+=1")
        self.fails(2, "there is no side 'z+' in 2 dimensions", "y+ (top)", *sides, "--velocity", "z+=0,1")
        self.fails(2, "--box-velocity '1,2=0,1' has 2 coordinates", "X1,Y1,X2,Y2", *sides, "--box-velocity", "1,2=0,1")
        self.fails(2, "there is no solid node in box 1", "", *sides, "--box-velocity", "1,1,2,2=0,1")
        self.fails(2, "the motion has no end", "time", *good, "--initial-velocity", "1,0")
        self.fails(2, "nothing moves the sample", "", *good, "--load", "sides", "--end-time", "1e-7")
        self.fails(2, "is above the stable one", "or less", *good, "--time-step", "1")
        self.fails(2, "time step -1 is below 0", "0 or more", *good, "--time-step=-1")
        self.fails(2, "end time 'soon' is not a number", "--end-time NUMBER", *good, "--end-time", "soon")
        self.fails(2, "--frames without --end-time", "", *good, "--frames", "3", "-o", "s.vti")
        self.fails(2, "--at-time without a file", "-o FILE.vti", *good, "--at-time", "1e-8")
        self.fails(2, "delta l counts only with tau", "", *good, "--delta-l", "1um")
        self.fails(2, "start rate counts only with tau", "", *good, "--start-rate", "50%")
        self.fails(2, "start rate nan is not a number", "", *good, "--start-rate", "nan")
        for share in ["1e-300", "1e-6", "0"]:
            self.fails(2, "step share %s is below 1e-05" % share.replace("e-6", "e-06"), "1e-05 to 1", *good, "--step-share", share)
        self.fails(2, "of the stable one, ", "or leave it out", *good, "--time-step", "1e-30")
        self.fails(2, "steps until the first break", "give a larger one", *good, "--strain-rate", "1e-30")
        self.fails(2, "steps until the first break", "give a larger one", *good, "--travel-times", "1e30")
        self.fails(2, "until 1e+30 s it takes", "what you want to see", *STRIP, "--velocity", "y+=0,1", "--end-time", "1e30")
        self.fails(2, "omega0 and delta l", "", *good, "--tau", "1e-6", "--delta-l", "1um", "--omega0", "1")
        self.fails(2, "no strain rate, and nothing can break", "", *STRIP)
        self.fails(2, "damping 2 is above 1", "0 to 1", *good, "--damping", "2")
        self.write("bare.png", pictures.png([[255] * 30 for _ in range(44)]))
        self.fails(2, "motion needs the size of a pixel", "pixel size", "dynamics", "bare.png", "--phase", "255=stone", "--young",
                   "stone=1e9", "--density", "1000", "--critical-stretch", "stone=0.01")


if __name__ == "__main__":
    unittest.main()
