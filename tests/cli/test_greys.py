"""Grey pictures and volumes: ranges of greys as phases, Otsu's levels, --segment of a volume."""

import random
import struct
import unittest

import pictures
from program import Case

RAMP = [[x for x in range(256)] for _ in range(8)]
HALF = ["--conductivity", "void=0", "--conductivity", "fibre=1"]
NAMED = ["--phase", "..otsu=void", "--phase", "otsu..=fibre"]
EDGE = 40


def tomogram(noise=25, low=60, high=170, bits=8):
    """Bars of 10 × 10 along z, 20 apart: a quarter of the volume, with noise."""
    numbers = random.Random(4)
    values = []
    for _ in range(EDGE):
        for y in range(EDGE):
            for x in range(EDGE):
                fibre = 5 <= x % 20 < 15 and 5 <= y % 20 < 15
                values.append(round(min(max(numbers.gauss(high if fibre else low, noise), 0), 2**bits - 1)))
    return struct.pack("<%d%s" % (len(values), "B" if bits == 8 else "H"), *values)


class Ranges(Case):
    def setUp(self):
        super().setUp()
        self.write("ramp.png", pictures.png(RAMP))

    def shares(self, *words, name="ramp.png"):
        found = self.works("diffusion", name, *words, *HALF, "--no-error-estimate", "--direction", "y", "--json").json()
        return {phase["name"]: phase["fraction"] for phase in found["phases"]}

    def test_both_ends_belong_to_a_range(self):
        self.assertEqual(self.shares("--phase", "0..89=void", "--phase", "90..255=fibre"), {"void": 90 / 256, "fibre": 166 / 256})
        self.assertEqual(self.shares("--phase", "..89=void,90..=fibre"), {"void": 90 / 256, "fibre": 166 / 256})
        self.assertEqual(self.shares("--phase", "7=void", "--phase", "100..109=void", "--other", "fibre")["void"], 11 / 256)

    def test_the_same_in_every_kind_of_file(self):
        wide = struct.pack("<1000H", *[65 * i for i in range(1000)])
        self.write("wide_10x10x10_u16.raw", wide)
        found = self.shares("--phase", "0..32499=void", "--phase", "32500..65535=fibre", name="wide_10x10x10_u16.raw")
        self.assertEqual(found, {"void": 0.5, "fibre": 0.5})
        for name in ("wide.tif", "wide.vti", "wide.mhd"):
            self.works("convert", "wide_10x10x10_u16.raw", "-o", name)
        words = ["--phase", "..32499=void", "--phase", "32500..=fibre"]
        self.assertEqual(self.shares(*words, name="wide.tif"), {"void": 0.5, "fibre": 0.5})
        array = self.info("wide.vti")["point_arrays"][0]["name"]
        self.assertEqual(self.shares(*words, "--array", array, name="wide.vti"), {"void": 0.5, "fibre": 0.5})

    def test_bad_ranges(self):
        run = ["diffusion", "ramp.png", *HALF]
        self.fails(2, "'89..0' runs backwards", "0..89", *run, "--phase", "89..0=void")
        self.fails(2, "overlap: 80..89 would be both", "both ends belong", *run, "--phase", "..89=void", "--phase", "80..=fibre")
        self.fails(3, "the grey values 90..99 are in no phase: 80 nodes", "with phase 90..99=NAME", *run, "--phase", "..89=void",
                   "--phase", "100..=fibre")
        self.fails(2, "the greys 90..300, and those of this picture run from 0 to 255", "as in 90..", *run, "--phase", "..89=void",
                   "--phase", "90..300=fibre")
        self.fails(2, "'x' is not a grey value, in the range '0..x'", "0..89", *run, "--phase", "0..x=void")
        self.fails(2, "the range '..' has no end", "given as other", *run, "--phase", "..=void")
        self.fails(2, "'otsu' is a level between two greys", "..otsu", *run, "--phase", "otsu=void")
        self.fails(2, "of 3 classes, and another range of 2", "otsu1 and otsu2", *run, "--phase", "..otsu=void", "--phase", "otsu2..=fibre")
        self.write("even.png", pictures.png([[9] * 8] * 8))
        self.fails(3, "one single grey", "picture you mean", "diffusion", "even.png", *NAMED, *HALF)

    def test_otsu_parts_the_greys(self):
        self.write("two.png", pictures.png(pictures.stripes(40, 40, 30, 200, bands=4)))
        result = self.works("diffusion", "two.png", *NAMED, *HALF, "--direction", "y", "--no-error-estimate")
        self.assertIn("greys: parted at 115, means 30.0, 200.0, separability 1.000", result.out)
        # All greys alike common: there is a level, and it means nothing.
        result = self.run_lamella("diffusion", "ramp.png", *NAMED, *HALF, "--direction", "y", "--no-error-estimate", "--json")
        self.assertIn("warning: the grey values have no valley where the phases are parted", result.err)
        self.assertEqual(result.json()["phases"][0]["fraction"], 0.5)

    def test_in_a_scene(self):
        self.write("scene.toml", b"""
[sample]
file = "ramp.png"
phase = { "..89" = "void", "90.." = "fibre" }

[diffusion]
conductivity = { void = 0.1, fibre = 1 }
direction = "y"
no-error-estimate = true

[measure]
share = "sample.phases.fibre.fraction"
y = "diffusion.effective.y"
""")
        self.works("run", "scene.toml", "--results", "r", "--quiet")
        with open(self.path("r/table.csv"), encoding="utf-8") as file:
            self.assertIn(str(166 / 256), file.read())


class Volumes(Case):
    def setUp(self):
        super().setUp()
        self.write("t_40x40x40_u8.raw", tomogram())
        self.solve = ["diffusion", "t_40x40x40_u8.raw", "--segment", "--direction", "z", "--no-error-estimate"]

    def test_void_and_solid(self):
        found = self.works(*self.solve, "--conductivity", "void=0,solid=1", "--json").json()
        said = found["segmentation"]
        self.assertEqual(said["polarity"], "void is dark")
        self.assertGreater(said["separability"], said["separability_before"])
        self.assertAlmostEqual(said["levels"][0], 115, delta=2)
        # Bars along the flux: the conductivity is their share; noise at their faces takes some voxels either way.
        self.assertAlmostEqual(found["effective"]["z"], 0.25, delta=0.005)
        table = self.works(*self.solve, "--conductivity", "void=0,solid=1").out
        self.assertIn("void is dark", table)
        self.assertIn("noise: smoothed over", table)

    def test_polarity_threshold_and_names(self):
        bright = self.works(*self.solve, "--lumen", "bright", "--conductivity", "void=0,solid=1", "--json").json()
        self.assertEqual(bright["segmentation"]["polarity"], "void is bright")
        self.assertAlmostEqual(bright["effective"]["z"], 0.75, delta=0.005)
        named = self.works(*self.solve, *NAMED, *HALF, "--json").json()
        self.assertEqual([phase["name"] for phase in named["phases"]], ["void", "fibre"])
        self.assertIsNone(named["segmentation"]["polarity"])
        high = self.works(*self.solve, "--threshold", "140", "--conductivity", "void=0,solid=1", "--json").json()
        self.assertEqual(round(high["segmentation"]["levels"][0]), 140)
        self.assertLess(high["effective"]["z"], named["effective"]["z"])
        numbers = self.works(*self.solve, "--phase", "..114=void,115..=fibre", *HALF, "--json").json()
        self.assertAlmostEqual(numbers["effective"]["z"], 0.25, delta=0.005)

    def test_sixteen_bits_and_other_commands(self):
        self.write("w_40x40x40_u16.raw", tomogram(3000, 12000, 30000, 16))
        wide = self.works("diffusion", "w_40x40x40_u16.raw", "--segment", "--conductivity", "void=0,solid=1", "--direction", "z",
                          "--no-error-estimate", "--json").json()
        self.assertAlmostEqual(wide["effective"]["z"], 0.25, delta=0.005)
        pores = self.works("pore-flood-fill", "t_40x40x40_u8.raw", "--segment", *NAMED, "--json").json()
        self.assertEqual(pores["count"], 1)
        # Of a volume only the window is looked at: within one bar all is one heap of noise, and a warning says so.
        within = self.run_lamella("diffusion", "t_40x40x40_u8.raw", "--segment", "--window", "6,6,0,8,8,40", "--conductivity",
                                  "void=0.1,solid=1", "--no-error-estimate", "--json")
        self.assertEqual(within.json()["size"], [8, 8, 40])
        self.assertIn("warning: ", within.err)

    def test_bad_input(self):
        solid = ["--conductivity", "void=0,solid=1"]
        self.fails(2, "a threshold of 300 for greys from 0 to 255", "leave it out", *self.solve, "--threshold", "300", *solid)
        self.fails(2, "threshold and phases contradict", "..89 is void", *self.solve, "--threshold", "90", *NAMED, *HALF)
        self.fails(2, "lumen and phases contradict", "..89 is void", *self.solve, "--lumen", "dark", *NAMED, *HALF)
        self.fails(2, "threshold counts only with segment", "choose segment", "diffusion", "t_40x40x40_u8.raw",
                   "--threshold", "90", *NAMED, *HALF)
        self.fails(3, "which phases are in 't_40x40x40_u8.raw'?", "--segment to find void and solid", "diffusion",
                   "t_40x40x40_u8.raw", *solid)
        self.write("even_10x10x10_u8.raw", bytes(1000))
        self.fails(3, "one single grey", "picture you mean", "diffusion", "even_10x10x10_u8.raw", "--segment", *solid)


if __name__ == "__main__":
    unittest.main()
