"""The commands that the project is shown by, on real pictures made by others (LAMELLA_REAL_DATA), against numbers
computed independently with finite volumes and harmonic faces."""

import gzip
import os
import unittest

from program import REAL_DATA, Case


@unittest.skipUnless(REAL_DATA, "LAMELLA_REAL_DATA is not set")
class Real(Case):
    def spruce(self, kind, *words):
        return self.works(
            "diffusion", os.path.join(REAL_DATA, "spruce_%s_labels_0.5um.png" % kind), "--phase", "0=lumen", "--phase",
            "128=wall", "--phase", "255=wall", "--conductivity", "lumen=0.05", "--conductivity", "wall=1", "--window",
            "100,20,400,400", "--sides", "insulated", "--lattice", "d2q5", "--json", *words).json()["effective"]

    def test_spruce_to_the_last_digit(self):
        for kind, words, y, x in [
            ("EW", [], "0.15803", "0.15774"),
            ("LW", [], "0.44488", "0.48006"),
            ("EW", ["--refine", "2"], "0.15893", "0.15841"),
            ("LW", ["--refine", "2"], "0.44713", "0.48172"),
        ]:
            effective = self.spruce(kind, *words)
            self.assertEqual("%.5f" % effective["y"], y)
            self.assertEqual("%.5f" % effective["x"], x)

    def test_berea_to_the_last_digit(self):
        # The array's axes 0, 1, 2 are z, y, x of a file with x fastest.
        with gzip.open(os.path.join(REAL_DATA, "berea_200x200x200_u8.raw.gz")) as packed:
            self.write("berea_200x200x200_u8.raw", packed.read())
        effective = self.works(
            "diffusion", "berea_200x200x200_u8.raw", "--phase", "1=pore", "--other", "solid", "--conductivity", "pore=1",
            "--conductivity", "solid=0", "--window", "50,50,50,100,100,100", "--no-error-estimate", "--json",
        ).json()["effective"]
        self.assertEqual(
            ["%.6f" % effective[axis] for axis in "zyx"], ["0.058184", "0.053040", "0.054915"])

    def pores(self, file, connectivity, *words, **options):
        found = self.works("pore-flood-fill", file, *words, "--connectivity", connectivity, "--json", **options).json()
        return found["count"], found["largest"], found["total"]

    # Counted independently with SciPy's ndimage.label.
    def test_pores_of_pictures(self):
        void = ["--phase", "0=void", "--other", "solid"]
        for file, connectivity, words, count, largest in [
            ("spruce_EW_labels_0.5um.png", 4, void, 104, 9935),
            ("spruce_EW_labels_0.5um.png", 8, void, 104, 9935),
            ("spruce_LW_labels_0.5um.png", 4, void, 133, 2517),
            ("spruce_LW_labels_0.5um.png", 8, void, 133, 2517),
            ("conifer_roxas_lumen_mask.png", 4, ["--phase", "255=lumen", "--other", "wall"], 251, 12205),
            ("sandstone_se3_labels_x85.png", 4, void, 123, None),
            ("sandstone_se3_labels_x85.png", 8, void, 109, None),
        ]:
            first = None
            for ranks in [0, 2, 4] if "spruce" in file else [0]:
                found = self.pores(os.path.join(REAL_DATA, file), connectivity, *words, ranks=ranks)
                self.assertEqual(found[0], count, file)
                self.assertIn(largest, [None, found[1]], file)
                first = first or found
                self.assertEqual(found, first, "on %d ranks" % ranks)

    def test_pores_of_berea(self):
        with gzip.open(os.path.join(REAL_DATA, "berea_200x200x200_u8.raw.gz")) as packed:
            self.write("berea_200x200x200_u8.raw", packed.read())
        for connectivity, count, largest in [(6, 331, 1581946), (18, 272, 1582412), (26, 262, 1582787)]:
            for ranks in [0, 2, 4]:
                found = self.pores("berea_200x200x200_u8.raw", connectivity, "--phase", "1=pore", "--other", "solid",
                                   ranks=ranks)
                self.assertEqual(found, (count, largest, 1589722), "on %d ranks" % ranks)

    def test_a_raw_scan_is_segmented(self):
        answer = self.run_lamella(  # warns of gaps in rays
            "diffusion", os.path.join(REAL_DATA, "conifer_roxas_scan.jpg"), "--segment", "--window", "0,0,300,300",
            "--conductivity", "lumen=0.02", "--conductivity", "wall=1", "--no-error-estimate", "--json")
        self.assertEqual(answer.code, 0, answer.err)
        self.assertGreater(answer.json()["effective"]["x"], 0)

    def test_conifer_scan_as_a_micrograph(self):
        answer = self.run_lamella(  # warns of gaps in rays
            "micrograph", os.path.join(REAL_DATA, "conifer_roxas_scan.jpg"), "--pixel-size", "0.441um", "--overlay", "o.png",
            "--least-diameter", "4.98um", "--json").json()
        # The expert marked 236 lumens of at least 100 pixels, a circle of 4.98 um, and 65.62 % of the picture as lumen.
        self.assertAlmostEqual(answer["lumens"]["count"], 236, delta=0.05 * 236)
        self.assertAlmostEqual(1 - answer["wall_fraction"], 0.6562, delta=0.02)
        self.assertIsNone(answer["vessels"])

    def test_spruce_polygons_as_a_micrograph(self):
        # The windows that the label pictures of the same spruce show, in the files' micrometres; their lumens are
        # larger by 0.01 um all around, 0.5 % of thin walls (tests/verification/Contours.cpp).
        for kind, fraction, window, within in [
            ("EW", 0.19966, "60,20,380,390", 0.006), ("LW", 0.60941, "12,22,376,223", 0.003)
        ]:
            for part in ([], ["--conductivity", "lumen=0.05,wall=1"]):
                result = self.run_lamella(
                    "micrograph", os.path.join(REAL_DATA, "spruce_%s_polygons.json.gz" % kind), "--spacing", "0.5um",
                    "--window", window, "--json", *part)
                self.assertEqual(result.code, 0, result.err)
                answer = result.json()
                self.assertAlmostEqual(answer["lattice"]["wall_fraction"], fraction, delta=within * fraction)
            for axis in "xy":
                solved = answer["diffusion"]["axes"][axis]
                self.assertLess(solved["relative_error"], 0.03)

    def test_latewood_flux_without_a_display(self):
        self.works(
            "diffusion", os.path.join(REAL_DATA, "spruce_LW_labels_0.5um.png"), "--phase", "0=lumen", "--other", "wall",
            "--conductivity", "lumen=0.05", "--conductivity", "wall=1", "--window", "100,20,400,400", "--pixel-size",
            "0.5um", "--direction", "y", "--no-error-estimate", "-o", "latewood.vti")
        self.works("snapshot", "latewood.vti", "--preset", "flux", "-o", "latewood.png", environment={"DISPLAY": ""})
        self.assertGreater(os.path.getsize(self.path("latewood.png")), 10000)


if __name__ == "__main__":
    unittest.main()
