"""Solvers as live sources in ParaView: after a change only what depends on it is computed again. A run of a solver leaves its
own times in the field data: as long as they stay, nothing ran.
"""

import unittest

import lamella
import numpy as np
import paraview.simple as pv
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

lamella.load_plugin()


def numbers(source, name, port=0):
    array = servermanager.Fetch(source, idx=port).GetFieldData().GetArray(name)
    return vtk_to_numpy(array).ravel().tolist()


def field(source, name):
    return vtk_to_numpy(servermanager.Fetch(source).GetPointData().GetArray(name)).copy()


class Runs:
    """Counts the runs of an algorithm of VTK, whoever asks for them."""

    def __init__(self, proxy):
        self.count = 0
        self.source = proxy.GetClientSideObject()
        self.tag = self.source.AddObserver("EndEvent", self.ended)

    def ended(self, *_):
        self.count += 1


class Live(unittest.TestCase):
    def setUp(self):
        self.tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)

    def tearDown(self):
        for source in reversed(list(pv.GetSources().values())):
            pv.Delete(source)

    def assert_stays(self, solver, **changes):
        before = numbers(solver, "seconds")
        for name, value in changes.items():
            setattr(solver, name, value)
            solver.UpdatePipeline()
            self.assertEqual(numbers(solver, "seconds"), before, f"{name} = {value} runs the solver again")

    def assert_runs(self, solver, **changes):
        before = numbers(solver, "seconds")
        for name, value in changes.items():
            setattr(solver, name, value)
        solver.UpdatePipeline()
        self.assertNotEqual(numbers(solver, "seconds"), before)

    def test_fracture(self):
        torn = pv.BondFracture(Input=self.tissue, StatesAtBroken=[3, 6])
        torn.UpdatePipeline()
        self.assert_stays(torn, State=0, ComputeStress=1, ComputeStrainEnergy=1)
        self.assertEqual(sorted(torn.PointData.keys()),
                         ["broken", "damage", "displacement", "phase", "strain_energy", "stress"])
        other = pv.BondFracture(Input=self.tissue, StatesAtBroken=[3, 6], State=0, ComputeStress=1, ComputeStrainEnergy=1)
        other.UpdatePipeline()
        for name in ("stress", "strain_energy", "damage"):
            np.testing.assert_array_equal(field(torn, name), field(other, name))
        torn.SMProxy.UpdatePropertyInformation()
        self.assertEqual(list(torn.GetPropertyValue("StateRange")), [-1, 2])
        for proxy in (torn, other):
            proxy.ComputeStress = proxy.ComputeStrainEnergy = 0
        self.assert_stays(torn, State=2, ComputeDisplacement=0)
        self.assertEqual(sorted(torn.PointData.keys()), ["broken", "damage", "phase"])
        self.assert_stays(torn, ComputeDisplacement=1)
        self.assert_runs(torn, StopShare=0.5)

    def test_others(self):
        loaded = pv.BondEquilibrium(Input=self.tissue)
        loaded.UpdatePipeline()
        self.assert_stays(loaded, ComputeStress=1, ComputeStrainEnergy=1)
        other = pv.BondEquilibrium(Input=self.tissue, ComputeStress=1)
        other.UpdatePipeline()
        np.testing.assert_array_equal(field(loaded, "stress"), field(other, "stress"))
        self.assert_stays(loaded, ComputeStress=0)
        self.assertEqual(sorted(loaded.PointData.keys()), ["displacement", "phase", "strain_energy"])
        self.assert_runs(loaded, Strain=2e-3)
        moved = pv.BondDynamics(Input=self.tissue, StatesAtBroken=[5])
        moved.UpdatePipeline()
        self.assert_stays(moved, State=0, ComputeStress=1, ComputeVelocity=0, ComputeDisplacement=0)
        other = pv.BondDynamics(Input=self.tissue, StatesAtBroken=[5], State=0, ComputeStress=1)
        other.UpdatePipeline()
        np.testing.assert_array_equal(field(moved, "stress"), field(other, "stress"))
        pressed = pv.PointCompression(Input=self.tissue, Strain=0.02, Rows=4, FirstSpeed=0.01, ComputeStress=1)
        pressed.UpdatePipeline()
        self.assert_stays(pressed, ComputeStress=0, State=0)
        self.assertNotIn("stress", pressed.PointData.keys())
        self.assert_stays(pressed, ComputeStress=1)
        self.assertIn("stress", pressed.PointData.keys())
        self.assert_runs(pressed, ComputeVelocity=1)  # which the run was not to keep

    def test_times(self):
        # Times of a run in time come from one run, whichever is shown.
        steps = pv.LatticeBoltzmann(Input=self.tissue, EndTime=1e-7, NumberOfSteps=4)
        steps.UpdatePipeline(1e-7)
        rates = numbers(steps, "updates_per_second")
        runs = Runs(steps)
        steps.UpdatePipeline(5e-8)
        self.assertAlmostEqual(numbers(steps, "time")[0], 5e-8)
        steps.UpdatePipeline(1e-7)
        self.assertEqual(numbers(steps, "updates_per_second"), rates)
        self.assertGreater(runs.count, 0)  # it was asked, and handed on what it had

    def test_chain(self):
        # Generator, solver, filter: a change runs what stands behind it.
        torn = pv.BondFracture(Input=self.tissue)
        cracks = pv.CrackPath(Input=pv.OutputPort(torn, 1))
        cracks.UpdatePipeline()
        made, ran, followed = Runs(self.tissue), Runs(torn), Runs(cracks)
        times = numbers(torn, "seconds")

        def changed(expected):
            cracks.UpdatePipeline()
            self.assertEqual([made.count > 0, ran.count > 0, followed.count > 0], expected)
            made.count = ran.count = followed.count = 0

        cracks.MinimumLength = 0
        changed([False, False, True])
        torn.StopShare = 0.3
        changed([False, True, True])
        self.assertNotEqual(numbers(torn, "seconds"), times)
        self.tissue.SolidFraction = 0.5
        changed([True, True, True])
        changed([False, False, False])

    def test_progress_and_abort(self):
        # As the window's button does: what runs stops, the error says so, and the next Apply runs.
        torn = pv.BondFracture(Input=self.tissue)
        algorithm = torn.GetClientSideObject()
        heard = []

        def progress(caller, _event):
            heard.append((caller.GetProgress(), caller.GetProgressText()))
            caller.SetAbortExecute(1)

        tag = algorithm.AddObserver("ProgressEvent", progress)
        torn.UpdatePipeline()
        algorithm.RemoveObserver(tag)
        self.assertTrue(heard)
        self.assertEqual(servermanager.Fetch(torn, idx=2).GetNumberOfRows(), 0)
        algorithm.SetAbortExecute(0)
        torn.StopShare = 0.06
        torn.UpdatePipeline()
        self.assertGreater(servermanager.Fetch(torn, idx=2).GetNumberOfRows(), 0)


class Presets(unittest.TestCase):
    def test_colour_maps(self):
        names = lamella.load_presets()
        self.assertEqual(lamella.load_presets(), names)  # not twice
        presets = servermanager.vtkSMTransferFunctionPresets.GetInstance()
        own = [presets.GetPresetName(i) for i in range(presets.GetNumberOfPresets())]
        for name in names:
            self.assertEqual(own.count(name), 1)
            self.assertTrue(pv.GetColorTransferFunction("damage").ApplyPreset(name, True))

    def test_materials(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
        heat = pv.SteadyDiffusion(Input=tissue)
        self.assertIn("2016", lamella.use_preset(heat, "wood, vapour"))
        heat.UpdatePipeline()
        self.assertIn("concentration", heat.PointData.keys())
        expected = lamella.diffusion(servermanager.Fetch(tissue), {"wall": 0.004, "lumen": 1}, "x").effective[0, 0]
        self.assertAlmostEqual(numbers(heat, "effective_conductivity")[0] / expected, 1, places=7)
        for name in ("cemented grains", "wood that breaks"):
            torn = pv.BondFracture(Input=tissue)
            lamella.use_preset(torn, name)
        self.assertEqual(list(torn.CriticalStretches), [])
        with self.assertRaisesRegex(ValueError, "preset is 'steel'; it can be 'cemented grains'"):
            lamella.use_preset(heat, "steel")
        with self.assertRaisesRegex(ValueError, "'wood, heat' has nothing for this source; it sets Conductivities"):
            lamella.use_preset(tissue, "wood, heat")


if __name__ == "__main__":
    unittest.main(argv=["live"], verbosity=2)
