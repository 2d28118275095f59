"""An open-cell foam: what a dense packing of spheres leaves, once they have grown until neighbours open into each other."""

import lamella
import numpy as np
from scipy import ndimage
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

DIAMETER = 0.5e-3  # mean one of the spheres before they grow [m]
REACH = 1.5  # radii: no node of a dense packing is further than that from its nearest sphere


class Foam:
    """A foam on a lattice.

    nodes     along x
    count     pores
    aspect    height over width
    porosity  share of the nodes; spheres have grown by the same length until it is met
    seed      of the packing, which repeats itself: the box's faces cut pores as they come
    """

    def __init__(self, nodes, count, aspect, porosity, seed):
        packing = lamella.packing(count=count, dimension=3, mean_diameter=DIAMETER, diameter_ratio=1.3, aspect=aspect, periodic=True,
                                  seed=seed)
        self.spacing = packing.box[0] / nodes
        inside = depth(packing, self.spacing)
        level = np.quantile(inside, 1 - porosity)
        self.growth = -level / float(np.mean(packing.radii))
        distance = level - inside  # to the pores, above 0 in the solid
        parts, _ = ndimage.label(distance > 0)
        sizes = np.bincount(parts.ravel())
        sizes[0] = 0
        loose = (distance > 0) & (parts != sizes.argmax())  # crumbs of a node or a few that nothing holds
        self.loose = float(loose.sum() / sizes.sum())
        distance[loose] = -0.5 * self.spacing
        self.distance = distance
        self.sample = lamella.from_array((distance > 0).astype(np.uint8), names=["void", "solid"], spacing=self.spacing)
        self.solid = float((distance > 0).mean())

    def surface(self):
        """Of the solid, closed where the box cuts it: vtkPolyData, metres."""
        edge = np.pad(self.distance, 1, mode="edge")
        inner = np.zeros(edge.shape, bool)
        inner[1:-1, 1:-1, 1:-1] = True
        padded = np.where(inner, edge, -np.abs(edge))  # so that the level lies half a spacing beyond the outer nodes
        image = vtkImageData()
        image.SetDimensions(*padded.shape[::-1])
        image.SetSpacing(*[self.spacing] * 3)
        image.SetOrigin(*[-self.spacing / 2] * 3)
        values = numpy_to_vtk(padded.ravel(), deep=True)
        values.SetName("distance")
        image.GetPointData().SetScalars(values)
        contour = vtkFlyingEdges3D()
        contour.SetInputData(image)
        contour.SetValue(0, 0)
        contour.ComputeScalarsOff()
        contour.ComputeNormalsOff()
        contour.Update()
        return contour.GetOutput()


def depth(packing, spacing):
    """How deep each node of the box lies in the sphere it is deepest in [m], below 0 outside of all: array [z, y, x]."""
    counts = np.round(packing.box / spacing).astype(int)
    steps = packing.box / counts  # the spacing but for rounding: it has to fit into a period
    deepest = np.full(counts[::-1], -np.inf)
    for centre, radius in zip(packing.centres, packing.radii):
        index, squares = [], []
        for axis in range(3):
            low, high = ((centre[axis] + side * REACH * radius) / steps[axis] - 0.5 for side in (-1, 1))
            i = np.arange(int(np.floor(low)), int(np.ceil(high)) + 1)
            index.append(i % counts[axis])
            squares.append(((i + 0.5) * steps[axis] - centre[axis]) ** 2)
        distance = np.sqrt(squares[2][:, None, None] + squares[1][:, None] + squares[0])
        where = np.ix_(*index[::-1])
        deepest[where] = np.maximum(deepest[where], radius - distance)
    return np.maximum(deepest, -REACH * float(np.max(packing.radii)))
