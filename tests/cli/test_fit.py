"""lamella fit: conductivities and moduli from effective ones, what it says where measurements do not tell them, and what it refuses."""

import csv
import glob
import unittest

from program import Case


class Fit(Case):
    def tissue(self, name="t.vti", seed="3"):
        self.works("generate", "softwood", "--size", "90,80", "--seed", seed, "-o", name)
        return name

    def effective(self, name, *words):
        return self.works("diffusion", name, *words, "--no-error-estimate", "--json").json()["effective"]

    def test_conductivity(self):
        name = self.tissue()
        truth = self.effective(name, "--conductivity", "lumen=0.026,wall=0.41")
        words = ["fit", "diffusion", name, "--conductivity", "lumen=0.026", "--unknown", "wall"]
        found = self.works(*words, "--measured", f"y={truth['y']!r}±0.002", "--json", "-o", "fields.vti").json()
        wall = found["unknown"]["conductivity:wall"]
        self.assertAlmostEqual(wall["value"], 0.41, delta=1e-3)
        self.assertTrue(wall["low"] < wall["low_by_measurement"] < 0.41 < wall["high_by_measurement"] < wall["high"])
        self.assertLessEqual(found["solves"], 10)
        self.assertEqual((found["freedom"], found["chance"]), (0, None))
        # its fields, a file a direction, as diffusion writes them with what was found
        self.assertEqual(found["output"], ["fields_x.vti", "fields_y.vti"])
        self.works("diffusion", name, "--conductivity", f"lumen=0.026,wall={wall['value']!r}", "--sensitivity", "-o", "wood.vti")
        for axis in "xy":
            fit, heat = (self.works("info", f"{stem}_{axis}.vti", "--json").json() for stem in ("fields", "wood"))
            rows = [{array["name"]: (array["unit"], array["description"]) for array in one["point_arrays"]} for one in (fit, heat)]
            self.assertEqual(*rows)
            tau = [self.works("flux-map", f"{stem}_{axis}.vti", "--json").json()["tortuosity"][axis] for stem in ("fields", "wood")]
            self.assertAlmostEqual(*tau, places=6)
        # two directions that fit, and two that do not
        both = self.works(*words, "--measured", f"x={truth['x']!r}±0.003,y={truth['y']!r}+-0.002", "--json").json()
        self.assertGreater(both["chance"], 0.9)
        self.assertLess(both["unknown"]["conductivity:wall"]["high_by_measurement"], wall["high_by_measurement"])
        text = self.works(*words, "--measured", f"x={1.5 * truth['x']!r}±0.003", "--measured", f"y={truth['y']!r}±0.002").out
        self.assertIn("the model does not fit", text)

    def test_two_samples_tell_two_phases(self):
        names = self.tissue(), self.tissue("dense.vti", "5")
        self.works("generate", "softwood", "--size", "90,80", "--solid-fraction", "0.75", "--seed", "4", "-o", names[1], "--overwrite")
        given = "lumen=0.05,wall=0.5"
        first, second = (self.effective(name, "--conductivity", given) for name in names)
        found = self.works("fit", "diffusion", names[0], "--also", names[1], "--unknown", "wall", "--unknown", "lumen=0.01",
                           "--measured", f"y={first['y']!r}±{0.001 * first['y']!r}", "--measured", f"2/x={second['x']!r}±{0.001 * second['x']!r}",
                           "--no-error-estimate", "--json").json()
        for phase, value in (("wall", 0.5), ("lumen", 0.05)):
            self.assertAlmostEqual(found["unknown"]["conductivity:" + phase]["value"] / value, 1, delta=0.01)
        self.assertEqual(list(found["measured"]), ["y", "2/x"])

    def test_moistures(self):
        """A wall whose conductivity rises with moisture, of two samples; a modulus that falls."""
        names = self.tissue(), self.tissue("dense.vti", "5")
        value, slope = 0.4, 0.6
        words, truth = [], []
        for which, name, moisture in (("", names[0], 0.0), ("", names[0], 0.12), ("2/", names[1], 0.2)):
            truth.append(self.effective(name, "--conductivity", f"lumen=0.026,wall={value + slope * moisture!r}")["y"])
            words += ["--measured", f"{which}y@{moisture!r}={truth[-1]!r}±{0.005 * truth[-1]!r}"]
        fit = ["fit", "diffusion", names[0], "--also", names[1], "--conductivity", "lumen=0.026", *words, "--direction", "y"]
        found = self.works(*fit, "--unknown", "wall", "--unknown", "slope:wall", "--json", "-o", "wet.vti").json()
        for key, known in (("conductivity:wall", value), ("slope:conductivity:wall", slope)):
            one = found["unknown"][key]
            self.assertAlmostEqual(one["value"] / known, 1, delta=1e-4)  # a search ends within a twentieth of a deviation
            self.assertTrue(one["low"] < one["low_by_measurement"] < known < one["high_by_measurement"] < one["high"])
        self.assertLess(found["correlation"][0][1], -0.5)
        self.assertEqual(found["freedom"], 1)
        self.assertEqual(list(found["measured"]), ["y@0.0", "y@0.12", "2/y@0.2"])
        made = [self.works("stiffness", names[0], "--young", f"wall={young!r}", "--no-error-estimate", "--json").json()["constants"]["E_x"]["value"]
                for young in (8e9, 5.6e9)]
        found = self.works("fit", "stiffness", names[0], "--unknown", "young:wall", "--unknown", "slope:young:wall", "--no-error-estimate",
                           "--measured", f"E_x@0={made[0]!r}±{0.01 * made[0]!r},E_x@12={made[1]!r}±{0.01 * made[1]!r}", "--json").json()["unknown"]
        self.assertAlmostEqual(found["young:wall"]["value"] / 8e9, 1, delta=1e-4)
        self.assertAlmostEqual(found["slope:young:wall"]["value"] / -0.2e9, 1, delta=1e-3)  # for each per cent

    def test_scene_of_moistures(self):
        # as the command, to the last digit; its field of one direction goes on
        name = self.tissue()
        words = ["--conductivity", "lumen=0.026", "--unknown", "wall", "--unknown", "slope:wall", "--measured", "y@0=0.112±0.003,y@0.12=0.127±0.003"]
        told = self.works("fit", "diffusion", name, *words, "--json", "-o", "f.vti").json()["unknown"]
        tau = self.works("flux-map", "f_y.vti", "--json").json()["tortuosity"]["y"]
        scene = f"""
[sample]
file = "{name}"

[fit]
solver = "diffusion"
conductivity = {{ lumen = 0.026 }}
unknown = ["wall", "slope:wall"]
measured = {{ "y@0" = "0.112±0.003", "y@0.12" = "0.127±0.003" }}

[flux-map]
of = "fit:y"

[[picture]]
name = "wall"
of = "fit:x"
array = "temperature"

[measure]
wall = "fit.unknown.conductivity:wall.value"
slope = "fit.unknown.slope:conductivity:wall.high"
moist = "fit.measured.y@0.12.fitted"
tau = "flux-map.tortuosity.y"
"""
        self.write("moist.toml", scene.encode())
        self.works("run", "moist.toml", "--quiet")
        with open(self.path("moist.results/table.csv"), encoding="utf-8", newline="") as file:
            row = next(csv.DictReader(file))
        self.assertEqual([float(row[key]) for key in ("wall", "slope", "tau")],
                         [told["conductivity:wall"]["value"], told["slope:conductivity:wall"]["high"], tau])
        self.assertAlmostEqual(float(row["moist"]), 0.127, delta=1e-6)
        self.assertEqual(len(glob.glob(self.path("moist.results/samples/*/wall.png"))), 1)
        for old, new, message, hint in (
            ('"fit:y"', '"fit"', "[flux-map] takes one field, and [fit] gives one for each direction", 'of = "fit:x"'),
            ('"fit:y"', '"fit:u"', "'fit:u' is no direction", 'of = "fit:x"'),
            ("[fit]", '[fit]\ndirection = "y"', "[fit] has one direction only, and no 'fit:x'", 'of = "fit"'),
            ('"temperature"', '"temprature"', "'temprature', which fit does not give", "did you mean 'temperature'?"),
        ):
            self.write("moist.toml", scene.replace(old, new).encode())
            self.fails(2, message, hint, "run", "moist.toml", "--dry-run")

    def test_moduli(self):
        name = self.tissue()
        made = self.works("stiffness", name, "--young", "wall=8e9", "--no-error-estimate", "--json").json()["constants"]["E_x"]["value"]
        found = self.works("fit", "stiffness", name, "--unknown", "young:wall", "--measured", f"E_x={made!r}±{0.02 * made!r}", "--json").json()
        young = found["unknown"]["young:wall"]
        self.assertAlmostEqual(young["value"] / 8e9, 1, delta=1e-3)
        self.assertTrue(young["low"] < young["low_by_measurement"] < 8e9 < young["high_by_measurement"] < young["high"])
        self.assertLessEqual(found["solves"], 10)

    def test_two_moduli(self):
        # of walls along and across in one, of two phases in the other, in few solves
        self.works("generate", "softwood", "--size", "90,80", "--seed", "3", "-o", "labels.png")
        self.works("micrograph", "labels.png", "--lamella", "none", "-o", "wood.vti")
        for name, truths, more in (("wood.vti", {"young:wall": 8e9, "young-across:wall": 3e9}, ("--shear", "wall=2e9")),
                                   (self.tissue(), {"young:wall": 8e9, "young:lumen": 4e8}, ())):
            material = [word for key, value in truths.items() for word in (f"--{key.split(':')[0]}", f"{key.split(':')[1]}={value!r}")]
            made = self.works("stiffness", name, *material, *more, "--no-error-estimate", "--json").json()["constants"]
            measured = [word for key in ("E_x", "E_y") for word in ("--measured", f"{key}={made[key]['value']!r}±{0.005 * made[key]['value']!r}")]
            unknown = [word for key in truths for word in ("--unknown", key + ("=3e8" if key == "young:lumen" else ""))]
            found = self.works("fit", "stiffness", name, *unknown, *measured, *more, "--no-error-estimate", "--json").json()
            for key, truth in truths.items():
                self.assertAlmostEqual(found["unknown"][key]["value"] / truth, 1, delta=0.02)
            self.assertLessEqual(found["solves"], 10)
        self.fails(2, "'8e9±1e8' is not a number", "--young", "fit", "stiffness", "wood.vti", "--young", "wall=8e9±1e8", "--unknown", "shear:wall", "--measured", "E_x=1e9±1e8")

    def test_scene(self):
        # the same numbers as the command, to the last digit; one after the other for two measurements
        names = self.tissue(), self.tissue("other.vti", "5")
        words = ["--conductivity", "lumen=0.026", "--unknown", "wall", "--measured", "y=0.112±0.003", "--measured", "2/x=0.12±0.004"]
        told = self.works("fit", "diffusion", names[0], "--also", names[1], *words, "--json").json()
        self.write("heat.toml", f"""
[sample]
file = "{names[0]}"

[fit]
solver = "diffusion"
also = ["{names[1]}"]
conductivity = {{ lumen = 0.026 }}
unknown = "wall"
measured = {{ y = ["0.112±0.003", "0.12±0.003"], "2/x" = "0.12±0.004" }}

[measure]
wall = "fit.unknown.conductivity:wall.value"
low = "fit.unknown.conductivity:wall.low"
error = "fit.measured.2/x.lattice_and_picture"
solves = "fit.solves"
""".encode())
        self.assertIn("fit", self.works("run", "heat.toml", "--dry-run").out)
        self.works("run", "heat.toml", "--quiet")
        with open(self.path("heat.results/table.csv"), encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        wall = told["unknown"]["conductivity:wall"]
        self.assertEqual([float(rows[0][key]) for key in ("wall", "low", "error", "solves")],
                         [wall["value"], wall["low"], told["measured"]["2/x"]["lattice_and_picture"], told["solves"]])
        self.assertGreater(float(rows[1]["wall"]), wall["value"])

    def test_scene_of_moduli(self):
        # what [material] tells goes to the fit; the fields at the fit are there to be written
        name = self.tissue()
        words = ["--poisson", "wall=0.2", "--unknown", "young:wall=5e9", "--measured", "E_x=1e9±2e7"]
        told = self.works("fit", "stiffness", name, *words, "--json", "-o", "fields.vti").json()["unknown"]["young:wall"]
        self.write("moduli.toml", f"""
[sample]
file = "{name}"

[material]
poisson = {{ wall = 0.2 }}

[fit]
solver = "stiffness"
unknown = {{ "young:wall" = 5e9 }}
measured = {{ E_x = "1e9±2e7" }}
write = true

[measure]
young = "fit.unknown.young:wall.value"
high = "fit.unknown.young:wall.high"
""".encode())
        self.works("run", "moduli.toml", "--quiet")
        with open(self.path("moduli.results/table.csv"), encoding="utf-8", newline="") as file:
            row = next(csv.DictReader(file))
        self.assertEqual([float(row["young"]), float(row["high"])], [told["value"], told["high"]])
        wrote = glob.glob(self.path("moduli.results/samples/*/fit.vti"))
        self.assertEqual(len(wrote), 1)

    def test_what_a_scene_refuses(self):
        name = self.tissue()
        fit = '[fit]\nconductivity = { lumen = 0.026 }\nunknown = "wall"\nmeasured = { x = "0.1±0.01" }\n'
        for change, message, hint in (
            (("", ""), "[fit] does not say what was measured", "'diffusion' or 'stiffness'"),
            (("[fit]", '[fit]\nsolver = "diffusoin"'), "'diffusoin' is no solver of [fit]", "did you mean 'diffusion'?"),
            (("[fit]", '[fit]\nsolver = "stiffness"'), "'conductivity' is no key of [fit]", "lamella fit stiffness --help"),
            (("[fit]", '[fit]\nsolver = "diffusion"\nflux = true'), "'flux' is no key of [fit]", "--help"),
        ):
            self.write("scene.toml", f'[sample]\nfile = "{name}"\n\n{fit.replace(*change)}'.encode())
            self.fails(2, message, hint, "run", "scene.toml")
        whole = fit.replace("[fit]", '[fit]\nsolver = "diffusion"')
        for old, new, message, hint in (
            ('"wall"', '"bark"', "scene.toml:7: [fit] unknown names 'bark', which is no phase of this sample", "its phases are 'lumen' and 'wall'"),
            ("±0.01", "", "scene.toml:8: [fit] measured x=0.1 does not say how far", "x=0.1±…"),
        ):
            self.write("scene.toml", f'[sample]\nfile = "{name}"\n\n{whole.replace(old, new)}'.encode())
            self.fails(2, message, hint, "run", "scene.toml", "--dry-run")

    def test_what_is_not_told(self):
        name = self.tissue()
        words = ["fit", "diffusion", name]
        dry = self.effective(name, "--conductivity", "lumen=1e-6,wall=0.41")["x"]
        self.fails(3, "do not tell conductivity of lumen", "give it a value", *words, "--conductivity", "wall=0.41", "--unknown", "lumen=1e-6", "--measured", f"x={dry!r}±0.01")
        self.fails(3, "only together", "give one of them a value", *words, "--unknown", "lumen", "--unknown", "wall", "--measured", "x=0.13±0.02", "--measured", "y=0.09±0.02")
        self.fails(3, "nothing fits", "look at the units", *words, "--conductivity", "wall=0.41", "--unknown", "lumen", "--measured", f"x={dry / 2!r}±0.001")

    def test_what_it_refuses(self):
        name = self.tissue()
        words = ["fit", "diffusion", name, "--conductivity", "lumen=0.026"]
        self.fails(2, "no phase of this sample", "its phases are 'lumen' and 'wall'", *words, "--unknown", "bark", "--measured", "x=0.1±0.01")
        self.fails(2, "which is no phase of this sample", "did you mean 'lumen'?", *words[:3], "--conductivity", "lumne=0.026", "--unknown", "wall", "--measured", "x=0.1±0.01")
        self.fails(2, "does not say how far", "x=0.1±…", *words, "--unknown", "wall", "--measured", "x=0.1")
        self.fails(2, "there is 1 sample", "also", *words, "--unknown", "wall", "--measured", "2/x=0.1±0.01")
        self.fails(2, "'z' is not found", "'x' and 'y'", *words, "--unknown", "wall", "--measured", "z=0.1±0.01")
        self.fails(2, "1 measurements for 2 unknowns", "at least as many", *words[:3], "--unknown", "wall", "--unknown", "lumen", "--measured", "x=0.1±0.01")
        self.fails(2, "'0.1o' is not a number", "QUANTITY=VALUE±HALF", *words, "--unknown", "wall", "--measured", "x=0.1o±0.01")
        self.fails(2, "'-1' is not a number", "positive", *words, "--unknown", "wall=-1", "--measured", "x=0.1±0.01")
        self.fails(2, "'yuong' is nothing that can be looked for", "did you mean 'young'?", "fit", "stiffness", name, "--unknown", "yuong:wall", "--measured", "E_x=1e9±1e8")
        self.fails(2, "measured has x twice", "mean of both", *words, "--unknown", "wall", "--measured", "x=0.1±0.01,x=0.12±0.01")
        moist = [*words, "--unknown", "wall", "--unknown", "slope:wall", "--measured"]
        self.fails(2, "all was measured at 0.12, and one moisture does not tell the slope", "another moisture", *moist, "x@0.12=0.1±0.01,y@0.12=0.1±0.01")
        self.fails(2, "measured y does not say at which moisture", "y@0.12=", *moist, "x@0.12=0.1±0.01,y=0.1±0.01")
        self.fails(2, "nothing that is looked for changes with it", "slope:conductivity:wall", *words, "--unknown", "wall", "--measured", "x@0.12=0.1±0.01")
        self.fails(2, "together with the value", "look for conductivity:wall", *words, "--unknown", "slope:wall", "--measured", "x@0.12=0.1±0.01")
        self.fails(2, "'dry' is not a number", "QUANTITY@MOISTURE", *moist, "x@dry=0.1±0.01")
        self.fails(2, "twice", "once", *words, "--unknown", "wall", "--unknown", "wall", "--measured", "x=0.1±0.01")
        self.fails(2, "which command?", "diffusion", "fit")


if __name__ == "__main__":
    unittest.main()
