"""lamella run: scenes, sweeps, filters on steps in memory, what is skipped, interruptions, bad input."""

import csv
import json
import os
import pty
import select
import signal
import subprocess
import time
import unittest

import pictures
import program
import theora
from program import HERE, Case

EXAMPLES = os.path.join(HERE, "..", "..", "examples", "scenes")

DIFFUSION = """
[sample]
generate = "softwood"
size = [48, 48]
seed = "1..4"

[diffusion]
conductivity = { lumen = [0.1, 0.2], wall = 1 }
direction = "x"

[measure]
conductivity = "diffusion.effective.x"
wall = "sample.phases.wall.fraction"
"""

# 20 ms a sample or more: long enough to be stopped on the way
MANY = """
[sample]
generate = "softwood"
size = [150, 150]
seed = "1..20"

[diffusion]
conductivity = { lumen = [0.001, 0.1], wall = 1 }

[measure]
x = "diffusion.effective.x"
y = "diffusion.effective.y"
"""

FRACTURE = """
[sample]
generate = "softwood"
size = [40, 40]
solid-fraction = 0.5
seed = 2

[fracture]
young = { wall = 1e10 }
critical-stretch = { wall = 0.01 }
at-strain = [0.002, 0.004]
at-broken = "20..60 step 20"

[[each]]
name = "pdf"
run = "stress-pdf"

[[each]]
name = "crack"
run = "crack-path"

[crack-path]

[measure]
strength = "fracture.peak_stress"
length = "crack-path.length"
"""


class Scenes(Case):
    def scene(self, text, name="scene.toml"):
        return self.write(name, text.encode("utf-8"))

    def table(self, name, folder="scene.results"):
        with open(self.path(os.path.join(folder, name)), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def bytes_of(self, folder="scene.results"):
        """The tables that depend on nothing but the scene."""
        files = {}
        for name in sorted(os.listdir(self.path(folder))):
            if name.endswith(".csv") and name != "times.csv":
                with open(self.path(os.path.join(folder, name)), "rb") as file:
                    files[name] = file.read()
        return files

    def test_sweep_is_the_commands(self):
        self.scene(DIFFUSION)
        out = self.works("run", "scene.toml").out
        self.assertIn("8 of 8 samples finished", out)
        rows = self.table("table.csv")
        self.assertEqual(list(rows[0]), ["sample", "sample.seed", "diffusion.conductivity.lumen", "status", "conductivity", "wall"])
        # the last key is the fastest
        self.assertEqual([(row["sample.seed"], row["diffusion.conductivity.lumen"]) for row in rows],
                         [(str(seed), k) for seed in (1, 2, 3, 4) for k in ("0.1", "0.2")])
        self.works("generate", "softwood", "--size", "48,48", "--seed", "3", "-o", "s.vti")
        direct = self.works("diffusion", "s.vti", "--conductivity", "lumen=0.2", "--conductivity", "wall=1", "--direction", "x",
                            "--json").json()
        self.assertEqual(float(rows[5]["conductivity"]), direct["effective"]["x"])  # to the bit: the same code
        settings = self.table("settings.csv")
        self.assertEqual([row["n"] for row in settings], ["4", "4"])
        values = [float(row["conductivity"]) for row in rows[::2]]
        mean = sum(values) / 4
        deviation = (sum((v - mean) ** 2 for v in values) / 3) ** 0.5
        self.assertAlmostEqual(float(settings[0]["conductivity.mean"]) / mean, 1, places=12)
        self.assertAlmostEqual(float(settings[0]["conductivity.deviation"]) / deviation, 1, places=9)
        self.assertAlmostEqual(float(settings[0]["conductivity.error"]) / (deviation / 2), 1, places=9)
        # Student's t for three degrees of freedom
        self.assertAlmostEqual(float(settings[0]["conductivity.half_width"]) / (3.18245 * deviation / 2), 1, places=5)
        with open(self.path("scene.results/table.csv.json"), encoding="utf-8") as file:
            record = json.load(file)["provenance"]
        self.assertEqual(record["parameters"]["scene"]["text"], DIFFUSION)
        self.assertIn("lamella run scene.toml", record["command"])

        # several pictures of one material
        for seed in (1, 2, 3):
            self.works("generate", "softwood", "--size", "48,48", "--seed", seed, "-o", f"{seed}.vti")
        with open(self.path("files.toml"), "w", encoding="utf-8") as file:
            file.write('average-over = ["sample.file"]\n[sample]\nfile = ["1.vti", "2.vti", "3.vti"]\n[diffusion]\nconductivity = { lumen '
                       '= 0.2, wall = 1 }\ndirection = "x"\n[measure]\nconductivity = "diffusion.effective.x"\n')
        said = self.works("run", "files.toml").out
        self.assertIn("the mean of such samples is, with 95 % probability", said)
        self.assertIn("such samples for", said)
        files = self.table("table.csv", "files.results")
        self.assertEqual([row["sample.file"] for row in files], ["1.vti", "2.vti", "3.vti"])
        self.assertEqual([row["conductivity"] for row in files], [row["conductivity"] for row in rows[1:6:2]])

        # nothing runs twice; what is added runs alone; the command line wins
        again = self.works("run", "scene.toml", "--json", "--stats").json()
        self.assertEqual((again["finished_before"], again["finished"]), (8, 8))
        more = self.works("run", "scene.toml", "--json", "--sample.seed", "1..5").json()
        self.assertEqual((more["finished_before"], more["samples"]), (8, 10))
        self.assertEqual(len(self.table("table.csv")), 10)
        one = self.works("run", "scene.toml", "--set", "sample.seed=3", "--set", "diffusion.conductivity.lumen=0.2", "--json").json()
        self.assertEqual((one["finished_before"], one["samples"]), (1, 1))

    def test_processes_and_ranks_make_the_same_table(self):
        self.scene(DIFFUSION)
        self.works("run", "scene.toml", "--results", "one")
        self.works("run", "scene.toml", "--results", "two", "--jobs", "2")
        result = self.run_lamella("run", "scene.toml", "--results", "ranks", ranks=2)
        self.assertEqual(result.code, 0, result.err)
        self.assertEqual(self.bytes_of("one"), self.bytes_of("two"))
        self.assertEqual(self.bytes_of("one"), self.bytes_of("ranks"))

    def test_killed_twice_and_continued(self):
        self.scene(MANY)
        self.works("run", "scene.toml", "--results", "whole", "--quiet")
        for attempt in range(2):
            run = subprocess.Popen([program.PROGRAM, "run", "scene.toml", "--jobs", "2"], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            samples = self.path("scene.results/samples")
            goal = 6 * (attempt + 1)
            for _ in range(600):
                done = sum(os.path.exists(os.path.join(samples, key, "record.json")) for key in os.listdir(samples)) \
                    if os.path.isdir(samples) else 0
                if done >= goal:
                    break
                time.sleep(0.05)
            # the first time asked to stop, the second time shot
            run.send_signal(signal.SIGINT if attempt == 0 else signal.SIGKILL)
            error = run.communicate(timeout=60)[1].decode()
            if attempt == 0:
                self.assertEqual(run.returncode, 130, error)
                self.assertIn("the same command goes on", error)
            time.sleep(0.3)  # the shot one's processes end with it
        self.assertFalse(os.path.exists(self.path("scene.results/table.csv")))
        last = self.works("run", "scene.toml", "--json").json()
        self.assertGreaterEqual(last["finished_before"], 12)
        self.assertLess(last["finished_before"], 40)
        self.assertEqual(last["finished"], 40)
        self.assertEqual(self.bytes_of("whole"), self.bytes_of())
        leftovers = [name for _, _, names in os.walk(self.path("scene.results")) for name in names if name.startswith(".lamella")]
        self.assertLessEqual(len(leftovers), 2)  # of the two processes that were shot

    def test_filters_on_steps_in_memory(self):
        self.scene(FRACTURE)
        result = self.run_lamella("run", "scene.toml")
        self.assertEqual(result.code, 0, result.err)
        self.assertEqual(result.err, "warning: 'memory:step of fracture.vtp' holds no broken bond: there is no crack\n")
        written = sorted(os.path.relpath(os.path.join(at, name), self.path("scene.results"))
                         for at, _, names in os.walk(self.path("scene.results")) for name in names)
        self.assertEqual([name for name in written if not name.endswith((".csv", ".csv.json", "record.json"))],
                         ["lamella-results.json", "results.h5", "scene.toml"])  # tables and nothing else
        # the same by way of files
        self.works("generate", "softwood", "--size", "40,40", "--solid-fraction", "0.5", "--seed", "2", "-o", "s.vti")
        self.works("fracture", "s.vti", "--young", "wall=1e10", "--critical-stretch", "wall=0.01", "--at-strain", "0.002,0.004",
                   "--at-broken", "20,40,60", "--stress", "-o", "t.vti", "--broken", "b.vtp", "--quiet")
        rows = self.table("steps_pdf.csv")
        self.assertEqual(len(rows), 6)
        for i, row in enumerate(rows):
            pdf = self.works("stress-pdf", f"t_{i:03}.vti", "--json").json()
            self.assertEqual(float(row["mean_tensile"]), pdf["mean_tensile"])
            self.assertEqual(float(row["deviation"]), pdf["deviation"])
            self.assertEqual(float(row["count"]), pdf["count"])
        direct = self.works("crack-path", "b.vtp", "--json").json()
        crack = self.table("steps_crack.csv")
        self.assertEqual(float(crack[-1]["length"]), direct["length"])
        self.assertEqual(float(self.table("table.csv")[0]["length"]), direct["length"])
        lengths = [float(row["length"]) for row in crack]
        self.assertLess(lengths[0], lengths[-1])

    def test_what_nobody_asks_for_is_not_computed(self):
        bare = FRACTURE.split("[[each]]", maxsplit=1)[0] + '[pore-flood-fill]\n[diffusion]\nconductivity = { lumen = 0.1, wall = 1 }\n' \
            '[measure]\nstrength = "fracture.peak_stress"\npores = "pore-flood-fill.count"\nk = "diffusion.effective.x"\n'
        self.scene(bare)
        calls = self.works("run", "scene.toml", "--json", "--stats").json()["statistics"]["calls"]
        self.assertEqual(calls, {"nodal_stress": 0, "strain_energy": 0, "flux": 0, "labels": 0})
        # asked for, each is counted: the counters count
        asked = bare.replace("[pore-flood-fill]", "[pore-flood-fill]\nwrite = true").replace(
            "[diffusion]", "[diffusion]\nwrite = true") + '[[each]]\nrun = "stress-pdf"\nof = "fracture"\n'
        self.scene(asked)
        calls = self.works("run", "scene.toml", "--json", "--stats").json()["statistics"]["calls"]
        self.assertEqual((calls["nodal_stress"], calls["flux"], calls["labels"]), (6, 2, 1))  # 6 states, 2 directions
        # and a stage that no measure names does not run
        self.scene(bare.replace('pores = "pore-flood-fill.count"\n', ""))
        statistics = self.works("run", "scene.toml", "--json", "--stats").json()["statistics"]
        self.assertNotIn("pore-flood-fill", statistics["stages"])
        self.assertIn("pore-flood-fill: nothing asks for it", statistics["left_out"])
        # a state's displacements want an equilibrium of their own: not for who looks at the damage
        self.scene(FRACTURE.split("[[each]]", maxsplit=1)[0] + '[[each]]\nname = "crack"\nrun = "crack-path"\n'
                   '[measure]\nstrength = "fracture.peak_stress"\n')
        self.assertEqual(self.run_lamella("run", "scene.toml").code, 0)
        self.assertEqual(len(self.table("steps_crack.csv")), 6)

    def test_dry_run(self):
        self.scene(DIFFUSION)
        plan = self.works("run", "scene.toml", "--dry-run", "--json").json()
        self.assertEqual((plan["samples"], plan["nodes"], plan["finished"]), (8, 48 * 48, 0))
        self.assertEqual([stage["name"] for stage in plan["stages"]], ["sample", "diffusion"])
        self.assertFalse(os.path.exists(self.path("scene.results")))
        text = self.works("run", "scene.toml", "--dry-run").out
        self.assertIn("sample.seed", text)
        self.assertIn("an order of magnitude", text)

    def within(self, factor, estimate, real):
        self.assertLess(1 / factor, estimate / real)
        self.assertLess(estimate / real, factor)

    def test_estimates_against_reality(self):
        # memory to a factor of two, as the docs say; work to a factor of ten
        self.scene("[sample]\ngenerate = \"softwood\"\nsize = [700, 700]\n[diffusion]\nconductivity = { lumen = 0.1, wall = 1 }\n"
                   "direction = \"x\"\n")
        plan = self.works("run", "scene.toml", "--dry-run", "--json").json()
        self.works("run", "scene.toml", "--quiet")
        real = float(self.table("times.csv")[0]["peak_memory"])
        self.within(2, plan["memory"], real)
        row = self.table("table.csv")[0]
        iterations = float(row["diffusion.iterations"])
        work = next(stage["work"] for stage in plan["stages"] if stage["name"] == "diffusion")
        self.within(10, work, iterations * 5 * 700 * 700)  # on the sample and on one twice as fine

        self.scene("[sample]\ngenerate = \"softwood\"\nsize = [64, 64]\nsolid-fraction = 0.5\n[fracture]\nyoung = { wall = 1e10 }\n"
                   "critical-stretch = { wall = 0.01 }\n[[picture]]\narray = \"damage\"\n", "f.toml")
        plan = self.works("run", "f.toml", "--dry-run", "--json").json()
        self.works("run", "f.toml", "--quiet")
        real = float(self.table("times.csv", "f.results")[0]["peak_memory"])
        self.within(2, plan["memory"], real)  # most of it is Mesa, which draws
        row = self.table("table.csv", "f.results")[0]
        work = next(stage["work"] for stage in plan["stages"] if stage["name"] == "fracture")
        self.within(10, work, float(row["fracture.broken"]))

    def test_estimates_of_each_solver(self):
        """Memory to a factor of two, work to one of ten, as the docs say."""
        transient = "[transient]\ndiffusivity = { lumen = 2e-5, wall = 2e-7 }\n"
        wood = '[sample]\ngenerate = "softwood"\nsize = [%d, %d]\nsolid-fraction = 0.45\n'
        for name, text, count in (
            ("transient", wood % (500, 500) + transient + "end-time = 1e-6\nframes = 4\n", lambda r: 250000 * r["steps"]),
            ("transient", wood % (500, 500) + transient + "at-time = [2e-7, 1e-6]\n", lambda r: 250000 * r["steps"]),
            ("transient", wood % (500, 500) + transient + "at-step = [20, 60]\n", lambda r: 250000 * r["steps"]),
            ("equilibrium", wood % (350, 350) + "[equilibrium]\nyoung = { wall = 1e10 }\n", lambda r: 350 * 350 * r["iterations"]),
            ("bond-stiffness", wood % (90, 90) + "[bond-stiffness]\nyoung = { wall = 1e10 }\n",
             lambda r: 5 * 8100 * sum(r["iterations"])),  # on the sample and on one twice as fine
            ("dynamics", wood % (300, 300) + "[dynamics]\nyoung = { wall = 1e10 }\ncritical-stretch = { wall = 0.01 }\n"
             "density = 1500\nvelocity = [\"x-=1,free\"]\nend-time = 1e-8\n", lambda r: 90000 * r["steps"]),
            ("compression", wood % (70, 70) + "[compression]\nstrain = 0.01\n", lambda r: r["points"] * r["steps"]),
        ):
            with self.subTest(text):
                self.scene(text)
                plan = self.works("run", "scene.toml", "--dry-run", "--json").json()
                result = self.run_lamella("run", "scene.toml", "--json")
                self.assertEqual(result.code, 0, result.err)
                key = self.table("table.csv")[0]["sample"]
                with open(self.path(f"scene.results/samples/{key}/record.json"), encoding="utf-8") as file:
                    record = json.load(file)
                self.within(2, plan["memory"], record["peak_memory"])
                (work,) = [stage["work"] for stage in plan["stages"] if stage["name"] == name]
                self.within(10, work, count(record["stages"][name]))

    def test_pictures_films_and_files(self):
        self.scene("""
[sample]
generate = "softwood"
size = [40, 30]
[transient]
diffusivity = { lumen = 2e-5, wall = 2e-7 }
end-time = 1e-5
frames = 4
write = ["output", "curve"]
[[each]]
name = "film"
run = "snapshot"
every = 2
preset = "temperature"
range = [0, 1]
size = [320, 240]
movie = "heat.ogv"
[[picture]]
name = "end"
of = "transient"
preset = "temperature"
""")
        self.works("run", "scene.toml", "--quiet")
        folder = self.path(os.path.join("scene.results/samples", self.table("table.csv")[0]["sample"]))
        self.assertEqual(sorted(os.listdir(folder)), sorted(
            ["end.png", "film_0000.png", "film_0002.png", "film_0004.png", "heat.ogv", "record.json", "transient.pvd",
             "transient_curve.csv", "transient_curve.csv.json", *[f"transient_{i:03}.vti" for i in range(5)]]))
        film = theora.Film(os.path.join(folder, "heat.ogv"))
        self.assertEqual((film.width, film.height, film.rate), (320, 240, 10))
        frames = film.frames()
        self.assertEqual(len(frames), 3)  # as many as pictures
        for frame, number in zip(frames, (0, 2, 4)):
            with open(os.path.join(folder, f"film_{number:04}.png"), "rb") as file:
                picture = pictures.luma(file.read())
            difference = [abs(a - b) for a, b in zip(frame, picture)]
            # lossy: some levels at edges; another frame of this film is 3 levels away on the mean
            self.assertLess(sum(difference) / len(difference), 1, number)
        self.assertEqual(self.info(os.path.join(folder, "transient_004.vti"))["provenance"]["parameters"]["scene"]["file"], "scene.toml")

    def test_streamlines_are_written_and_drawn(self):
        scene = """
[sample]
generate = "softwood"
size = [60, 40]
[diffusion]
conductivity = { lumen = 0.1, wall = 1 }
direction = "x"
[flux-map]
streamlines = 5
write = ["lines"]
[[picture]]
name = "flux"
of = "flux-map"
preset = "flux"
size = [400, 300]
"""
        found = {}
        for name, more in (("own", ""), ("drawn", 'lines = "flux-map"\n')):
            self.scene(scene + more, name + ".toml")
            self.works("run", name + ".toml", "--quiet")
            (key,) = os.listdir(self.path(name + ".results/samples"))
            with open(self.path(f"{name}.results/samples/{key}/flux.png"), "rb") as file:
                found[name] = pictures.luma(file.read())
        self.works("generate", "softwood", "--size", "60,40", "-o", "s.vti")
        self.works("diffusion", "s.vti", "--conductivity", "lumen=0.1", "--conductivity", "wall=1", "--direction", "x", "-o", "h.vti")
        both = self.works("flux-map", "h.vti", "--streamlines", "5", "-o", "f.vti", "--lines", "l.vtp", "--json").json()
        self.assertEqual(sorted(both["files"]), ["f.vti", "l.vtp"])
        lines = self.info(f"drawn.results/samples/{key}/flux-map_lines.vtp")
        self.assertEqual(lines["cells"], both["streamlines"])
        self.works("snapshot", "f.vti", "--preset", "flux", "--lines", "l.vtp", "--size", "400,300", "-o", "f.png")
        with open(self.path("f.png"), "rb") as file:
            self.assertEqual(pictures.luma(file.read()), found["drawn"])
        self.assertNotEqual(found["own"], found["drawn"])  # five lines, not as many as look well

    def test_packing_and_bridges(self):
        self.scene("""
[sample]
packing = true
count = 40
seed = 5
[bridges]
saturation = [0.3, 0.6]
nodes = 48
[material]
young = { matrix = 1e9, grain = 4e9 }
like = ["matrix-grain=matrix", "grain-grain=matrix"]
[equilibrium]
[stress-pdf]
[measure]
modulus = "equilibrium.effective_modulus"
tensile = "stress-pdf.mean_tensile"
""")
        self.assertEqual(self.run_lamella("run", "scene.toml", "--quiet").code, 0)  # so few grains: a warning
        self.run_lamella("packing", "--count", "40", "--seed", "5", "-o", "g.vtp")  # so few grains: a warning
        self.works("bridges", "g.vtp", "--saturation", "0.6", "--nodes", "48", "-o", "b.vti")
        self.works("equilibrium", "b.vti", "--young", "matrix=1e9", "--young", "grain=4e9", "--like", "matrix-grain=matrix",
                   "--like", "grain-grain=matrix", "--stress", "-o", "e.vti")
        direct = self.works("stress-pdf", "e.vti", "--json").json()
        self.assertEqual(float(self.table("table.csv")[1]["tensile"]), direct["mean_tensile"])

    def test_steps_of_a_packing(self):
        self.scene("""
[sample]
packing = true
count = 40
seed = 5
every = 20000
[[each]]
run = "snapshot"
name = "way"
size = "120,200"
[measure]
fraction = "sample.packing_fraction"
""")
        self.assertEqual(self.run_lamella("run", "scene.toml", "--quiet").code, 0)  # so few grains: a warning
        rows = self.table("steps_way.csv")
        self.assertGreater(len(rows), 2)
        self.assertAlmostEqual(float(rows[0]["packing_fraction"]), 0.7, places=12)  # where it starts, summed over grains
        self.assertEqual(rows[-1]["packing_fraction"], self.table("table.csv")[0]["fraction"])

    def test_a_file_as_sample(self):
        self.works("generate", "softwood", "--size", "40,40", "-o", "s.png")
        self.scene("[sample]\nfile = \"s.png\"\nwindow = [0, 0, 30, 20]\n[diffusion]\nconductivity = [\"lumen=0.1\", \"wall=1\"]\n")
        self.works("run", "scene.toml", "--quiet")
        direct = self.works("diffusion", "s.png", "--window", "0,0,30,20", "--conductivity", "lumen=0.1", "--conductivity", "wall=1",
                            "--json").json()
        self.assertEqual(float(self.table("table.csv")[0]["diffusion.effective.x"]), direct["effective"]["x"])
        # another picture under the same name is another sample
        self.works("generate", "softwood", "--size", "40,40", "--seed", "9", "-o", "s.png", "--overwrite")
        self.assertEqual(self.works("run", "scene.toml", "--json").json()["finished_before"], 0)

    def test_samples_that_fail(self):
        self.scene(DIFFUSION.replace("lumen = [0.1, 0.2], wall = 1", "lumen = 0, wall = [0, 1]").replace('"1..4"', "1"))
        result = self.run_lamella("run", "scene.toml")
        self.assertEqual(result.code, 4, result.err)
        self.assertIn("1 of 2 samples failed", result.err)
        self.assertIn("scene.toml:", result.err)
        self.assertEqual([row["status"] for row in self.table("table.csv")], ["failed", "done"])
        again = self.run_lamella("run", "scene.toml", "--jobs", "2")  # tried again
        self.assertEqual(again.code, 4)

    def test_bad_scenes(self):
        def bad(text, message, hint, code=2, words=()):
            self.scene(text)
            self.fails(code, message, hint, "run", "scene.toml", *words)

        good = '[sample]\ngenerate = "softwood"\n'
        solver = '[diffusion]\nconductivity = { lumen = 0.1, wall = 1 }\n'
        bad("", "empty", "no data", 3)
        bad("# nothing\n", "holds no section", "[sample]", 3)
        bad("[sample\n", "scene.toml:1", "TOML")
        bad(good + "sed = 1\n" + solver, "scene.toml:3: 'sed' is no key of [sample]", "did you mean 'seed'?")
        bad(good + "[difusion]\n", "scene.toml:3: there is no section [difusion]", "did you mean 'diffusion'?")
        bad(good + solver + "tolerence = 1e-9\n", "scene.toml:5", "did you mean 'tolerance'?")
        bad(good + solver + 'output = "x.vti"\n', "'output'", "write =")
        bad('[sample]\ngenerate = "softwod"\n', "'softwod'", "did you mean 'softwood'?")
        bad('[sample]\nseed = 1\n' + solver, "does not say what the sample is", "file =")
        bad('[sample]\ngenrate = "softwood"\n' + solver, "scene.toml:2: 'genrate' is no key of [sample]", "did you mean 'generate'?")
        bad('[sample]\nfile = "a.png"\ngenerate = "softwood"\n' + solver, "both", "give one of")
        bad(solver, "no [sample]", "say what the sample is")
        bad(good + solver + 'direction = true\n', "diffusion.direction = true", "--help")
        bad(good + solver + 'refine = "much"\n', "scene.toml:5: [diffusion] refine 'much'", "")
        bad(good + solver + 'no-error-estimate = 1\n', "true or false", "")
        bad(good + solver + 'tolerance = []\n', "a list without values", "")
        bad(good + solver + 'refine = "3..1"\n', "leads nowhere", "1..10")
        bad(good + '[crack-path]\n', "[crack-path] takes broken", "fracture")
        bad(good + solver + '[[each]]\nrun = "stress-pdf"\n', "no stage of this scene comes to steps", "fracture")
        bad(good + solver + '[[each]]\nrun = "snapshot"\nwrite = true\n', "write is for stages", "pictures")
        bad(good + solver + '[[each]]\nrun = "stres-pdf"\n', "does not run on steps", "did you mean 'stress-pdf'?")
        bad(good + solver + '[measure]\nk = "difusion.effective.x"\n', "'difusion' is no stage", "did you mean 'diffusion'?")
        bad(good + solver + '[measure]\nk = 3\n', "says no number", "STAGE.KEY")
        bad(good + solver + '[material]\nyoung = { wall = 1 }\n', "'young' is no key of [material]", "no solver")
        bad(good + solver + 'when = 2020-01-01\n', "dates", "quotes")
        bad('titel = "x"\n' + good + solver, "'titel' is no key of a scene", "did you mean 'title'?")
        bad(good + solver, "no section 'fracture'", "sample", words=["--fracture.horizon", "3"])
        bad(good + solver, "'--jbos' is not an option of lamella run", "did you mean '--jobs'?", words=["--jbos", "3"])
        bad(good + solver, "--jobs 0", "number of processes", words=["--jobs", "0"])
        bad('[sample]\nfile = "none.png"\n' + solver, "there is no file 'none.png'", "folder", 3)
        bad(good + 'seed = "1..20000"\n' + solver, "20 000 samples", "--yes")
        bad(good + 'seed = "1..1000000"\n[diffusion]\nconductivity = { lumen = "1..1000", wall = 1 }\n', "samples", "fewer values")

    def at_a_terminal(self, words, answer):
        """Runs at a pseudo-terminal and types `answer` once it is asked. Returns the program and what it showed so far."""
        ours, its = pty.openpty()
        self.addCleanup(os.close, ours)
        run = subprocess.Popen([program.PROGRAM, *words], cwd=self.folder, stdin=its, stdout=its, stderr=its, start_new_session=True)
        os.close(its)
        self.addCleanup(run.kill)
        shown = self.read_until(ours, "[y/N] ")
        self.assertTrue(shown.endswith("this sweep has 10 002 samples. Run them? [y/N] "), shown)
        os.write(ours, answer)
        return run, ours

    @staticmethod
    def read_until(terminal, words):
        shown = b""
        while words.encode() not in shown and select.select([terminal], [], [], 60)[0]:
            try:
                shown += os.read(terminal, 4096)
            except OSError:  # it is closed: the program has ended
                break
        return shown.decode().replace("\r\n", "\n")

    def test_a_large_sweep_asks(self):
        self.scene('[sample]\ngenerate = "checkerboard"\nsize = [4, 4]\ncells = 2\n'
                   '[diffusion]\nconductivity = { matrix = "1..5001", inclusion = [1, 2] }\n')
        for answer in (b"n\n", b"\n", b"what?\n", b"\x04"):  # the last one: end of file
            with self.subTest(answer):
                run, terminal = self.at_a_terminal(["run", "scene.toml"], answer)
                shown = self.read_until(terminal, "dry-run first\n")
                self.assertIn("error: this sweep has 10 002 samples, and was not run\nhint: look at it with --dry-run first\n", shown)
                self.assertEqual(run.wait(60), 2)
                self.assertEqual(os.listdir(self.folder), ["scene.toml"])
        run, terminal = self.at_a_terminal(["run", "scene.toml"], b"")
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(60), 130)
        run, terminal = self.at_a_terminal(["run", "scene.toml"], b"y\n")
        for _ in range(1200):
            if os.path.isdir(self.path("scene.results/samples")) and len(os.listdir(self.path("scene.results/samples"))) > 2:
                break
            time.sleep(0.05)
        run.send_signal(signal.SIGINT)
        self.assertIn("the same command goes on", self.read_until(terminal, "goes on from them"))
        self.assertEqual(run.wait(60), 130)
        self.assertGreater(len(os.listdir(self.path("scene.results/samples"))), 2)

    def test_units_of_the_tables(self):
        """Of swept keys those of the settings, of measures those of the reports; lengths are in pixels where their size is not known."""
        self.write("a.png", pictures.png(pictures.stripes(24, 24)))
        sample = '[sample]\nfile = "a.png"\nphase = { 0 = "lumen", 255 = "wall" }\n'
        self.scene(sample + FRACTURE[FRACTURE.index("[fracture]"):].replace("1e10", "[1e10, 2e10]"))
        for words, length in ((), "pixels"), (("--sample.pixel-size=2um",), "m"):
            self.assertEqual(self.run_lamella("run", "scene.toml", *words).code, 0)
            units = {}
            for name in ("table", "settings", "steps_crack", "times"):
                with open(self.path(f"scene.results/{name}.csv.json"), encoding="utf-8") as file:
                    units[name] = {column: about["unit"] for column, about in json.load(file)["columns"].items()}
            self.assertEqual(units["table"], {"fracture.young.wall": "Pa", "strength": "Pa", "length": length})
            self.assertEqual(units["settings"]["length.error"], length)
            self.assertEqual((units["steps_crack"]["stress"], units["steps_crack"]["length"]), ("Pa", length))
            self.assertEqual(units["times"]["seconds.fracture"], "s")

    def test_bad_folders(self):
        self.scene(DIFFUSION)
        os.mkdir(self.path("mine"))
        self.write("mine/letter.txt", b"dear")
        self.fails(7, "holds other things", "--results", "run", "scene.toml", "--results", "mine")
        self.write("file", b"x")
        self.fails(7, "is a file", "--results", "run", "scene.toml", "--results", "file")
        self.fails(3, "there is no file", "", "run", "none.toml")

    def test_a_measure_that_leads_nowhere(self):
        self.scene(DIFFUSION.replace("diffusion.effective.x", "diffusion.efective.x"))
        result = self.run_lamella("run", "scene.toml")
        self.assertEqual(result.code, 2)
        self.assertIn("scene.toml:12", result.err)
        self.assertIn("did you mean 'effective'?", result.err)
        self.assertEqual(os.listdir(self.folder), ["scene.toml"])
        # what only the sample tells is seen after the first; it was computed by then, and is not lost
        self.scene(DIFFUSION.replace("phases.wall", "phases.wal"))
        self.fails(2, "scene.toml:13", "did you mean 'wall'?", "run", "scene.toml", keep=("scene.results",))
        self.scene(DIFFUSION)
        self.assertEqual(self.works("run", "scene.toml", "--json").json()["finished_before"], 1)

    def test_examples(self):
        small = {
            "diffusion": ["--sample.size=[64, 64]", "--sample.seed=1..2"],
            "transient": ["--sample.size=[40, 30]", "--transient.end-time=2e-4", "--transient.frames=3"],
            "equilibrium": ["--sample.count=30", "--bridges.nodes=40", "--sample.seed=1"],
            "crack-tip": ["--sample.size=[40, 40]", "--sample.cells=2", "--fracture.notch=0,0.2mm,0.12mm,0.2mm",
                          "--fracture.at-broken=50..400 step 50"],
            "fracture": ["--sample.count=20", "--bridges.nodes=32", "--sample.seed=1", "--bridges.width=0.75"],
            "dynamics": ["--sample.size=[40, 10]", "--dynamics.end-time=1e-5"],
            "compression": ["--sample.size=[24, 24]", "--compression.strain=0.04", "--compression.at-strain=0.02"],
            "stiffness": ["--sample.count=30", "--bridges.nodes=40", "--bridges.saturation=[0.5, 0.7]"],
            "bond-stiffness": ["--sample.size=[48, 48]", "--sample.solid-fraction=[0.3, 0.4]"],
        }
        self.assertEqual(sorted(small), sorted(name[:-5] for name in os.listdir(EXAMPLES) if name.endswith(".toml")))
        for name, words in small.items():
            with self.subTest(name):
                result = self.run_lamella("run", os.path.join(EXAMPLES, name + ".toml"), *words)
                self.assertEqual(result.code, 0, result.err + result.out)
                for row in self.table("table.csv", name + ".results"):
                    self.assertEqual(row["status"], "done")


if __name__ == "__main__":
    unittest.main()
