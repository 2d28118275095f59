"""Files of all formats: read, written, converted."""

from __future__ import annotations

import os
import re

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkDataSet, vtkImageData, vtkTable

from . import _arrays
from ._errors import Cancelled, LamellaError, run
from ._settings import Settings, declared
from ._types import ArrayLike, Columns, HasImage, Iterator, Path, Progress
from .vtkLamellaConvert import vtkFileConverter


def _in_words_of_python(text):
    """The program's message, with arguments for options: ``--raw-size NX,NY,NZ`` is ``raw_size``."""
    text = re.sub(r"--([a-z][a-z-]*)", lambda found: found[1].replace("-", "_"), text)
    return re.sub(r"(^|\s)-o\s", r"\1", text)


def _converter(source, settings):
    converter = vtkFileConverter()
    if source is not None:
        converter.SetFileName(os.fspath(source))
    settings.give(converter)
    return converter


def _write(converter, path, progress):
    converter.SetOutputFileName(os.fspath(path))
    _run(converter, progress)
    files = converter.GetFiles()
    return [files.GetValue(i) for i in range(files.GetNumberOfValues())]


def _run(converter, progress):
    try:
        run(converter, progress)
    except Cancelled:
        raise
    except LamellaError as error:
        if " exists already" in error.message:
            raise FileExistsError(f"{error.message}; {_in_words_of_python(error.hint)}") from None
        raise type(error)(_in_words_of_python(error.message), _in_words_of_python(error.hint)) from None


_NAMES = ("source", "path")  # parameters of the functions themselves
_SURFACE = ("phase", "smooth")
_RAW = ("pixel_size", "raw_size", "raw_bits", "raw_header", "raw_type", "raw_order")


@declared(vtkFileConverter, first=("array", "step", "type", "range", "lossy"), without=_NAMES)
def convert(source: Path, path: Path, settings: Settings, progress: Progress | None = None) -> list[str]:
    """Converts a file to another format as ``lamella convert`` does, a slab at a time, and returns the files written.

    source          a file, a folder or pattern of slices (slice_%04d.png), a .pvd, or a pattern of steps (step_*.vti)
    path            the file to write; its ending tells the format. A pattern for slices or steps
    progress        called as progress(share, text); return False to cancel (raises Cancelled), nothing is left then
    """
    return _write(_converter(source, settings), path, progress)


@declared(vtkFileConverter, first=("array", "step", "lossy"), without=(*_NAMES, *_SURFACE, "type", "range", "overwrite"))
def read(path: Path, settings: Settings, progress: Progress | None = None) -> vtkDataObject:
    """Reads a file of any format of ``lamella convert`` into a vtkImageData, vtkPolyData, vtkUnstructuredGrid or vtkTable.

    Units, phases' names and provenance are with it; ``lamella.arrays(data)`` gives its numbers. Every function that takes
    an image takes what this returns.

    path            a file, a folder or pattern of slices (slice_%04d.png), a .pvd, or a pattern of steps (step_*.vti)
    """
    converter = _converter(path, settings)
    _run(converter, progress)
    return converter.GetOutput()


@declared(vtkFileConverter, first=("array", "lossy"), without=(*_NAMES, *_RAW, *_SURFACE, "step", "type", "range", "overwrite"))
def read_steps(path: Path, settings: Settings, progress: Progress | None = None) -> Iterator[tuple[float, vtkDataObject]]:
    """Reads a series step by step, one in memory at a time: ``for time, data in lamella.read_steps("run.pvd")``.

    The time is the step's number where nothing tells it.

    path            a .pvd, or a pattern of steps (step_*.vti)
    progress        as of ``lamella.read``
    """
    return _steps(path, settings, progress)


def _steps(path, settings, progress):
    number, steps = 0, 1
    while number < steps:
        converter = _converter(path, settings)
        converter.SetStep(number)
        _run(converter, progress)
        steps = converter.GetNumberOfSteps()
        data = converter.GetOutput()
        time = _arrays.numbers(data, "TimeValue")
        yield float(number if time is None else time[0]), data
        number += 1


@declared(vtkFileConverter, first=("array", "type", "range", "lossy"), without=(*_NAMES, *_RAW, "step"))
def write(
    data: HasImage | vtkDataObject | ArrayLike,
    path: Path,
    settings: Settings,
    spacing: float = 1.0,
    name: str = "values",
    vectors: bool = False,
    progress: Progress | None = None,
) -> list[str]:
    """Writes data to a file of any format of ``lamella convert``, whole or not at all, and returns the files written.

    data            a Sample, a result, a vtkImageData, vtkPolyData, vtkUnstructuredGrid or vtkTable, or an array in the
                    order of pictures: rows by columns, or z by y by x
    path            the file; its ending tells the format. A pattern for slices (slice_%04d.png)
    spacing         of an array: distance of two nodes [m]
    name            of an array: what it is called
    vectors         of an array: its last axis is that of components, such as red, green and blue
    progress        as of ``lamella.convert``
    """
    if hasattr(data, "vtk"):
        data = data.vtk
    if not isinstance(data, vtkDataObject):
        given = _arrays.checked(data, "the array", "give numbers of 1, 2, 4 or 8 bytes")
        data = _arrays.image_of(given, spacing, name, given.shape[-1:] if vectors else ())
    converter = _converter(None, settings)
    converter.SetInputData(data)
    return _write(converter, path, progress)


def arrays(data: HasImage | vtkDataObject, cells: bool = False) -> Columns:
    """The arrays of data by name: of an image in the order of pictures, of points one row each, of a table its columns.

    They are views of VTK's memory: nothing is copied. Texts are lists.

    data   what ``lamella.read`` gives, a Sample or a result
    cells  those in cells instead of those at points
    """
    data = getattr(data, "vtk", data)
    if isinstance(data, vtkTable):
        return _arrays.columns(data)
    if not isinstance(data, vtkDataSet):
        raise TypeError(f"data is a {data.__class__.__name__}; it can be a Sample, a result, a vtkDataSet or a vtkTable")
    held = data.GetCellData() if cells else data.GetPointData()
    found = {}
    for i in range(held.GetNumberOfArrays()):
        one = held.GetAbstractArray(i)
        if not one.IsA("vtkDataArray"):
            found[one.GetName()] = [one.GetValue(k) for k in range(one.GetNumberOfValues())]
        elif isinstance(data, vtkImageData) and not cells:
            found[one.GetName()] = _arrays.to_numpy(data, one)
        else:
            found[one.GetName()] = vtk_to_numpy(one)
    return found
