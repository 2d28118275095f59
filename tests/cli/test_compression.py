"""lamella compression: numbers, files, states, checkpoints; what is refused."""

import csv
import os
import resource
import re
import signal
import time
import unittest

import grids
import pictures
from program import Case, processor

TISSUE = ["compression", "tissue.png", "--phase", "255=wall", "--phase", "0=lumen"]
# to 4 %, of few rows, not so calm: a second or two
QUICK = ["--strain", "0.04", "--rows", "8", "--first-speed", "1e-2"]


class Compression(Case):
    def setUp(self):
        super().setUp()
        # two lumens, walls of three pixels
        self.rows = [[0 if x % 10 in range(3, 10) and x < 20 and 2 < y < 13 else 255 for x in range(23)] for y in range(16)]
        self.write("tissue.png", pictures.png(self.rows, pixels_per_metre=1000000))

    def curve(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def test_numbers_and_files(self):
        words = [*TISSUE, *QUICK, "--at-strain", "0.01,0.02", "--at-strain", "0.03", "-o", "p.vtp", "--stress",
                 "--deformation-gradient", "--curve", "c.csv"]
        found = self.works(*words, "--json").json()
        self.assertEqual((found["axis"], found["sides"], found["law"], found["plane"]),
                         ("y", "straight", "isotropic", "plane-stress"))
        self.assertAlmostEqual(found["strain"], 0.04, places=9)
        self.assertEqual(found["points"], 4 * sum(grey == 255 for row in self.rows for grey in row))
        self.assertEqual(found["phases"][1]["name"], "wall")
        self.assertEqual([round(state["strain"], 9) for state in found["states"]], [0.01, 0.02, 0.03, 0.04])
        names = ["p_000.vtp", "p_001.vtp", "p_002.vtp", "p_003.vtp"]
        self.assertEqual([state["file"] for state in found["states"]], names)
        self.assertEqual(sorted(os.listdir(self.folder)), sorted([*names, "p.pvd", "c.csv", "c.csv.json", "tissue.png"]))
        with open(self.path("p.pvd"), encoding="utf-8") as file:
            times = [float(value) for value in re.findall(r'timestep="([^"]+)"', file.read())]
        self.assertEqual([round(value, 9) for value in times], [0.01, 0.02, 0.03, 0.04])
        arrays = [array["name"] for array in self.info("p_001.vtp")["point_arrays"]]
        self.assertEqual(arrays, ["id", "phase", "displacement", "stress", "deformation_gradient"])
        rows = self.curve("c.csv")
        self.assertEqual(len(rows), 9)
        self.assertEqual([row["stress"] for row in rows], [row["stress"] for row in found["curve"]])
        self.assertEqual((rows[0]["strain"], rows[0]["stress"]), (0, 0))
        self.assertTrue(all(a["strain"] < b["strain"] for a, b in zip(rows, rows[1:])))
        # the stiffness without time is the slope at which the curve begins: the first rows still swing, and
        # lumens bend on the way, so half of it is all that is asked for here
        still = self.works(*TISSUE, "--stiffness-only", "--json").json()
        slope = rows[3]["stress"] / rows[3]["strain"] / still["constants"]["E_y"]
        self.assertTrue(0.5 < slope < 1.5, slope)
        text = self.works(*TISSUE, *QUICK).out
        for words in ("pressed along y, sides straight", "kinetic energy at most", "million points a second", "positive in compression"):
            self.assertIn(words, text)

    def test_stiffness_only(self):
        found = self.works(*TISSUE, "--stiffness-only", "--constants", "k.csv", "--json").json()
        constants = found["constants"]
        self.assertEqual(list(constants), ["E_x", "nu_xy", "E_y", "nu_yx"])
        self.assertEqual(sorted(os.listdir(self.folder)), ["k.csv", "k.csv.json", "tissue.png"])
        # Maxwell and Betti
        self.assertAlmostEqual(constants["nu_xy"] / constants["E_x"] / (constants["nu_yx"] / constants["E_y"]), 1, places=6)
        stiffer = self.works(*TISSUE, "--stiffness-only", "--young", "wall=14.4e9", "--json").json()["constants"]
        self.assertAlmostEqual(stiffer["E_x"] / constants["E_x"], 2, places=6)
        tensor = self.works(*TISSUE, "--stiffness-only", "--sides", "periodic", "--json").json()
        self.assertEqual(tensor["components"], ["xx", "yy", "xy"])
        self.assertEqual(list(tensor["constants"]), ["E_x", "E_y", "nu_xy", "nu_yx", "G_xy"])
        text = self.works(*TISSUE, "--stiffness-only", "--sides", "fixed").out
        self.assertIn("sides fixed", text)
        self.assertIn("E_y", text)

    def test_directions_of_the_file(self):
        # a block of wall whose grain lies along x in one file and along y in the other
        phase = grids.array("phase", [1] * 100, "UInt8")
        for name, direction in (("x.vti", [1, 0, 0]), ("y.vti", [0, 2, 0])):
            self.write(name, grids.vti([phase, grids.array("axis", direction * 100, "Float32", 3)], spacing="1e-6 1e-6 1e-6"))
        words = ["--array", "phase", "--phase", "1=wall", "--stiffness-only", "--json"]
        for name, across, along in (("x.vti", "E_y", "E_x"), ("y.vti", "E_x", "E_y")):
            found = self.works("compression", name, *words).json()
            self.assertEqual(found["law"], "orthotropic")
            self.assertAlmostEqual(found["constants"][along] / 8e9, 1, places=5)
            self.assertAlmostEqual(found["constants"][across] / 6.4e9, 1, places=5)
        self.fails(3, "array 'axis' holds nan", "directions are finite", "compression",
                   self.write("nan.vti", grids.vti([phase, grids.array("axis", ["nan", 0, 0] * 100, "Float32", 3)])), *words)

    def test_checkpoints(self):
        words = [*TISSUE, *QUICK, "--checkpoint-every", "400"]
        both = ["--checkpoint", "run.h5", "--continue", "run.h5"]
        whole = self.works(*words, "--checkpoint", "whole.h5", "--curve", "whole.csv", "--json").json()
        self.assertEqual((whole["continued_at"], whole["last_checkpoint"]), (0, whole["steps"]))
        with self.popen(*words, *both) as run:
            while not os.path.exists(self.path("run.h5")) and run.poll() is None:
                time.sleep(0.002)
            run.kill()
            run.communicate()
        result = self.run_lamella(*words, *both, "--curve", "again.csv", "--json")
        self.assertEqual((result.code, result.err), (0, ""))
        self.assertGreater(result.json()["continued_at"], 0)
        # killed, not interrupted: points were sorted anew at the same steps, so it is the same curve to the last bit
        self.assertEqual(self.curve("again.csv"), self.curve("whole.csv"))
        self.fails(3, "another scene", "", *words, "--axis", "x", "--continue", "run.h5")
        self.fails(3, "", "", *words, "--continue", self.write("cut.h5", b"no checkpoint at all"))
        with open(self.path("whole.h5"), "rb") as file:
            content = file.read()
        self.fails(3, "", "", *words, "--continue", self.write("half.h5", content[: len(content) // 2]))
        foreign = self.path("foreign.h5")
        self.assertEqual(self.run_lamella("fracture", "tissue.png", *TISSUE[2:], "--young", "wall=1e9", "--critical-stretch",
                                          "wall=1e-3", "--max-broken", "4", "--checkpoint", foreign, "--checkpoint-every", "2").code, 0)
        self.fails(3, "", "", *words, "--continue", "foreign.h5")
        self.fails(7, "exists already", "--continue", *words, "--checkpoint", "run.h5")

    def test_ranks(self):
        words = [*TISSUE, *QUICK, "--at-strain", "0.02"]
        one = self.works(*words, "-o", "one.vtp", "--curve", "one.csv", "--checkpoint", "one.h5", "--json").json()
        several = self.run_lamella(*words, "-o", "two.vtp", "--curve", "two.csv", "--json", ranks=2)
        self.assertEqual((several.code, several.err), (0, ""))
        two = several.json()
        self.assertEqual((two["ranks"], two["points"], two["steps"]), (2, one["points"], one["steps"]))
        # the same to the round-off of sums in another order
        for row, expected in zip(self.curve("two.csv"), self.curve("one.csv")):
            self.assertAlmostEqual(row["strain"], expected["strain"], delta=1e-9)
            self.assertAlmostEqual(row["stress"], expected["stress"], delta=1e-9 * one["stress"])
        for name in ("two_000.vtp", "two_001.vtp"):
            found, expected = self.info(name), self.info(name.replace("two", "one"))
            self.assertEqual(found["points"], expected["points"])
            self.assertEqual([a["name"] for a in found["point_arrays"]], [a["name"] for a in expected["point_arrays"]])
        again = self.run_lamella(*TISSUE, *QUICK, "--continue", "one.h5", "--json", ranks=2)
        self.assertEqual(again.json()["continued_at"], one["steps"])
        self.assertAlmostEqual(again.json()["stress"] / one["stress"], 1, delta=1e-9)

    def test_a_checkpoint_changes_nothing(self):
        bare = self.works(*TISSUE, *QUICK, "--curve", "bare.csv", "--json").json()
        for every in ("200", "600", "400,1h", "0.01s"):
            self.works(*TISSUE, *QUICK, "--checkpoint", "run.h5", "--checkpoint-every", every, "--curve", "kept.csv", "--overwrite", "--quiet")
            self.assertEqual(self.curve("kept.csv"), self.curve("bare.csv"), every)
        # and one goes on from any of its steps to the last bit
        words = [*TISSUE, *QUICK, "--checkpoint", "run.h5", "--checkpoint-every", "1"]
        with self.popen(*words, "--overwrite") as run:
            time.sleep(0.3)
            run.kill()
            run.communicate()
        on = self.run_lamella(*words, "--continue", "run.h5", "--curve", "on.csv", "--json").json()
        self.assertEqual((on["steps"], self.curve("on.csv")), (bare["steps"], self.curve("bare.csv")))

    # A block between straight sides is under uniaxial stress: E/(1 - nu^2) in plane strain, whatever nu; but for the
    # barrier, of fourth power in the loss of area, and swings, whose share of the stress is the root of the energies'.
    def test_walls_that_hardly_change_their_volume(self):
        self.write("block.png", pictures.png([[255] * 16 for _ in range(16)], pixels_per_metre=1000000))
        for poisson in (0.3, 0.49, 0.499, 0.4999):
            found = self.works("compression", "block.png", "--phase", "255=wall", "--plane", "plane-strain", "--poisson", poisson,
                               "--strain", "2%", "--rows", "10", "--json").json()
            exact = 0.02 * 7.2e9 / (1 - poisson**2)
            self.assertAlmostEqual(found["stress"] / exact, 1, delta=0.05, msg=poisson)
            # kinetic energy is judged though the run ends below 5 %: from half of it on, and before
            self.assertAlmostEqual(found["calm_from"], 0.01)
            self.assertTrue(0 < found["worst_energy_ratio"] <= 0.01, found["worst_energy_ratio"])
            self.assertGreater(found["early_energy_ratio"], found["worst_energy_ratio"])
            self.assertLess(found["early_energy_ratio_strain"], 0.01)

    # Half a row of 5e-5 in 240 rows is 1e-7 of the height, and a thousand-millionth of that, up to which a row was to be
    # met, less than the round-off of platens' positions: such a run waited for ever for a strain that no step brings nearer.
    def test_small_strains_end(self):
        self.write("block.png", pictures.png([[255] * 6 for _ in range(6)], pixels_per_metre=1000000))
        words = ["compression", "block.png", "--phase", "255=wall", "--strain"]
        for strain in (5e-5, 1e-6):
            result = self.run_lamella(*words, strain, "--json")  # with a warning: platens this fast shake so little strain
            self.assertEqual(result.code, 0, result.err)
            found = result.json()
            self.assertAlmostEqual(found["strain"] / strain, 1, places=6)
            self.assertTrue(all(a["strain"] < b["strain"] for a, b in zip(found["curve"], found["curve"][1:])))
        self.fails(2, "a strain of 1e-13 in 240 rows", "1e-11 a row", *words, 1e-13)

    def test_restless_runs_are_warned_of(self):
        words = [*TISSUE, "--strain", "0.04", "--rows", "8", "--first-speed", "2e-2", "--least-speed", "2e-2"]
        result = self.run_lamella(*words, "--json")
        self.assertEqual(result.code, 0)
        self.assertIn("warning: the kinetic energy was", result.err)
        self.assertGreater(result.json()["worst_energy_ratio"], 0.01)

    def test_units(self):
        plain = self.works(*TISSUE, *QUICK, "--young", "8e9", "--json").json()
        written = self.works(*TISSUE, "--strain", "4%", *QUICK[2:], "--young", "wall=8 GPa", "--json").json()
        self.assertEqual((plain["strain"], plain["stress"]), (written["strain"], written["stress"]))

    def test_two_points_a_cell_by_default(self):
        words = [*TISSUE, "--stiffness-only", "--cells-per-node", "2", "--json"]
        self.assertEqual(self.works(*words).json()["points_per_node"], 4)
        few = self.run_lamella(*words, "--points-per-node", "2")
        self.assertIn("warning: 1 points along each axis of a cell: two want 4 points a node", few.err)
        self.assertIn("straight sides", self.works(*words[:-1]).out)
        self.assertIn("straight sides are stiffer", self.works(*words).json()["sides_note"])
        self.assertEqual(self.works(*words, "--sides", "open").json()["sides_note"], "")

    def test_what_a_stiffness_takes_is_said_or_refused(self):
        self.works("generate", "softwood", "--size", "48,48,48", "-o", "wood.vti")
        with self.popen("compression", "wood.vti", "--stiffness-only") as run:
            time.sleep(1)
            note = run.stderr.readline().decode()
            run.send_signal(signal.SIGTERM)
            run.communicate(timeout=100)
        self.assertRegex(note, r"note: the stiffness of 67 652 nodes takes about [\d.]+ MB of memory and [\d.]+ to \d+ s of processor time")
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (1200 * 10**6, 1200 * 10**6))  # the program itself takes some 500 of them
        refused = self.run_lamella("compression", "wood.vti", "--stiffness-only", preexec_fn=limit, environment={"OMP_NUM_THREADS": "1"})
        self.assertEqual(refused.code, 5, refused.err)
        self.assertIn("nodes takes about", refused.err)

    def test_stops_at_once_and_says_where(self):
        rows = [[0 if x % 12 in range(3, 12) and y % 12 in range(3, 12) else 255 for x in range(303)] for y in range(303)]
        self.write("large.png", pictures.png(rows, pixels_per_metre=1000000))
        with self.popen("compression", "large.png", *TISSUE[2:], "--threads", "1", "--checkpoint", "run.h5", "--checkpoint-every", "1h") as run:
            while processor(run) < 2:  # it has set up after less than one
                time.sleep(0.01)
            before = processor(run)
            run.send_signal(signal.SIGTERM)
            _, status, usage = os.wait4(run.pid, 0)
            run.returncode = os.waitstatus_to_exitcode(status)
            err = run.stderr.read().decode()
        self.assertEqual(run.returncode, 143, err)
        self.assertRegex(err, r"error: interrupted at [\d.e-]+ %, after [\d.]+ s: strain 0.\d+, stress .* Pa\nhint: the checkpoint 'run.h5' stands after \d+ steps")
        self.assertLess(usage.ru_utime + usage.ru_stime - before, 2)  # 0.2 s as a rule

    def test_interrupted(self):
        with self.popen(*TISSUE, "--strain", "0.3", "--checkpoint", "run.h5", "--checkpoint-every", "200", "-o", "p.vtp") as run:
            while not os.path.exists(self.path("run.h5")) and run.poll() is None:
                time.sleep(0.01)
            run.send_signal(signal.SIGINT)
            out, err = run.communicate(timeout=100)
        self.assertEqual((run.returncode, out), (130, b""))
        self.assertRegex(err.decode(), r"the checkpoint 'run.h5' stands after \d+ steps; go on from it with: .* --continue run.h5")
        self.assertEqual(sorted(os.listdir(self.folder)), ["run.h5", "tissue.png"])

    def test_warns(self):
        rows = [[0 if x % 6 and y % 6 else 255 for x in range(25)] for y in range(25)]
        self.write("thin.png", pictures.png(rows))
        result = self.run_lamella("compression", "thin.png", *TISSUE[2:], "--stiffness-only", "--json")
        self.assertEqual(result.code, 0)
        self.assertIn("warning: walls are 1 cells of the grid thick", result.err)
        self.assertEqual(result.json()["cells_across_walls"], 1)
        finer = self.works("compression", "thin.png", *TISSUE[2:], "--stiffness-only", "--cells-per-node", "2", "--json").json()
        self.assertEqual((finer["cells_across_walls"], finer["warnings"]), (2, []))

    def test_friction(self):
        # two walls, one on the other: what is not joined slides, and what rubs holds
        rows = [[255 if y < 8 else 128 for _ in range(24)] for y in range(16)]
        self.write("two.png", pictures.png(rows, pixels_per_metre=1000000))
        words = ["compression", "two.png", "--phase", "255=wall", "--phase", "128=soft", *QUICK, "--sides", "open", "--young",
                 "soft=1e9", "--poisson", "soft=0.45", "--first-speed", "1e-3", "--most-speed", "2e-3", "--json"]
        words = [word for i, word in enumerate(words) if not (word == "--first-speed" and words[i + 1] == "1e-2")
                 and not (word == "1e-2" and words[i - 1] == "--first-speed")]
        slides = self.works(*words, "--friction", "wall-soft=0").json()["stress"]
        rubs = self.works(*words, "--friction", "wall-soft=0.3").json()["stress"]
        joined = self.works(*words).json()["stress"]
        platens = self.works(*words, "--platen-friction", "0.3").json()["stress"]
        self.assertLess(slides, rubs)
        self.assertLess(rubs, joined * 1.01)
        self.assertLess(joined, platens)
        several = self.run_lamella(*words, "--friction", "wall-soft=0.3", ranks=2)
        self.assertEqual(several.code, 0, several.err)
        self.assertAlmostEqual(several.json()["stress"], rubs, delta=1e-9 * rubs)  # round-off, amplified

    def test_refused(self):
        gap = [[0] * 23] * 3 + self.rows
        self.write("gap.png", pictures.png(gap, pixels_per_metre=1000000))
        words = ["compression", "gap.png", *TISSUE[2:], *QUICK]
        self.fails(3, "the tissue does not touch the upper platen: 3e-06 m lie between them", "crop", *words)
        self.works(*words, "--fit-platens", "--quiet")
        self.write("empty.png", pictures.png([[0] * 20] * 20))
        self.fails(3, "all 400 nodes are void", "look at the phases", "compression", "empty.png", "--phase", "0=lumen")
        self.write("parts.png", pictures.png([[255 if y < 5 or y > 14 else 0 for _ in range(20)] for y in range(20)]))
        self.fails(4, "", "", "compression", "parts.png", *TISSUE[2:], "--stiffness-only")
        for code, message, hint, more in (
            (2, "strain 1 is not below 1", "below 1", ["--strain", "1"]),
            (2, "strain nan is not a number", "below 1", ["--strain", "nan"]),
            (2, "a state at a strain of 0.2", "between 0 and", ["--at-strain", "0.2", "-o", "p.vtp"]),
            (2, "poisson 1.1 is not below 1", "above -1 and below 1",
             ["--poisson", "1.1"]),
            (2, "poisson 'x' is not a number", "--poisson NUMBER", ["--poisson", "wall=x"]),
            (2, "--young names 'wal'", "did you mean 'wall'?", ["--young", "wal=1e9"]),
            (2, "yield counts only with law plastic or orthotropic-plastic", "choose law", ["--yield", "1e8"]),
            (2, "young 0 is not above 0", "above 0", ["--young", "0"]),
            (2, "1e-300", "", ["--young", "wall=1e-300"]),
            (2, "1e+308", "", ["--density", "1e308"]),
            (2, "--transverse of walls that have no direction", "one modulus", ["--transverse", "6GPa"]),
            (2, "--shear of walls that have no direction", "one modulus", ["--shear", "1e9"]),
            (2, "young '8 GP' is not a number", "NUMBER", ["--young", "8 GP"]),
            (2, "shear counts only with law auto or orthotropic", "choose law", ["--law", "isotropic", "--shear", "1e9"]),
            (3, "the image has no point array 'axis'", "isotropic", ["--law", "orthotropic"]),
            (2, "walls that yield in plane stress", "plane strain", ["--law", "plastic", "--plane", "plane-stress"]),
            (2, "is unstable: the largest stable one is", "take a smaller one", ["--time-step", "1e-3"]),
            (2, "most speed 2 is not below 1", "below 1", ["--most-speed", "2"]),
            (2, "platens that grip, and have a friction of 0.3", "one of the two", ["--grip", "--platen-friction", "0.3"]),
            (2, "friction of 'wall' with itself", "another phase", ["--friction", "wall=0.3"]),
            (2, "friction of 'lumen', which has no points", "leave the pair out", ["--friction", "wall-lumen=0.3"]),
            (2, "a load along z of a picture", "x or y", ["--axis", "z"]),
            (2, "--stress without a file to write to", "-o FILE.vtp", ["--stress"]),
            (2, "-o 'p.vti': points are written as .vtp", "--curve", ["-o", "p.vti"]),
            (2, "--checkpoint 'run.txt'", ".h5", ["--checkpoint", "run.txt"]),
            (2, "sides 'sticky' is none of its choices", "straight", ["--sides", "sticky"]),
            (2, "--constants of a compression", "--curve", ["--constants", "k.csv"]),
            (2, "cells per node 'x' is not a number", "--cells-per-node", ["--cells-per-node", "x"]),
            (2, "cells per node -1 is not above 0", "above 0", ["--cells-per-node", "-1"]),
            (2, "--stiffness-only with --", "leave one of them out", ["--stiffness-only"]),
        ):
            with self.subTest(message):
                self.fails(code, message, hint, *TISSUE, *(word for i in range(0, 6, 2) if QUICK[i] not in more for word in QUICK[i : i + 2]), *more)
        # the launcher has its say too
        several = self.run_lamella(*TISSUE, "--stiffness-only", ranks=2)
        self.assertEqual(several.code, 2)
        self.assertIn("error: --stiffness-only on 2 processes\nhint: run one, with --threads", several.err)
        several = self.run_lamella(*TISSUE, *QUICK, "--transfer", "flip", ranks=2)
        self.assertEqual(several.code, 2)
        self.assertEqual(several.err.count("error: 2 ranks with FLIP, XPIC or a consistent mass\nhint: take APIC or PIC"), 1)


if __name__ == "__main__":
    unittest.main()
