"""Where the flux goes."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from . import _arrays
from ._errors import run
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, Image, Progress
from .vtkLamellaFilters import vtkFluxMap


class FluxMapResult(ImageBase):
    """``vtk`` is the image with ``flux_magnitude``; ``streamlines`` the vtkPolyData of the lines."""

    def __init__(self, image, streamlines) -> None:
        super().__init__(image)
        #: vtkPolyData
        self.streamlines = streamlines

    def _by_direction(self, name):
        values = _arrays.numbers(self.vtk, name)
        return {axis: float(value) for axis, value in zip("xyz", values) if not np.isnan(value)}

    @property
    def magnitude(self) -> Array:
        """Magnitude of the flux [conductivity's unit/m], in the order of pictures (a view)."""
        return self.array("flux_magnitude")

    @property
    def effective(self) -> Array:
        """The mean flux over the mean gradient, NaN in columns that were not solved. Off the diagonal with insulated sides
        it is what flows across in this box, and no property of the material."""
        n = 3 if self.vtk.GetDimensions()[2] > 1 else 2
        return _arrays.numbers(self.vtk, "effective_from_flux").reshape(3, 3)[:n, :n]

    @property
    def tortuosity(self) -> dict[str, float]:
        """Mean magnitude of the flux over its mean along the direction, by direction."""
        return self._by_direction("tortuosity")

    @property
    def tortuosity_factor(self) -> dict[str, float]:
        """Mean conductivity over the effective one, by direction."""
        return self._by_direction("tortuosity_factor")

    @property
    def streamline_tortuosity(self) -> dict[str, float]:
        """Mean length of the streamlines over the length of the box, of the direction shown."""
        return self._by_direction("streamline_tortuosity")

    @property
    def lines(self) -> list[Array]:
        """The streamlines as arrays of points (n by 3) [m]."""
        points = vtk_to_numpy(self.streamlines.GetPoints().GetData()) if self.streamlines.GetNumberOfPoints() else None
        cells = self.streamlines.GetLines()
        if points is None:
            return []
        offsets = vtk_to_numpy(cells.GetOffsetsArray())
        ids = vtk_to_numpy(cells.GetConnectivityArray())
        return [points[ids[begin:end]] for begin, end in zip(offsets[:-1], offsets[1:])]


@declared(vtkFluxMap, first=("direction", "streamlines"))
def flux_map(result: Image, settings: Settings, progress: Progress | None = None) -> FluxMapResult:
    """Magnitude, streamlines and effective numbers.

    result          a DiffusionResult, or an image like it
    progress        called as progress(share, text); return False to cancel (raises Cancelled)
    """
    flux = vtkFluxMap()
    flux.SetInputData(as_image(result))
    settings.give(flux)
    run(flux, progress)
    return FluxMapResult(flux.GetOutput(), flux.GetStreamlines())
