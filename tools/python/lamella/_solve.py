"""Steady diffusion."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData

from . import _arrays
from ._errors import choose, entries, number, run
from ._samples import ImageBase, from_array
from ._types import Array, Image, Mapping, Name, Progress
from .vtkLamellaSolversVTK import vtkSteadyDiffusion

_DIRECTIONS = {"x": 0, "y": 1, "z": 2, "all": 3}
_LATTICES = {None: 0, "d2q5": 1, "d2q9": 2, "d3q7": 3, "d3q19": 4}
_METHODS = {"auto": 0, "multigrid": 1, "algebraic": 2}


class DiffusionResult(ImageBase):
    """What a solve gives. ``vtk`` is the image with all arrays and field data; ``save()`` writes it."""

    @property
    def _dimension(self):
        return 3 if self.vtk.GetDimensions()[2] > 1 else 2

    def _by_direction(self, name):
        values = _arrays.numbers(self.vtk, name)
        return {axis: float(value) for axis, value in zip("xyz", values) if not np.isnan(value)}

    @property
    def effective(self) -> Array:
        """The effective conductivity as a matrix (2 by 2 or 3 by 3), NaN in columns that were not solved, and off the
        diagonal with insulated sides: what flows across there is decided by the box, not by the material."""
        n = self._dimension
        values = _arrays.numbers(self.vtk, "effective_conductivity").reshape(3, 3)[:n, :n]
        if _arrays.text(self.vtk, "sides") == "insulated":
            values[~np.eye(n, dtype=bool)] = np.nan
        return values

    @property
    def estimated_error(self) -> float:
        """Relative error of the effective conductivity against the material's; NaN unless it was asked for."""
        return float(_arrays.numbers(self.vtk, "estimated_error")[0])

    @property
    def lattice_error(self) -> float:
        """The part of it that one node a pixel makes, which a finer lattice of the same pixels mends."""
        return float(_arrays.numbers(self.vtk, "lattice_error")[0])

    @property
    def picture_error(self) -> float:
        """The part of it that the steps of the pixels make, which only smaller pixels mend."""
        return float(_arrays.numbers(self.vtk, "picture_error")[0])

    @property
    def extrapolated(self) -> dict[str, float]:
        """Effective conductivity that the material is expected to have, by direction: only where it is nearer."""
        return self._by_direction("extrapolated_conductivity")

    @property
    def bounds(self) -> dict[str, float]:
        """Bounds that only the phases' shares are needed for, a dictionary: series and parallel, which hold for every
        material of these phases, and Hashin and Shtrikman's of isotropic media, which wood may pass."""
        names = ("series", "hashin_shtrikman_lower", "hashin_shtrikman_upper", "parallel")
        return dict(zip(names, map(float, _arrays.numbers(self.vtk, "bounds"))))

    @property
    def iterations(self) -> dict[str, int]:
        """Iterations by direction."""
        return {axis: int(value) for axis, value in self._by_direction("iterations").items()}

    @property
    def balance(self) -> dict[str, float]:
        """Relative difference of the flux through the worse face, by direction."""
        return self._by_direction("balance")

    @property
    def fields(self) -> dict[str, Array]:
        """Fields and fluxes by name, as arrays in the order of pictures (views, no copies)."""
        data = self.vtk.GetPointData()
        names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
        kinds = ("temperature", "concentration", "flux")
        return {name: self.array(name) for name in names if name.split("_")[0] in kinds}

    def __repr__(self) -> str:
        numbers = ", ".join(f"k_{axis} {self.effective[i, i]:.6g}" for i, axis in enumerate("xyz"[: self._dimension]))
        return f"<lamella.DiffusionResult {numbers}>"


def as_image(image):
    """The vtkImageData behind a sample, a result or an array."""
    if isinstance(image, ImageBase):
        return image.vtk
    if isinstance(image, vtkImageData):
        return image
    return from_array(image).vtk


def diffusion(
    image: Image,
    conductivity: Mapping[Name, float | tuple[float, float]],
    direction: str = "all",
    sides: str = "insulated",
    quantity: str = "temperature",
    lattice: str | None = None,
    tolerance: float = 1e-8,
    threads: int = 1,
    fields: bool = True,
    flux: bool = True,
    estimate_error: bool = False,
    method: str = "auto",
    max_iterations: int = 500,
    progress: Progress | None = None,
) -> DiffusionResult:
    """Solves steady diffusion and returns a DiffusionResult.

    image         a Sample, a vtkImageData with the point array ``phase``, or an array of whole numbers
    conductivity  {name or number of the phase: value}, one for each phase that occurs, 0 for what does not conduct;
                  (along, across) where it differs along the wall, whose direction is the point array ``axis`` of a
                  lattice from outlines; pictures only, ratios up to 5.82 in every direction
    direction     "x" (left to right), "y" (in a picture from top to bottom), "z" or "all"
    sides         "insulated" or "periodic"
    quantity      "temperature" or "concentration": names the field
    lattice       None (d2q5 or d3q7), "d2q5", "d2q9", "d3q7" or "d3q19"
    method        "auto", "multigrid" or "algebraic": how the system is solved; all give the same answer
    tolerance     largest relative error of the flux through either face
    max_iterations  gives up after so many
    threads       0: all cores
    fields, flux  whether the field and its flux are kept; what is not asked for is not computed
    estimate_error  solve every second pixel and a finer lattice too, and estimate the error; several times the work
    progress      called as progress(share, text); return False to cancel (raises Cancelled)

    With direction "all" names of fields end in _x, _y, _z.
    """
    solver = vtkSteadyDiffusion()
    solver.SetInputData(as_image(image))
    solver.SetDirection(choose(_DIRECTIONS, direction, "direction"))
    solver.SetSides(choose({"insulated": 0, "periodic": 1}, sides, "sides"))
    solver.SetQuantity(choose({"temperature": 0, "concentration": 1}, quantity, "quantity"))
    solver.SetLattice(choose(_LATTICES, lattice, "lattice"))
    solver.SetMethod(choose(_METHODS, method, "method"))
    for name, value in entries(conductivity, "conductivity", "{phase: value}"):
        what = f"the conductivity of {name!r}"
        pair = isinstance(value, (tuple, list))
        if pair and len(value) != 2:
            raise ValueError(f"{what} is {value!r}; give a number, or (along, across)")
        solver.SetConductivity(str(name), number(value[0] if pair else value, what))
        if pair:
            solver.SetConductivityAcross(str(name), number(value[1], what))
    solver.SetTolerance(tolerance)
    solver.SetMaximumIterations(max_iterations)
    solver.SetThreads(threads)
    solver.SetComputeField(bool(fields))
    solver.SetComputeFlux(bool(flux))
    solver.SetEstimateError(bool(estimate_error))
    run(solver, progress)
    return DiffusionResult(solver.GetOutput())
