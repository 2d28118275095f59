"""Samples without their ends, for platens that hold whatever lies there instead of grains that only touch them."""

import lamella
from vtkmodules.vtkImagingCore import vtkExtractVOI


def without_ends(sample, length):
    """Cut off that much [m] at both ends of the last axis."""
    whole = sample.vtk
    extent = list(whole.GetExtent())
    axis = 2 if extent[5] > extent[4] else 1
    layers = round(length / whole.GetSpacing()[axis])
    extent[2 * axis] += layers
    extent[2 * axis + 1] -= layers
    part = vtkExtractVOI()
    part.SetInputData(whole)
    part.SetVOI(*extent)
    part.Update()
    image = part.GetOutput()
    image.GetFieldData().ShallowCopy(whole.GetFieldData())
    return lamella.Sample(image)
