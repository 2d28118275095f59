"""Files of all formats: read, written, converted."""

from __future__ import annotations

import os
import re

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkDataSet, vtkImageData, vtkTable

from . import _arrays
from ._errors import Cancelled, LamellaError, run
from ._types import ArrayLike, Columns, HasImage, Iterator, Path, Progress, Sequence
from .vtkLamellaConvert import vtkFileConverter


def _in_words_of_python(text):
    """The program's message, with arguments for options: ``--raw-size NX,NY,NZ`` is ``raw_size``."""
    text = re.sub(r"--([a-z][a-z-]*)", lambda found: found[1].replace("-", "_"), text)
    return re.sub(r"(^|\s)-o\s", r"\1", text)


def _converter(source=None, array=None, step=None, type=None, range=None, lossy=False, pixel_size=None,  # pylint: disable=redefined-builtin
               raw_size=None, raw_type=None, raw_order=None, raw_header=0, phase=None, smooth=0):
    converter = vtkFileConverter()
    if source is not None:
        converter.SetFileName(os.fspath(source))
    for name in [array] if isinstance(array, str) else array or ():
        converter.AddArray(name)
    for name in [phase] if isinstance(phase, str) else phase or ():
        converter.AddPhase(name)
    converter.SetSmoothing(int(smooth))
    if step is not None:
        if step < 0:
            raise ValueError(f"step is {step}; steps count from 0")
        converter.SetStep(step)
    converter.SetNumberType(type or "")
    if range is not None:
        low, high = range
        converter.SetRange(float(low), float(high))
    converter.SetLossy(bool(lossy))
    if pixel_size is not None:
        if not pixel_size > 0:
            raise ValueError(f"pixel_size is {pixel_size!r}; give the edge of a pixel in metres, above 0")
        converter.SetPixelSize(float(pixel_size))
    if raw_size is not None:
        converter.SetRawSize(*(int(n) for n in (*raw_size, 1)[:3]))
    converter.SetRawType(raw_type or "")
    converter.SetRawOrder(raw_order or "")
    converter.SetRawHeader(int(raw_header))
    return converter


def _write(converter, path, overwrite, progress):
    converter.SetOutputFileName(os.fspath(path))
    converter.SetOverwrite(bool(overwrite))
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
        raise LamellaError(_in_words_of_python(error.message), _in_words_of_python(error.hint)) from None


def convert(
    source: Path,
    path: Path,
    array: str | Sequence[str] | None = None,
    step: int | None = None,
    type: str | None = None,  # pylint: disable=redefined-builtin
    range: Sequence[float] | None = None,  # pylint: disable=redefined-builtin
    lossy: bool = False,
    pixel_size: float | None = None,
    raw_size: Sequence[int] | None = None,
    raw_type: str | None = None,
    raw_order: str | None = None,
    raw_header: int = 0,
    phase: str | Sequence[str] | None = None,
    smooth: int = 0,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> list[str]:
    """Converts a file to another format as ``lamella convert`` does, a slab at a time, and returns the files written.

    source      a file, a folder or pattern of slices (slice_%04d.png), a .pvd, or a pattern of steps (step_*.vti)
    path        the file to write; its ending tells the format. A pattern for slices or steps
    array       names of the arrays to keep; None: all
    step        of a series: this step, counted from 0; None: all
    type        of numbers: u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64; None: as they are
    range       (low, high): values that become the least and the largest grey
    lossy       go on where something is lost: docs/commands/convert.md says what
    pixel_size  metres; wins over what the file says
    raw_size, raw_type, raw_order, raw_header   raw volumes: (nx, ny, nz), type, "little" or "big", bytes to skip
    phase       names of phases of a volume: their closed surface is written, as .stl, .ply or .vtp
    smooth      iterations of a windowed sinc filter on that surface
    overwrite   replace files that exist
    progress    called as progress(share, text); return False to cancel (raises Cancelled), nothing is left then
    """
    converter = _converter(source, array, step, type, range, lossy, pixel_size, raw_size, raw_type, raw_order, raw_header,
                           phase, smooth)
    return _write(converter, path, overwrite, progress)


def read(
    path: Path,
    array: str | Sequence[str] | None = None,
    step: int | None = None,
    lossy: bool = False,
    pixel_size: float | None = None,
    raw_size: Sequence[int] | None = None,
    raw_type: str | None = None,
    raw_order: str | None = None,
    raw_header: int = 0,
    progress: Progress | None = None,
) -> vtkDataObject:
    """Reads a file of any format of ``lamella convert`` into a vtkImageData, vtkPolyData, vtkUnstructuredGrid or vtkTable.

    Units, phases' names and provenance are with it; ``lamella.arrays(data)`` gives its numbers. Every function that takes
    an image takes what this returns.

    path        a file, a folder or pattern of slices (slice_%04d.png), a .pvd, or a pattern of steps (step_*.vti)
    step        of a series: the step, counted from 0
    array, lossy, pixel_size, raw_size, raw_type, raw_order, raw_header   as of ``lamella.convert``
    progress    called as progress(share, text); return False to cancel (raises Cancelled)
    """
    converter = _converter(path, array, step, None, None, lossy, pixel_size, raw_size, raw_type, raw_order, raw_header)
    _run(converter, progress)
    return converter.GetOutput()


def read_steps(
    path: Path, array: str | Sequence[str] | None = None, lossy: bool = False, progress: Progress | None = None
) -> Iterator[tuple[float, vtkDataObject]]:
    """Reads a series step by step, one in memory at a time: ``for time, data in lamella.read_steps("run.pvd")``.

    The time is the step's number where nothing tells it.

    path                     a .pvd, or a pattern of steps (step_*.vti)
    array, lossy, progress   as of ``lamella.read``
    """
    number, steps = 0, 1
    while number < steps:
        converter = _converter(path, array, number, lossy=lossy)
        _run(converter, progress)
        steps = converter.GetNumberOfSteps()
        data = converter.GetOutput()
        time = _arrays.numbers(data, "TimeValue")
        yield float(number if time is None else time[0]), data
        number += 1


def write(
    data: HasImage | vtkDataObject | ArrayLike,
    path: Path,
    array: str | Sequence[str] | None = None,
    type: str | None = None,  # pylint: disable=redefined-builtin
    range: Sequence[float] | None = None,  # pylint: disable=redefined-builtin
    lossy: bool = False,
    spacing: float = 1.0,
    name: str = "values",
    vectors: bool = False,
    phase: str | Sequence[str] | None = None,
    smooth: int = 0,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> list[str]:
    """Writes data to a file of any format of ``lamella convert``, whole or not at all, and returns the files written.

    data        a Sample, a result, a vtkImageData, vtkPolyData, vtkUnstructuredGrid or vtkTable, or an array in the order
                of pictures: rows by columns, or z by y by x
    path        the file; its ending tells the format. A pattern for slices (slice_%04d.png)
    spacing, name, vectors   of an array: distance of two nodes [m], what it is called, whether its last axis is that of
                             components, such as red, green and blue
    array, type, range, lossy, phase, smooth, overwrite, progress   as of ``lamella.convert``
    """
    if hasattr(data, "vtk"):
        data = data.vtk
    if not isinstance(data, vtkDataObject):
        given = _arrays.checked(data, "the array", "give numbers of 1, 2, 4 or 8 bytes")
        data = _arrays.image_of(given, spacing, name, given.shape[-1:] if vectors else ())
    converter = _converter(None, array, None, type, range, lossy, phase=phase, smooth=smooth)
    converter.SetInputData(data)
    return _write(converter, path, overwrite, progress)


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
