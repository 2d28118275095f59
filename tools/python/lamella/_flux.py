"""Where the flux goes."""

from __future__ import annotations

from vtkmodules.util.numpy_support import vtk_to_numpy

from . import _arrays
from ._arrays import told
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import run_on
from ._types import Array, Image, Progress
from .vtkLamellaFilters import vtkFluxMap


class FluxMapResult(ImageBase):
    """``vtk`` is the image with ``flux_magnitude``; ``streamlines`` the vtkPolyData of the lines."""

    def __init__(self, image, streamlines) -> None:
        super().__init__(image)
        #: vtkPolyData
        self.streamlines = streamlines

    magnitude: Array = told(
        "Magnitude of the flux [conductivity's unit/m], in the order of pictures (a view).", "flux_magnitude")

    @property
    def effective(self) -> Array:
        """The mean flux over the mean gradient, NaN in columns that were not solved. Off the diagonal with insulated sides
        it is what flows across in this box, and no property of the material."""
        n = 3 if self.vtk.GetDimensions()[2] > 1 else 2
        return _arrays.numbers(self.vtk, "effective_from_flux").reshape(3, 3)[:n, :n]

    tortuosity: dict[str, float] = told(
        "Mean magnitude of the flux over its mean along the direction, by direction.", by="_by_direction")
    tortuosity_factor: dict[str, float] = told(
        "Mean conductivity over the effective one, by direction.", by="_by_direction")
    streamline_tortuosity: dict[str, float] = told(
        "Mean length of the streamlines over the length of the box, of the direction shown.", by="_by_direction")

    @property
    def lines(self) -> list[Array]:
        """The streamlines as arrays of points (n by 3) [m]."""
        if not self.streamlines.GetNumberOfPoints():
            return []
        points = vtk_to_numpy(self.streamlines.GetPoints().GetData())
        return [points[ids] for ids in _arrays.lines_of(self.streamlines)]


@declared(vtkFluxMap, first=("direction", "streamlines"))
def flux_map(result: Image, settings: Settings, progress: Progress | None = None) -> FluxMapResult:
    """Magnitude, streamlines and effective numbers.

    result          a DiffusionResult, or an image like it
    """
    flux = run_on(result, vtkFluxMap(), settings, progress)
    return FluxMapResult(flux.GetOutput(), flux.GetStreamlines())
