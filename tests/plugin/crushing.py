"""lamella.compression() and lamella.point_stiffness(), as scripts use them."""

import os
import tempfile
import unittest

import lamella
import numpy as np

QUICK = {"strain": 0.04, "rows": 8, "first_speed": 1e-2}


def tissue():
    """Two lumens, walls of three pixels."""
    phase = np.ones((16, 23), int)
    phase[3:13, 3:10] = phase[3:13, 13:20] = 0
    return lamella.from_array(phase, names=["lumen", "wall"], spacing=1e-6)


class Compression(unittest.TestCase):
    def test_curve_and_states(self):
        seen = []
        result = lamella.compression(
            tissue(), **QUICK, at_strains=[0.02, 0.01], stress=True, deformation_gradient=True, energy_density=True,
            progress=lambda share, text: seen.append(share))
        self.assertEqual(len(result.strain), 9)
        np.testing.assert_allclose(result.strain, np.linspace(0, 0.04, 9), atol=1e-9)
        self.assertEqual(result.strain[0], 0)
        self.assertEqual(sorted(result.curve), sorted(
            ("strain stress imbalance lateral_stress lateral_strain porosity elastic_energy kinetic_energy work dissipated plastic_work "
             "speed steps time").split()))
        np.testing.assert_allclose([state.imposed_strain for state in result.states], [0.01, 0.02, 0.04], atol=1e-9)
        self.assertAlmostEqual(result.states[0].imposed_stress / result.stress[2], 1, places=6)
        points = result.points
        count = result.statistics["points"]
        self.assertEqual(points.positions.shape, (count, 3))
        np.testing.assert_array_equal(points.array("id"), np.arange(count))
        self.assertEqual(points.array("id").dtype, np.uint32)
        gradient = points.array("deformation_gradient").reshape(-1, 3, 3)
        # the mean of F over the box is that of its sides, but for lumens, which points do not show: walls hold the strain
        self.assertLess(np.linalg.det(gradient).mean(), 1)
        self.assertEqual(np.abs(gradient[:, 2, 2] - 1).max(), 0)
        # elastic energy is that of the points
        energy = points.array("energy_density").sum() * (0.5e-6) ** 2
        self.assertAlmostEqual(energy / result.curve["elastic_energy"][-1], 1, places=9)
        self.assertLess(points.array("stress")[:, 1].mean(), 0)  # tension is positive
        with self.assertRaisesRegex(KeyError, "velocity"):
            points.array("velocity")
        self.assertEqual(result.axis, "y")
        self.assertEqual(set(result.quality), {"energy_ratio", "energy_ratio_strain", "lateral", "imbalance", "first_touch_strain",
                                               "slowdowns"})
        self.assertIn("points, kinetic energy at most", repr(result))
        self.assertEqual(seen, sorted(seen))
        self.assertEqual(result.provenance["parameters"]["compression"]["model"]["walls"]["wall"]["young"], 7.2e9)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "curve.csv")
            self.assertEqual(result.save_curve(path), path)
            table = np.genfromtxt(path, delimiter=",", names=True)
            np.testing.assert_array_equal(table["stress"], result.stress)
            with self.assertRaises(FileExistsError):
                result.save_curve(path)
            self.assertTrue(os.path.getsize(result.save(os.path.join(folder, "p.vtp"))) > 0)

    def test_goes_on(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "run.h5")
            keeps = {"checkpoint": path, "checkpoint_every": 400}

            def stop(share, _text):
                return share <= 0  # the first time that it is told anything

            with self.assertRaises(lamella.Cancelled):
                lamella.compression(tissue(), **QUICK, **keeps, progress=stop)
            with self.assertRaisesRegex(FileExistsError, "continue_from"):
                lamella.compression(tissue(), **QUICK, **keeps)
            result = lamella.compression(tissue(), **QUICK, **keeps, continue_from=path)
            self.assertGreater(result.continued_at, 0)
            self.assertEqual(result.last_checkpoint, result.statistics["steps"])
            whole = lamella.compression(tissue(), **QUICK)
            # points were sorted anew where it was interrupted: round-off, grown by what vibrates
            np.testing.assert_allclose(result.stress, whole.stress, rtol=1e-3)

    def test_stiffness(self):
        result = lamella.point_stiffness(tissue())
        self.assertEqual(list(result.constants), ["E_x", "nu_xy", "E_y", "nu_yx"])
        self.assertEqual(result.stiffness.shape, (2, 2))
        self.assertAlmostEqual(result.stiffness[0, 1] / result.stiffness[1, 0], 1, places=9)
        self.assertLess(result.statistics["residual"], 1e-6)
        tensor = lamella.point_stiffness(tissue(), sides="periodic", young={"wall": 3.6e9})
        self.assertEqual(tensor.components, ["xx", "yy", "xy"])
        self.assertEqual(lamella.point_stiffness(tissue(), sides="open").stiffness.size, 0)
        self.assertIn("E_x", repr(result))
        held = lamella.point_stiffness(tissue(), plane="plane-strain", points_per_node=3, cells_per_node=2)
        # plane stress over 1 - nu^2, but for the finer grid and points, which change walls of three pixels by a few per cent
        self.assertAlmostEqual(held.constants["E_y"] / result.constants["E_y"] * 0.91, 1, delta=0.1)

    def test_mistakes(self):
        for words, options in (
            ("strain 1 is not below 1", {"strain": 1}),
            ("poisson 1.5 is not below 1", {"poisson": 1.5}),
            ("no point array 'axis'", {"law": "orthotropic"}),
            ("all 368 nodes are void", {"void": ["lumen", "wall"]}),
            ("largest stable one is", {"time_step": 1.0}),
        ):
            with self.assertRaisesRegex(lamella.LamellaError, words):
                lamella.compression(tissue(), **{**QUICK, **options})
        with self.assertRaisesRegex(ValueError, "sides 'stuck' is none of its choices"):
            lamella.compression(tissue(), sides="stuck")
        with self.assertRaisesRegex(ValueError, "a field is 'strain'"):
            lamella.compression(tissue(), fields="strain")  # as it was called before
        with self.assertRaisesRegex(ValueError, "density is nan; it is above 0"):
            lamella.compression(tissue(), density=float("nan"))
        with self.assertRaises(lamella.Cancelled):
            lamella.point_stiffness(tissue(), progress=lambda share, text: False)


if __name__ == "__main__":
    unittest.main()
