"""lamella fit: conductivities and moduli from effective ones, what it says where measurements do not tell them, and what it refuses."""

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
        self.assertIn("temperature_y", self.works("info", "fields.vti").out)
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
        self.fails(2, "does not say how far", "--measured x=0.1±…", *words, "--unknown", "wall", "--measured", "x=0.1")
        self.fails(2, "there is 1 sample", "--also", *words, "--unknown", "wall", "--measured", "2/x=0.1±0.01")
        self.fails(2, "'z' is not found", "'x' and 'y'", *words, "--unknown", "wall", "--measured", "z=0.1±0.01")
        self.fails(2, "1 measurements for 2 unknowns", "at least as many", *words[:3], "--unknown", "wall", "--unknown", "lumen", "--measured", "x=0.1±0.01")
        self.fails(2, "twice", "once", *words, "--unknown", "wall", "--unknown", "wall", "--measured", "x=0.1±0.01")
        self.fails(2, "which command?", "diffusion", "fit")


if __name__ == "__main__":
    unittest.main()
