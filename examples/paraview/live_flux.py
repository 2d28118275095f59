"""Heat through wood, live in ParaView: the flux and its lines.

    PYTHONPATH=build/python paraview --script examples/paraview/live_flux.py
    PYTHONPATH=build/python pvpython examples/paraview/live_flux.py flux.png

In the window change the wood (MicrostructureSource1), the conductivities (SteadyDiffusion1) or the number of lines
(FluxMap1) and press Apply: the solver only runs again for the first two. ``lamella.use_preset(GetActiveSource(), "wood,
vapour")`` in ParaView's Python shell makes it vapour. LAMELLA_SCALE=0.5 in the environment halves the sample.
"""

import os
import sys

import lamella
import paraview.simple as pv

lamella.load_plugin()
size = int(300 * float(os.environ.get("LAMELLA_SCALE", 1)))

wood = pv.MicrostructureSource(Size=[size, size, 1])
heat = pv.SteadyDiffusion(Input=wood)
lamella.use_preset(heat, "wood, heat")
flux = pv.FluxMap(Input=heat, NumberOfStreamlines=40)

view = pv.GetActiveViewOrCreate("RenderView")
view.InteractionMode = "2D"
view.OrientationAxesVisibility = 0
view.UseColorPaletteForBackground, view.Background = 0, [1, 1, 1]
field = pv.Show(pv.OutputPort(flux, 0), view, "UniformGridRepresentation")
field.SetRepresentationType("Slice")
pv.ColorBy(field, ("POINTS", "flux_magnitude"))
magnitude = pv.GetColorTransferFunction("flux_magnitude")
magnitude.ApplyPreset("Inferno (matplotlib)", True)
field.SetScalarBarVisibility(view, True)
bar = pv.GetScalarBar(magnitude, view)
bar.Title = "flux [W/m²]"
bar.TitleFontSize, bar.LabelFontSize = 20, 18
bar.TitleColor = bar.LabelColor = [0, 0, 0]
bar.AutomaticLabelFormat, bar.LabelFormat, bar.RangeLabelFormat = 0, "%.0f", "%.0f"
lines = pv.Show(pv.OutputPort(flux, 1), view)
pv.ColorBy(lines, None)
lines.AmbientColor = lines.DiffuseColor = [0.6, 0.9, 1]
pv.ResetCamera(view)
pv.SetActiveSource(flux)
pv.Render(view)
if len(getattr(sys, "argv", [])) > 1 and sys.argv[1].endswith(".png"):
    pv.SaveScreenshot(sys.argv[1], view, ImageResolution=[900, 800], FontScaling="Do not scale fonts")
