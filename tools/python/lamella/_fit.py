"""What the phases must be for samples to have what was measured."""

from __future__ import annotations

from collections.abc import Mapping as IsMapping

import numpy as np
from vtkmodules.vtkCommonCore import vtkStringArray

from . import _arrays
from ._arrays import told
from ._bonds import check_names
from ._errors import choose, number, run
from ._samples import ImageBase
from ._settings import Settings, declared, keywords_of, pair
from ._solve import DiffusionResult, as_image, parted
from ._stiffness import StiffnessResult, result_of
from ._types import Any, Array, Image, Progress, Sequence
from .vtkLamellaSolversVTK import vtkMaterialFit, vtkSteadyDiffusion, vtkVoxelStiffness


class FitResult(_arrays.FieldData):
    """What fits best, with its intervals. ``vtk`` is the image of ``solution``; its field data has all that is told here.

    Names are as the command has them: PROPERTY:PHASE of what was looked for, "young:wall"; those that were given of what
    was measured.
    """

    def __init__(self, solution) -> None:
        self._solution = solution
        self.vtk = solution.vtk

    @property
    def solution(self) -> DiffusionResult | StiffnessResult:
        """The first sample as diffusion() or stiffness() gives it at the fit, with its fields and its sensitivities."""
        return self._solution

    def _by_unknown(self, name):
        return dict(zip(_arrays.texts(self.vtk, "fit_unknown"), map(float, self._numbers(name))))

    def _by_measurement(self, name):
        return dict(zip(_arrays.texts(self.vtk, "fit_measured"), map(float, self._numbers(name))))

    def _matrix(self, name):
        values = self._numbers(name)
        n = round(len(values) ** 0.5)
        return values.reshape(n, n)

    values: dict[str, float] = told("What fits best, by name, in the unit of its property; of a slope in that for each unit of moisture.", "fit_value", by="_by_unknown")
    low: dict[str, float] = told(
        "The interval that holds it 19 times out of 20, by name; ``interval`` says by what.", "fit_low", by="_by_unknown")
    high: dict[str, float] = told("Its other end, by name.", "fit_high", by="_by_unknown")
    low_by_measurement: dict[str, float] = told(
        "The interval by the measurements alone, by name.", "fit_low_by_measurement", by="_by_unknown")
    high_by_measurement: dict[str, float] = told("Its other end, by name.", "fit_high_by_measurement", by="_by_unknown")
    interval: str = told("What the interval holds, in words: errors of lattice and picture, too, where they are known.", "fit_interval")
    correlation: Array = told(
        "Of what was looked for, a symmetric matrix in the order of ``values`` [1].", "fit_correlation", by="_matrix")
    fitted: dict[str, float] = told("What was measured, as it is at the fit, by name and in its unit.", "fit_fitted", by="_by_measurement")
    lattice_and_picture: dict[str, float] = told(
        "What lattice and picture leave of that, by name and in its unit; NaN where it is not known.", by="_by_measured")

    def _by_measured(self, name):
        return self._by_measurement("fit_" + name)

    @property
    def measured(self) -> dict[str, tuple[float, float]]:
        """What was measured, by name: its value and half of its interval, as they were given."""
        halves = self._by_measurement("fit_measured_half_width")
        return {name: (value, halves[name]) for name, value in self._by_measurement("fit_measured_value").items()}

    misfit: float = told("Sum of the squared differences over their standard deviations.", "fit_misfit")
    freedom: int = told("How many more measurements there are than unknowns.", "fit_freedom")
    chance: float = told("How often chance alone makes the misfit as large, 0 to 1; NaN without freedom.", "fit_chance")
    solves: int = told("Solves of all samples together.", "fit_solves")

    def __repr__(self) -> str:
        low, high = self.low, self.high
        found = ", ".join(f"{name} {value:.6g} ({low[name]:.4g} to {high[name]:.4g})" for name, value in self.values.items())
        return f"<lamella.FitResult: {found}>"


def _solver(kind, prepare, result):
    """A function of the settings of a solver that a fit leaves open, and what makes a result of the solver."""
    words = vtkStringArray()
    vtkMaterialFit.GetSettingsLeftOut(kind.__name__, words)

    def fit(samples, settings):
        prepare(settings)
        solver = kind()
        elsewhere = {name for sample in samples[1:] for name in _arrays.texts(sample, "phase_names")}
        settings.give(solver, lambda names, pairs: check_names(samples[0], [name for name in names if name not in elsewhere], pairs))
        return solver

    left = keywords_of(kind, [words.GetValue(i) for i in range(words.GetNumberOfValues())])
    return declared(kind, without=left)(fit), result


_SOLVERS = {
    "diffusion": _solver(vtkSteadyDiffusion, parted, lambda solver: DiffusionResult(solver.GetOutput())),
    "stiffness": _solver(vtkVoxelStiffness, lambda settings: None, result_of),
}


def _texts(settings, keyword, form, text):
    """Rows of a dictionary as the class takes them."""
    given = settings.values.get(keyword)
    if isinstance(given, IsMapping):
        settings.values[keyword] = [text(pair(name), value) for name, value in given.items()]
    elif given is not None and (np.isscalar(given) and not isinstance(given, str)):
        raise TypeError(f"{keyword} is of type {type(given).__name__}; give a dictionary, {form}, or texts")


def _unknown(name, start):
    return name if start is None else f"{name}={number(start, f'the start of {name!r}')!r}"


def _measured(name, value):
    if isinstance(value, str):
        return f"{name}={value}"
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        raise ValueError(f"measured {name!r} is {value!r}; give (value, half of the interval that holds it 19 times out of 20)")
    return "{}={!r}±{!r}".format(name, *(number(part, f"measured {name!r}") for part in value))


@declared(vtkMaterialFit, first=("unknown", "measured"), hints={"unknown": "Names | Mapping | None", "measured": "Names | Mapping | None"})
def fit(of: str, image: Image, settings: Settings, also: Sequence[Image] = (), progress: Progress | None = None, **solver: Any) -> FitResult:
    """What the phases must be for samples to have what was measured, as ``lamella fit`` finds it; returns a FitResult.

    of              what was measured: "diffusion", or "stiffness"
    image           the sample, as diffusion() and stiffness() take it
    also            others of the same materials, with measurements of their own
    solver          what is known, and all else: keywords of diffusion() or stiffness(), but for those that a fit sees to
                    itself (sensitivities, uncertainties, fields, loads)

    ``unknown`` may be a dictionary, {"young:wall": start}, with None for a start that the search finds itself, and
    ``measured`` one too, {"E_x": (value, half of its interval)}, of a second sample {"2/E_x": ...}, for slopes with the
    moisture {"E_x@0.12": ...}; or texts as the command takes them.
    """
    prepare, result = choose(_SOLVERS, of, "of")
    _texts(settings, "unknown", "{PROPERTY:PHASE: start}", _unknown)
    _texts(settings, "measured", "{quantity: (value, half of its interval)}", _measured)
    if isinstance(also, ImageBase) or hasattr(also, "GetDimensions"):
        raise TypeError(f"also is of type {type(also).__name__}; give a list of samples")
    samples = [as_image(one) for one in (image, *also)]
    search = vtkMaterialFit()
    algorithm = prepare(samples, **solver)
    search.SetSolver(algorithm)
    for sample in samples:
        search.AddInputDataObject(sample)
    settings.give(search)
    run(search, progress)
    return FitResult(result(algorithm))
