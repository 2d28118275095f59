"""Ranges of greys as phases and grey volumes, through lamella.read_picture and, in pvpython, the picture reader's proxy."""

import os
import sys
import tempfile
import unittest

import lamella
import numpy as np

VOID_FIBRE = {"..otsu": "void", "otsu..": "fibre"}


def tomogram(truth, noise=0.2, seed=1):
    """Greys of 8 bits, (z, y, x): 60 and 170 with normally distributed noise, a share of the contrast."""
    grey = 60 + 110 * (truth + noise * np.random.default_rng(seed).normal(size=truth.shape))
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8)


class Volume(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.truth = np.zeros((40, 40, 40), bool)
        self.truth[:, 10:22, 8:30] = True

    def raw(self, array, kind="u8"):
        path = os.path.join(self.folder, "t_{2}x{1}x{0}_{3}.raw".format(*array.shape, kind))
        array.tofile(path)
        return path


class Greys(Volume):
    def test_ranges(self):
        ramp = np.arange(27000, dtype="<u2").reshape(30, 30, 30)
        path = self.raw(ramp, "u16")
        phase = lamella.read_picture(path, {"0..999": "void", "1000..1999": "resin", "2000..": "fibre"})
        self.assertEqual(phase.names, ["void", "resin", "fibre"])
        np.testing.assert_array_equal(phase.phase, np.minimum(ramp // 1000, 2))
        # Numbers, as before, beside ranges, and the rest.
        some = lamella.read_picture(path, {7: "void", np.int64(9): "void", "..5": "void"}, other="fibre")
        self.assertEqual(np.count_nonzero(some.phase == 0), 8)
        self.assertEqual(phase.segmentation, [])

    def test_mistakes_are_told(self):
        path = self.raw(tomogram(self.truth))
        for phases, words in (
            ({"..89": "void", "80..": "fibre"}, "80..89 would be both"),
            ({"..89": "void", "100..": "fibre"}, "the grey values 90..99 are in no phase"),
            ({"89..0": "void"}, "runs backwards"),
            ({"..89": "void", "90..300": "fibre"}, "run from 0 to 255"),
            ({"wall": "void"}, "'wall' is not a grey value"),
        ):
            with self.assertRaisesRegex(lamella.LamellaError, words):
                lamella.read_picture(path, phases)
        with self.assertRaisesRegex(lamella.LamellaError, "threshold and phases contradict"):
            lamella.read_picture(path, VOID_FIBRE, segment=True, threshold=90)

    def test_a_volume_is_segmented(self):
        path = self.raw(tomogram(self.truth))
        plain = lamella.read_picture(path, VOID_FIBRE)
        found = lamella.read_picture(path, VOID_FIBRE, segment=True)
        wrong = [np.mean(np.asarray(one) != self.truth) for one in (plain, found)]
        # Half the contrast is 2.5 deviations of the noise: 0.6 % are beyond it. What is left lies at faces and edges.
        self.assertAlmostEqual(wrong[0], 0.0062, delta=0.001)
        self.assertLess(wrong[1], 0.002)
        self.assertIn("parted at", plain.segmentation[0])
        self.assertEqual(len(found.segmentation), 6)
        self.assertEqual(lamella.read_picture(path, segment=True).names, ["void", "solid"])
        bright = lamella.read_picture(path, segment=True, lumen="bright")
        self.assertGreater(bright.fractions["void"], 0.1)
        self.assertLess(bright.fractions["void"], 0.2)
        # Bars along z: the conductivity along them is their share.
        along = lamella.diffusion(found, {"void": 0, "fibre": 1}, direction="z").effective[2, 2]
        self.assertAlmostEqual(along, self.truth.mean(), delta=0.003)


def paraview_with_plugin():
    """ParaView's modules once the plugin is loaded; nothing where either is missing."""
    try:
        import paraview.simple
        from paraview import servermanager

        lamella.load_plugin()
    except (ImportError, FileNotFoundError):
        return None
    return paraview.simple, servermanager


@unittest.skipIf(paraview_with_plugin() is None, "needs ParaView's Python and the plugin")
class Proxy(Volume):
    def test_the_panels_rows_are_ranges(self):
        pv, servermanager = paraview_with_plugin()
        path = self.raw(tomogram(self.truth, 0))
        reader = pv.PictureReader(FileName=path, Phases=["..89", "void", "90..", "fibre"])
        image = servermanager.Fetch(reader)
        self.assertEqual(lamella.arrays(image)["phase"].mean(), self.truth.mean())
        reader.Phases = ["60", "void", "170", "fibre"]
        self.assertEqual(lamella.arrays(servermanager.Fetch(reader))["phase"].mean(), self.truth.mean())
        reader.Phases = []
        reader.Segment = 1
        image = servermanager.Fetch(reader)
        names = image.GetFieldData().GetAbstractArray("phase_names")
        self.assertEqual([names.GetValue(i) for i in range(2)], ["void", "solid"])


if __name__ == "__main__":
    sys.exit(unittest.main())
