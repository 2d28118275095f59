"""Elastic equilibrium: displacement, stress, stiffness, first break."""

from __future__ import annotations

import numpy as np

from . import _arrays
from ._arrays import told
from ._bonds import FORMERLY, MATERIALS, BondFields, BreakInputs, give_bonds
from ._errors import run
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, Image, Progress
from .vtkLamellaFilters import vtkBondStress
from .vtkLamellaSolversVTK import vtkBondEquilibrium


def _mean_stress(image):
    xx, yy, zz, xy, yz, xz = _arrays.numbers(image, "mean_stress")
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class EquilibriumResult(BreakInputs, BondFields):
    """``vtk`` is the image with ``displacement`` and what else was asked for, and all numbers as field data.

    Forces and energies of a picture are per metre of thickness. y points up.
    """

    effective_stress: float = told("Force on the platen over the section of the box [Pa].")
    strain: float = told("The strain applied; of a traction the one that it causes, of a pressure what the pores gain of their volume.")

    @property
    def mean_stress(self) -> Array:
        """Over the whole box, platens and voids included: 3 by 3 [Pa]."""
        return _mean_stress(self.vtk)

    @property
    def reactions(self) -> Array:
        """Forces that the sample exerts on the low and on the high platen [N]: 2 by 2 or 3."""
        low = _arrays.numbers(self.vtk, "reaction_low")
        return np.stack([low, _arrays.numbers(self.vtk, "reaction_high")])[:, : self._dimension]

    elastic_energy: float = told("J.")
    first_break_strain: float = told(
        "Strain at which the first bond breaks; NaN where none does, and in large strains.")
    first_break_stress: float = told("Effective stress at which the first bond breaks [Pa]; NaN likewise.")

    @property
    def first_break_position(self) -> Array:
        """Middle of that bond [m]."""
        return _arrays.numbers(self.vtk, "first_break_position")[: self._dimension]

    @property
    def first_break_phases(self) -> tuple[str, ...]:
        """Names of the phases at its two ends."""
        return tuple(_arrays.texts(self.vtk, "first_break_phases"))

    largest_stretch_ratio: float = told("The largest elongation of a bond over its critical one, at this load.")
    iterations: int = told("Of conjugate gradients.")
    residual: float = told("Residual force, relative.")

    def __repr__(self) -> str:
        return (
            f"<lamella.EquilibriumResult: effective modulus {self.effective_modulus:.6g} Pa, "
            f"first break at a strain of {self.first_break_strain:.4g}>"
        )


@declared(vtkBondEquilibrium, first=MATERIALS, formerly=FORMERLY)
def equilibrium(image: Image, settings: Settings, progress: Progress | None = None) -> EquilibriumResult:
    """Loads a sample of bonded nodes and returns an EquilibriumResult.

    image           a Sample, a vtkImageData with the point array ``phase`` (and ``grain``), or an array of whole numbers

    Pairs are keys: a phase ("grain": bonds within it), two phases ("matrix-grain" or ("matrix", "grain")), or one phase
    twice ("grain-grain": bonds between two different grains; the image needs the array ``grain``). A notch is ((x1, y1), (x2,
    y2)); in space a corner and two edges.
    """
    solve = vtkBondEquilibrium()
    sample = as_image(image)
    solve.SetInputData(sample)
    give_bonds(settings, solve, sample)
    run(solve, progress)
    return EquilibriumResult(solve.GetOutput())


class BondStressResult(ImageBase):
    """``vtk`` is the image with ``stress``."""

    stress: Array = told("[Pa], the six components xx, yy, zz, xy, yz, xz in the last axis (a view).")

    @property
    def mean_stress(self) -> Array:
        """Over the whole box, voids included: 3 by 3 [Pa]."""
        return _mean_stress(self.vtk)


@declared(vtkBondStress, first=("young",), without=("model_from_input",), formerly=FORMERLY)
def bond_stress(image: Image, settings: Settings, progress: Progress | None = None) -> BondStressResult:
    """Stress of every node from its displacement and its bonds; returns a BondStressResult.

    image           an EquilibriumResult, or an image with the point arrays ``phase`` and ``displacement`` (metres)

    Without ``young`` the model is that with which the image was solved; else the bonds are those of equilibrium().
    """
    stress = vtkBondStress()
    sample = as_image(image)
    stress.SetInputData(sample)
    given = {name for name, value in settings.values.items() if value is not None}
    stress.SetModelFromInput("young" not in given)
    if "young" not in given and given - {"threads", "strain_energy"}:
        raise ValueError("the model comes with the image unless young is given")
    give_bonds(settings, stress, sample)
    run(stress, progress)
    return BondStressResult(stress.GetOutput())
