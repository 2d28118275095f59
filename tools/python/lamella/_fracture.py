"""Quasi-static fracture: strength, curve, broken bonds, damage."""

from __future__ import annotations

import numpy as np

from . import _arrays
from ._bonds import LOADS, set_bonds, set_load
from ._breaks import BreakResult, BrokenState, run_breaks
from ._errors import check_keywords, choose
from ._solve import as_image
from ._types import Any, Array, ArrayLike, Image, OnStep, Pairs, Path, Progress
from .vtkLamellaSolversVTK import vtkBondFracture

_METHODS = {"auto": 0, "events": 1, "accurate": 2}
_BREAKINGS = {"strict": 0, "batched": 1}
_COUNTS = (
    "events raises equilibria iterations local_cycles visited_nodes searches freed_pieces freed_nodes freed_bonds "
    "solid_nodes skipped_nodes bonds skipped_strips bytes"
).split()


class FractureState(BrokenState):
    """The sample in one state: ``vtk`` is the image with ``damage``, ``broken`` and what was asked for."""

    def __repr__(self) -> str:
        return f"<lamella.FractureState: strain {self.imposed_strain:.6g}, {self.broken_bonds} bonds broken>"


class FractureResult(BreakResult):
    """``vtk`` is the image at the end with all numbers as field data; ``vtk_broken`` a vtkPolyData with a vertex a
    broken bond; ``vtk_curve`` a vtkTable.

    Strains and stresses are positive along the load. Energies of a picture are per metre of thickness. y points up.
    """

    _State = FractureState
    _KINDS = (("event", "i8", 1), ("strain", "f8", 1), ("critical_strain", "f8", 1), ("stress", "f8", 1))
    _TIMES = ("bonds", "first", "equilibria", "local", "search", "run", "states", "checkpoints")

    @property
    def strain(self) -> Array:
        """Curve: imposed strains, from 0 on; they never fall. Just before each event, what each avalanche left, the
        end."""
        return self._column("strain")

    @property
    def critical_strain(self) -> Array:
        """Curve that follows every snap-back: strain at which the next bond is just critical."""
        return self._column("critical_strain")

    @property
    def critical_stress(self) -> Array:
        """Curve that follows every snap-back: stress at ``critical_strain`` [Pa]."""
        return self._column("critical_stress")

    @property
    def broken(self) -> Array:
        """The broken bonds in order, a structured array: ``event`` (from 1), ``strain`` (imposed), ``critical_strain``,
        ``stress`` [Pa], ``position`` of the middle and ``bond`` vector (x, y (and z) [m]), ``phases`` of both ends (the
        lesser first), ``between_grains``."""
        return self._broken_bonds()

    @property
    def first_break_strain(self) -> float:
        """Strain at which the first bond broke; NaN where none did."""
        return self._number("first_break_strain")

    @property
    def first_break_stress(self) -> float:
        """Stress at which the first bond broke [Pa]; NaN where none did."""
        return self._number("first_break_stress")

    @property
    def modulus(self) -> float:
        """Stress over strain of the unbroken sample [Pa]."""
        return self.effective_modulus

    @property
    def broken_energy(self) -> float:
        """What the broken bonds held when they were just critical [J]."""
        return self._number("broken_energy")

    @property
    def method(self) -> str:
        """"events" or "accurate"."""
        return _arrays.text(self.vtk, "method")

    @property
    def statistics(self) -> dict[str, Any]:
        """What was done and what was skipped: a dictionary of counts, and ``seconds``, one of times."""
        counts = {name: self._count(name) for name in _COUNTS}
        counts["seconds"] = self._seconds()
        return counts

    def __repr__(self) -> str:
        return (
            f"<lamella.FractureResult: peak stress {self.peak_stress:.6g} Pa at a strain of {self.peak_strain:.4g}, "
            f"{self.vtk_broken.GetNumberOfPoints()} bonds broken, {self.end}>"
        )


def fracture(
    image: Image,
    young: Pairs,
    fracture_energy: Pairs | None = None,
    toughness: Pairs | None = None,
    critical_stretch: Pairs | None = None,
    load: str = "stretch",
    axis: str | None = None,
    compression: bool = False,
    lateral_ratio: float = 0.0,
    smooth_platens: bool = False,
    rigid_platens: bool = False,
    platen_layers: int = 0,
    method: str = "auto",
    breaking: str = "strict",
    rivals: bool = True,
    stop: float = 0.05,
    strain_step: float = 0.0,
    max_strain: float | None = None,
    max_broken: int | None = None,
    tolerance: float = 1e-6,
    at_strains: ArrayLike = (),
    at_broken: ArrayLike = (),
    displacement: bool = True,
    stress: bool = False,
    strain_energy: bool = False,
    checkpoint: Path | None = None,
    checkpoint_every: int = 500,
    continue_from: Path | None = None,
    progress: Progress | None = None,
    on_step: OnStep | None = None,
    **bonds: Any,
) -> FractureResult:
    """Strains a sample until it has failed and returns a FractureResult.

    image, young, fracture_energy, toughness, critical_stretch  as equilibrium() takes them; pairs without one of the
              last three never break
    load      "stretch" (bottom fixed, top moves along the axis), "shear" (it moves across), "biaxial"
    axis      None: y of a picture, z of a volume
    compression  the top moves towards the bottom; strains and stresses are then positive in compression
    lateral_ratio  of "biaxial": strain along the other axes over that along the axis
    smooth_platens, rigid_platens, platen_layers  as equilibrium() takes them
    method    "auto", "events" (corrections around each break; one rank) or "accurate" (all after each break)
    breaking  "strict" (one bond at a time) or "batched" (all that are critical at once; accurate only)
    rivals    of "events": look closer where two bonds are nearly as critical as each other
    stop      ends when the stress has fallen to this share of the peak
    strain_step  the strain is raised to multiples of this, each time to the first at which a bond is critical; with
              batches, a run of fewer equilibria. 0: to where the next bond just is critical
    max_strain, max_broken  ends there; None: no limit
    tolerance  largest relative residual force of an equilibrium, at most 1e-3; a sample that carries too little for it,
              as hinges do, is refused
    at_strains, at_broken  states to keep: imposed strains, numbers of broken bonds; the end is always kept
    displacement, stress, strain_energy  whether states have these fields; what is off is not computed
    checkpoint  a file that keeps where the run stands, in HDF5; replaced after every checkpoint_every events. One that
              is there already is only replaced where continue_from names it too
    checkpoint_every  events; which of two bonds breaks first where both are nearly critical may depend on it, so a run
              goes on with the number that it began with
    continue_from  a checkpoint of the same run: the same bonds break, to the last bit, as if it had not been stopped;
              states before it are not made. With the name of checkpoint, and nothing there yet, the run begins
    progress  called as progress(share, text); return False to cancel (raises Cancelled)
    on_step   called as on_step(state) with each state that the run comes to, as ``states`` has them; memory then holds one
              at a time, and the result has the last one only

    Of the bonds' keywords it takes those of equilibrium() but strains: they are small. A sample that is periodic along
    an axis is solved by the accurate method.
    """
    if "strains" in bonds:
        raise TypeError("fracture() takes no strains: quasi-static fracture is linear")
    solve = vtkBondFracture()
    sample = as_image(image)
    solve.SetInputData(sample)
    check_keywords(fracture, set_bonds, bonds)
    set_bonds(solve, sample, young, fracture_energy, toughness, critical_stretch, **bonds)
    set_load(solve, LOADS, load, axis, smooth_platens, rigid_platens, platen_layers, tolerance, stress, strain_energy)
    solve.SetLateralRatio(float(lateral_ratio))
    solve.SetMethod(choose(_METHODS, method, "method"))
    solve.SetBreaking(choose(_BREAKINGS, breaking, "breaking"))
    solve.SetRivals(bool(rivals))
    solve.SetStrainStep(float(strain_step))
    for strain in np.ravel(at_strains):
        solve.AddStateAtStrain(float(strain))
    return run_breaks(
        solve, FractureResult, progress, compression, stop, max_strain, max_broken, at_broken, displacement,
        checkpoint, checkpoint_every, continue_from, on_step,
    )
