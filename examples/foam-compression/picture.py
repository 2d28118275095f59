"""Pictures of a surface that material points carry along, with no display."""

import lamella  # noqa: F401 - lets VTK draw where there is no display
import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - what windows and mappers are made of
from matplotlib import pyplot as plt
from scipy.spatial import cKDTree
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

NEIGHBOURS = 4
AZIMUTH, ELEVATION = 35, 9  # where it is looked at from [degrees]
MARGIN = 1.1  # of what is seen, over the box at the start


class Carried:
    """A surface of the body at the start, each vertex carried by the points nearest to it: x = x_p + F_p (X - X_p)."""

    def __init__(self, surface, start):
        """The surface: vtkPolyData, metres. The state at the start: its points' deformations do not matter."""
        self.surface = surface
        self.vertices = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
        self.begun = start.positions - start.array("displacement")
        distances, self.nearest = cKDTree(self.begun).query(self.vertices, NEIGHBOURS)
        weights = 1 / np.maximum(distances, 1e-6 * distances.max()) ** 2
        self.weights = weights / weights.sum(axis=1, keepdims=True)

    def at(self, state):
        """(vtkPolyData, the stress zz of each vertex [Pa], tension positive) in a state of the same points."""
        places, gradients, stress = state.positions, state.array("deformation_gradient").reshape(-1, 3, 3), state.array("stress")
        moved, carried = np.zeros_like(self.vertices), np.zeros(len(self.vertices))
        for k in range(NEIGHBOURS):
            i, weight = self.nearest[:, k], self.weights[:, k]
            moved += weight[:, None] * (places[i] + np.einsum("nij,nj->ni", gradients[i], self.vertices - self.begun[i]))
            carried += weight * stress[i, 2]
        shape = vtkPolyData()
        shape.SetPoints(vtkPoints())
        shape.GetPoints().SetData(numpy_to_vtk(moved, deep=True))
        shape.SetPolys(self.surface.GetPolys())
        return shape, carried


def actor_of(data, colour=None, ambient=0.3):
    mapper = vtkPolyDataMapper()
    mapper.SetInputDataObject(data)
    actor = vtkActor()
    actor.SetMapper(mapper)
    if colour is None:
        mapper.SetColorModeToDirectScalars()
    else:
        mapper.ScalarVisibilityOff()
        actor.GetProperty().SetColor(*colour)
    actor.GetProperty().SetAmbient(ambient)
    actor.GetProperty().SetDiffuse(1 - ambient)
    return actor


def platens(shape, bounds):
    """Plates where the body begins and ends along z, a little wider than it was at the start."""
    low, high = shape.GetBounds()[4:]
    thick, wider = 0.02 * (bounds[5] - bounds[4]), 0.04 * (bounds[1] - bounds[0])
    for bottom in (low - thick, high):
        plate = vtkCubeSource()
        plate.SetBounds(bounds[0] - wider, bounds[1] + wider, bounds[2] - wider, bounds[3] + wider, bottom, bottom + thick)
        plate.Update()
        yield plate.GetOutput()


def render(carried, bounds, limit, pixels):
    """A state as an array of colours [row, column, 3]: red where pressed by ``limit`` [Pa] or more, blue where pulled.

    bounds  of the body at the start: what is seen is the same for all states
    pixels  across
    """
    shape, stress = carried
    rgba = plt.get_cmap("RdBu_r")(0.5 - 0.5 * np.clip(stress / limit, -1, 1), bytes=True)
    colours = numpy_to_vtk(np.ascontiguousarray(rgba[:, :3]), deep=True)
    colours.SetName("colour")
    shape.GetPointData().SetScalars(colours)
    smooth = vtkPolyDataNormals()
    smooth.SetInputData(shape)
    smooth.SetFeatureAngle(50)
    smooth.Update()
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor_of(smooth.GetOutput()))
    for plate in platens(shape, bounds):
        renderer.AddActor(actor_of(plate, (0.8, 0.8, 0.8), 0.7))

    size = np.array([bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4]])
    middle = np.array([bounds[0] + bounds[1], bounds[2] + bounds[3], bounds[4] + bounds[5]]) / 2
    azimuth, elevation = np.radians([-AZIMUTH, ELEVATION])
    towards = np.array([np.cos(elevation) * np.sin(azimuth), -np.cos(elevation) * np.cos(azimuth), np.sin(elevation)])
    wide = MARGIN * (size[0] * np.cos(azimuth) + size[1] * abs(np.sin(azimuth)))
    high = MARGIN * (size[2] * np.cos(elevation) + (size[0] * abs(np.sin(azimuth)) + size[1] * np.cos(azimuth)) * np.sin(elevation))
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetParallelScale(high / 2)
    camera.SetFocalPoint(*middle)
    camera.SetPosition(*(middle + 3 * np.linalg.norm(size) * towards))
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCameraClippingRange()
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(2 * pixels, round(2 * pixels * high / wide))  # twice as large, then halved: smooth edges
    window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    columns, rows, _ = image.GetDimensions()
    seen = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, 3)[::-1]
    rows, columns = rows // 2, columns // 2
    return seen[: 2 * rows, : 2 * columns].reshape(rows, 2, columns, 2, 3).mean(axis=(1, 3)).astype(np.uint8)
