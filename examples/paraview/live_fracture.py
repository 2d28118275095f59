"""Cemented grains that break live in ParaView: the sample, its broken bonds in order, the curve.

    PYTHONPATH=build/python paraview --script examples/paraview/live_fracture.py
    PYTHONPATH=build/python pvpython examples/paraview/live_fracture.py fracture.png

In the window change a number of BondFracture1 (Stop Share, Young's modulus, State, a field) and press Apply. Only what
depends on it is computed again: another state or field takes no time, another material breaks the sample anew but does
not pack it again. LAMELLA_SCALE=0.5 in the environment halves the sample.
"""

import os
import sys

import lamella
import paraview.simple as pv

lamella.load_plugin()
lamella.load_presets()
scale = float(os.environ.get("LAMELLA_SCALE", 1))

grains = pv.GrainPacking(Count=int(200 * scale), Softness=1e-4)
cemented = pv.MatrixBridges(Input=grains, Saturation=0.5, NodesAcross=int(200 * scale))
torn = pv.BondFracture(Input=cemented, StatesAtBroken=[50, 200], ComputeStress=1)
lamella.use_preset(torn, "cemented grains")

layout = pv.CreateLayout("Fracture")
left, right = layout.SplitHorizontal(0, 0.5), 2
view = pv.CreateView("RenderView")
layout.AssignView(left, view)
view.InteractionMode = "2D"
view.OrientationAxesVisibility = 0
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
sample = pv.Show(pv.OutputPort(torn, 0), view, "UniformGridRepresentation")
sample.SetRepresentationType("Slice")
pv.ColorBy(sample, ("POINTS", "phase"))
phases = pv.GetColorTransferFunction("phase")
phases.InterpretValuesAsCategories = 1
phases.Annotations = ["0", "void", "1", "matrix", "2", "grain"]
phases.ApplyPreset("Lamella Phases", True)
bonds = pv.Show(pv.OutputPort(torn, 1), view)
bonds.PointSize = 4
pv.ColorBy(bonds, ("POINTS", "event"))
order = pv.GetColorTransferFunction("event")
order.ApplyPreset("Inferno (matplotlib)", True)
bonds.SetScalarBarVisibility(view, True)
bar = pv.GetScalarBar(order, view)
bar.Title, bar.ComponentTitle = "broken bonds, in order", ""
bar.TitleColor = bar.LabelColor = [0, 0, 0]
bar.TitleFontSize, bar.LabelFontSize = 12, 10
bar.WindowLocation = "Lower Right Corner"
pv.ResetCamera(view)

chart = pv.CreateView("XYChartView")
layout.AssignView(right, chart)
pv.Show(pv.OutputPort(torn, 2), chart)

pv.SetActiveView(view)
pv.SetActiveSource(torn)
pv.RenderAllViews()
if len(getattr(sys, "argv", [])) > 1 and sys.argv[1].endswith(".png"):
    pv.SaveScreenshot(sys.argv[1], layout, ImageResolution=[1200, 800], FontScaling="Do not scale fonts")
