"""What samples that break have in common, under a load and in motion: states, broken bonds, curve, checkpoints."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkTable

from . import _arrays, _files
from ._arrays import told
from ._bonds import BondFields, BondNumbers, give_bonds
from ._errors import run
from ._runs import LoadedState, LongRun, check_checkpoint
from ._types import Array, Path


class BrokenState(BondFields, LoadedState):
    """The sample in one state: ``vtk`` is the image with ``damage``, ``broken`` and what was asked for."""

    damage: Array = told("Share of each node's bonds that are broken, 0 to 1; NaN in voids (a view).")
    broken: Array = told("Broken bonds of each node (a view).")
    broken_bonds: int = told("How many bonds of the sample are broken.")


class BreakResult(BondNumbers, LongRun):
    """``vtk`` is the image at the end with all numbers as field data; ``vtk_broken`` a vtkPolyData with a vertex a
    broken bond; ``vtk_curve`` a vtkTable."""

    _State = BrokenState
    _KINDS = ()  # of broken bonds: name, type, components
    _TIMES = ()  # what took how long

    def __init__(self, algorithm) -> None:
        images = [algorithm.GetStateImage(i) for i in range(algorithm.GetNumberOfStates())]
        super().__init__(images[-1])
        #: a state for each one asked for that was reached, and the end
        self.states = [self._State(image) for image in images]
        self.vtk_broken, self.vtk_curve = vtkPolyData(), vtkTable()
        self.vtk_broken.ShallowCopy(algorithm.GetBrokenBonds())
        self.vtk_curve.ShallowCopy(algorithm.GetCurve())

    def _at_end(self, name):
        return getattr(self.states[-1], name)

    stress: Array = told("Curve: stresses at ``strain`` [Pa].", by="_column")
    broken_so_far: Array = told("Curve: number of broken bonds at ``strain``.", "broken", by="_column")

    def _broken_bonds(self):
        d = self._dimension
        kinds = [(name, kind, () if n == 1 else (n,)) for name, kind, n in self._KINDS]
        kinds += [("position", "f8", (d,)), ("bond", "f8", (d,)), ("phases", "u1", (2,)), ("between_grains", "?", ())]
        data = self.vtk_broken.GetPointData()
        bonds = np.zeros(self.vtk_broken.GetNumberOfPoints(), dtype=kinds)
        if len(bonds) > 0:
            for name, _, shape in kinds:
                points = self.vtk_broken.GetPoints().GetData()
                values = vtk_to_numpy(points if name == "position" else data.GetArray(name))
                bonds[name] = values[:, : shape[0]] if shape else values
        return bonds

    end: str = told(
        'Why the run ended: "stress-fell", "maximum-strain" or "maximum-broken"; of fracture() also "severed" '
        'or "nothing-breaks", of dynamics() "time".')

    def _seconds(self):
        return dict(zip(self._TIMES, map(float, _arrays.numbers(self.vtk, "seconds"))))

    peak_stress: float = told("The largest stress: the strength, if the run went beyond it [Pa].")
    peak_strain: float = told("The strain imposed then.")
    damage: Array = told("At the end: share of each node's bonds that are broken, 0 to 1; NaN in voids (a view).", by="_at_end")
    displacement: Array = told("At the end: [m], x, y (and z) in the last axis (a view).", by="_at_end")

    def save_broken(self, path: Path, overwrite: bool = False) -> str:
        """Writes the broken bonds as a .vtp file, whole or not at all."""
        return _files.save_poly_data(self.vtk_broken, path, overwrite)


def run_breaks(algorithm, image, result, settings, progress, on_step):
    """Sets what was given and runs; the result is of this class."""
    algorithm.SetInputData(image)
    check_checkpoint(settings)
    give_bonds(settings, algorithm, image)
    run(algorithm, progress, on_step, result._State)
    return result(algorithm)
