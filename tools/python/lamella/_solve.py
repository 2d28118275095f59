"""Steady diffusion."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData

from . import _arrays
from ._arrays import checked, image_of, told
from ._errors import entries, run
from ._samples import ImageBase, from_array
from ._settings import Settings, declared
from ._types import Array, Image, Progress
from .vtkLamellaSolversVTK import vtkSteadyDiffusion


class DiffusionResult(ImageBase):
    """What a solve gives. ``vtk`` is the image with all arrays and field data; ``save()`` writes it."""

    @property
    def _dimension(self):
        return 3 if self.vtk.GetDimensions()[2] > 1 else 2

    @property
    def effective(self) -> Array:
        """The effective conductivity as a matrix (2 by 2 or 3 by 3), NaN in columns that were not solved, and off the
        diagonal with insulated sides: what flows across there is decided by the box, not by the material."""
        n = self._dimension
        values = _arrays.numbers(self.vtk, "effective_conductivity").reshape(3, 3)[:n, :n]
        if _arrays.text(self.vtk, "sides") == "insulated":
            values[~np.eye(n, dtype=bool)] = np.nan
        return values

    def _if_asked(self, name):
        return self._by_direction(name) if self._numbers(name) is not None else {}

    estimated_error: float = told(
        "Relative error of the effective conductivity against the material's; NaN unless it was asked for.")
    lattice_error: float = told(
        "The part of it that one node a pixel makes, which a finer lattice of the same pixels mends.")
    picture_error: float = told("The part of it that the steps of the pixels make, which only smaller pixels mend.")
    window_error: dict[str, float] = told(
        "How far the material that the picture was cut out of may be from the picture's value, relative, by direction;"
        " empty unless it was asked for.", "window_error_by_direction", by="_if_asked")
    window_low: dict[str, float] = told("The interval that holds the material's value with 95 %, by direction.",
                                        by="_if_asked")
    window_high: dict[str, float] = told("Its other end, by direction.", by="_if_asked")
    window_deviation: dict[str, float] = told(
        "Standard deviation between the values of pictures of this size, by direction.", by="_if_asked")
    window_bias: dict[str, float] = told(
        "Value of the picture less the material's because the picture ends, as far as its windows tell, by direction.",
        by="_if_asked")
    window_gradient: dict[str, float] = told(
        "Axis, 0 to 2, along which the picture changes steadily, by direction; empty where it does not.", by="_if_asked")
    layered_conductivity: dict[str, float] = told(
        "Of a picture that changes so its slabs as layers, in series or in parallel, by direction.", by="_if_asked")
    layered_low: dict[str, float] = told("The interval of a material of such layers, by direction.", by="_if_asked")
    layered_high: dict[str, float] = told("Its other end, by direction.", by="_if_asked")
    segmentation_error: dict[str, float] = told(
        "How far the value may be off because surfaces between phases lie elsewhere, relative, by direction; empty unless"
        " it was asked for.", "segmentation_error_by_direction", by="_if_asked")
    input_error: dict[str, float] = told(
        "What the uncertainty of the phases' conductivities leaves of the value, relative, by direction; empty where none"
        " was given.", "input_error_by_direction", by="_if_asked")
    total_error: dict[str, float] = told(
        "All that is known of the value's error, the root of the squares of the parts that were asked for, relative, by"
        " direction; empty unless there is a part beside that of lattice and picture.", "total_error_by_direction",
        by="_if_asked")
    extrapolated: dict[str, float] = told(
        "Effective conductivity that the material is expected to have, by direction: only where it is nearer.",
        "extrapolated_conductivity", by="_by_direction")
    relative: dict[str, float] = told(
        "Effective over the conductivity of the only phase that conducts (of pores D_eff / D_0), by direction; empty where"
        " several conduct.", "relative_conductivity", by="_by_direction")
    formation_factor: dict[str, float] = told("Its inverse, by direction.", by="_by_direction")
    tortuosity_factor: dict[str, float] = told(
        "Mean conductivity of the phases over the effective one, by direction; of one conducting phase its fraction times"
        " the formation factor.", by="_by_direction")

    @property
    def bounds(self) -> dict[str, float]:
        """Bounds that only the phases' shares are needed for, a dictionary: series and parallel, which hold for every
        material of these phases, and Hashin and Shtrikman's of isotropic media, which wood may pass."""
        names = ("series", "hashin_shtrikman_lower", "hashin_shtrikman_upper", "parallel")
        return dict(zip(names, map(float, _arrays.numbers(self.vtk, "bounds"))))

    @property
    def membrane_area(self) -> dict[str, float]:
        """Area of the surface over the volume [1/m], of pictures length over area, of each pair of phases with a membrane
        between them; empty where there is none."""
        areas = self._numbers("membrane_area")
        return {} if areas is None else dict(zip(_arrays.texts(self.vtk, "membrane_names"), map(float, areas)))

    @property
    def iterations(self) -> dict[str, int]:
        """Iterations by direction."""
        return {axis: int(value) for axis, value in self._by_direction("iterations").items()}

    balance: dict[str, float] = told(
        "Relative difference of the flux through the worse face, by direction.", by="_by_direction")

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


def run_on(image, algorithm, settings, progress=None):
    """Gives the algorithm an image and what was set, runs it and returns it."""
    algorithm.SetInputData(as_image(image))
    settings.give(algorithm)
    run(algorithm, progress)
    return algorithm


def parted(settings):
    """Conductivities (along, across), and tensors, as the class takes them."""
    given = settings.values
    along, across = {}, dict(given.get("conductivity_across") or {})
    tensors = {name: row if isinstance(row, str) else " ".join(map(repr, np.ravel(row).astype(float).tolist()))
               for name, row in (given.get("conductivity_tensor") or {}).items()}
    for name, value in entries(given.get("conductivity"), "conductivity", "{phase: value}"):
        if np.ndim(value) == 2:
            tensors[name] = " ".join(map(repr, np.ravel(value).astype(float).tolist()))
            continue
        pair = isinstance(value, (tuple, list))
        if pair and len(value) != 2:
            raise ValueError(f"the conductivity of {name!r} is {value!r}; give a number, (along, across), or a tensor")
        along[name] = value[0] if pair else value
        if pair:
            across[name] = value[1]
    given.update(conductivity=along, conductivity_across=across, conductivity_tensor=tensors)


@declared(vtkSteadyDiffusion, first=("conductivity", "direction", "sides", "quantity"), formerly={"fields": "field"})
def diffusion(image: Image, settings: Settings, progress: Progress | None = None) -> DiffusionResult:
    """Solves steady diffusion and returns a DiffusionResult.

    image           a Sample, a vtkImageData with the point array ``phase``, or an array of whole numbers; with ``shares`` or
                    ``interpolate`` an array of greys of any type

    ``membrane`` and ``permeance`` are dictionaries by pair of phases, {"lumen-wall": 2e-8}.

    What is not asked for, field or flux, is not computed. A conductivity may be (along, across) where it differs along the
    wall, whose direction is the point array ``axis`` of a lattice from outlines, or a symmetric tensor, 3 by 3 (of pictures 2 by
    2) in the image's axes. Phases without one take the tensors of the image's point array ``tensor``, where it has that.
    """
    parted(settings)
    given = settings.values
    if given.get("method") == "algebraic":  # as it was called
        given["method"] = "algebraic-multigrid"
    if (given.get("shares") or given.get("interpolate")) and not isinstance(image, (ImageBase, vtkImageData)):
        image = image_of(checked(image, "the grey image", "give real numbers"), 1.0, "phase")
    return DiffusionResult(run_on(image, vtkSteadyDiffusion(), settings, progress).GetOutput())
