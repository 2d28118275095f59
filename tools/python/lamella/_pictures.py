"""Pictures fit for a paper, with no display."""

from __future__ import annotations

from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData

from . import _files
from ._errors import LamellaError, last_failure
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import ArrayLike, HasImage, Path

try:
    from .vtkLamellaRendering import vtkSnapshot
except ModuleNotFoundError:
    vtkSnapshot = None


def _declared(function):
    if vtkSnapshot is None:
        return function
    return declared(vtkSnapshot, first=("preset", "array"), without=("overwrite", "provenance"))(function)


@_declared
def snapshot(
    data: HasImage | vtkDataObject | ArrayLike,
    path: Path,
    settings: Settings,
    lines: vtkPolyData | None = None,
    overwrite: bool = False,
) -> str:
    """Draws a Sample, a result or a VTK data object into a PNG.

    data            what to draw
    path, overwrite  the file; one that is there already is only replaced where overwrite is True
    lines           streamlines (vtkPolyData) to draw instead of those that it finds
    """
    if vtkSnapshot is None:
        raise LamellaError("this build draws no pictures", "build filters/rendering as well")
    drawing = vtkSnapshot()
    errors = []
    drawing.AddObserver("ErrorEvent", lambda *_: errors.append(True))
    drawing.SetInputData(data.vtk if isinstance(data, ImageBase) else data if hasattr(data, "IsA") else as_image(data))
    settings.give(drawing)
    if lines is not None:
        drawing.SetOverlayLines(lines)
    drawing.SetOverwrite(bool(overwrite))
    path = _files.new_path(path, overwrite)
    last_failure()  # of something before
    if not drawing.Write(path) or errors:
        raise last_failure() or LamellaError(drawing.GetErrorMessage(), drawing.GetErrorHint())
    return path
