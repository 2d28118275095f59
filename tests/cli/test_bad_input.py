"""Every bad input: one clear line, one remedy, an exit code that is not 0, nothing lost.

Folders that cannot be written and full disks are in test_output.py, more ranks than rows in test_diffusion.py.
"""

import os
import struct
import unittest

import pictures
from program import CONDUCTIVITIES, PHASES, Case

SOLVE = [*PHASES, *CONDUCTIVITIES]
GOOD = pictures.png(pictures.stripes(40, 30, bands=8))


class BadPictures(Case):
    def solve(self, code, message, hint, name, *words):
        self.fails(code, message, hint, "diffusion", name, *(words or SOLVE))

    def test_missing(self):
        self.solve(3, "there is no file", "check the name", "nowhere.png")
        self.fails(3, "there is no file", "check the name", "info", "nowhere.png")
        self.fails(3, "there is no file", "check the name", "flux-map", "nowhere.vti")
        self.fails(3, "there is no file", "check the name", "snapshot", "nowhere.vti", "-o", "x.png")

    def test_empty(self):
        self.solve(3, "is empty", "no data", self.write("p.png", b""))
        self.solve(3, "is empty", "no data", self.write("p.vti", b""))
        os.mkdir(self.path("folder"))
        self.solve(3, "the folder 'folder' holds no PNG, JPEG, TIFF, PGM, PPM or BMP", "numbered slices", "folder")

    def test_truncated(self):
        self.solve(3, "is truncated", "again", self.write("p.png", GOOD[: len(GOOD) // 2]))
        self.works("generate", "softwood", "-o", "t.tif")
        self.works("generate", "softwood", "-o", "t.vti")
        self.works("generate", "softwood", "--size", "30,30,30", "--pixel-size", "2um", "-o", "t.raw")
        for name, message, hint in [
            ("t.tif", "'t.tif' is truncated", "again"),
            ("t.vti", "'t.vti' is a .vti file that is damaged or cut short", "again"),
            ("t.raw", "'t.raw' has 18000 bytes, but 30 × 30 × 30 voxels of u8 take 27000", "raw size"),
        ]:
            with open(self.path(name), "rb") as file:
                data = file.read()
            self.write(name, data[: len(data) * 2 // 3])
            self.fails(3, message, hint, "diffusion", name, *CONDUCTIVITIES)
        self.solve(3, "'j.jpg' is truncated", "again", self.write("j.jpg", b"\xff\xd8\xff\xe0\x00\x10JFIF\0\1\1"))
        self.fails(3, "'t.vti' is a .vti file that is damaged or cut short", "again", "flux-map", "t.vti")
        self.fails(3, "'t.vti' is a .vti file that is damaged or cut short", "again", "snapshot", "t.vti", "-o", "x.png")

    def test_damaged_pixels(self):
        # Chunks that are whole with pixels that are not: the decoder's own words stay off standard error.
        name = self.write("p.png", pictures.png([[0] * 9] * 9, height=10))
        for command in ["diffusion", "equilibrium", "bond-stiffness", "pore-flood-fill", "snapshot", "info"]:
            words = {"diffusion": SOLVE, "equilibrium": ["--young", "wall=1"], "bond-stiffness": ["--young", "wall=1"],
                     "snapshot": ["-o", "x.png"]}.get(command, [])
            self.fails(3, "cannot be decoded: the PNG is damaged or of a rare kind (Not enough image data)",
                       "save it again", command, name, *words)

    def test_not_a_picture(self):
        self.solve(3, "is not a PNG, JPEG, TIFF, PGM, PPM or BMP", "convert it", self.write("p.png", b"Dear diary, " * 20))
        self.solve(3, "'p.vti' is not a .vti file, or is cut short", "again", self.write("p.vti", b"Dear diary, " * 20))
        self.solve(3, "is packed", "gunzip", self.write("v.raw.gz", b"\x1f\x8b"))

    def test_sixteen_bits(self):
        rows = pictures.stripes(40, 30, 0, 40000, bands=4)
        name = self.write("p.png", pictures.png(rows, bits=16))
        self.solve(3, "grey value 40000 is in no phase", "with phase 40000=NAME", name)
        # With its own greys named it is as good as any other.
        answer = self.works("diffusion", name, "--phase", "0=lumen", "--phase", "40000=wall", *CONDUCTIVITIES, "--json").json()
        self.assertAlmostEqual(answer["effective"]["y"], 0.55, places=7)  # layers along the flux: the mean

    def test_palette(self):
        rows = pictures.stripes(40, 30, 0, 1, bands=4)
        colours = self.write("c.png", pictures.png(rows, palette=[(200, 0, 0), (0, 0, 200)]))
        self.solve(3, "is a colour picture", "convert it to grey", colours)
        greys = self.write("g.png", pictures.png(rows, palette=[(0, 0, 0), (255, 255, 255)]))
        answer = self.works("diffusion", greys, *SOLVE, "--json").json()
        self.assertAlmostEqual(answer["effective"]["y"], 0.55, places=7)

    def test_colour(self):
        name = self.write("p.png", pictures.png([[(255, 0, 0)] * 9] * 9, colour=True))
        self.solve(3, "is a colour picture", "or segment it", name)

    def test_cmyk(self):
        self.solve(3, "CMYK", "convert it to grey", self.write("p.tif", pictures.cmyk_tiff(10, 8)))
        try:
            from PIL import Image
        except ImportError:
            return
        Image.new("CMYK", (20, 20)).save(self.path("p.jpg"))
        self.solve(3, "CMYK", "convert it to grey", "p.jpg")

    def test_one_pixel(self):
        self.solve(3, "1 × 1 pixels", "larger picture", self.write("p.png", pictures.png([[255]])))

    def test_one_row(self):
        name = self.write("p.png", pictures.png(pictures.stripes(100000, 1, bands=10)))
        self.solve(3, "100000 × 1 pixels: one node along y", "another direction", name)
        # What the hint says works, and is right: equal layers across the flux have the harmonic mean.
        answer = self.works("diffusion", name, *SOLVE, "--direction", "x", "--no-error-estimate", "--json").json()
        self.assertAlmostEqual(answer["effective"]["x"], 2 / (1 / 0.1 + 1 / 1.0), places=6)

    def test_raw_of_unknown_or_wrong_size(self):
        name = self.write("v.raw", bytes(1000))
        self.solve(3, "size of the raw volume", "the raw size, NX,NY,NZ", name)
        self.fails(3, "has 1000 bytes, but 10 × 10 × 11 voxels", "raw size", "diffusion", name, "--raw-size", "10,10,11", *SOLVE)
        self.fails(2, "raw size '10,10' is not 3 numbers", "NX,NY,NZ", "diffusion", name, "--raw-size", "10,10", *SOLVE)
        self.fails(2, "raw bits 12 is none of its choices", "0, 8, 16", "diffusion", name, "--raw-bits", "12", *SOLVE)

    def test_not_what_a_command_reads(self):
        self.write("p.png", GOOD)
        self.fails(3, "is not a .vti", "lamella diffusion", "flux-map", "p.png")
        self.works("generate", "disks", "-o", "d.vti")
        self.fails(3, "'d.vti' holds a sample and no solution", "solve first: lamella diffusion d.vti", "flux-map", "d.vti")


class BadPhases(Case):
    def setUp(self):
        super().setUp()
        self.write("p.png", GOOD)

    def test_a_grey_in_no_phase(self):
        self.fails(3, "grey value 255 is in no phase: 600 nodes", "with phase 255=NAME", "diffusion", "p.png", "--phase",
                   "0=lumen", *CONDUCTIVITIES)
        # --other takes it; so does a window without it.
        self.works("diffusion", "p.png", "--phase", "0=lumen", "--other", "wall", *CONDUCTIVITIES)
        self.works("diffusion", "p.png", "--phase", "0=lumen", "--window", "0,0,5,5", "--conductivity", "lumen=1")

    def test_no_names_at_all(self):
        self.fails(3, "Its grey values are 0 (50.0 %), 255 (50.0 %)", "--phase 0=NAME --phase 255=NAME",
                   "diffusion", "p.png", *CONDUCTIVITIES)
        self.write("scan.png", pictures.png([[(7 * x + 3 * y) % 256 for x in range(60)] for y in range(50)]))
        self.fails(3, "which phases are in 'scan.png'?", "--segment", "diffusion", "scan.png", *CONDUCTIVITIES)
        self.fails(3, "which phases are in 'p.png'?", "--phase 0=NAME", "snapshot", "p.png", "-o", "x.png")

    def test_conductivities_that_are_none(self):
        for value in ["-1", "nan", "inf", "-inf", "1e999"]:
            self.fails(2, "--conductivity wall=" + value, "0 for a phase that does not conduct", "diffusion", "p.png",
                       *PHASES, "--conductivity", "lumen=1", "--conductivity", "wall=" + value)
        self.fails(2, "'much' is not a number", "NAME=VALUE", "diffusion", "p.png", *PHASES, "--conductivity", "wall=much")
        self.fails(2, "is not NAME=VALUE", "NAME=VALUE", "diffusion", "p.png", *PHASES, "--conductivity", "wall")
        self.fails(2, "'wall' two values", "one value", "diffusion", "p.png", *PHASES, *CONDUCTIVITIES,
                   "--conductivity", "wall=2")
        self.fails(2, "phase 'wall' has no conductivity", "give one to each phase", "diffusion", "p.png",
                   *PHASES, "--conductivity", "lumen=1")

    def test_zero_conductivity_is_a_phase_that_does_not_conduct(self):
        zero = ["--conductivity", "lumen=0", "--conductivity", "wall=1"]
        answer = self.works("diffusion", "p.png", *PHASES, *zero, "--direction", "y", "--json").json()
        self.assertAlmostEqual(answer["effective"]["y"], 0.5, places=7)
        self.assertEqual(answer["skipped"], 600)
        self.assertEqual(answer["stored"], 600)
        self.fails(4, "no node of the picture conducts", "above 0", "diffusion", "p.png", *PHASES, "--conductivity",
                   "lumen=0", "--conductivity", "wall=0")

    def test_no_percolation(self):
        zero = ["--conductivity", "lumen=0", "--conductivity", "wall=1"]
        self.fails(4, "no conducting path crosses the sample along x", "direction y has one", "diffusion", "p.png",
                   *PHASES, *zero)
        board = [[255 if (x // 5 + y // 5) % 2 else 0 for x in range(40)] for y in range(40)]
        self.write("board.png", pictures.png(board))
        self.fails(4, "along x or y", "a conductivity above 0", "diffusion", "board.png", *PHASES, *zero)

    def test_a_window_outside(self):
        for window, word in [("0,0,50,10", "outside along x"), ("0,25,10,10", "outside along y"),
                             ("-1,0,5,5", "outside along x"), ("0,0,0,5", "empty along x"),
                             ("1,1,2000000000,5", "outside along x")]:
            self.fails(2, word, "inside the picture", "diffusion", "p.png", *SOLVE, "--window=" + window)
        self.fails(2, "too large for a whole number", "", "diffusion", "p.png", *SOLVE, "--window", "1,1,4000000000000000000,5")
        self.fails(2, "window '1,2,3' is not 4 or 6 numbers", "X,Y[,Z],WIDTH", "diffusion", "p.png", *SOLVE, "--window", "1,2,3")
        self.fails(2, "the window has a depth", "X,Y,WIDTH,HEIGHT", "diffusion", "p.png", *SOLVE, "--window", "0,0,0,5,5,5")
        self.works("generate", "spheres", "--size", "8,8,8", "-o", "s.vti")
        self.fails(2, "the window has no depth", "WIDTH,HEIGHT,DEPTH", "diffusion", "s.vti", "--window", "0,0,5,5",
                   "--conductivity", "matrix=1", "--conductivity", "inclusion=2")

    def test_a_refinement_beyond_memory(self):
        result = self.fails(5, "4000000 × 3000000 nodes at refinement 100000 need about", "fits", "diffusion", "p.png",
                            *SOLVE, "--refine", "100000")
        self.assertRegex(result.err, r"need about [0-9.]+ [TPE]B of memory, and [0-9.]+ [MG]B are free")
        self.assertRegex(result.err, r"hint: refinement \d+ fits")
        self.fails(5, "nodes at refinement 2000000000", "fits", "diffusion", "p.png", *SOLVE, "--refine", "2000000000")
        self.fails(5, "to make, and", "smaller", "generate", "softwood", "--size", "1000000,1000000", "-o", "x.png")

    def test_a_volume_beyond_memory_is_refused_unread(self):
        # 4 TB that take no space. Read first, it would take the hundred seconds that a command is given here.
        name = self.write("rock_20000x20000x10000_u8.raw", b"")
        try:
            os.truncate(self.path(name), 4 * 10**12)
        except OSError as error:
            self.skipTest(f"no sparse files here: {error}")
        words = [name, "--phase", "0=void", "--other", "solid"]
        for command, *more in (
            ["diffusion", "--conductivity", "void=1", "--conductivity", "solid=2"],
            ["diffusion", "--conductivity", "void=0", "--conductivity", "solid=1"],
            ["pore-flood-fill"],
            ["equilibrium", "--young", "solid=1"],
            ["bond-stiffness", "--young", "solid=1"],
        ):
            self.fails(5, "20000 × 20000 × 10000", "window", command, *words, *more)
            if command in ("pore-flood-fill", "bond-stiffness"):  # the launcher has its say as well
                several = self.run_lamella(command, *words, *more, ranks=2)
                self.assertEqual(several.code, 5, several.err)
                self.assertIn("20000 × 20000 × 10000", several.err)
        self.fails(5, "takes 12.0 TB", "--window", "snapshot", *words, "-o", "x.png")
        window = ["--window", "19990,19990,9990,8,9,10", "--conductivity", "void=1", "--json"]
        answer = self.works("diffusion", *words, *window).json()
        self.assertEqual(answer["size"], [8, 9, 10])
        self.assertAlmostEqual(answer["effective"]["x"], 1, places=9)
        self.assertEqual(len(answer["provenance"]["inputs"][0]["sha256_of_ends"]), 64)


class Sizes(Case):
    def test_a_printers_resolution_is_doubted(self):
        name = self.write("p.png", pictures.png(pictures.stripes(40, 30), pixels_per_metre=2835))
        for words in (["info", name], ["diffusion", name, *SOLVE]):
            result = self.run_lamella(*words)
            self.assertEqual(result.code, 0, result.err)
            self.assertRegex(result.err, "^warning: PNG pHYs of 'p.png' says 72.* dots an inch")
        self.assertEqual(len(self.works("info", name, "--json").json()["warnings"]), 1)

    def test_a_pixel_of_half_a_metre_is_doubted(self):
        self.write("p.png", GOOD)
        result = self.run_lamella("diffusion", "p.png", *SOLVE, "--pixel-size", "0.5", "--quiet")
        self.assertEqual(result.code, 0)
        self.assertEqual(result.err, "warning: --pixel-size 0.5 is 0.5 metres; for micrometres write 0.5um\n")
        self.works("diffusion", "p.png", *SOLVE, "--pixel-size", "500mm", "--quiet")  # says what it means

    def test_a_pixel_that_no_arithmetic_holds(self):
        self.write("p.png", GOOD)
        young = ["--young", "wall=1e9", "--young", "lumen=1e9"]
        for words in [
            ["diffusion", "p.png", *SOLVE],
            ["transient", "p.png", *PHASES, "--diffusivity", "wall=1", "--diffusivity", "lumen=1", "--end-time", "1"],
            ["bond-stiffness", "p.png", *PHASES, *young],
            ["equilibrium", "p.png", *PHASES, *young],
            ["fracture", "p.png", *PHASES, *young, "--critical-stretch", "wall=0.1"],
            ["dynamics", "p.png", *PHASES, *young, "--density", "1", "--critical-stretch", "wall=0.1"],
            ["compression", "p.png", *PHASES],
            ["micrograph", "p.png"],
            ["pore-flood-fill", "p.png", "--phase", "0=void", "--other", "wall"],
            ["snapshot", "p.png", "-o", "s.png"],
            ["convert", "p.png", "-o", "p.vti"],
            ["info", "p.png"],
            ["generate", "honeycomb", "-o", "h.png"],
        ]:
            for size in ["1e-300", "1e308", "1e-31", "1e31"]:
                self.fails(2, "pixel size %g is not between 1e-30 and 1e30" % float(size), "", *words, "--pixel-size", size)
        self.works("diffusion", "p.png", *SOLVE, "--pixel-size", "1e-30")

    def test_generators_refuse_what_cannot_be(self):
        for words, message in [
            (["softwood", "--size", "5"], "is not 2 or 3 numbers"),
            (["softwood", "--solid-fraction", "1.5"], "solid fraction 1.5 is not below 1"),
            (["softwood", "--ring", "2,3"], "ring position (left) 2 is above 1"),
            (["softwood", "--tangential-diameter", "1um"], "less than"),
            (["laminate", "--axis", "z"], "layers perpendicular to axis 2"),
            (["laminate", "--periods", "0"], "cells 0 is below 1"),
            (["honeycomb", "--cells", "100"], "100 cells"),
            (["disks", "--size", "9,9,9"], "that of a volume"),
            (["softwood", "--size", "40,40,40"], "a PNG holds one picture"),
            (["softwood", "--size", "40,40,40", "--look", "blue"], "a PNG holds one picture"),
            (["hardwood", "--size", "40,40,40"], "that of a volume"),
            (["hardwood", "--vessel-share", "0.3,0.2,0.1"], "is not 1 or 2 numbers"),
            (["hardwood", "--vessel-share", "0.9"], "vessel share (start) 0.9 is above 0.5"),
            (["hardwood", "--vessel-diameter", "20um"], "among fibres"),
            (["hardwood", "--ray-every", "50um"], "a ray every"),
            (["hardwood", "--pixel-size", "5um"], "less than 6 nodes"),
            (["hardwood", "--ring-position", "0,2"], "ring position (right) 2 is above 1"),
            (["hardwood", "--look", "red"], "look 'red' is none of its choices"),
            (["hardwood", "--look", "blue", "--noise", "3"], "noise 3 is above 0.5"),
            (["hardwood", "--look", "blue", "--scale-bar", "1mm"], "a scale bar of 0.001 m"),
            (["hardwood", "--look", "blue", "--truth", "x.png"], "the same file"),
            (["hardwood", "--look", "blue", "--truth", "y.jpg"], "--truth 'y.jpg'"),
            (["hardwood", "--dirt", "3"], "dirt counts only with look"),
        ]:
            self.fails(2, message, "", "generate", *words, "-o", "x.png")
        self.fails(2, "ending", "JPEG would blur", "generate", "softwood", "-o", "x.jpg")
        self.fails(2, "cannot hold a micrograph", ".png", "generate", "softwood", "--look", "blue", "-o", "x.tif")

    def test_tiff_of_other_byte_order(self):
        # A TIFF that is not ours must not be taken for a record of ours.
        name = self.write("p.tif", struct.pack(">2sHI", b"MM", 42, 8) + bytes(64))
        self.fails(3, "the pixels of 'p.tif' cannot be decoded: the TIFF is damaged", "again", "diffusion", name, *SOLVE)


if __name__ == "__main__":
    unittest.main()
