"""Quasi-static fracture: strength, curve, broken bonds, damage."""

from __future__ import annotations

import numpy as np

from ._arrays import told
from ._bonds import FORMERLY, MATERIALS, BreakInputs
from ._breaks import BreakResult, BrokenState, run_breaks
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Any, Array, Image, OnStep, Progress
from ._windows import WindowErrors
from .vtkLamellaSolversVTK import vtkBondFracture

_COUNTS = (
    "events raises equilibria iterations local_cycles visited_nodes searches freed_pieces freed_nodes freed_bonds "
    "solid_nodes skipped_nodes bonds skipped_strips bytes"
).split()


class FractureState(BrokenState):
    """The sample in one state: ``vtk`` is the image with ``damage``, ``broken`` and what was asked for."""

    def __repr__(self) -> str:
        return f"<lamella.FractureState: strain {self.imposed_strain:.6g}, {self.broken_bonds} bonds broken>"


class FractureResult(BreakInputs, BreakResult, WindowErrors):
    """``vtk`` is the image at the end with all numbers as field data; ``vtk_broken`` a vtkPolyData with a vertex a
    broken bond; ``vtk_curve`` a vtkTable.

    Strains and stresses are positive along the load. Energies of a picture are per metre of thickness. y points up.
    """

    _State = FractureState
    _KINDS = (("event", "i8", 1), ("strain", "f8", 1), ("critical_strain", "f8", 1), ("stress", "f8", 1))
    _TIMES = ("bonds", "first", "equilibria", "local", "search", "run", "states", "checkpoints")

    strain: Array = told(
        "Curve: imposed strains, from 0 on; without turning points they never fall. Just before each event, what each avalanche left, "
        "turning points and passages of 0, the end.", by="_column")
    critical_strain: Array = told(
        "Curve that follows every snap-back: strain at which the next bond is just critical.", by="_column")
    critical_stress: Array = told(
        "Curve that follows every snap-back: stress at ``critical_strain`` [Pa].", by="_column")

    def _asked(self, name):
        return float("nan") if self._numbers(name) is None else self._number(name)

    strength_exponent: float = told(
        "Strength is in proportion to volume (of a picture its area) to this power, by the windows' means; rough. NaN"
        " unless a window error was asked for.", by="_asked")
    segmentation_error: float = told(
        "How far the strength may be off because surfaces between solid and void lie elsewhere [Pa]; rough. NaN unless it was asked"
        " for.", "strength_segmentation_error", by="_asked")
    total_error: float = told(
        "The root of the squares of this and of the window's error [Pa]; NaN unless both were asked for.", "strength_total_error", by="_asked")
    weibull_modulus: float = told("Weibull's modulus by the scatter of the windows' strengths; rough. NaN likewise.", by="_asked")

    @property
    def broken(self) -> Array:
        """The broken bonds in order, a structured array: ``event`` (from 1), ``strain`` (imposed), ``critical_strain``,
        ``stress`` [Pa], ``position`` of the middle and ``bond`` vector (x, y (and z) [m]), ``phases`` of both ends (the
        lesser first), ``between_grains``."""
        return self._broken_bonds()

    @property
    def branches(self) -> Array:
        """Of a load that turns round, from one turning point to the next, a structured array: ``from`` and ``to`` (strains),
        ``stress`` and ``modulus`` [Pa] (stress over strain; NaN at 0) at its end, ``work`` of the platens and what of it was
        ``released`` by the breaks [J/m³, over the box between the platens], ``broken`` bonds. Empty without turning points."""
        names = ("from", "to", "stress", "modulus", "work", "released", "broken")
        columns = [self._numbers(f"branch_{name}") for name in names]
        found = np.zeros(0 if columns[0] is None else len(columns[0]), [(name, "i8" if name == "broken" else "f8") for name in names])
        for name, column in zip(names, columns):
            if column is not None:
                found[name] = column
        return found

    trough_stress: float = told("The largest stress against the load [Pa], negative or 0; NaN without turning points.", by="_asked")
    trough_strain: float = told("The strain then; NaN likewise.", by="_asked")

    first_break_strain: float = told("Strain at which the first bond broke; NaN where none did.")
    first_break_stress: float = told("Stress at which the first bond broke [Pa]; NaN where none did.")

    @property
    def modulus(self) -> float:
        """Stress over strain of the unbroken sample [Pa]."""
        return self.effective_modulus

    broken_energy: float = told("What the broken bonds held when they were just critical [J].")
    method: str = told('"events" or "accurate".')

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


@declared(vtkBondFracture, first=MATERIALS, without=("keep_states", "state", "large_strains"), formerly={"void_bonds": FORMERLY["void_bonds"]})
def fracture(image: Image, settings: Settings, progress: Progress | None = None, on_step: OnStep | None = None) -> FractureResult:
    """Strains a sample until it has failed and returns a FractureResult.

    image           as equilibrium() takes it, and so are pairs; those that are given no toughness, fracture energy or
                    critical stretch never break
    on_step         called as on_step(state) with each state that the run comes to, as ``states`` has them; memory then holds
                    one at a time, and the result has the last one only

    Quasi-static fracture is linear: strains are small. A sample that is periodic along an axis is solved by the accurate
    method. One that carries too little for the tolerance, as hinges do, is refused. A checkpoint that is there already is
    only replaced where continue_from names it too.
    """
    return run_breaks(vtkBondFracture(), as_image(image), FractureResult, settings, progress, on_step)
