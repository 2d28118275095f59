"""Elastic equilibrium: displacement, stress, stiffness, first break."""

from __future__ import annotations

import numpy as np

from . import _arrays
from ._bonds import LOADS, BondFields, set_bonds, set_load
from ._errors import check_keywords, choose, run
from ._samples import ImageBase
from ._solve import as_image
from ._types import Any, Array, Image, Pairs, Progress
from .vtkLamellaFilters import vtkBondStress
from .vtkLamellaSolversVTK import vtkBondEquilibrium

_LOADS = {**LOADS, "traction": 3}
_SOLVERS = {"multigrid": 0, "jacobi": 1, "direct": 2, "dynamic-relaxation": 3}


def _mean_stress(image):
    xx, yy, zz, xy, yz, xz = _arrays.numbers(image, "mean_stress")
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class EquilibriumResult(BondFields):
    """``vtk`` is the image with ``displacement`` and what else was asked for, and all numbers as field data.

    Forces and energies of a picture are per metre of thickness. y points up.
    """

    @property
    def effective_stress(self) -> float:
        """Force on the platen over the section of the box [Pa]."""
        return self._number("effective_stress")

    @property
    def strain(self) -> float:
        """The strain applied; of a traction the one that it causes."""
        return self._number("strain")

    @property
    def mean_stress(self) -> Array:
        """Over the whole box, platens and voids included: 3 by 3 [Pa]."""
        return _mean_stress(self.vtk)

    @property
    def reactions(self) -> Array:
        """Forces that the sample exerts on the low and on the high platen [N]: 2 by 2 or 3."""
        low = _arrays.numbers(self.vtk, "reaction_low")
        return np.stack([low, _arrays.numbers(self.vtk, "reaction_high")])[:, : self._dimension]

    @property
    def elastic_energy(self) -> float:
        """J."""
        return self._number("elastic_energy")

    @property
    def first_break_strain(self) -> float:
        """Strain at which the first bond breaks; NaN where none does, and in large strains."""
        return self._number("first_break_strain")

    @property
    def first_break_stress(self) -> float:
        """Effective stress at which the first bond breaks [Pa]; NaN likewise."""
        return self._number("first_break_stress")

    @property
    def first_break_position(self) -> Array:
        """Middle of that bond [m]."""
        return _arrays.numbers(self.vtk, "first_break_position")[: self._dimension]

    @property
    def first_break_phases(self) -> tuple[str, ...]:
        """Names of the phases at its two ends."""
        return tuple(_arrays.texts(self.vtk, "first_break_phases"))

    @property
    def largest_stretch_ratio(self) -> float:
        """The largest elongation of a bond over its critical one, at this load."""
        return self._number("largest_stretch_ratio")

    @property
    def iterations(self) -> int:
        """Of conjugate gradients."""
        return self._count("iterations")

    @property
    def residual(self) -> float:
        """Residual force, relative."""
        return self._number("residual")

    def __repr__(self) -> str:
        return (
            f"<lamella.EquilibriumResult: effective modulus {self.effective_modulus:.6g} Pa, "
            f"first break at a strain of {self.first_break_strain:.4g}>"
        )


def equilibrium(
    image: Image,
    young: Pairs,
    fracture_energy: Pairs | None = None,
    toughness: Pairs | None = None,
    critical_stretch: Pairs | None = None,
    load: str = "stretch",
    strain: float = 1e-3,
    axis: str | None = None,
    lateral_strain: float = 0.0,
    traction: float = 0.0,
    smooth_platens: bool = False,
    rigid_platens: bool = False,
    platen_layers: int = 0,
    stress: bool = False,
    strain_energy: bool = False,
    solver: str = "multigrid",
    tolerance: float = 1e-6,
    max_iterations: int = 20000,
    progress: Progress | None = None,
    **bonds: Any,
) -> EquilibriumResult:
    """Loads a sample of bonded nodes and returns an EquilibriumResult.

    image     a Sample, a vtkImageData with the point array ``phase`` (and ``grain``), or an array of whole numbers
    young     {pair: Young's modulus in Pa}. A pair is a phase ("grain": bonds within it), two phases ("matrix-grain"
              or ("matrix", "grain")), or one phase twice ("grain-grain": bonds between two different grains; the image
              needs the array ``grain``)
    fracture_energy, toughness, critical_stretch  {pair: J/m^2, Pa m^(1/2), elongation}: at most one for each pair
    load      "stretch" (bottom fixed, top moves along the axis), "shear" (it moves across), "biaxial", "traction"
    strain    movement of the platen over the distance between the platens; tension positive
    axis      None: y of a picture, z of a volume
    lateral_strain  of "biaxial", along the other axes
    traction  of "traction" [Pa]
    smooth_platens  of "stretch": they hold the component along the axis only
    rigid_platens   all layers of a platen move alike; else as the mean strain has it, as if the sample went on
    platen_layers   nodes that a platen holds; 0: as many as a bond reaches
    stress, strain_energy  whether these fields are computed
    solver    "multigrid", "jacobi", "direct" (small images) or "dynamic-relaxation"
    tolerance, max_iterations  largest relative residual force; gives up after so many iterations
    progress  called as progress(share, text); return False to cancel (raises Cancelled)

    and of the bonds, as keywords:

    like          {pair: pair}: bonds that are like those of another pair, but for what they have of their own
    relative_to   a pair: all other values are multiples of its
    mixing        pairs of phases without material: None (an error), "harmonic" (two half bonds in series), "minimum"
    void          phases without bonds; None: those called void, pore, lumen, air or 0 that have no Young's modulus
    horizon       length of the longest bonds in spacings, 1 to 8
    continuum     None ("plane-stress" of a picture, "space" of a volume) or "plane-strain"
    micromodulus  "continuum" (as in the literature), "lattice" (Young's modulus along the axes exact) or "isotropic"
                  (exact in every direction); None: isotropic of a volume and in stiffness(), else continuum
    void_bonds    "keep" or "cut": bonds across thin voids
    surface_correction  stiffer bonds near free surfaces
    notches       ((x1, y1), (x2, y2)) in metres each; in space a corner and two edges
    periodic      axes at whose end the sample begins again, as "x"
    strains       "small" (linear) or "large"
    threads       0: all cores
    """
    solve = vtkBondEquilibrium()
    sample = as_image(image)
    solve.SetInputData(sample)
    check_keywords(equilibrium, set_bonds, bonds)
    set_bonds(solve, sample, young, fracture_energy, toughness, critical_stretch, **bonds)
    set_load(solve, _LOADS, load, axis, smooth_platens, rigid_platens, platen_layers, tolerance, stress, strain_energy)
    solve.SetStrain(float(strain))
    solve.SetLateralStrain(float(lateral_strain))
    solve.SetTraction(float(traction))
    solve.SetSolver(choose(_SOLVERS, solver, "solver"))
    solve.SetMaximumIterations(int(max_iterations))
    run(solve, progress)
    return EquilibriumResult(solve.GetOutput())


class BondStressResult(ImageBase):
    """``vtk`` is the image with ``stress``."""

    @property
    def stress(self) -> Array:
        """[Pa], the six components xx, yy, zz, xy, yz, xz in the last axis (a view)."""
        return self.array("stress")

    @property
    def mean_stress(self) -> Array:
        """Over the whole box, voids included: 3 by 3 [Pa]."""
        return _mean_stress(self.vtk)


def bond_stress(
    image: Image,
    young: Pairs | None = None,
    strain_energy: bool = False,
    progress: Progress | None = None,
    **bonds: Any,
) -> BondStressResult:
    """Stress of every node from its displacement and its bonds; returns a BondStressResult.

    image   an EquilibriumResult, or an image with the point arrays ``phase`` and ``displacement`` (metres)
    young   None: the model with which the image was solved. Else the bonds as equilibrium() takes them, with **bonds
    strain_energy  also the strain energy of every node
    progress  called as progress(share, text); return False to cancel (raises Cancelled)
    """
    stress = vtkBondStress()
    sample = as_image(image)
    stress.SetInputData(sample)
    stress.SetModelFromInput(young is None)
    if young is None and set(bonds) - {"threads"}:
        raise ValueError("the model comes with the image unless young is given")
    check_keywords(bond_stress, set_bonds, bonds)
    set_bonds(stress, sample, young, **bonds)
    stress.SetComputeStrainEnergy(bool(strain_energy))
    run(stress, progress)
    return BondStressResult(stress.GetOutput())
