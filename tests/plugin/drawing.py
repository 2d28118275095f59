"""ParaView draws with no display once the package is imported; in pvbatch on several ranks, too."""

import os
import sys

import lamella

from paraview.simple import *  # noqa: F403 - ParaView's way
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

lamella.load_plugin(globals())
if os.environ.get("DISPLAY"):
    sys.exit("this test is to run without DISPLAY")

tissue = MicrostructureSource(Size=[120, 100, 1])  # noqa: F405
heat = SteadyDiffusion(Input=tissue)  # noqa: F405
flux = FluxMap(Input=heat, NumberOfStreamlines=20)  # noqa: F405
view = CreateView("RenderView")  # noqa: F405
view.ViewSize = [400, 300]
view.Background = [1, 1, 1]
view.UseColorPaletteForBackground = 0
view.OrientationAxesVisibility = 0
shown = Show(OutputPort(flux, 0), view)  # noqa: F405
shown.SetScalarBarVisibility(view, False)
lines = Show(OutputPort(flux, 1), view)  # noqa: F405
lines.SetScalarBarVisibility(view, False)
ColorBy(lines, None)  # noqa: F405
lines.AmbientColor = lines.DiffuseColor = [0, 1, 0]
view.InteractionMode = "2D"
ResetCamera(view)  # noqa: F405
name = f"drawing-{os.getpid()}.png"
SaveScreenshot(name, view)  # noqa: F405

reader = vtkPNGReader()
reader.SetFileName(name)
reader.Update()
pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)
os.remove(name)
red, green, blue = pixels.T[:3]
white = (pixels.min(axis=1) > 250).mean()
green_lines = ((green > 150) & (red < 100) & (blue < 100)).mean()
cold = ((blue > 120) & (red < 110) & (green < 110)).mean()  # lumens carry little
print(f"white {white:.2f}, cold {cold:.2f}, lines {green_lines:.3f}")
# The box is 120 : 100 in a view of 4 : 3 and fills most of it; two fifths of it are walls; some pixels are lines.
assert 0.2 < white < 0.7, "the background is not as large as it should be"
assert cold > 0.1, "the map is not there"
assert green_lines > 0.01, "the streamlines are not there"
