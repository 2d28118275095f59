"""Labels of ParaView's views tell the units that the arrays carry: colour bars and axes of charts. What somebody wrote stays, and
data that tell no unit are labelled as ParaView does.
"""

import unittest

import lamella
import paraview.simple as pv

lamella.load_plugin()


class Labels(unittest.TestCase):
    def setUp(self):
        self.tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)

    def tearDown(self):
        pv.Disconnect()
        pv.Connect()

    def bar(self, source, *array):
        view = pv.CreateView("RenderView")
        shown = pv.Show(source, view)
        pv.ColorBy(shown, ("POINTS", *array))
        shown.SetScalarBarVisibility(view, True)
        found = pv.GetScalarBar(pv.GetColorTransferFunction(array[0]), view)
        return found, shown, view

    def chart(self, source, port):
        view = pv.CreateView("XYChartView")
        shown = pv.Show(pv.OutputPort(source, port), view)
        pv.Render(view)
        return view, shown

    def test_colour_bars(self):
        loaded = pv.BondEquilibrium(Input=self.tissue, ComputeStress=1, ComputeStrainEnergy=1)
        energy, _, _ = self.bar(loaded, "strain_energy")
        self.assertEqual((energy.Title, energy.ComponentTitle), ("strain_energy (J/m³)", ""))
        way, shown, view = self.bar(loaded, "displacement", "Magnitude")
        self.assertEqual((way.Title, way.ComponentTitle), ("displacement", "Magnitude (m)"))
        pv.ColorBy(shown, ("POINTS", "displacement", "X"))
        pv.UpdateScalarBarsComponentTitle(pv.GetColorTransferFunction("displacement"), shown)
        self.assertEqual(way.ComponentTitle, "X (m)")
        stress, _, _ = self.bar(loaded, "stress", "XX")
        self.assertEqual((stress.Title, stress.ComponentTitle), ("stress", "XX (Pa)"))
        stress.Title, stress.ComponentTitle = "pull", ""
        pv.Render(view)
        self.assertEqual((stress.Title, stress.ComponentTitle), ("pull", ""))
        phase, _, _ = self.bar(loaded, "phase")
        self.assertEqual(phase.Title, "phase")  # a number

    def test_charts(self):
        torn = pv.BondFracture(Input=self.tissue)
        view, curve = self.chart(torn, 2)
        self.assertEqual((view.BottomAxisTitle, view.LeftAxisTitle), ("strain", "stress (Pa)"))
        curve.SeriesVisibility = ["stress", "1", "critical_stress", "1"]
        pv.Render(view)
        self.assertEqual(view.LeftAxisTitle, "stress, critical_stress (Pa)")
        curve.SeriesVisibility = ["stress", "1", "broken", "1"]
        pv.Render(view)
        self.assertEqual(view.LeftAxisTitle, "stress (Pa), broken")
        curve.XArrayName = "broken"
        view.LeftAxisTitle = "pull"
        curve.SeriesVisibility = ["stress", "1"]
        pv.Render(view)
        self.assertEqual((view.BottomAxisTitle, view.LeftAxisTitle), ("broken", "pull"))

    def test_data_of_others(self):
        wavelet = pv.Wavelet()
        found, _, _ = self.bar(wavelet, "RTData")
        self.assertEqual(found.Title, "RTData")
        view, _ = self.chart(pv.PlotOverLine(Input=wavelet), 0)
        self.assertEqual((view.BottomAxisTitle, view.LeftAxisTitle), ("", ""))


if __name__ == "__main__":
    unittest.main(argv=["labels"], verbosity=2)
