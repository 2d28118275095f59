"""lamella stiffness: tensor, errors, loads, tables, several ranks; what is doubtful and what is refused."""

import csv
import json
import math
import unittest

import pictures
from program import Case

STONE = ["stiffness", "stone.png", "--phase", "255=stone", "--young", "stone=2e9"]
LAYERS = ["stiffness", "layers.png", "--phase", "0=soft", "--phase", "255=hard", "--young", "soft=1e9", "--young", "hard=4e9",
          "--poisson", "soft=0,hard=0"]


class Stiffness(Case):
    def setUp(self):
        super().setUp()
        self.write("stone.png", pictures.png([[255] * 32 for _ in range(32)], pixels_per_metre=100000))
        self.write("layers.png", pictures.png([[0 if y < 16 else 255] * 32 for y in range(32)]))

    def test_one_phase_is_exact(self):
        found = self.works(*STONE, "--poisson", "stone=0.49", "--json").json()
        self.assertEqual((found["components"], found["continuum"], found["sides"]), (["xx", "yy", "xy"], "plane-stress", "periodic"))
        self.assertAlmostEqual(found["constants"]["E_x"]["value"] / 2e9, 1, places=9)
        self.assertAlmostEqual(found["constants"]["nu_xy"]["value"], 0.49, places=9)
        self.assertAlmostEqual(found["isotropic"]["young"] / 2e9, 1, places=9)
        self.assertLess(found["isotropic"]["rest"], 1e-9)
        self.assertEqual((found["iterations"], found["resisting"], found["warnings"]), ([0, 0, 0], 3, []))
        self.assertAlmostEqual(found["bounds"]["voigt"][0][0] / found["stiffness"][0][0], 1, places=9)
        self.assertAlmostEqual(found["bounds"]["hashin_shtrikman"]["shear"][0] / found["stiffness"][2][2], 1, places=9)
        self.assertEqual(found["pixel_size"], 1e-5)
        strain = self.works(*STONE, "--plane", "plane-strain", "--json").json()
        self.assertAlmostEqual(strain["constants"]["E_x"]["value"] / (2e9 / (1 - 0.09)), 1, places=9)

    def test_a_picture_takes_tensors_of_space(self):
        # E 2, nu 0.3: C12 = E nu / (1 + nu)(1 - 2 nu), C44 = E / 2(1 + nu), C11 = C12 + 2 C44
        c12, c44 = 0.6e9 / 0.52, 2e9 / 2.6
        words = ["stiffness", "stone.png", "--phase", "255=stone", "--stiffness", f"stone={c12 + 2 * c44} {c12} {c44}", "--json"]
        found = self.works(*words).json()
        self.assertAlmostEqual(found["constants"]["E_x"]["value"] / 2e9, 1, places=9)
        strain = self.works(*words, "--plane", "plane-strain", "--expansion", "stone=1e-4").json()
        self.assertAlmostEqual(strain["constants"]["E_x"]["value"] / (2e9 / 0.91), 1, places=9)
        self.assertAlmostEqual(strain["expansion"][0] / 1.3e-4, 1, places=6)  # 1 + nu: the third direction is not let
        self.fails(2, "2 numbers for the stiffness of 'stone'", "21, 9 or 3", *words[:4], "--stiffness", "stone=1 2")

    def test_layers(self):
        found = self.works(*LAYERS, "--json").json()
        # without Poisson's effect: in parallel 2.5e9, in series 1.6e9, shear in series
        for i, exact in enumerate((2.5e9, 1.6e9, 0.8e9)):
            self.assertAlmostEqual(found["stiffness"][i][i] / exact, 1, places=6)
            self.assertLessEqual(abs(found["stiffness"][i][i] - exact), found["estimated_errors"][i][i] + 1e-6 * exact)
        self.assertEqual([round(step.get("every_pixel") or 1) for step in found["steps"]], [1, 2, 3, 4])
        self.assertLess(found["orthotropic"]["rest"], 1e-6)
        # without Poisson's effect 1/E = c⁴/2.5 + s⁴/1.6 + s²c²/0.8: most along the layers; G has its most at 45°, 2 / (1/2.5 + 1/1.6) / 2
        young, shear, poisson = (found["by_direction"][name] for name in ("young", "shear", "poisson"))
        self.assertAlmostEqual(young["most"]["value"] / 2.5e9, 1, places=6)
        self.assertEqual((young["most"]["direction"], len(shear["least"]["across"])), ([1, 0], 2))
        self.assertAlmostEqual(shear["least"]["value"] / 0.8e9, 1, places=6)
        self.assertAlmostEqual(shear["most"]["value"] / (1e9 / (1 / 2.5 + 1 / 1.6)), 1, places=6)
        self.assertAlmostEqual(poisson["least"]["value"], 0, places=6)

    def test_loads(self):
        words = self.works(*LAYERS, "--mean-strain", "yy=0.01", "--mean-stress", "xx=0", "-o", "s.vti", "--json").json()
        self.assertAlmostEqual(words["load"]["stress"][1] / 1.6e7, 1, places=5)
        self.assertAlmostEqual(words["load"]["energy"] / (0.5 * 0.01 * 1.6e7), 1, places=5)
        pdf = self.run_lamella("stress-pdf", "s.vti", "--component", "yy", "--json").json()  # one stress: no tail
        self.assertAlmostEqual(pdf["mean"] / 1.6e7, 1, places=4)
        alone = self.works(*LAYERS, "--mean-strain", "xx=0.01", "--no-tensor", "--no-stress", "-o", "t.vti", "--json").json()
        self.assertIsNone(alone["stiffness"])
        self.assertAlmostEqual(alone["load"]["stress"][0] / 2.5e7, 1, places=5)
        warm = self.works(*LAYERS, "--expansion", "soft=4e-5,hard=1e-5", "--change", "10", "--json").json()
        # held: each layer is as stiff as itself along x
        self.assertAlmostEqual(warm["load"]["stress"][0] / (-10 * (4e-5 * 1e9 + 1e-5 * 4e9) / 2), 1, places=5)
        self.assertAlmostEqual(warm["expansion"][1] / 2.5e-5, 1, places=5)

    def test_what_constants_leave(self):
        # in series 1.6e9: 1/E = (1/1e9 + 1/4e9) / 2, so that dE/E = (E/2e9) dE1/E1 + (E/8e9) dE2/E2
        words = [*LAYERS[:6], "--young", "soft=1e9±1e8,hard=4GPa+-0.2GPa", "--poisson", "soft=0,hard=0"]
        found = self.works(*words, "--json").json()
        for name, soft, hard in (("E_y", 0.8, 0.2), ("E_x", 0.2, 0.8), ("G_xy", 0.8, 0.2)):
            relative = found["relative_sensitivity"][name]
            self.assertAlmostEqual(relative["young:soft"], soft, delta=1e-5)
            self.assertAlmostEqual(relative["young:hard"], hard, delta=1e-5)
            value = found["constants"][name]["value"]
            self.assertAlmostEqual(found["sensitivity"][name]["young:soft"] * 1e9 / value, relative["young:soft"], places=12)
            inputs = math.hypot(0.1 * soft, 0.05 * hard)
            self.assertAlmostEqual(found["input_errors"][name], inputs, delta=1e-6)
            self.assertAlmostEqual(found["total_errors"][name], math.hypot(inputs, found["constants"][name]["estimated_error"] / value), delta=1e-6)
        self.assertEqual(found["materials"]["hard"]["young_uncertainty"], 2e8)
        text = self.works(*words).out
        for line in ("1 % more of a phase's constant changes the box's by", "the constants' uncertainty leaves", "in all, of what was asked for", "half of it takes less of "):
            self.assertIn(line, text)
        plain = self.works(*LAYERS, "--json").json()
        self.assertEqual([plain[key] for key in ("sensitivity", "relative_sensitivity", "input_errors", "surface_doubt", "segmentation_errors", "total_errors")], [None] * 6)
        alone = self.works(*LAYERS, "--sensitivity", "--no-error-estimate", "--json", ranks=2).json()
        self.assertEqual(alone["sensitivity"], found["sensitivity"])
        self.assertEqual((alone["input_errors"], alone["total_errors"]), (None, None))
        # both surfaces of a period of 32 pixels, each moved by half a pixel: E_x by the moduli's difference
        moved = self.works(*LAYERS, "--surface-doubt", "0.5", "--json").json()
        self.assertAlmostEqual(moved["surface_sensitivity"]["E_x"]["soft:hard"] / (2 / 32 * (1e9 - 4e9)), 1, places=5)
        self.assertAlmostEqual(moved["segmentation_errors"]["E_x"], 0.5 * 2 / 32 * 3 / 2.5, places=5)
        whole = math.hypot(moved["segmentation_errors"]["E_x"], moved["constants"]["E_x"]["estimated_error"] / moved["constants"]["E_x"]["value"])
        self.assertAlmostEqual(moved["total_errors"]["E_x"], whole, places=9)
        self.assertIn("surfaces within 0.5 pixels", self.works(*LAYERS, "--surface-doubt", "0.5").out)
        self.fails(2, "nothing tells how far surfaces may lie", "in pixels", *LAYERS, "--segmentation-error")
        # a scene
        scene = ('[sample]\ngenerate = "laminate"\nsize = [32, 32]\naxis = "y"\ncells = 1\n[stiffness]\nyoung = { matrix = "1e9±1e8", inclusion = 4e9 }\n'
                 'poisson = { matrix = 0, inclusion = 0 }\n[measure]\nby = "stiffness.relative_sensitivity.E_y.young:matrix"\ninputs = "stiffness.input_errors.E_y"\n')
        self.write("s.toml", scene.encode())
        self.works("run", "s.toml")
        with open(self.path("s.results/table.csv"), encoding="utf-8") as file:
            row = next(csv.DictReader(file))
        self.assertAlmostEqual(float(row["by"]), 0.8, delta=1e-5)
        self.assertAlmostEqual(float(row["inputs"]), 0.08, delta=1e-5)
        # the energy of a load: in parallel
        load = self.works(*words, "--mean-strain", "xx=0.01", "--no-tensor", "--no-stress", "--json").json()
        self.assertAlmostEqual(load["relative_sensitivity"]["energy"]["young:hard"], 0.8, delta=1e-5)
        self.write("block.png", pictures.png([[255 if 8 <= x < 24 and 8 <= y < 24 else 0 for x in range(32)] for y in range(32)]))
        rigid = self.works("stiffness", "block.png", *LAYERS[2:6], "--young", "soft=1e9±1e8", "--rigid", "hard")
        self.assertIn("not told of 'hard', which is rigid", rigid.out)
        self.fails(2, "'wide' is not a number", "--young PHASE=VALUE", *LAYERS[:6], "--young", "soft=1e9±wide")
        self.fails(2, "uncertainty of the Young's modulus of 'soft' is -1", "0 or more", *words[:6], "--young", "soft=1e9±-1,hard=1e9")

    def test_constants_along_and_across(self):
        # the shear modulus follows from the others where none is given
        self.works("generate", "softwood", "--size", "60,50", "--seed", "3", "-o", "labels.png")
        self.works("micrograph", "labels.png", "--lamella", "none", "-o", "wood.vti")
        given = {"young": 8e9, "young-across": 5e9, "poisson": 0.3, "poisson-across": 0.25}

        def solve(*more, **changed):
            constants = {**given, **{name.replace("_", "-"): value for name, value in changed.items()}}
            words = [word for name, value in constants.items() for word in (f"--{name}", f"wall={value!r}")]
            return self.works("stiffness", "wood.vti", *words, "--no-error-estimate", "--tolerance", "1e-11", "--json", *more).json()

        found = solve("--sensitivity")
        value, by = found["constants"]["E_x"]["value"], found["sensitivity"]["E_x"]
        self.assertEqual([name.removesuffix(":wall") for name in by], list(given))
        for name, number in given.items():
            step = 1e-3 * number
            more, less = (solve(**{name.replace("-", "_"): number + side * step})["constants"]["E_x"]["value"] for side in (1, -1))
            self.assertAlmostEqual(by[name + ":wall"] * number / value, (more - less) / (2 * step) * number / value, delta=1e-5)
        self.assertIn("shear:wall", solve("--sensitivity", shear=2e9)["sensitivity"]["E_x"])

    def test_a_field_of_diffusion_expands(self):
        self.works("diffusion", "layers.png", "--phase", "0=soft", "--phase", "255=hard", "--conductivity", "soft=1,hard=1", "--direction", "x",
                   "-o", "heat.vti", "--no-error-estimate")
        found = self.works("stiffness", "heat.vti", "--young", "soft=1e9,hard=1e9", "--expansion", "soft=1e-5,hard=1e-5", "--change", "30",
                           "--change-array", "temperature", "--mean-stress", "xx=0", "--json").json()
        self.assertAlmostEqual(found["load"]["strain"][0] / 15e-5, 1, places=4)  # the mean of 1 to 0, in one material

    def test_sides(self):
        periodic = self.works(*LAYERS, "--json").json()["stiffness"]
        upper = self.works(*LAYERS, "--sides", "uniform-strain", "--json").json()["stiffness"]
        lower = self.works(*LAYERS, "--sides", "uniform-stress", "--json").json()["stiffness"]
        self.assertLess(lower[0][0], periodic[0][0] * (1 + 1e-5))
        self.assertGreater(upper[2][2], periodic[2][2])
        slip = self.works(*LAYERS, "--sides", "slip", "--json").json()
        self.assertAlmostEqual(slip["constants"]["E_y"]["value"] / 1.6e9, 1, places=4)
        self.assertNotIn("isotropic", slip)

    def test_table_and_files(self):
        text = self.works(*LAYERS, "--tensor", "c.csv", "--constants", "e.csv", "--directions", "d.vtp").out
        for words in ("stiffness [GPa]", "after ± its error", "E_x", "nu_yx", "G_xy", "extrapolated", "bounds of the diagonal", "Hashin",
                      "nearest isotropic tensor", "of all directions", "wrote c.csv", "wrote e.csv", "wrote d.vtp"):
            self.assertIn(words, text)
        with open(self.path("c.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["stress"] for row in rows], ["xx", "yy", "xy"])
        with open(self.path("e.csv.json"), encoding="utf-8") as file:
            self.assertIn("lamella stiffness", json.load(file)["provenance"]["command"])
        self.fails(7, "c.csv", "--overwrite", *LAYERS, "--tensor", "c.csv")

    def test_ranks(self):
        one = self.works(*LAYERS, "--json").json()
        two = self.works(*LAYERS, "--mean-strain", "xx=0.01", "-o", "r.vti", "--json", ranks=2).json()
        self.assertEqual((two["ranks"], two["stiffness"]), (2, one["stiffness"]))

    def test_what_is_refused(self):
        for options, message, hint, code in (
                (["--poisson", "stone=1"], "a Poisson's ratio of 1 of phase 'stone'", "it lies above -1 and below 1", 2),
                (["--poisson", "stone=-1"], "a Poisson's ratio of -1", "it lies above -1", 2),
                (["--poisson", "stone=0.5", "--plane", "plane-strain"], "a Poisson's ratio of 0.5", "below 0.5", 2),
                (["--mean-strain", "zz=1"], "a mean strain 'zz' of a picture", "there are xx, yy, xy", 2),
                (["--sides", "slip", "--mean-strain", "xy=1"], "between platens", "give one", 2),
                (["--rigid", "stone"], "'stone' is to be rigid and has a stiffness", "say one thing", 2),
                (["--young-across", "stone=1e9"], "no point array 'axis'", "directions", 3),
                (["--no-tensor"], "neither the tensor nor", "give a mean strain", 2),
                (["--refine", "0"], "--refine 0 is below 1", "every pixel", 2)):
            with self.subTest(options):
                self.fails(code, message, hint, *STONE, *options)
        self.fails(2, "is not positive definite", "Poisson", "stiffness", "stone.png", "--phase", "255=stone", "--stiffness", "stone=1 2 1 1")
        self.fails(4, "all of the box is void", "give some phase", "stiffness", "stone.png", "--phase", "255=void")

    def test_loose_pieces_are_told(self):
        self.write("loose.png", pictures.png([[255 if y < 8 or (16 < y < 24 and 10 < x < 20) else 0 for x in range(32)] for y in range(32)]))
        done = self.run_lamella("stiffness", "loose.png", "--phase", "0=void", "--phase", "255=stone", "--young", "stone=1e9", "--json")
        found = done.json()
        self.assertEqual((found["loose_pieces"], found["loose_nodes"]), (1, 63))
        self.assertIn("loose", done.err)
        self.assertIsNone(found["constants"]["nu_xy"]["value"])
        self.assertEqual(found["constants"]["E_y"]["value"], 0)
        self.assertAlmostEqual(found["constants"]["E_x"]["value"] / 0.25e9, 1, places=5)


if __name__ == "__main__":
    unittest.main()
