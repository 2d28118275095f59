"""Numpy arrays in and out of the package: shared where the layout allows it, alive as long as anybody looks, and refused
in words where they are not what they should be."""

import gc
import unittest

import lamella
import numpy as np


def churn():
    """Frees what nobody holds, and writes over it."""
    gc.collect()
    return [np.full((40, 50), 9, np.uint8) for _ in range(200)]


class Shared(unittest.TestCase):
    def test_volumes(self):
        volume = np.zeros((3, 4, 5), np.uint8)
        sample = lamella.from_array(volume, copy=False)
        self.assertTrue(np.shares_memory(sample.phase, volume))
        volume[1, 2, 3] = 7  # the same memory, in VTK as in numpy
        self.assertEqual(sample.vtk.GetScalarComponentAsDouble(3, 2, 1, 0), 7)
        own = lamella.from_array(volume, copy=True)
        self.assertFalse(np.shares_memory(own.phase, volume))
        np.testing.assert_array_equal(own.phase, volume)

    def test_pictures(self):
        # The last row first in memory, as VTK has it; and as the package's own arrays are.
        picture = np.zeros((40, 50), np.uint8)[::-1]
        picture[:10] = 1
        sample = lamella.from_array(picture, copy=False)
        self.assertTrue(np.shares_memory(sample.phase, picture))
        again = lamella.from_array(sample.phase, copy=False)
        self.assertTrue(np.shares_memory(again.phase, picture))
        usual = np.ascontiguousarray(picture)
        copied = lamella.from_array(usual)
        self.assertFalse(np.shares_memory(copied.phase, usual))
        np.testing.assert_array_equal(copied.phase, usual)

    def test_masks_and_fields(self):
        mask = np.zeros((3, 4, 5), bool)
        mask[1] = True
        self.assertTrue(np.shares_memory(lamella.from_array(mask, copy=False).phase, mask))
        sample = lamella.from_array(np.zeros((3, 4, 5), np.uint8))
        axis = np.ones((3, 4, 5, 3))
        sample.set_array("axis", axis, copy=False)
        self.assertTrue(np.shares_memory(sample.array("axis"), axis))

    def test_results(self):
        tissue = lamella.softwood(size=(40, 30))
        result = lamella.diffusion(tissue, {"wall": 1, "lumen": 0.1}, "x")
        self.assertTrue(np.shares_memory(result.phase, tissue.phase))  # handed on, not copied
        field = result.fields["temperature"]
        self.assertTrue(np.shares_memory(field, result.array("temperature")))

    def test_other_layouts_are_copied(self):
        volume = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
        for other in (np.asfortranarray(volume), np.repeat(volume, 2, axis=2)[..., ::2], volume.astype(">u2"),
                      volume.astype(np.int64), volume.tolist()):
            np.testing.assert_array_equal(lamella.from_array(other).phase, volume)
            with self.assertRaisesRegex(ValueError, "needs a copy"):
                lamella.from_array(other, copy=False)
        volume.flags.writeable = False
        np.testing.assert_array_equal(lamella.from_array(volume).phase, volume)
        with self.assertRaisesRegex(ValueError, "read-only"):
            lamella.from_array(volume, copy=False)


class Alive(unittest.TestCase):
    def test_arrays_given(self):
        picture = np.zeros((40, 50), np.uint8)[::-1]
        picture[:10] = 1
        image = lamella.from_array(picture, copy=False).vtk
        del picture
        junk = churn()
        self.assertEqual(lamella.Sample(image).phase.sum(), 500)
        # Nor does it matter that the numpy array that VTK was given is only known to VTK's own pipeline.
        result = lamella.pore_flood_fill(image, phase=1)
        del image
        junk += churn()
        self.assertEqual(result.total, 500)
        self.assertEqual(result.array("phase").sum(), 500)

    def test_arrays_taken(self):
        phase = lamella.softwood(size=(40, 30)).phase  # of a sample that is gone
        expected = phase.copy()
        junk = churn()
        np.testing.assert_array_equal(phase, expected)
        chain = lamella.contours(lamella.softwood(size=(240, 200), spacing=5e-7)).chains[0]
        expected = chain.copy()
        junk += churn()
        np.testing.assert_array_equal(chain, expected)

    def test_memory_is_given_back(self):
        # An array that is shared goes when the last one that looks at it goes.
        class Owner(np.ndarray):
            freed = 0

            def __del__(self):
                Owner.freed += 1

        for _ in range(5):
            lamella.from_array(np.zeros((3, 4, 5), np.uint8).view(Owner), copy=False)
        gc.collect()
        self.assertGreaterEqual(Owner.freed, 5)


class Refused(unittest.TestCase):
    def refused(self, pattern, call, *arguments, **keywords):
        with self.assertRaisesRegex((ValueError, TypeError, lamella.LamellaError), pattern) as caught:
            call(*arguments, **keywords)
        self.assertNotIn("\n", str(caught.exception))

    def test_types(self):
        refused, make = self.refused, lamella.from_array
        refused(r"phases are whole numbers, not float64; give whole numbers: values.astype\(numpy.uint8\)", make, [[0, 1.5]])
        refused("phases are whole numbers, not float64", make, np.array([[0, np.nan]]))
        refused("phase is of type complex128; give whole numbers", make, np.zeros((2, 2), complex))
        refused("phase is of type <U1", make, np.array([["a"]]))
        refused("phase is of type object", make, np.zeros((2, 2), object))
        refused("phase is of type str; give an array of numbers", make, "tissue.png")
        refused("phase is of type NoneType", lamella.diffusion, None, {})
        refused(r"1 values masked; fill them: values.filled\(0\)", make, np.ma.masked_equal([[1, 2]], 2))

    def test_shapes(self):
        refused, make = self.refused, lamella.from_array
        refused(r"shape \(3,\) is neither a picture nor a volume", make, np.zeros(3, int))
        refused(r"shape \(0, 3\) is neither", make, np.zeros((0, 3), int))
        refused(r"shape \(8, 8, 2, 2\) is neither", lamella.diffusion, np.zeros((8, 8, 2, 2), int), {})
        for spacing in (0, -1, float("nan"), float("inf"), "1e-6", None):
            refused("spacing is .*; give the distance of two nodes in metres", make, [[0, 1]], spacing=spacing)

    def test_values(self):
        self.refused("more than 256 different values", lamella.pore_flood_fill, np.arange(400).reshape(20, 20))
        self.refused("phases are whole numbers", lamella.pore_flood_fill, np.full((20, 20), 2**60))
        self.refused("no finite numbers", lamella.contours, np.full((8, 8), np.nan), level=0.5)

    def test_fields(self):
        sample = lamella.from_array(np.zeros((4, 5), np.uint8))
        refused, put = self.refused, sample.set_array
        refused(r"grain has the shape \(3, 3\); the sample's is \(4, 5\)", put, "grain", np.zeros((3, 3)))
        refused(r"axis has the shape \(4, 5, 0\)", put, "axis", np.zeros((4, 5, 0)))
        refused("grain is of type str", put, "grain", "x")
        refused("axis is of type float16", put, "axis", np.zeros((4, 5), np.float16))
        refused("needs a copy: VTK's vectors have three components", put, "velocity", np.zeros((4, 5, 2)), copy=False)
        put("velocity", np.full((4, 5, 2), np.nan))
        self.assertEqual(sample.array("velocity").shape, (4, 5, 3))
        refused(r"velocity has the shape \(3, 3, 2\); give 4 by 5 by 2 numbers", lamella.dynamics, sample, {"0": 1e9}, 1000,
                velocity=np.zeros((3, 3, 2)), end_time=1e-9)

    def test_columns_and_grains(self):
        curve, bridges = lamella.compression_curve, lamella.bridges
        self.refused("stress is of type <U1; give real numbers", curve, [0, 1], ["a", "b"])
        self.refused(r"have the shapes \(2,\) and \(3,\); give two columns", curve, [0, 1], [0, 1, 2])
        self.refused("radius of grain 1 is nan", bridges, ([[0, 0]], [np.nan]))
        self.refused("radii is of type <U1", bridges, ([[0, 0]], ["a"]))
        self.refused(r"centres \(1, 4\) and radii \(1,\)", bridges, ([[0, 0, 0, 0]], [1]))
        self.refused("grains is of type int; give a Packing", bridges, 5)


if __name__ == "__main__":
    unittest.main(argv=["memory"], verbosity=2)
