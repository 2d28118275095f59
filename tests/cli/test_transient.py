"""lamella transient: heating, the end at rest, files, several ranks, checkpoints; what is doubtful and what is refused."""

import json
import math
import os
import random
import re
import signal
import time
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
            self.assertEqual(file.readline().strip(), "time,inlet_flux,outlet_flux,mean_value,steps")
            self.assertEqual(len(file.readlines()), 4)
        with open(self.path("heat.csv.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["columns"]["inlet_flux"]["unit"], "m/s")
        self.fails(7, "heat_000.vti", "--overwrite", *words)

    def test_times_and_steps(self):
        found = self.works(*LAYERS, "--at-time", "1e-4,0", "--at-time", "1e-3", "--json").json()["curve"]
        self.assertEqual([row["time"] for row in found][0], 0)
        # of several times the last is met, the others by the nearest pair of steps
        self.assertAlmostEqual(found[1]["time"], 1e-4, delta=2e-6)
        self.assertAlmostEqual(found[2]["time"], 1e-3, delta=1e-15)
        steps = self.works(*LAYERS, "--at-step", "10,400", "--time-step", "1e-6", "-o", "s.vti", "--json").json()
        self.assertEqual([(row["steps"], round(row["time"], 12)) for row in steps["curve"]], [(10, 1e-5), (400, 4e-4)])
        self.assertEqual(steps["written"], ["s_000.vti", "s_001.vti", "s.pvd"])
        # the usual step: a relaxation of 1/2 of what conducts best, 1e-12/(6 * 1e-7)
        usual = self.run_lamella(*LAYERS, "--at-step", "10", "-o", "one.vti", "--json").json()  # so few steps: a warning
        self.assertAlmostEqual(usual["time_step"] / (1e-12 / 6e-7), 1, places=12)
        self.assertEqual(usual["written"], ["one.vti"])

    def data(self, name):
        """Point data of a .vti to the last bit, as they are stored."""
        with open(self.path(name), encoding="utf-8") as file:
            return re.search("<PointData.*</PointData>", file.read(), re.DOTALL).group()

    def test_goes_on_to_the_same_bits(self):
        words = [*LAYERS, "--direction", "y", "--time-step", "1e-6"]
        whole = self.works(*words, "--at-step", "0,200,600,1000", "--flux", "-o", "whole.vti", "--json").json()
        self.assertEqual((whole["continued_at"], whole["checkpoints"], whole["last_checkpoint"]), (0, 0, 0))
        both = ["--checkpoint", "run.h5", "--continue", "run.h5", "--flux", "-o", "half.vti", "--curve", "half.csv", "--overwrite",
                "--json"]
        first = self.run_lamella(*words, "--at-step", "0,200", *both)
        self.assertEqual(first.err, "warning: there was no checkpoint 'run.h5' yet: the run began with the initial value\n")
        self.assertEqual(first.json()["last_checkpoint"], 200)
        again = self.run_lamella(*words, "--at-step", "0,200,600,1000", *both)
        self.assertEqual(again.code, 0, again.err)
        self.assertEqual(again.err, "warning: 1 of the states asked for lie before the checkpoint, which stands after 200 steps: "
                                    "they are not made, the curve has them\n")
        found = again.json()
        self.assertEqual((found["continued_at"], found["states_before"], found["last_checkpoint"]), (200, 1, 1000))
        self.assertEqual(found["written"], ["half_001.vti", "half_002.vti", "half_003.vti", "half.pvd", "half.csv"])
        self.assertEqual(found["curve"], whole["curve"])
        for k in (1, 2, 3):
            self.assertEqual(self.data("half_%03d.vti" % k), self.data("whole_%03d.vti" % k))
        # a rank more goes on from it, too
        result = self.run_lamella(*words, "--at-step", "1000,1200", "--continue", "run.h5", "--json", ranks=2)
        self.assertEqual(result.code, 0, result.err)
        self.assertEqual(result.json()["continued_at"], 1000)
        ended = self.run_lamella(*words, "--at-step", "400", "--continue", "run.h5", "--json")
        self.assertIn("warning: the run had ended where the checkpoint stands, after 1000 steps", ended.err)
        self.assertEqual((ended.code, ended.json()["steps"]), (0, 1000))

    def test_killed_and_interrupted(self):
        self.write("large.png", pictures.png([[255 if (x // 7 + y // 9) % 2 else 0 for x in range(240)] for y in range(160)]))
        words = [*LAYERS, "--at-step", "0,20000", "--checkpoint", "run.h5", "--checkpoint-every", "500", "-o", "f.vti"]
        words[1] = "large.png"
        self.works(*words[:-6], "-o", "whole.vti", "--quiet")
        with self.popen(*words) as run:
            while not os.path.exists(self.path("run.h5")) and run.poll() is None:
                time.sleep(0.002)
            time.sleep(random.Random(7).random() * 0.2)
            run.kill()
            run.communicate()
        before = os.stat(self.path("run.h5")).st_mtime_ns
        # the state at step 0 is there
        self.assertIn("'f_000.vti' exists already", self.run_lamella(*words, "--continue", "run.h5").err)
        with self.popen(*words, "--continue", "run.h5", "--overwrite") as run:
            while os.stat(self.path("run.h5")).st_mtime_ns == before and run.poll() is None:
                time.sleep(0.002)
            run.send_signal(signal.SIGINT)
            out, err = run.communicate(timeout=60)
        if run.returncode != 0:  # a fast machine may have been through
            self.assertEqual((run.returncode, out), (130, b""))
            self.assertRegex(err.decode(), r"error: interrupted at [^\n]+\nhint: the checkpoint 'run.h5' stands after \d+ steps; the same command ")
            self.assertNotIn("f_001.vti", os.listdir(self.folder))
        result = self.run_lamella(*words, "--continue", "run.h5", "--overwrite", "--json")
        self.assertEqual(result.code, 0, result.err)
        self.assertGreater(result.json()["continued_at"], 0)
        self.assertEqual(self.data("f_001.vti"), self.data("whole_001.vti"))

    def test_what_cannot_be_continued(self):
        words = [*LAYERS, "--at-step", "100"]
        self.works(*words, "--checkpoint", "run.h5", "--quiet")
        with open(self.path("run.h5"), "rb") as file:
            data = file.read()
        bad = {"cut.h5": (data[:2000], "is cut off"), "empty.h5": (b"", "is empty"), "text.h5": (b"no checkpoint", "is not a checkpoint"),
               "bad.h5": (data[:-100] + bytes([data[-100] ^ 1]) + data[-99:], "is damaged"),
               "new.h5": (data.replace(b"\nformat 1\n", b"\nformat 7\n", 1), "is newer than this program")}
        for name, (content, message) in bad.items():
            self.fails(3, f"'{name}' {message}", "", *words, "--continue", self.write(name, content))
        self.works("fracture", "layers.png", *LAYERS[2:8], "--young", "slow=1e9", "--young", "fast=1e9", "--like", "fast-slow=slow",
                   "--critical-stretch", "slow=1e-3", "--critical-stretch", "fast=1e-3", "--max-broken", "4", "--checkpoint", "foreign.h5",
                   "--checkpoint-every", "2", "--quiet")
        self.fails(3, "'foreign.h5' is a checkpoint of ", "of this run", *words, "--continue", "foreign.h5")
        other = "'run.h5' is a checkpoint of another scene: "
        go = [*words, "--continue", "run.h5"]
        self.fails(3, other + "initial value: 0 there, 0.5 here", "of the run that wrote it", *go, "--initial", "0.5")
        self.fails(3, other + "time step: ", "", *go, "--step", "1e-7")
        self.fails(3, other + "stencil: d2q5 there, d2q9 here", "", *go, "--lattice", "d2q9")
        self.fails(3, other, "", *go, "--window", "0,0,20,16")
        self.fails(7, "'run.h5' exists already", "--continue run.h5", *words, "--checkpoint", "run.h5")
        self.fails(3, "there is no folder 'nowhere'", "make it first", *words, "--checkpoint", "nowhere/run.h5")
        self.fails(2, "--checkpoint 'run.txt'", ".h5", *words, "--checkpoint", "run.txt")

    def test_too_much_for_the_memory(self):
        self.write("wide.png", pictures.png([[0] * 1000] * 1000))
        # 100 001 fields of a million doubles
        self.fails(5, "keeping 100001 states of 1000000 nodes needs about 800.0 GB", "keep fewer states", "transient", "wide.png", "--phase",
                   "0=a", "--pixel-size", "1um", "--diffusivity", "a=1e-7", "--end-time", "1", "--frames", "100000")

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

    def test_less_than_a_node_deep_warns(self):
        # sqrt(1e-8 m2/s 5e-5 s) = 0.71 um, where the slow phase has nodes of 1 um
        result = self.run_lamella(*LAYERS, "--direction", "y", "--end-time", "5e-5", "--json")
        self.assertEqual(result.code, 0, result.err)
        self.assertIn("goes 0.71 of a node's distance deep", result.err)
        # into a single phase of 1e-9: the flux through the face is told from a node's distance on, 1 ms, and then within 12 % of
        # what it is into a half space, sqrt(D/(pi t)); before, nothing is
        words = [*LAYERS[:8], "--diffusivity", "slow=1e-9", "--diffusivity", "fast=1e-9"]
        told = self.run_lamella(*words, "--at-time", "4e-4,1.1e-3,4e-3", "--json").json()["curve"]
        self.assertIsNone(told[0]["inlet_flux"])
        self.assertEqual(told[0]["outlet_flux"], 0)
        for row in told[1:]:
            self.assertAlmostEqual(row["inlet_flux"] / math.sqrt(1e-9 / math.pi / row["time"]), 1, delta=0.12)
        table = self.run_lamella(*words, "--at-time", "4e-4")
        self.assertIn("not known", table.out)
        self.works(*LAYERS, "--direction", "y", "--end-time", "2e-4", "--json")

    def test_few_nodes_in_the_direction_warn(self):
        # A bar that empties through both faces: the mean is off the series by 0.1 where it is 2 nodes long, and by less than 0.8/64
        # from 8 on.
        for nodes, most in ((2, 0.2), (8, 0.0126)):
            self.write("bar.png", pictures.png([[10] * nodes] * 3))
            result = self.run_lamella("transient", "bar.png", "--phase", "10=bar", "--pixel-size", "1mm", "--diffusivity", "bar=1e-6",
                                      "--direction", "x", "--end-time", str(0.3 * nodes**2), "--frames", "20", "--inlet-value=0", "--outlet-value=0", "--initial-value=1",
                                      "--json")
            self.assertEqual("2 nodes long" in result.err, nodes == 2, result.err)
            off = 0
            for row in result.json()["curve"]:
                odd = [(math.pi * k) ** 2 for k in range(1, 400, 2)]
                series = sum(8 / k * math.exp(-k * row["time"] / nodes**2) for k in odd)
                off = max(off, abs(row["mean_value"] - series))
            self.assertLess(off, most)
            self.assertEqual(off > 0.0126, nodes == 2)

    def test_refuses(self):
        known = [*LAYERS, "--end-time", "1"]
        self.fails(2, "no end time was given", "in seconds", *LAYERS)
        self.fails(2, "a state after 11 steps cannot be kept", "in pairs", *LAYERS, "--at-step", "10,11")
        self.fails(2, "a time of -1 s cannot be reached", "", *LAYERS, "--at-time=-1")
        self.fails(2, "--at-time with --end-time", "the last of which is the end", *known, "--at-time", "1")
        self.fails(2, "no end time was given", "in seconds", *LAYERS, "--end-time", "0")
        self.fails(2, "frames 0 is below 1", "1 to 100000", *known, "--frames", "0")
        self.fails(2, "diffusivity gives 'slow' two values, 1e-08 and -1", "one value", *known, "--diffusivity", "slow=-1")
        self.fails(2, "the diffusivity of phase 'slow' is -1", "0 for a phase", *(word.replace("1e-8", "-1") for word in known))
        self.fails(2, "--flux without a file", "-o FILE.vti", *known, "--flux")
        self.fails(2, "lattice d3q7 does not fit", "d2q5", *known, "--lattice", "d3q7")
        self.fails(2, "has no diffusivity", "give one to each phase", *LAYERS[:-2], "--end-time", "1")
        self.write("bare.png", pictures.png([[0] * 9] * 9))
        self.fails(2, "needs the size of a pixel", "pixel size", "transient", "bare.png", "--phase", "0=a",
                   "--diffusivity", "a=1", "--end-time", "1")


if __name__ == "__main__":
    unittest.main()
