"""Labels of ParaView's views tell the units that the arrays carry: colour bars and axes of charts. What somebody wrote stays, and
data that tell no unit are labelled as ParaView does. Every array of ours tells one.
"""

import unittest

import lamella
import paraview.simple as pv
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkCommonDataModel import vtkDataObject

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

    def test_every_array_tells_its_unit(self):
        heat = pv.SteadyDiffusion(Input=self.tissue)
        loaded = pv.BondEquilibrium(Input=self.tissue, ComputeStress=1, ComputeStrainEnergy=1)
        torn = pv.BondFracture(Input=self.tissue, ComputeStress=1)
        pressed = pv.PointCompression(Input=self.tissue, Strain=0.02, Rows=4, FirstSpeed=0.01, ComputeStress=1, ComputeVelocity=1,
                                      ComputeDeformationGradient=1)
        grains = pv.GrainPacking(Count=30)
        outlines = pv.MicrographContours(Input=self.tissue)
        sources = [
            self.tissue, heat, pv.FluxMap(Input=heat), pv.LatticeBoltzmann(Input=self.tissue, EndTime=1e-4), pv.PoreFloodFill(Input=self.tissue),
            loaded, pv.StressPDF(Input=loaded), torn, pv.CrackPath(Input=pv.OutputPort(torn, 1), Image=torn),
            pv.BondDynamics(Input=self.tissue, StatesAtBroken=[5]), pv.BondStiffness(Input=self.tissue), pressed,
            pv.VoxelStiffness(Input=self.tissue, MeanStrains=["xx", "0.01"]),
            pv.CompressionCurve(Input=pv.OutputPort(pressed, 1)), pv.CollapseMap(Input=self.tissue, Points=pressed),
            pv.PointStiffness(Input=self.tissue), grains, pv.MatrixBridges(Input=grains), outlines, pv.MicrographLattice(Input=outlines),
            pv.OutlineDiffusion(Input=outlines)]
        for source in sources:
            source.UpdatePipeline()
            algorithm = source.GetClientSideObject()
            for data in map(algorithm.GetOutputDataObject, range(algorithm.GetNumberOfOutputPorts())):
                for kind in (vtkDataObject.POINT, vtkDataObject.CELL, vtkDataObject.ROW):
                    arrays = data.GetAttributesAsFieldData(kind)
                    if arrays is None or arrays.HasArray("unit"):  # a column that tells each row's
                        continue
                    for array in filter(None, map(arrays.GetArray, range(arrays.GetNumberOfArrays()))):
                        with self.subTest(f"{algorithm.GetClassName()}: {array.GetName()}"):
                            self.assertTrue(array.GetInformation().Get(vtkDataArray.UNITS_LABEL()))

    def test_data_of_others(self):
        wavelet = pv.Wavelet()
        found, _, _ = self.bar(wavelet, "RTData")
        self.assertEqual(found.Title, "RTData")
        view, _ = self.chart(pv.PlotOverLine(Input=wavelet), 0)
        self.assertEqual((view.BottomAxisTitle, view.LeftAxisTitle), ("", ""))


if __name__ == "__main__":
    unittest.main(argv=["labels"], verbosity=2)
