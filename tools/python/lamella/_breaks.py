"""What samples that break have in common, under a load and in motion: states, broken bonds, curve, checkpoints."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkTable

from . import _arrays, _files
from ._bonds import BondFields, BondNumbers, give_bonds
from ._errors import run
from ._runs import LoadedState, LongRun, check_checkpoint
from ._types import Array, Path


class BrokenState(BondFields, LoadedState):
    """The sample in one state: ``vtk`` is the image with ``damage``, ``broken`` and what was asked for."""

    @property
    def damage(self) -> Array:
        """Share of each node's bonds that are broken, 0 to 1; NaN in voids (a view)."""
        return self.array("damage")

    @property
    def broken(self) -> Array:
        """Broken bonds of each node (a view)."""
        return self.array("broken")

    @property
    def broken_bonds(self) -> int:
        """How many bonds of the sample are broken."""
        return self._count("broken_bonds")


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

    def _column(self, name):
        return vtk_to_numpy(self.vtk_curve.GetColumnByName(name))

    @property
    def stress(self) -> Array:
        """Curve: stresses at ``strain`` [Pa]."""
        return self._column("stress")

    @property
    def broken_so_far(self) -> Array:
        """Curve: number of broken bonds at ``strain``."""
        return self._column("broken")

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

    @property
    def end(self) -> str:
        """Why the run ended: "stress-fell", "maximum-strain" or "maximum-broken"; of fracture() also "severed" or
        "nothing-breaks", of dynamics() "time"."""
        return _arrays.text(self.vtk, "end")

    def _seconds(self):
        return dict(zip(self._TIMES, map(float, _arrays.numbers(self.vtk, "seconds"))))

    @property
    def peak_stress(self) -> float:
        """The largest stress: the strength, if the run went beyond it [Pa]."""
        return self._number("peak_stress")

    @property
    def peak_strain(self) -> float:
        """The strain imposed then."""
        return self._number("peak_strain")

    @property
    def damage(self) -> Array:
        """At the end: share of each node's bonds that are broken, 0 to 1; NaN in voids (a view)."""
        return self.states[-1].damage

    @property
    def displacement(self) -> Array:
        """At the end: [m], x, y (and z) in the last axis (a view)."""
        return self.states[-1].displacement

    def save_broken(self, path: Path, overwrite: bool = False) -> str:
        """Writes the broken bonds as a .vtp file, whole or not at all."""
        path = _files.new_path(path, overwrite)
        _files.write_poly_data(self.vtk_broken, path)
        return path


def run_breaks(algorithm, image, result, settings, progress, on_step):
    """Sets what was given and runs; the result is of this class."""
    algorithm.SetInputData(image)
    check_checkpoint(settings)
    give_bonds(settings, algorithm, image)
    run(algorithm, progress, on_step, result._State)
    return result(algorithm)
