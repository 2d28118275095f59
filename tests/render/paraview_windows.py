"""ParaView draws with no display once Lamella's windows are installed: one rank or several.

Run by ctest in pvpython, pvbatch and mpirun -n 2 pvbatch. On several ranks the script itself runs on rank 0 only (or on
all, with --sym), so the others are told through a programmable source.
"""

import os
import sys

FOLDER = sys.argv[1]
OUTPUT = sys.argv[2]
sys.path.insert(0, FOLDER)

from lamella.vtkLamellaRendering import vtkOffScreenWindows  # noqa: E402

if not vtkOffScreenWindows.Install():
    print("SKIPPED:", vtkOffScreenWindows.GetMessage())
    sys.exit(77)

from paraview.simple import *  # noqa: E402,F403
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkIOImage import vtkPNGReader  # noqa: E402
from vtkmodules.vtkParallelCore import vtkMultiProcessController  # noqa: E402

controller = vtkMultiProcessController.GetGlobalController()
rank = controller.GetLocalProcessId()
if controller.GetNumberOfProcesses() > 1 and "--sym" not in sys.argv:
    tell = ProgrammableSource(OutputDataSetType="vtkTable")
    tell.Script = (
        f"import sys; sys.path.insert(0, {FOLDER!r})\n"
        "from lamella.vtkLamellaRendering import vtkOffScreenWindows\n"
        "vtkOffScreenWindows.Install()"
    )
    tell.UpdatePipeline()
    Delete(tell)

sphere = Sphere(Radius=1, ThetaResolution=40, PhiResolution=40)
view = CreateView("RenderView", ViewSize=[300, 200])
view.UseColorPaletteForBackground = 0
view.Background = [0, 0, 1]
view.OrientationAxesVisibility = 0
display = Show(sphere, view)
display.ColorArrayName = ["POINTS", ""]
display.AmbientColor = display.DiffuseColor = [1, 0, 0]
display.Ambient = 1
display.Diffuse = 0
display.Specular = 0
Render(view)
SaveScreenshot(OUTPUT, view, ImageResolution=[300, 200])

if rank == 0:
    reader = vtkPNGReader()
    reader.SetFileName(OUTPUT)
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions()[:2] == (300, 200), image.GetDimensions()
    colors = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(200, 300, -1)
    assert tuple(colors[100, 150][:3]) == (255, 0, 0), colors[100, 150]
    assert tuple(colors[2, 2][:3]) == (0, 0, 255), colors[2, 2]
    red = ((colors[..., 0] > 200) & (colors[..., 2] < 50)).mean()
    assert 0.1 < red < 0.6, red
    os.remove(OUTPUT)
    print("drawn with", vtkOffScreenWindows.GetBackend())
