"""lamella micrograph: from scans, labels and polygons to outlines, lattices and conductivities; and every mistake."""

import gzip
import json
import math
import os
import struct
import unittest

import pictures
from program import Case

TISSUE = ["generate", "softwood", "--size", "360,270", "--pixel-size", "0.5um", "--seed", "1"]
LOOK = ["--look", "magenta", "--truth", "labels.png"]
CONDUCT = ["--conductivity", "lumen=0.05", "--conductivity", "wall=1"]


def circle(x, y, r, n=60):
    return [[x + r * math.cos(2 * math.pi * i / n), y + r * math.sin(2 * math.pi * i / n)] for i in range(n)]


def honeycomb():
    """Nine round lumens, 10 wide, whose centres are 12 apart: walls 2 thick at their thinnest. In micrometres."""
    return [circle(6 + 12 * i, 6 + 12 * j, 5) for i in range(3) for j in range(3)]


def size_of(path):
    with open(path, "rb") as file:
        return struct.unpack(">II", file.read(24)[16:24])


def drawn(width, height, grey):
    """A grey picture of a function of the place, with a lens of 3 x 3 pixels and a little noise."""
    sharp = [[grey(x, y) for x in range(width)] for y in range(height)]
    rows = []
    for y in range(height):
        row = []
        for x in range(width):
            around = [
                sharp[min(max(y + j, 0), height - 1)][min(max(x + i, 0), width - 1)] for j in (-1, 0, 1) for i in (-1, 0, 1)
            ]
            row.append(round(sum(around) / 9) + (x * 7 + y * 13) % 5)
        rows.append(row)
    return pictures.png(rows)


def cell(x, y, pitch, wall):
    """Number of the square cell, and whether the place is in its lumen."""
    inside = wall <= x % pitch < pitch and wall <= y % pitch < pitch
    return x // pitch * 31 + y // pitch * 17, inside


class Doubts(Case):
    """What a threshold gets wrong is told on standard error and in JSON."""

    def doubts(self, picture, *options):
        self.write("scan.png", picture)
        result = self.run_lamella("micrograph", "scan.png", "--pixel-size", "1um", "--lamella", "none", "--json", *options)
        self.assertEqual(result.code, 0, result.err)
        answer = result.json()
        for warning in answer["warnings"]:
            self.assertIn("warning: " + warning, result.err)
        return answer

    def test_whole_tissue_raises_none(self):
        answer = self.doubts(drawn(200, 160, lambda x, y: 220 if cell(x, y, 20, 4)[1] else 90))
        self.assertEqual(answer["segmentation"]["doubts"], [])
        self.assertEqual(answer["cells"], True)

    def test_cells_filled_with_stain(self):
        def grey(x, y):
            number, inside = cell(x, y, 20, 3)
            return 220 if inside and number * 2654435761 % 2**32 < 2**31 else 90  # as chance has it

        answer = self.doubts(drawn(200, 160, grey))
        self.assertIn("filled", answer["segmentation"]["doubts"])

    def test_three_phases(self):
        def grey(x, y):
            if math.hypot(x % 80 - 40, y % 80 - 40) < 24:
                return 30
            return 210 if math.hypot(x % 20 - 10, y % 20 - 10) < 6 else 120

        answer = self.doubts(drawn(240, 160, grey))
        self.assertIn("greys", answer["segmentation"]["doubts"])
        told = next(text for text in answer["warnings"] if "3 classes of greys" in text)
        self.assertIn("split with threshold", told)
        self.assertIn("a phase: phase 0..", told)

    def test_lumens_of_three_pixels(self):
        def grey(x, y):
            if y % 80 < 30:  # a row of vessels above fibres
                return 220 if math.hypot(x % 40 - 20, y % 80 - 15) < 12 else 90
            return 220 if x % 6 < 3 and y % 6 < 3 else 90

        answer = self.doubts(drawn(240, 160, grey))
        self.assertIn("resolution", answer["segmentation"]["doubts"])

    def test_slide_beside_the_tissue(self):
        def grey(x, y):
            return 220 if x < 80 or cell(x, y, 20, 4)[1] else 90

        picture = drawn(240, 160, grey)
        answer = self.doubts(picture)
        self.assertIn("gaps", answer["segmentation"]["doubts"])
        self.assertIsNone(answer["vessels"])
        # What is cut away is not warned of.
        self.assertEqual(self.doubts(picture, "--window", "90,0,150,160")["segmentation"]["doubts"], [])

    def test_grains_that_touch(self):
        def grey(x, y):
            # Bars of unlike length, shifted from row to row, that meet every other one.
            row = y // 26
            along = (x + 37 * row) % 61
            pore = y % 26 < 3 and (x // 9 + row) % 3 or along < 4 and (y // 9) % 3 and row % 2
            return 70 if pore else 225

        answer = self.doubts(drawn(240, 160, grey))
        self.assertIn("side", answer["segmentation"]["doubts"])
        self.assertTrue(any("bright or lumen dark" in text for text in answer["warnings"]))
        self.assertEqual(answer["cells"], False)
        self.assertNotIn("side", self.doubts(drawn(240, 160, grey), "--lumen", "dark")["segmentation"]["doubts"])


class Micrograph(Case):
    def polygons(self, name="cells.json", lumens=None, **more):
        text = json.dumps({"units": "um", "lumens": honeycomb() if lumens is None else lumens, **more})
        if name.endswith(".gz"):
            return self.write(name, gzip.compress(text.encode()))
        return self.write(name, text.encode())

    def test_a_scan(self):
        self.works(*TISSUE, *LOOK, "-o", "scan.png")
        truth = self.works("micrograph", "labels.png", "--json").json()
        answer = self.works(
            "micrograph", "scan.png", "--json", "-o", "t.vti", "--contours", "c.vtp", "--overlay", "o.png", *CONDUCT
        ).json()
        self.assertEqual((answer["kind"], truth["kind"]), ("scan", "labels"))
        self.assertEqual(answer["pixels"], [360, 270])
        self.assertEqual(answer["files"], ["t.vti", "c.vtp", "o.png"])
        # Blur, noise and uneven light at a pixel of 0.5 um, walls of 14 pixels: the share of the walls is met to two hundredths.
        self.assertAlmostEqual(answer["wall_fraction"], truth["wall_fraction"], delta=0.02)
        self.assertAlmostEqual(answer["lumens"]["count"], truth["lumens"]["count"], delta=2)
        self.assertEqual(answer["segmentation"]["lumen"], "bright")
        self.assertGreater(answer["segmentation"]["separability"], 0.7)
        self.assertAlmostEqual(answer["lattice"]["wall_fraction"], answer["wall_fraction"], delta=1e-3)
        self.assertEqual(answer["lattice"]["size"], [360, 270])
        lamella = answer["lamella"]
        self.assertEqual(lamella["method"], "growth")
        self.assertGreater(lamella["nodes_across"]["mean"], 0)
        for axis in "xy":
            solved = answer["diffusion"]["axes"][axis]
            self.assertTrue(0.05 < solved["value"] < 1)
            self.assertAlmostEqual(solved["error"], solved["relative_error"] * solved["value"])
            # twice it, but for what it takes to fit the same box
            self.assertAlmostEqual(solved["coarse"]["spacing"], 2 * solved["fine"]["spacing"], delta=1e-12)
            self.assertAlmostEqual(solved["value"], 2 * solved["fine"]["value"] - solved["coarse"]["value"])
        info = self.info("t.vti")
        self.assertEqual([a["name"] for a in info["point_arrays"]], ["phase", "grain", "axis", "lumen_share"])
        self.assertIn("micrograph scan.png", json.dumps(info["provenance"]))
        self.assertEqual(size_of(self.path("o.png"))[0] >= 1000, True)
        # What was written goes on: phases into diffusion, outlines back into the same numbers.
        self.works("diffusion", "t.vti", "--conductivity", "void=0.05", "--conductivity", "secondary wall=1",
                   "--conductivity", "middle lamella=1", "--no-error-estimate")
        again = self.works("micrograph", "c.vtp", "--spacing", "0.5um", "--json").json()
        self.assertEqual(again["kind"], "polygons")
        self.assertAlmostEqual(again["wall_fraction"], answer["wall_fraction"], places=9)
        self.assertEqual(again["lumens"]["count"], answer["lumens"]["count"])

    def test_options_of_scans(self):
        self.works(*TISSUE, *LOOK, "-o", "scan.png")
        shown = self.works(
            "micrograph", "scan.png", "--channel", "green", "--threshold", "140", "--smoothing", "1", "--rim", "0",
            "--opening", "0", "--smallest-lumen", "30", "--smallest-wall", "20", "--background", "100", "--ray-slenderness",
            "0", "--lumen", "bright", "--keep-graphics", "--wavelength", "10", "--tolerance", "0", "--least-diameter", "5um",
            "--json").json()["segmentation"]  # fmt: skip
        self.assertEqual((shown["channel"], shown["threshold"], shown["smoothing"]), ("green", 140, 1))
        self.assertEqual((shown["rim"], shown["opening"], shown["smallest_lumen"]), (0, 0, 30))

    def test_greys_and_windows_of_outlines(self):
        cells = self.polygons("cells.json", [circle(6 + 12 * i, 6 + 12 * j, 5, 400) for i in range(3) for j in range(3)])
        whole = self.works("micrograph", cells, "--spacing", "0.25um", "-o", "t.vti", "--contours", "c.vtp",
                           "--json").json()
        # Lumens of 20 pixels are off by a pixel at most; those that touch the border, as eight of them do, by some.
        for words in (["--shares"], ["--level", "0.5"]):
            again = self.works("micrograph", "t.vti", *words, "--json").json()
            self.assertEqual((again["kind"], again["lumens"]["count"]), ("grey", 9))
            self.assertAlmostEqual(again["wall_fraction"] / whole["wall_fraction"], 1, delta=5e-3)
            part = self.works("micrograph", "t.vti", *words, "--window", "0,0,96,96", "--json").json()
            self.assertEqual(part["pixels"], [96, 96])
        corner = whole["picture"]["width"] / 2
        parts = [
            self.works("micrograph", "c.vtp", "--window", "%r,%r,%r,%r" % (x, y, corner, whole["picture"]["height"] / 2),
                       "--spacing", "0.25um", "--json").json()["wall_fraction"]
            for x in (0, corner) for y in (0, whole["picture"]["height"] / 2)]
        self.assertAlmostEqual(sum(parts) / 4, whole["wall_fraction"], places=9)
        self.fails(2, "does not lie in the picture", "part", "micrograph", "c.vtp", "--window", "0,0,1,1")
        self.fails(2, "contradict", "one half", "micrograph", "t.vti", "--shares", "--level", "0.5")
        self.fails(2, "level nan", "", "micrograph", "t.vti", "--level", "nan")
        self.fails(2, "--no-smooth is for", "leave it out", "micrograph", "t.vti", "--shares", "--no-smooth")
        self.fails(2, "--level is for", "leave it out", "micrograph", "c.vtp", "--level", "0.5")
        self.fails(3, "no point array 'nothing'", "", "micrograph", "t.vti", "--shares", "--array", "nothing")

    def test_a_window(self):
        self.works(*TISSUE, *LOOK, "-o", "scan.png")
        for name in ("scan.png", "labels.png"):
            answer = self.works("micrograph", name, "--window", "20,30,100,80", "--json").json()
            self.assertEqual(answer["pixels"], [100, 80])
            self.assertAlmostEqual(answer["picture"]["width"], 50e-6)

    def test_labels(self):
        self.works(*TISSUE, "-o", "labels.png")
        for output in ("a.png", "a.tif", "a.raw", "a.vti"):
            self.works("micrograph", "labels.png", "--spacing", "0.5um", "-o", output)
            info = self.works("micrograph", output, "--json").json() if output != "a.raw" else None
            if info:
                self.assertEqual(info["pixels"], [360, 270])
        rows = pictures.stripes(64, 64, first=0, second=255, bands=8)
        self.write("bare.png", pictures.png(rows))
        answer = self.works("micrograph", "bare.png", "--phase", "0=hole", "--other", "wood", "--lumen-phase", "hole",
                            "--pixel-size", "1um", "--lamella", "none", "--json").json()  # fmt: skip
        self.assertAlmostEqual(answer["wall_fraction"], 0.5)
        self.assertAlmostEqual(answer["wall_thickness"]["median"], 8e-6, delta=1e-8)

    def test_polygons(self):
        for name in ("cells.json", "cells.json.gz"):
            self.polygons(name)
            answer = self.works("micrograph", name, "--contours", "out_" + name, "--json").json()
            self.assertEqual(answer["lumens"]["count"], 9)
            # The default spacing is a quarter of the walls, which are 2 um thick at their thinnest.
            self.assertAlmostEqual(
                answer["lattice"]["spacing"], answer["wall_thickness"]["median"] / 4,
                delta=0.02 * answer["lattice"]["spacing"])
            back = self.works("micrograph", "out_" + name, "--json").json()
            self.assertEqual(back["wall_fraction"], answer["wall_fraction"])
        half = self.works("micrograph", "cells.json", "--window", "0,0,18,18", "--spacing", "0.2um", "--json").json()
        self.assertEqual(half["lumens"]["open"], 3)
        self.assertEqual(half["lattice"]["size"], [90, 90])
        self.write("plain.json", json.dumps(honeycomb()).encode())
        plain = self.works("micrograph", "plain.json", "--unit", "1um", "--y-down", "--json").json()
        self.assertAlmostEqual(plain["wall_fraction"], answer["wall_fraction"])

    def test_diffusion_of_disks(self):
        # Disks of 0.545 of the area in a square array, walls a lumen's 20 times: Keller's theorem and Rayleigh's series
        # give 0.2946 for conductivity 0.05 in 1 (by the series of Perrins et al. 1979); a quarter of a per cent is what
        # the error bar of 60 nodes a cell allows.
        self.polygons(lumens=[circle(6 + 12 * i, 6 + 12 * j, 5, 720) for i in range(2) for j in range(2)], outer=None)
        answer = self.works(
            "micrograph", "cells.json", "--window", "0,0,24,24", "--spacing", "0.2um", *CONDUCT, "--json").json()
        axes = answer["diffusion"]["axes"]
        self.assertAlmostEqual(axes["x"]["value"], axes["y"]["value"], delta=1e-6)
        contrast = (0.05 - 1) / (0.05 + 1)
        f = math.pi * 25 / 144
        b = contrast
        # Rayleigh to the fourth power: 1 + 2 f / (1/b - f - 0.305827 b f^4 / (1 - 1.402958 b^2 f^8) - 0.013362 b f^8)
        exact = 1 + 2 * f / (1 / b - f - 0.305827 * b * f**4 / (1 - 1.402958 * b**2 * f**8) - 0.013362 * b * f**8)
        self.assertAlmostEqual(axes["x"]["value"], exact, delta=2.5e-3 * exact)
        self.assertLess(axes["x"]["relative_error"], 0.02)
        one = self.works("micrograph", "cells.json", "--window", "0,0,24,24", "--spacing", "0.2um", "--conductivity",
                         "wall=1,lumen=0.05", "--direction", "y", "--json").json()["diffusion"]  # fmt: skip
        self.assertEqual(list(one["axes"]), ["y"])
        self.assertAlmostEqual(one["axes"]["y"]["value"], axes["y"]["value"])

    def test_conductivity_is_of_the_whole_picture(self):
        # Layers across y in a picture of 10.37 um, which no spacing fits: were a row cut off, the value would show it.
        size = "0,0,8,10.37"
        layers = [[[-1, low], [9, low], [9, high], [-1, high]] for low, high in ((1, 2.5), (4, 5), (9.5, 10))]
        self.polygons(lumens=layers)
        for spacing in ("0.25um", "0.3um", "0.41um"):
            run = ["micrograph", "cells.json", "--window", size, "--spacing", spacing, "--lamella", "none", *CONDUCT]
            answer = self.works(*run, "--json").json()
            axes = answer["diffusion"]["axes"]
            share = 3 / 10.37
            self.assertAlmostEqual(axes["x"]["value"], 1 - 0.95 * share, places=6)
            self.assertAlmostEqual(axes["y"]["value"], 1 / (1 - share + share / 0.05), places=6)
            lattice = answer["lattice"]
            rest = 10.37e-6 - lattice["size"][1] * lattice["spacing"]
            self.assertAlmostEqual(lattice["cropped"], rest, delta=1e-12)
            self.assertTrue(0 < rest < lattice["spacing"])
            self.assertIn("at the top cut off", self.works(*run).out)
            self.assertEqual(axes["x"]["picture_error"], 0)
            self.assertEqual(axes["x"]["relative_error"], axes["x"]["lattice_error"])

    def test_errors_of_lattice_and_picture(self):
        self.works("generate", "softwood", "--size", "121,97", "--pixel-size", "1um", "-o", "t.png")
        run = ["micrograph", "t.png", "--phase", "0=lumen", "--other", "wall", "--lamella", "none", *CONDUCT]
        text = self.works(*run).out
        self.assertIn("% lattice", text)
        self.assertIn("% picture", text)
        answer = self.works(*run, "--json").json()
        self.assertEqual(answer["lattice"]["cropped"], 0)
        # The same tissue drawn four times as fine.
        self.works("generate", "softwood", "--size", "484,388", "--pixel-size", "0.25um", "-o", "fine.png")
        fine = self.works("micrograph", "fine.png", *run[2:], "--json").json()["diffusion"]["axes"]
        for axis in "xy":
            found = answer["diffusion"]["axes"][axis]
            self.assertAlmostEqual(found["relative_error"], math.hypot(found["lattice_error"], found["picture_error"]))
            self.assertGreater(found["picture_error"], 3 * fine[axis]["picture_error"])  # order 3/2: eight
            self.assertLess(abs(found["value"] - fine[axis]["value"]), found["error"] + fine[axis]["error"])
            self.assertEqual([len(c["values"]) for c in found["coarser_pictures"]], [4, 5])

    def test_a_target_for_the_error_halves_the_spacing(self):
        self.polygons()
        run = ["micrograph", "cells.json", "--window", "0,0,36,36", "--spacing", "0.6um", "--direction", "x",
               "--lamella-thickness", "0.6um", "--json", *CONDUCT, "--conductivity", "lamella=0.3"]  # fmt: skip
        pair = self.works(*run).json()["diffusion"]["axes"]["x"]
        self.assertEqual(len(pair["steps"]), 2)
        target = pair["relative_error"] / 1.5
        answer = self.run_lamella(*run, "--target-error", f"{target:.6f}")
        self.assertEqual(answer.code, 0, answer.err)
        self.assertRegex(answer.err, r"^note: the error bar is .* takes about .* nodes and .* of memory\n$")
        fine = answer.json()["diffusion"]["axes"]["x"]
        self.assertLessEqual(fine["relative_error"], target)
        self.assertGreater(len(fine["steps"]), 2)
        self.assertEqual([step["value"] for step in fine["steps"][:2]], [step["value"] for step in pair["steps"]])
        self.assertEqual(fine["steps"][-1]["value"], fine["fine"]["value"])
        # The lattice that is written is that of --spacing all the same.
        self.assertEqual(answer.json()["lattice"]["size"], [60, 60])

    def test_a_target_that_only_a_finer_picture_reaches(self):
        self.works("generate", "softwood", "--size", "120,90", "-o", "t.png")
        answer = self.run_lamella("micrograph", "t.png", "--phase", "0=lumen", "--other", "wall", "--pixel-size", "1um",
                                  "--lamella", "none", "--json", *CONDUCT, "--target-error", "0.01%")  # fmt: skip
        self.assertEqual(answer.code, 8, answer.err)
        self.assertIn("an error of 0.01 % was asked for", answer.err)
        self.assertIn("only smaller pixels or outlines as vectors", answer.err)
        for found in answer.json()["diffusion"]["axes"].values():
            self.assertGreater(found["picture_error"], 1e-4)
            self.assertLessEqual(found["lattice_error"], found["picture_error"] / 2)

    def test_lamella(self):
        self.polygons()
        run = ["micrograph", "cells.json", "--spacing", "0.1um"]
        values = {}
        for how in ("growth", "constant", "none"):
            answer = self.works(*run, "--lamella", how, *CONDUCT, "--direction", "x", "-o", how + ".vti", "--json").json()
            values[how] = answer["diffusion"]["axes"]["x"]["value"]
            names = [phase["name"] for phase in answer["lattice"]["phases"]]
            self.assertEqual(names, ["lumen", "wall"] if how == "none" else ["lumen", "wall", "middle lamella"])
        self.assertEqual(len(set(values.values())), 1)
        # A lamella that conducts worse than the wall lowers the value, one that conducts better raises it.
        soft = self.works(*run, *CONDUCT, "--conductivity", "lamella=0.2", "--direction", "x", "--json").json()
        hard = self.works(*run, *CONDUCT, "--conductivity", "lamella=5", "--direction", "x", "--json").json()
        self.assertLess(soft["diffusion"]["axes"]["x"]["value"], values["none"])
        self.assertGreater(hard["diffusion"]["axes"]["x"]["value"], values["none"])
        thick = self.works(*run, "--lamella", "constant", "--lamella-thickness", "0.6um", "--json").json()["lamella"]
        self.assertAlmostEqual(thick["nodes_across"]["mean"], 6, delta=0.7)
        warned = self.run_lamella(*run, "--horizon", "20", "--json")
        self.assertEqual(warned.code, 0)
        self.assertIn("warning: the middle lamella is", warned.err)

    def test_lamella_of_labels(self):
        # Lumens 16 wide, walls of 4, lamella of 2 in their middle.
        def grey(x):
            at = x % 24
            return 0 if at < 16 else 128 if 19 <= at < 21 else 255

        self.write("three.png", pictures.png([[grey(x) for x in range(96)] for _ in range(60)]))
        words = ["micrograph", "three.png", "--pixel-size", "0.5um", "--phase", "0=lumen", "--phase", "128=lamella",
                 "--phase", "255=wall"]  # fmt: skip
        answer = self.works(*words, "--lamella", "labels", "--json").json()
        self.assertAlmostEqual(answer["lamella"]["nodes_across"]["mean"], 2, delta=0.1)
        self.assertAlmostEqual(answer["lamella"]["wall_share"], 0.25, delta=0.01)
        self.fails(3, "which phase is the middle lamella", "the lamella's phase", "micrograph", "three.png", "--pixel-size",
                   "1um", "--phase", "0=lumen", "--other", "wall", "--lamella", "labels")  # fmt: skip

    def test_vessels(self):
        self.works("generate", "hardwood", "--size", "600,480", "--pixel-size", "0.75um", "-o", "h.png")
        answer = self.run_lamella("micrograph", "h.png", "--overlay", "o.png", "--json").json()  # may warn of a cell
        self.assertGreater(answer["vessels"]["count"], 5)
        self.assertGreater(answer["fibres"]["count"], 100)
        self.assertGreater(answer["vessels"]["median_diameter"], 2 * answer["fibres"]["median_diameter"])
        self.assertEqual(answer["vessels"]["count"] + answer["fibres"]["count"], answer["lumens"]["count"])

    def test_what_is_printed(self):
        self.polygons()
        text = self.works("micrograph", "cells.json", *CONDUCT, "--contours", "c.json").out
        for word in ("lumens", "walls", "lattice", "lamella", "conductivity", "±", "wrote c.json"):
            self.assertIn(word, text)
        self.assertEqual(self.works("micrograph", "cells.json", "--quiet").out, "")
        self.works("micrograph", "cells.json", "--overlay", "o.png", "--overlay-width", "300")
        self.assertEqual(size_of(self.path("o.png"))[0], 300)

    def test_spacing(self):
        self.polygons()
        coarse = self.run_lamella("micrograph", "cells.json", "--spacing", "3um", "--json")
        self.assertEqual(coarse.code, 0, coarse.err)
        self.assertIn("warning: walls are", coarse.err)
        self.assertLess(coarse.json()["lattice"]["nodes_across_wall"]["low"], 1)
        fails = lambda code, message, hint, spacing: self.fails(  # noqa: E731
            code, message, hint, "micrograph", "cells.json", "--spacing", spacing)
        fails(5, "are free", "larger", "1e-10")
        fails(5, "nodes", "larger", "1e-20")
        fails(2, "a spacing of", "or less", "1")
        fails(2, "spacing -1e-06 is below 0", "", "-1um")

    def test_bad_polygons(self):
        def fails(message, hint, lumens, code=3):
            self.fails(code, message, hint, "micrograph", self.polygons("bad.json", lumens))

        fails("point", "", [[[0, 0]]])
        fails("", "", [])
        fails("", "", [circle(5, 5, 5), circle(5, 5, 2)])
        fails("cross", "", [circle(5, 5, 5), circle(9, 5, 5)])
        self.write("nan.json", b'{"units": "um", "lumens": [[[0, 0], [1, NaN], [1, 1]]]}')
        self.fails(3, "", "", "micrograph", "nan.json")
        self.write("null.json", b'{"units": "um", "lumens": [[[0, 0], [1, null], [1, 1]]]}')
        self.fails(3, "", "", "micrograph", "null.json")
        self.write("cut.json.gz", gzip.compress(json.dumps(honeycomb()).encode())[:200])
        self.fails(3, "cut.json.gz", "", "micrograph", "cut.json.gz", "--unit", "1um")
        self.write("plain.json", json.dumps(honeycomb()).encode())
        self.fails(3, "unit", "", "micrograph", "plain.json")
        self.polygons()
        self.fails(2, "window '1,2,3' is not 4 numbers", "--window", "micrograph", "cells.json", "--window", "1,2,3")
        self.fails(2, "--pixel-size is for pictures", "leave it out", "micrograph", "cells.json", "--pixel-size", "1um")
        self.fails(2, "--threshold is for scans", "leave it out", "micrograph", "cells.json", "--threshold", "100")
        self.fails(3, "no lumen", "least diameter", "micrograph", "cells.json", "--least-diameter", "1mm")
        self.fails(3, "no lumen", "", "micrograph", "cells.json", "--window", "11.5,11.5,1,1")

    def test_bad_pictures(self):
        size = ["--pixel-size", "1um"]
        self.write("grey.png", pictures.png([[90] * 64] * 64))
        self.fails(3, "one single grey", "", "micrograph", "grey.png", *size)
        rows = pictures.stripes(64, 64, bands=8)
        self.write("bands.png", pictures.png(rows))
        self.fails(3, "which phases are in", "--phase", "micrograph", "bands.png", *size)
        labels = ["--phase", "0=lumen", "--phase", "255=wall"]
        self.fails(3, "the pixel size of 'bands.png' is not known", "--pixel-size", "micrograph", "bands.png", *labels)
        for name, grey, message in [("lumen.png", 0, "no wall"), ("wall.png", 255, "no lumen")]:
            self.write(name, pictures.png([[grey] * 32] * 32))
            self.fails(3, message, "", "micrograph", name, *labels, *size)
        ring = [[255 if 20 < x < 40 and 20 < y < 40 else 0 for x in range(64)] for y in range(64)]
        self.write("ring.png", pictures.png(ring))
        self.fails(3, "one lumen", "", "micrograph", "ring.png", *labels, *size)
        self.fails(2, "no phase is called void, pore, lumen or air", "say which phase the lumens are", "micrograph", "bands.png", "--phase", "0=a", "--other",
                   "b", *size)  # fmt: skip
        self.fails(2, "'lumn' is no phase", "did you mean 'lumen'", "micrograph", "bands.png", *labels, *size,
                   "--lumen-phase", "lumn")  # fmt: skip
        self.fails(2, "--unit is for polygons", "leave it out", "micrograph", "bands.png", *labels, *size, "--unit", "1um")
        self.fails(3, "there is no file", "", "micrograph", "no.png", *size)
        self.fails(3, "there is no file", "", "micrograph", "no.json")
        self.works("generate", "spheres", "--size", "32,32,32", "-o", "v.vti")
        self.fails(3, "volume", "slice", "micrograph", "v.vti")

    def test_bad_options(self):
        self.polygons()

        def fails(message, hint, *words, code=2):
            self.fails(code, message, hint, "micrograph", "cells.json", *words)

        fails("lamella 'grwth'", "did you mean 'growth'", "--lamella", "grwth")
        fails("lamella thickness counts only with", "growth or constant", "--lamella", "none", "--lamella-thickness", "1um")
        fails("lamella radius counts only with", "growth", "--lamella", "constant", "--lamella-radius", "1um")
        fails("needs a picture of labels", "growth", "--lamella", "labels")
        fails("horizon -1 is below 0", "0 or more", "--horizon", "-1")
        fails("no conductivity was given for 'lumen'", "lumen=VALUE", "--conductivity", "wall=1")
        fails("'wal'", "did you mean 'wall'", "--conductivity", "wal=1", "--conductivity", "lumen=1")
        fails("lamella", "leave it out", *CONDUCT, "--conductivity", "lamella=1", "--lamella", "none")
        fails("two values", "one value", *CONDUCT, "--conductivity", "wall=2")
        fails("at least 0", "", "--conductivity", "wall=-1", "--conductivity", "lumen=1")
        fails("all conductivities are 0", "", "--conductivity", "wall=0,lumen=0", code=4)
        fails("direction 'z'", "x", "--direction", "z", *CONDUCT)
        fails("no conducting path", "", "--conductivity", "wall=0,lumen=1", code=4)
        fails("without --conductivity", "say what", "--target-error", "1%")
        fails("target error 2 is not below 1", "below 1", *CONDUCT, "--target-error", "2")
        fails("--contours 'c.txt'", "end it in", "--contours", "c.txt")
        fails("--overlay 'c.jpg'", "end it in .png", "--overlay", "c.jpg")
        fails("-o 'c.txt'", "", "-o", "c.txt")
        fails("written twice", "", "-o", "a.png", "--overlay", "a.png")
        fails("--overlay-width", "", "--overlay", "a.png", "--overlay-width", "3")
        self.write("there.png", b"x")
        for option in ("-o", "--overlay"):
            fails("there.png", "--overwrite", option, "there.png", code=7)
        self.write("there.json", b"x")
        fails("there.json", "--overwrite", "--contours", "there.json", code=7)
        self.works("micrograph", "cells.json", "-o", "there.png", "--overwrite")
        fails("nowhere", "", "-o", os.path.join("nowhere", "a.vti"), code=7)

    def test_one_lumen(self):
        self.polygons(lumens=[circle(6, 6, 5)])
        self.fails(2, "one lumen only", "give the spacing", "micrograph", "cells.json")
        alone = self.run_lamella("micrograph", "cells.json", "--spacing", "0.2um", "--json")
        self.assertEqual(alone.code, 0, alone.err)
        self.assertIn("warning: there is one lumen only", alone.err)
        self.assertIsNone(alone.json()["lamella"])
        self.fails(3, "fewer than two lumens", "", "micrograph", "cells.json", "--spacing", "0.2um", "--lamella", "growth")


if __name__ == "__main__":
    unittest.main()
