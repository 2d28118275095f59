"""flux-map, snapshot and info."""

import os
import re
import struct
import unittest

import pictures
from program import CONDUCTIVITIES, PHASES, Case


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(29)
    width, height, _, kind = struct.unpack(">IIBB", head[16:26])
    return width, height, kind


class Results(Case):
    def setUp(self):
        super().setUp()
        self.works("generate", "softwood", "--size", "90,70", "-o", "t.png")
        self.works("diffusion", "t.png", *CONDUCTIVITIES, "-o", "h.vti")

    def test_flux_map_agrees_with_the_solver(self):
        answer = self.works("diffusion", "t.png", *CONDUCTIVITIES, "--json").json()
        for axis in "xy":
            flux = self.works("flux-map", "h_%s.vti" % axis, "--json").json()
            # The mean flux is the energy's value to the solver's tolerance.
            self.assertAlmostEqual(flux["effective"][axis] / answer["effective"][axis], 1, delta=1e-6)
            self.assertGreaterEqual(flux["tortuosity"][axis], 1)
            self.assertGreaterEqual(flux["streamline_tortuosity"][axis], 1)
            self.assertEqual(flux["direction"], axis)
        for key in ["tensor", "mean_flux", "tortuosity_factor", "flux_magnitude", "streamlines", "line_flux", "seconds",
                    "files", "version", "commit", "provenance"]:
            self.assertIn(key, flux)

    def test_flux_map_writes_map_and_lines(self):
        out = self.works("flux-map", "h_y.vti", "-o", "m.vti", "-o", "l.vtp", "--streamlines", "12").out
        self.assertIn("wrote m.vti", out)
        self.assertIn("flux_magnitude", [array["name"] for array in self.info("m.vti")["point_arrays"]])
        lines = self.info("l.vtp")
        self.assertEqual(lines["kind"], "vtkPolyData")
        self.assertEqual(lines["cells"], 12)
        self.fails(2, "-o 'm.png': the map is written as .vti, its streamlines as .vtp", "twice", "flux-map", "h_y.vti", "-o", "m.png")
        self.fails(2, "streamlines -1 is below 0", "0 to 1000000", "flux-map", "h_y.vti", "--streamlines=-1")

    def test_files_can_be_written_again(self):
        # Field data hold NaN for directions that were not solved; neither we nor VTK may trip over them.
        self.works("flux-map", "h_y.vti", "-o", "a.vti")
        self.works("flux-map", "a.vti", "-o", "b.vti", "-o", "b.vtp")
        self.assertIsNone(self.info("b.vti")["field_data"]["effective_conductivity"][0])
        for name in ["h_y.vti", "a.vti", "b.vti", "b.vtp"]:
            with open(self.path(name), "rb") as file:
                ranges = re.findall(rb'"L2_NORM_(?:FINITE_)?RANGE".*?</InformationKey>', file.read(), re.DOTALL)
            self.assertTrue(ranges, "the flux has one")
            self.assertFalse([text for text in ranges if b"nan" in text], "VTK writes such ranges and cannot read them")

    def test_snapshots_need_no_display(self):
        environment = {"DISPLAY": ""}
        for name, words in [
            ("auto", []),
            ("flux", ["--preset", "flux", "--overlay", "lines"]),
            ("arrows", ["--array", "flux", "--overlay", "arrows"]),
            ("temperature", ["--preset", "temperature", "--overlay", "isolines", "--color-map", "magma"]),
            ("phase", ["--preset", "phase", "--phase-color", "wall=#8c5a2b"]),
            ("part", ["--window", "10,10,40,30"]),
        ]:
            file = name + ".png"
            self.assertEqual(self.works("snapshot", "h_y.vti", *words, "-o", file, environment=environment).out, "wrote " + file + "\n")
            self.assertGreater(os.path.getsize(self.path(file)), 1000)

    def test_snapshots_have_the_size_asked_for(self):
        answer = self.works("snapshot", "h_y.vti", "--size", "640,480", "-o", "s.png", "--json").json()
        self.assertEqual(png_size(self.path("s.png")), (640, 480, 2))
        self.assertIn("range", answer)
        self.works("snapshot", "h_y.vti", "--size", "640,480", "--transparent", "-o", "clear.png")
        self.assertEqual(png_size(self.path("clear.png"))[2], 6, "with an alpha channel")

    def test_snapshots_of_pictures_and_volumes(self):
        self.works("snapshot", "t.png", "-o", "tissue.png")
        self.write("p.png", pictures.png(pictures.stripes(40, 30)))
        self.works("snapshot", "p.png", *PHASES, "--pixel-size", "0.5um", "--background", "#f4ede4", "-o", "p_out.png")
        self.works("generate", "spheres", "--size", "16,16,16", "-o", "s.vti")
        self.works("snapshot", "s.vti", "--azimuth", "-40", "--elevation", "20", "-o", "s_out.png")

    def test_snapshots_of_what_is_not_there(self):
        self.fails(2, "pictures are written as PNG", ".png", "snapshot", "h_y.vti", "-o", "s.jpg")
        self.fails(3, "there is no array 'stress'", "name one of these", "snapshot", "h_y.vti", "--array", "stress", "-o", "s.png")
        self.fails(2, "preset 'fluks'", "did you mean 'flux'?", "snapshot", "h_y.vti", "--preset", "fluks", "-o", "s.png")
        self.fails(2, "size (width) 10 is below 64", "from 64 to 16384", "snapshot", "h_y.vti", "--size", "10,10", "-o", "s.png")
        self.fails(2, "background 'mauve' is not a colour", "#RRGGBB", "snapshot", "h_y.vti", "--background", "mauve", "-o", "s.png")
        self.fails(2, "range 2 to 1 is empty", "lower end first", "snapshot", "h_y.vti", "--range", "2,1", "-o", "s.png")
        self.fails(2, "exclude each other", "alone", "snapshot", "h_y.vti", "--arrows", "--streamlines", "-o", "s.png")
        self.fails(2, "outside", "inside the picture", "snapshot", "h_y.vti", "--window", "0,0,91,70", "-o", "s.png")

    def test_info_of_a_result(self):
        info = self.info("h_y.vti")
        arrays = {array["name"]: array for array in info["point_arrays"]}
        self.assertEqual(arrays["flux"]["components"], 3)
        self.assertTrue(arrays["flux"]["unit"])
        self.assertTrue(arrays["temperature"]["description"])
        self.assertEqual([phase["name"] for phase in info["phases"]], ["lumen", "wall"])
        self.assertEqual(info["spacing"], [1e-6, 1e-6])
        self.assertEqual(info["origin"], [5e-7, 5e-7])
        self.assertIsInstance(info["field_data"]["estimated_error"], float)
        text = self.works("info", "h_y.vti").out
        for word in ["temperature", "flux", "lumen", "provenance:", "lamella diffusion t.png"]:
            self.assertIn(word, text)

    def test_info_of_pictures(self):
        self.write("p.png", pictures.png(pictures.stripes(40, 30), pixels_per_metre=2000000))
        info = self.info("p.png")
        self.assertEqual(info["size"], [40, 30])
        self.assertEqual(info["bits"], 8)
        self.assertAlmostEqual(info["pixel_size"], 0.5e-6, delta=1e-12)
        self.assertNotIn(info["pixel_size_source"], ["none", "option"])
        self.assertEqual([(grey["grey"], grey["nodes"]) for grey in info["greys"]], [(0, 600), (255, 600)])
        self.assertEqual(self.works("info", "p.png", "--pixel-size", "2um", "--json").json()["pixel_size"], 2e-6)
        self.write("q.png", pictures.png(pictures.stripes(40, 30)))
        self.assertIsNone(self.info("q.png")["pixel_size"])
        self.assertIn("pixel size unknown", self.works("info", "q.png").out)
        self.write("scan.png", pictures.png([[(7 * x + 3 * y) % 256 for x in range(60)] for y in range(50)]))
        self.assertIn("240 to 255", self.works("info", "scan.png").out)
        named = {grey["name"]: grey["grey"] for grey in self.info("t.png")["greys"]}
        self.assertEqual(named, {"lumen": 0, "wall": 255})


class Micrographs(Case):
    """Tissues drawn as micrographs, with their labels."""

    def test_a_micrograph_and_its_truth(self):
        for kind, look, colour in [("hardwood", "magenta", 2), ("softwood", "blue", 2), ("hardwood", "grey", 0)]:
            words = ["generate", kind, "--size", "220,200", "--seed", "5"]
            plain = ["--noise", "0", "--dirt", "0", "--uneven-light", "0"]
            answer = self.works(*words, *plain, "--look", look, "-o", "s.png", "--truth", "t.raw", "--json",
                                "--overwrite").json()
            self.assertEqual(png_size(self.path("s.png")), (220, 200, colour))
            self.assertEqual(answer["look"]["stain"], look)
            self.assertEqual(answer["truth"], "t.raw")
            self.assertEqual(answer["seed"], 5)
            self.assertEqual(answer["phases"][1]["value"], 1)
            # The truth is the very tissue that is written without --look.
            self.works(*words, "-o", "l.raw", "--overwrite")
            with open(self.path("t.raw"), "rb") as one, open(self.path("l.raw"), "rb") as two:
                self.assertEqual(one.read(), two.read())
            # And the scan, segmented, is not far from it.
            found = self.works("diffusion", "s.png", "--segment", *CONDUCTIVITIES, "--direction", "x", "--json").json()
            wall = {phase["name"]: phase["fraction"] for phase in found["phases"]}["wall"]
            self.assertAlmostEqual(wall, answer["phases"][1]["fraction"], delta=0.05)

    def test_the_same_seed_gives_the_same_file(self):
        environment = {"SOURCE_DATE_EPOCH": "1700000000"}
        words = ["generate", "hardwood", "--size", "120,100", "--look", "magenta", "--tears", "50"]
        content = []
        for seed in ["1", "1", "2"]:
            self.works(*words, "--seed", seed, "-o", "a.png", "--overwrite", environment=environment)
            with open(self.path("a.png"), "rb") as file:
                content.append(file.read())
        self.assertEqual(content[0], content[1])
        self.assertNotEqual(content[0], content[2])

    def test_labels_without_a_value_where_none_are_written(self):
        answer = self.works("generate", "hardwood", "--size", "120,100", "--look", "grey", "-o", "a.png", "--json").json()
        self.assertNotIn("value", answer["phases"][0])
        self.assertNotIn("truth", answer)
        self.works("generate", "hardwood", "--size", "120,100", "--look", "grey", "-o", "b.png", "--truth", "b.raw")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.png", "b.png", "b.raw", "b.raw.json"])

    def test_neither_file_is_written_where_one_exists(self):
        self.write("t.png", b"mine")
        self.fails(7, "'t.png' exists already", "--overwrite", "generate", "hardwood", "--look", "blue", "-o", "s.png",
                   "--truth", "t.png")
        self.assertEqual(os.listdir(self.folder), ["t.png"])


if __name__ == "__main__":
    unittest.main()
