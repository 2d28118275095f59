"""Between VTK images and numpy arrays in the order of pictures."""

import json

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData


def to_numpy(image, array):
    """A point array of an image as numpy: [row, column] from the top of a picture, [z, y, x] of a volume. No copy."""
    nx, ny, nz = image.GetDimensions()
    values = vtk_to_numpy(array)
    tail = values.shape[1:]
    if nz == 1:
        return values.reshape((ny, nx) + tail)[::-1]
    return values.reshape((nz, ny, nx) + tail)


def to_image(phase, spacing, name="phase"):
    """An image with the point array of this name from numbers in the order of pictures; phases are whole ones."""
    phase = np.asarray(phase)
    if phase.ndim not in (2, 3) or phase.size == 0:
        raise ValueError(f"an array of shape {phase.shape} is neither a picture nor a volume")
    if phase.dtype == bool:
        phase = phase.astype(np.uint8)
    if name != "phase" and not np.issubdtype(phase.dtype, np.unsignedinteger):
        phase = phase.astype(float)
    elif not np.issubdtype(phase.dtype, np.integer):
        raise ValueError(f"phases are whole numbers, not {phase.dtype}")
    if phase.ndim == 2:
        phase = phase[::-1][np.newaxis]
    if name == "phase" and phase.min() >= 0 and phase.max() < 256:
        phase = phase.astype(np.uint8)
    nz, ny, nx = phase.shape
    image = vtkImageData()
    image.SetDimensions(nx, ny, nz)
    image.SetSpacing(spacing, spacing, spacing)
    image.SetOrigin(spacing / 2, spacing / 2, spacing / 2 if nz > 1 else 0)
    array = numpy_to_vtk(np.ascontiguousarray(phase).ravel(), deep=True)
    array.SetName(name)
    image.GetPointData().SetScalars(array)
    return image


def view(where, name, text):
    """A property that shows a point or cell array of ``self.vtk`` in place."""
    data = {"point": "GetPointData", "cell": "GetCellData"}[where]
    return property(lambda self: vtk_to_numpy(getattr(self.vtk, data)().GetArray(name)), doc=text)


def columns(table):
    """A vtkTable as a dictionary of columns: numpy arrays, or lists of texts."""
    found = {}
    for i in range(table.GetNumberOfColumns()):
        column = table.GetColumn(i)
        if column.IsA("vtkDataArray"):
            found[table.GetColumnName(i)] = vtk_to_numpy(column)
        else:
            found[table.GetColumnName(i)] = [column.GetValue(row) for row in range(column.GetNumberOfValues())]
    return found


def numbers(data, name):
    """Numbers of a field array, or None."""
    array = data.GetFieldData().GetArray(name)
    return None if array is None else vtk_to_numpy(array).ravel().copy()


def texts(data, name):
    """Strings of a field array; an empty list where it is missing."""
    array = data.GetFieldData().GetAbstractArray(name)
    return [] if array is None else [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def text(data, name):
    """The first string of a field array, or an empty string."""
    return (texts(data, name) or [""])[0]


def provenance(data):
    """Where an image comes from, as a dictionary."""
    return json.loads(text(data, "provenance") or "{}")


class FieldData:
    """What an object tells in the field data of ``self.vtk``."""

    def _number(self, name):
        return float(numbers(self.vtk, name)[0])

    def _count(self, name):
        return int(self._number(name))

    @property
    def provenance(self):
        """Version, parameters, seed and input files as a dictionary."""
        return provenance(self.vtk)


class Answer(FieldData):
    """The same of a solver, which says what it doubts."""

    @property
    def warnings(self):
        """What is doubtful about the answer, a list of sentences with their numbers."""
        return texts(self.vtk, "warnings")
