"""Effective stiffness of a cell that repeats, with its error, by bonds."""

from __future__ import annotations

from ._bonds import FORMERLY, give_bonds
from ._errors import run
from ._settings import Settings, declared
from ._solve import as_image
from ._stiffness_results import StiffnessBase
from ._types import Image, Progress
from .vtkLamellaSolversVTK import vtkBondStiffness


class BondStiffnessResult(StiffnessBase):
    """``vtk`` is the image with all numbers as field data; ``vtk_tensor`` and ``vtk_constants`` are vtkTables.

    Tensors are 3 by 3 of a picture (xx, yy, xy) and 6 by 6 of a volume (xx, yy, zz, yz, xz, xy), shear strains as
    angles. y points up.
    """


@declared(vtkBondStiffness, first=("young",), without=(
    "fracture_energy", "toughness", "critical_stretch", "large_strains", "periodic"), formerly={"void_bonds": FORMERLY["void_bonds"]})
def bond_stiffness(image: Image, settings: Settings, progress: Progress | None = None) -> BondStiffnessResult:
    """Effective stiffness tensor of a sample taken as a cell that repeats, by bonds; returns a BondStiffnessResult.

    image           as equilibrium() takes it, and so are pairs

    Strains are small, every side is periodic, nothing breaks.
    """
    solve = vtkBondStiffness()
    sample = as_image(image)
    solve.SetInputData(sample)
    give_bonds(settings, solve, sample)
    run(solve, progress)
    return BondStiffnessResult(solve.GetOutput(), solve.GetTensor(), solve.GetConstants())
