"""Packings of grains and the matrix between them."""

from __future__ import annotations

import os

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

from . import _arrays, _files
from ._arrays import told
from ._errors import LamellaError, run
from ._samples import Sample
from ._settings import Settings, declared
from ._types import Array, ArrayLike, OnStep, Path, Progress
from .vtkLamellaSolversVTK import vtkGrainPacking, vtkMatrixBridges, vtkPackingReader


class Packing(_arrays.FieldData):
    """Grains at rest. Lengths are in metres, forces in newtons (of disks: a metre of thickness)."""

    def __init__(self, particles, contacts=None, states=()) -> None:
        #: vtkPolyData: a point a grain
        self.vtk = particles
        #: vtkPolyData: a line a contact; None where they are not known
        self.contacts_vtk = contacts
        #: of packing() with every=: a Packing for each state on the way, and the end; else empty
        self.states = list(states)

    def _points(self, name):
        return vtk_to_numpy(self.vtk.GetPointData().GetArray(name))

    def _contacts(self, name):
        if self.contacts_vtk is None or self.contacts_vtk.GetCellData().GetArray(name) is None:
            raise LamellaError("this packing's contacts are not known", "a .vtp of grains does not hold them")
        return vtk_to_numpy(self.contacts_vtk.GetCellData().GetArray(name))

    def _number(self, name):
        values = _arrays.numbers(self.vtk, name)
        return float("nan") if values is None else float(values[0])

    def _tensor(self, name):
        n = self.dimension
        return _arrays.numbers(self.vtk, name).reshape(3, 3)[:n, :n]

    def __len__(self) -> int:
        return self.vtk.GetNumberOfPoints()

    @property
    def dimension(self) -> int:
        """2: disks, 3: spheres."""
        box = _arrays.numbers(self.vtk, "box")
        return 3 if (box[2] > 0 if box is not None else np.ptp(self._all_centres()[:, 2]) > 0) else 2

    def _all_centres(self):
        return vtk_to_numpy(self.vtk.GetPoints().GetData())

    @property
    def centres(self) -> Array:
        """#grains by 2 (disks: x, and y upwards) or 3 [m] (a view)."""
        return self._all_centres()[:, : self.dimension]

    radii: np.ndarray = told("#grains [m] (a view).", "radius", by="_points")

    @property
    def rattlers(self) -> Array:
        """#grains, True for those that nothing holds."""
        return self._points("rattler").astype(bool)

    contact_numbers: np.ndarray = told(
        "#grains, how many contacts each has, walls included (a view).", "contacts", by="_points")

    @property
    def net_forces(self) -> Array:
        """#grains by 2 or 3, the sum of the forces on each [N], of disks [N/m] (a view)."""
        return self._points("net_force")[:, : self.dimension]

    @property
    def contacts(self) -> Array:
        """#contacts by 2, grains counted from 0; the second is -1 ... -6 for the walls at low x, high x, low y ..."""
        pairs = np.stack([self._contacts("first"), self._contacts("second")], axis=1)
        return np.where(pairs > 0, pairs - 1, pairs)

    @property
    def forces(self) -> Array:
        """#contacts by 2 or 3, on the second grain of each by the first [N], of disks [N/m] (a view)."""
        return self._contacts("force")[:, : self.dimension]

    normal_forces: Array = told(
        "#contacts, compression is positive [N], of disks [N/m] (a view).", "normal_force", by="_contacts")

    @property
    def box(self) -> Array:
        """Edges of the box [m], 2 or 3 numbers."""
        return _arrays.numbers(self.vtk, "box")[: self.dimension]

    @property
    def periodic(self) -> bool:
        """Whether the box is one cell of an endless packing."""
        return bool(self._number("periodic") == 1)

    packing_fraction: float = told("Share of the box that is grains.")
    coordination: float = told("Contacts of a grain that is no rattler.")
    fabric: Array = told("Mean of n n over the contacts between grains, a matrix whose trace is 1.", by="_tensor")
    stress: Array = told("Mean stress [Pa], 2 by 2 or 3 by 3, compression positive.", by="_tensor")
    fabric_anisotropy: float = told("(largest - smallest)/sum of the fabric's principal values.")
    stress_anisotropy: float = told("The same of the stress.")
    unbalanced_force: float = told("Mean net force on a grain over the mean contact force.")

    @property
    def steps(self) -> int:
        """Steps of relaxation that led to it; of a table 0."""
        return 0 if _arrays.numbers(self.vtk, "relaxation_steps") is None else self._count("relaxation_steps")

    @property
    def stage(self) -> str:
        """What was done in a state: compressing, settling, turning, hardening, squeezing; at rest in the end; empty for a table."""
        text = self.vtk.GetFieldData().GetAbstractArray("stage")
        return text.GetValue(0) if text is not None else ""

    def save(self, path: Path, contacts: Path | None = None, overwrite: bool = False) -> str:
        """Writes the grains, and with ``contacts`` their contacts, as .vtp files, each whole or not at all."""
        if contacts is not None:
            self._contacts("force")  # says so where there are none
        both = ((path, self.vtk), (contacts, self.contacts_vtk))
        files = [(_files.new_path(name, overwrite), data) for name, data in both if name is not None]
        for name, data in files:
            _files.write_poly_data(data, name)
        return os.fspath(path)

    def __repr__(self) -> str:
        kind = "spheres" if self.dimension == 3 else "disks"
        return f"<lamella.Packing {len(self)} {kind}: packing fraction {self.packing_fraction:.4f}>"


@declared(vtkGrainPacking, first=("count", "dimension"), without=("keep_states", "state", "seeds", "threads"))
def packing(settings: Settings, progress: Progress | None = None, on_step: OnStep | None = None) -> Packing:
    """Presses grains together until they are at rest and returns a Packing.

    on_step         called as on_step(state) with each state, a Packing; memory then holds one at a time, and ``states`` has the
                    end alone
    """
    source = vtkGrainPacking()
    settings.give(source)
    run(source, progress, on_step, lambda data: Packing(data, source.GetStateContacts(source.GetNumberOfStates() - 1)))
    count = source.GetNumberOfStates() if settings["every"] > 0 else 0
    states = [Packing(source.GetStateGrains(i), source.GetStateContacts(i)) for i in range(count)]
    return Packing(source.GetOutput(), source.GetContacts(), states)


@declared(vtkGrainPacking, first=("seeds", "count", "dimension"), without=("keep_states", "state", "seed", "every"))
def packings(settings: Settings, progress: Progress | None = None, on_step: OnStep | None = None) -> list[Packing]:
    """Presses several packings, one of each seed, ``threads`` at once, and returns them: the same as one by one.

    on_step         called as on_step(packing) with each of them once all are made; the list then has the last one only
    """
    source = vtkGrainPacking()
    settings.give(source)
    run(source, progress, on_step, lambda data: Packing(data, source.GetStateContacts(source.GetNumberOfStates() - 1)))
    return [Packing(source.GetStateGrains(i), source.GetStateContacts(i)) for i in range(source.GetNumberOfStates())]


@declared(vtkPackingReader, first=("unit", "box"), without=("file_name",))
def read_packing(path: Path, settings: Settings) -> Packing:
    """Reads grains.

    path            a table (columns x, z, r of disks or x, y, z, r of spheres), or the .vtp of a Packing
    """
    reader = vtkPackingReader()
    reader.SetFileName(os.fspath(path))
    settings.give(reader)
    run(reader)
    contacts = reader.GetContacts()
    return Packing(reader.GetOutput(), contacts if contacts.GetNumberOfCells() > 0 else None)


def _as_particles(grains):
    if isinstance(grains, Packing):
        return grains.vtk
    if hasattr(grains, "IsA"):
        return grains
    if not (isinstance(grains, (tuple, list)) and len(grains) == 2):
        raise ValueError(f"grains is of type {type(grains).__name__}; give a Packing, a vtkPolyData or (centres, radii)")
    centres, radii = grains
    centres = np.atleast_2d(_arrays.reals(centres, "centres"))
    radii = _arrays.reals(radii, "radii").ravel()
    if centres.shape[1] not in (2, 3) or len(centres) != len(radii):
        raise ValueError(f"centres {centres.shape} and radii {radii.shape}: they are n by 2 or 3, and n")
    points = np.zeros((len(centres), 3))
    points[:, : centres.shape[1]] = centres
    data = vtkPolyData()
    data.SetPoints(vtkPoints())
    data.GetPoints().SetData(_arrays.to_vtk(points, "centres", (3,)))
    data.SetVerts(vtkCellArray())
    data.GetPointData().AddArray(_arrays.to_vtk(radii, "radius"))
    return data


class CementedSample(Sample):
    """Grains and matrix on a lattice: phases void, matrix, grain."""

    grain: Array = told(
        "Number of the grain at each node, from 1; 0: none, -1: platen. In the order of pictures (a view).")
    width: float = told("Width of a bridge at a grain's centre over the grain's diameter.")
    bridges: int = told("Number of bridges.")
    saturation: float = told("Share of the space between the grains that is matrix, of the geometry.")
    saturation_on_lattice: float = told("The same of the nodes.")


@declared(vtkMatrixBridges)
def bridges(grains: Packing | vtkPolyData | tuple[ArrayLike, ArrayLike], settings: Settings) -> CementedSample:
    """Puts bridges of matrix between grains and returns a sample of the phases void, matrix and grain.

    grains          a Packing, a vtkPolyData of particles, or (centres, radii) as arrays, n by 2 or 3 and n
    """
    source = vtkMatrixBridges()
    source.SetInputData(_as_particles(grains))
    settings.give(source)
    run(source)
    return CementedSample(source.GetOutput())
