"""The Python package as users call it, in pvpython and in Debian's python3: numpy in, numpy out, errors in words."""

import os
import subprocess
import sys
import tempfile
import unittest

import lamella
import numpy as np

PROGRAM = os.environ.get("LAMELLA_PROGRAM", os.path.join(os.path.dirname(__file__), "../../build/bin/lamella"))
REAL_DATA = os.environ.get("LAMELLA_REAL_DATA", "")


class Samples(unittest.TestCase):
    def test_arrays_have_the_order_of_pictures(self):
        picture = np.zeros((20, 30), int)
        picture[:10] = 1  # the upper half
        sample = lamella.from_array(picture, ["lumen", "wall"], spacing=1e-6)
        self.assertEqual(sample.shape, (20, 30))
        np.testing.assert_array_equal(sample.phase, picture)
        # VTK's y axis points up: the upper half has the high y.
        self.assertEqual(sample.vtk.GetScalarComponentAsDouble(0, 19, 0, 0), 1)
        self.assertEqual(sample.vtk.GetScalarComponentAsDouble(0, 0, 0, 0), 0)
        self.assertEqual(sample.fractions, {"lumen": 0.5, "wall": 0.5})

    def test_volumes_are_zyx(self):
        volume = np.arange(24).reshape(2, 3, 4)
        sample = lamella.from_array(volume)
        np.testing.assert_array_equal(np.asarray(sample), volume)
        self.assertEqual(sample.vtk.GetScalarComponentAsDouble(3, 2, 1, 0), 23)

    def test_generators(self):
        tissue = lamella.softwood(size=(120, 80), solid_fraction=0.4, seed=3)
        self.assertEqual(tissue.shape, (80, 120))
        self.assertAlmostEqual(tissue.fractions["wall"], 0.4, places=3)
        self.assertEqual(tissue.provenance["seed"], 3)
        np.testing.assert_array_equal(tissue.phase, lamella.softwood(size=(120, 80), solid_fraction=0.4, seed=3).phase)
        self.assertFalse(np.array_equal(tissue.phase, lamella.softwood(size=(120, 80), seed=4).phase))
        for sample in (
            lamella.honeycomb(size=(60, 50)),
            lamella.checkerboard(size=(40, 40)),
            lamella.disks(size=(40, 40)),
            lamella.spheres(size=(20, 20, 20)),
            lamella.laminate(size=(40, 40), axis="y"),
        ):
            self.assertEqual(len(sample.names), 2)

    def test_defaults_are_those_of_the_program(self):
        # tests/filters compares the source's with the library's.
        for kind, words, make, options in (
            ("softwood", ["--ring", "0,1"], lamella.softwood, {"ring_position": (0, 1)}),
            ("softwood", ["--ring", "0,1", "--size", "150,60,8"], lamella.softwood,
             {"ring_position": (0, 1), "size": (150, 60, 8)}),
            ("honeycomb", [], lamella.honeycomb, {}),
            ("checkerboard", [], lamella.checkerboard, {}),
            ("disks", [], lamella.disks, {}),
            ("spheres", [], lamella.spheres, {}),
            ("laminate", [], lamella.laminate, {}),
        ):
            with self.subTest(kind), tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "sample.vti")
                subprocess.run([PROGRAM, "generate", kind, *words, "--quiet", "-o", path], check=True)
                program = lamella.read_picture(path)
                sample = make(**options)
                self.assertEqual(sample.names, program.names)
                self.assertEqual(sample.spacing, program.spacing)
                np.testing.assert_array_equal(sample.phase, program.phase)
                source = lamella.vtkMicrostructureSource()
                if kind == "softwood":
                    source.SetRingPosition(0, 1)
                    source.SetSize(*(sample.shape[::-1] + (1,))[:3])
                    source.Update()
                    np.testing.assert_array_equal(lamella.Sample(source.GetOutput()).phase, program.phase)

    def test_files_are_read_as_they_were_written(self):
        tissue = lamella.softwood(size=(60, 40))
        with tempfile.TemporaryDirectory() as folder:
            path = tissue.save(os.path.join(folder, "tissue.vti"))
            with self.assertRaises(FileExistsError):
                tissue.save(path)
            back = lamella.read_picture(path, window=(10, 5, 30, 20), refine=2)
            self.assertEqual(os.listdir(folder), ["tissue.vti"])
        np.testing.assert_array_equal(back.phase[::2, ::2], tissue.phase[5:25, 10:40])
        self.assertEqual(back.names, ["lumen", "wall"])

    @unittest.skipUnless(REAL_DATA, "set LAMELLA_REAL_DATA to the folder of real pictures")
    def test_real_picture(self):
        path = os.path.join(REAL_DATA, "spruce_EW_labels_0.5um.png")
        wood = lamella.read_picture(
            path, {0: "lumen", 128: "wall", 255: "wall"}, window=(100, 20, 400, 400), pixel_size=5e-7
        )
        result = lamella.diffusion(wood, {"lumen": 0.05, "wall": 1}, fields=False, flux=False)
        # Computed independently of this project with finite volumes, to five digits.
        self.assertAlmostEqual(result.effective[0, 0], 0.15774, places=5)
        self.assertAlmostEqual(result.effective[1, 1], 0.15803, places=5)


class Diffusion(unittest.TestCase):
    def test_laminate_is_exact(self):
        layers = np.repeat([0, 1], 10)[:, None] * np.ones((1, 30), int)  # the lower half conducts ten times better
        result = lamella.diffusion(layers, {0: 1, 1: 10}, tolerance=1e-10, estimate_error=True)
        self.assertAlmostEqual(result.effective[0, 0], 5.5, places=8)
        self.assertAlmostEqual(result.effective[1, 1], 2 / 1.1, places=8)
        self.assertLess(result.estimated_error, 1e-6)
        self.assertAlmostEqual(result.bounds["series"], 2 / 1.1)
        self.assertAlmostEqual(result.bounds["parallel"], 5.5)
        field = result.fields["temperature_y"]
        self.assertEqual(field.shape, (20, 30))
        self.assertGreater(field[0, 0], 0.95)  # enters at the top
        self.assertLess(field[-1, 0], 0.05)
        self.assertEqual(result.fields["flux_x"].shape, (20, 30, 3))

    def test_flux_map(self):
        result = lamella.diffusion(lamella.softwood(size=(80, 60)), {"wall": 1, "lumen": 0.023}, "x")
        flux = lamella.flux_map(result, streamlines=20)
        self.assertEqual(len(flux.lines), 20)
        self.assertAlmostEqual(flux.effective[0, 0], result.effective[0, 0], places=7)
        self.assertGreater(flux.tortuosity["x"], 1)
        self.assertEqual(flux.magnitude.shape, (60, 80))
        np.testing.assert_allclose(flux.magnitude, np.linalg.norm(result.fields["flux"], axis=-1))

    def test_pore_flood_fill(self):
        picture = np.ones((6, 8), int)
        picture[0, :3] = 0  # the upper left corner
        picture[4, 5] = 0
        pores = lamella.pore_flood_fill(lamella.from_array(picture, ["void", "solid"], spacing=2e-6))
        self.assertEqual((pores.count, pores.total, pores.largest, pores.mean), (2, 4, 3, 2.0))
        expected = np.zeros((6, 8), int)
        expected[0, :3] = 1
        expected[4, 5] = 2
        np.testing.assert_array_equal(pores.labels, expected)
        self.assertEqual(pores.sizes[0, 1], 3)
        self.assertTrue(np.isnan(pores.sizes[3, 3]))
        self.assertEqual(pores.table["size"].tolist(), [3, 1])
        self.assertEqual(pores.table["touches_y_max"].tolist(), [1, 0])  # y points up
        np.testing.assert_allclose(pores.table["centre_x"], [3e-6, 11e-6])
        self.assertEqual(pores.distribution["pores"].tolist(), [1, 1])
        self.assertEqual(pores.phase, "void")
        self.assertEqual(pores.percolates, "")
        self.assertIn("2 pores", repr(pores))
        self.assertEqual(lamella.pore_flood_fill(picture, 1, periodic="y").percolates, "xy")
        self.assertEqual(lamella.pore_flood_fill(picture, 0, minimum_size=2).dropped, (1, 1))
        with self.assertRaisesRegex(lamella.LamellaError, "connectivity 26 does not fit a picture"):
            lamella.pore_flood_fill(picture, 0, 26)
        with self.assertRaisesRegex(lamella.LamellaError, "no phase is called void"):
            lamella.pore_flood_fill(picture)
        with self.assertRaisesRegex(ValueError, "names axes"):
            lamella.pore_flood_fill(picture, 0, periodic="w")

    def test_errors_have_words_and_a_hint(self):
        picture = np.zeros((8, 8), int)
        picture[3] = 1
        with self.assertRaisesRegex(lamella.LamellaError, "phase '1' has no conductivity") as caught:
            lamella.diffusion(picture, {0: 1})
        self.assertIn("give one to each phase", caught.exception.hint)
        with self.assertRaisesRegex(lamella.LamellaError, "no conducting path"):
            lamella.diffusion(picture, {0: 1, 1: 0}, "y")
        with self.assertRaisesRegex(lamella.LamellaError, "missing.png"):
            lamella.read_picture("missing.png")
        with self.assertRaisesRegex(ValueError, "'x', 'y', 'z', 'all'"):
            lamella.diffusion(picture, {0: 1, 1: 1}, "w")

    def test_progress_can_cancel(self):
        seen = []
        sample = lamella.softwood(size=(80, 60))
        lamella.diffusion(sample, {"wall": 1, "lumen": 0.1}, progress=lambda share, text: seen.append(share))
        self.assertEqual(seen, sorted(seen))
        with self.assertRaises(lamella.Cancelled):
            lamella.diffusion(sample, {"wall": 1, "lumen": 0.1}, progress=lambda share, text: False)

        def interrupt(share, text):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            lamella.diffusion(sample, {"wall": 1, "lumen": 0.1}, progress=interrupt)

    def test_snapshot(self):
        with tempfile.TemporaryDirectory() as folder:
            path = lamella.snapshot(lamella.softwood(size=(60, 40)), os.path.join(folder, "tissue.png"))
            self.assertGreater(os.path.getsize(path), 1000)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
