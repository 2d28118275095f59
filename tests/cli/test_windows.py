"""How far a sample speaks for the material that it was cut out of, of every command that tells it."""

import unittest

import pictures
from program import CONDUCTIVITIES, PHASES, Case

TISSUE = ["generate", "softwood", "--size", "240,200", "--solid-fraction", "0.42", "--seed", "5", "-o", "t.png"]


class Windows(Case):
    def tissue(self):
        self.works(*TISSUE)
        return "t.png"

    def test_diffusion_tells_an_interval(self):
        words = ["diffusion", self.tissue(), *CONDUCTIVITIES, "--no-error-estimate"]
        plain = self.works(*words, "--json").json()
        self.assertIsNone(plain["window_error"])
        self.assertIsNone(plain["window_errors"])
        answer = self.works(*words, "--window-error", "--json").json()
        self.assertEqual(answer["effective"], plain["effective"])
        for axis in "xy":
            window = answer["window_errors"][axis]
            value = answer["effective"][axis]
            self.assertLess(window["low"], value)
            self.assertGreater(window["high"], value)
            far = max(window["high"] - value, value - window["low"])
            self.assertAlmostEqual(window["error"], far / value)
            self.assertLess(window["error"], 1)
            self.assertGreaterEqual(window["pictures_for"]["1%"] or 1e9, window["pictures_for"]["5%"] or 1)
            windows = [step for step in answer["directions"][axis]["steps"] if step["parts"] > 1]
            self.assertEqual([(step["parts"], step["pictures"]) for step in windows], [(2, 4), (3, 9)])
        self.assertEqual(answer["window_error"], max(answer["window_errors"][axis]["error"] for axis in "xy"))
        text = self.works(*words, "--window-error").out
        self.assertIn("window: the material that the sample was cut out of has, with 95 % probability", text)

    def test_a_regular_sample_is_known(self):
        # Windows of whole layers are alike.
        self.write("p.png", pictures.png(pictures.stripes(72, 24, bands=24)))
        answer = self.works("diffusion", "p.png", *PHASES, *CONDUCTIVITIES, "--window-error", "--json", "--no-error-estimate").json()
        self.assertLess(answer["window_error"], 1e-3)
        self.works("generate", "laminate", "--size", "48,24", "--axis", "x", "--cells", "12", "--solid-fraction", "0.5", "-o", "l.vti")
        words = ["l.vti", "--young", "matrix=1e9,inclusion=3e9", "--window-error", "--json"]
        stiff = self.works("stiffness", *words).json()
        for name in ("xx", "yy", "xy", "E_x", "E_y", "G_xy"):
            window = stiff["window_errors"][name]
            # straight sides against periodic ones: mirrors of whole layers
            self.assertLess(window["error"], 1e-3, name)
        holes = self.works("generate", "disks", "--size", "48,48", "--cells", "12", "--solid-fraction", "0.4", "-o", "d.png")
        self.assertEqual(holes.code, 0)
        found = self.works("pore-flood-fill", "d.png", "--phase", "0=solid,255=pore", "--window-error", "--json").json()
        for name in ("porosity", "pore_density", "pore_mean"):
            self.assertLess(found["window_errors"][name]["error"], 1e-9, name)

    def test_a_ring_is_no_scatter(self):
        self.works("generate", "softwood", "--size", "400,300", "--ring-position", "0,1", "--solid-fraction", "0.45", "--seed", "3", "-o", "r.png")
        answer = self.works("diffusion", "r.png", *CONDUCTIVITIES, "--window-error", "--json", "--no-error-estimate").json()
        for axis in "xy":
            gradient = answer["window_errors"][axis]["gradient"]
            self.assertEqual(gradient["axis"], "x")
            # Layers in series along the ring, side by side across it, hold the picture's own value but for the sides
            # of thirds, which is more than a few per cent of tissue of ten cells.
            self.assertAlmostEqual(gradient["layered"] / answer["effective"][axis], 1, delta=0.1)

    def test_stiffness_and_pores(self):
        name = self.tissue()
        stiff = self.works("stiffness", name, "--void", "lumen", "--young", "wall=1e10", "--window-error", "--no-error-estimate", "--sides", "straight")
        self.assertIn("E_x ", stiff.out)
        self.assertIn("window: ", stiff.out)
        pressed = self.works("stiffness", name, "--void", "lumen", "--young", "wall=1e10", "--window-error", "--sides", "slip", "--no-error-estimate")
        self.assertIn("E_x ", pressed.out)
        self.assertNotIn("G_xy ", pressed.out.split("window: ")[1])
        found = self.works("pore-flood-fill", name, "--window-error", "--json").json()["window_errors"]
        self.assertAlmostEqual(found["porosity"]["bias"], 0, delta=1e-3)  # means of windows are that of the image
        self.assertNotEqual(found["pore_mean"]["bias"], 0)  # sides cut pores
        self.assertIsNone(self.works("pore-flood-fill", name, "--json").json()["window_errors"])

    def test_what_cannot_be_told(self):
        self.write("p.png", pictures.png(pictures.stripes(7, 6, bands=1)))
        result = self.run_lamella("diffusion", "p.png", *PHASES, *CONDUCTIVITIES, "--window-error", "--json", "--no-error-estimate")
        self.assertEqual(result.code, 0)
        self.assertIn("too small to be cut", result.err)
        self.assertIsNone(result.json()["window_error"])

    def test_shares_have_windows(self):
        # Layers along x whose surfaces lie in the middle of a node: shares of 0, a half and 1, the same in every window.
        row = [0, 128, 255, 128] * 12
        self.write("s.png", pictures.png([row] * 24))
        words = ["s.png", "--shares", "0,256", "--conductivity", "low=1,high=4", "--no-error-estimate", "--json"]
        plain = self.works("diffusion", *words).json()
        found = self.works("diffusion", *words, "--window-error").json()
        self.assertEqual(found["effective"], plain["effective"])
        self.assertEqual(found["estimated_error"], plain["estimated_error"])
        for axis in "xy":
            windows = [step for step in found["directions"][axis]["steps"] if step["parts"] > 1]
            self.assertEqual([(step["parts"], step["pictures"]) for step in windows], [(2, 4), (3, 9)])
        self.assertLess(found["window_errors"]["y"]["error"], 1e-3)
        several = self.run_lamella("diffusion", *words, "--window-error", ranks=2).json()
        for key in ("low", "high", "bias"):
            self.assertAlmostEqual(several["window_errors"]["x"][key], found["window_errors"]["x"][key], delta=1e-4)

    def test_smoothed_labels_tell_about_what_labels_do(self):
        name = self.tissue()
        words = ["diffusion", name, *CONDUCTIVITIES, "--no-error-estimate", "--window-error", "--json"]
        for sides in ("insulated", "mixed"):
            plain = self.works(*words, "--sides", sides).json()
            smooth = self.works(*words, "--smooth-labels", "--sides", sides).json()
            for axis in "xy":
                a, b = plain["window_errors"][axis], smooth["window_errors"][axis]
                self.assertAlmostEqual(b["error"] / a["error"], 1, delta=0.25)
                self.assertTrue(b["low"] < smooth["effective"][axis] < b["high"])
                self.assertNotEqual(a["low"], b["low"])

    def test_ranks_change_nothing(self):
        name = self.tissue()
        one, two = (self.run_lamella("pore-flood-fill", name, "--window-error", "--json", ranks=ranks).json() for ranks in (0, 2))
        self.assertEqual(one["window_errors"], two["window_errors"])


if __name__ == "__main__":
    unittest.main()
