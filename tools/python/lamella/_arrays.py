"""Between VTK images and numpy arrays in the order of pictures."""

from __future__ import annotations

import json
from ._types import Any

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


def checked(values, what, remedy):
    """The values as a numpy array of numbers that VTK knows, in the machine's byte order."""
    if np.ma.isMaskedArray(values) and np.ma.count_masked(values) > 0:
        raise ValueError(
            f"{what} is a masked array with {np.ma.count_masked(values)} values masked; fill them: values.filled(0)")
    array = np.asarray(values)
    if array.ndim == 0 and array.dtype.kind not in "biuf":
        raise ValueError(f"{what} is of type {type(values).__name__}; give an array of numbers, or what lamella makes")
    if array.dtype.kind not in "biuf" or array.dtype.itemsize > 8 or array.dtype == np.float16:
        raise ValueError(f"{what} is of type {array.dtype}; {remedy}")
    if array.dtype == bool:
        array = array.view(np.uint8)
    return array if array.dtype.isnative else array.astype(array.dtype.newbyteorder("="))


def reals(values, what, shape=None):
    """The values as an array of doubles; an error in words where they are none. ``shape``: -1 for any length."""
    array = checked(values, what, "give real numbers").astype(float, copy=False)
    fits = shape is None or (array.ndim == len(shape) and all(n in (-1, m) for n, m in zip(shape, array.shape)))
    if not fits:
        wanted = " by ".join("n" if n == -1 else str(n) for n in shape)
        raise ValueError(f"{what} has the shape {array.shape}; give {wanted} numbers")
    return array


def to_vtk(values, name, tail=(), copy=None):
    """A VTK array of values in the order of VTK, whose last axes ``tail`` are the components.

    It shares the memory of the values where they are contiguous, and keeps it from being freed.
    """
    count = int(np.prod(tail, dtype=int))
    flat = np.ascontiguousarray(values).reshape((-1, count) if tail else -1)
    shares = np.shares_memory(flat, values) and flat.flags.writeable  # VTK takes no memory that is read-only
    if copy is False and not shares:
        why = "its rows do not lie in memory as VTK wants them" if flat.flags.writeable else "its memory is read-only"
        raise ValueError(f"{name} needs a copy: {why}; say copy=None to make one")
    if np.shares_memory(flat, values) and (copy or not shares):
        flat = flat.copy()
    array = numpy_to_vtk(flat)
    array.AddObserver("DeleteEvent", lambda *_, owner=flat: None)  # the memory lives as long as the array of VTK
    array.SetName(name)
    return array


def in_vtk_order(values, dimension):
    """Rows of a picture begin at the top, those of VTK at the bottom; volumes stay."""
    return values[::-1] if dimension == 2 else values


def to_image(phase, spacing, name="phase", copy=None):
    """An image with the point array of this name from numbers in the order of pictures; phases are whole ones.

    The image shares the memory of the numbers where its layout allows it: ``copy`` as of from_array().
    """
    remedy = "give whole numbers: values.astype(numpy.uint8)" if name == "phase" else "give real numbers"
    values = checked(phase, name, remedy)
    if name != "phase" and values.dtype.kind != "u":
        values = values.astype(float, copy=False)
    elif values.dtype.kind == "f":
        raise ValueError(f"phases are whole numbers, not {values.dtype}; {remedy}")
    if name == "phase" and values.dtype != np.uint8 and values.size > 0 and values.min() >= 0 and values.max() < 256:
        values = values.astype(np.uint8)
    if copy is False and not np.shares_memory(values, phase):
        raise ValueError(f"{name} needs a copy: its type is {np.asarray(phase).dtype}; give numpy.uint8, or say copy=None")
    return image_of(values, spacing, name, copy=copy)


def image_of(values, spacing, name, tail=(), copy=None):
    """An image with a point array of numbers in the order of pictures, whose last axes ``tail`` are the components."""
    shape = values.shape[: values.ndim - len(tail)]
    if not (np.isscalar(spacing) and np.isreal(spacing) and np.isfinite(spacing) and spacing > 0):
        raise ValueError(f"spacing is {spacing!r}; give the distance of two nodes in metres, above 0")
    if len(shape) not in (2, 3) or values.size == 0:
        raise ValueError(f"an array of shape {values.shape} is neither a picture nor a volume; give rows by columns, or z by y by x")
    nz, ny, nx = shape if len(shape) == 3 else (1, *shape)
    image = vtkImageData()
    image.SetDimensions(nx, ny, nz)
    image.SetSpacing(spacing, spacing, spacing)
    image.SetOrigin(spacing / 2, spacing / 2, spacing / 2 if nz > 1 else 0)
    image.GetPointData().SetScalars(to_vtk(in_vtk_order(values, len(shape)), name, tail, copy))
    return image


class told(property):  # pylint: disable=invalid-name
    """A property that one method of the object tells, which takes the name of a field, an array or a table.

    Its type is the hint beside its name in the class. Where that leaves no choice it says which method it is, too.

    text  its docstring
    name  what the method is given; None: the name of the property
    by    the name of the method
    """

    METHODS = {"float": "_number", "float | None": "_number", "int": "_count", "str": "_text", "list[str]": "_texts",
               "Columns": "_table", "Array": "array"}

    def __init__(self, text, name=None, by=None):
        super().__init__(self._getter())
        self.__doc__, self.name, self.by = text, name, by

    def _getter(this):  # pylint: disable=no-self-argument
        return lambda self: getattr(self, this.by)(this.name)

    def __set_name__(self, owner, name):
        hint = owner.__annotations__[name]
        self.fget.__annotations__ = {"return": hint}
        self.name, self.by = self.name or name, self.by or self.METHODS[hint]


def lines_of(data):
    """Numbers of the points of each line of poly data, an array a line."""
    cells = data.GetLines()
    ids, offsets = vtk_to_numpy(cells.GetConnectivityArray()), vtk_to_numpy(cells.GetOffsetsArray())
    return [ids[begin:end] for begin, end in zip(offsets[:-1], offsets[1:])]


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

    def _numbers(self, name):
        return numbers(self.vtk, name)

    def _number(self, name):
        return float(self._numbers(name)[0])

    def _count(self, name):
        return int(self._number(name))

    def _range(self, name):
        """Two numbers; None where they are not known."""
        low, high = self._numbers(name)
        return None if np.isnan(low) else (float(low), float(high))

    def _text(self, name):
        return text(self.vtk, name)

    def _texts(self, name):
        return texts(self.vtk, name)

    def _table(self, name):
        return columns(getattr(self, name))

    def _by_direction(self, name):
        return {axis: float(value) for axis, value in zip("xyz", self._numbers(name)) if not np.isnan(value)}

    def _axes(self, name):
        """The axes whose flag is set, as "xy"; None where there are no flags."""
        flags = self._numbers(name)
        return None if flags is None else "".join(axis for axis, flag in zip("xyz", flags) if flag)

    @property
    def provenance(self) -> dict[str, Any]:
        """Version, parameters, seed and input files as a dictionary."""
        return provenance(self.vtk)


class Answer(FieldData):
    """The same of a solver, which says what it doubts."""

    @property
    def warnings(self) -> list[str]:
        """What is doubtful about the answer, a list of sentences with their numbers."""
        return texts(self.vtk, "warnings")
