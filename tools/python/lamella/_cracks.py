"""Cracks from broken bonds."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from . import _arrays, _files
from ._arrays import told
from ._dynamics import DynamicsResult
from ._errors import run
from ._fracture import FractureResult
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, Columns, Image, Path, Progress
from .vtkLamellaFilters import vtkCrackPath


class CrackPathResult(_arrays.FieldData):
    """``vtk`` holds the paths as poly-lines, the longest first; lengths are in metres, angles in degrees to x.

    In a volume it holds the cracks' surfaces as triangles, with the cell arrays ``crack``, ``area``, ``normal``,
    ``event`` and ``phases``.
    """

    def __init__(self, crack_path) -> None:
        #: vtkPolyData, a poly-line a path; in a volume triangles
        self.vtk = crack_path.GetOutput()
        #: vtkTable, one row a path; in a volume one row a crack
        self.vtk_paths = crack_path.GetPathTable()
        #: vtkTable, one row a pair of phases
        self.vtk_pairs = crack_path.GetPairTable()
        #: vtkTable, one row an event at which a path grew
        self.vtk_growth = crack_path.GetGrowthTable()
        #: vtkTable, one row a fragment
        self.vtk_fragments = crack_path.GetFragmentTable()
        image = crack_path.GetImage()
        #: the image with the array ``fragment``; None without an image of phases
        self.image = ImageBase(image) if image.GetNumberOfPoints() > 0 else None

    def _number(self, name):
        values = self._numbers(name)
        return None if values is None else float(values[0])

    @property
    def lines(self) -> list[Array]:
        """Points of each path, an array (n, 2) of x and y [m]; y points up."""
        points = self.vtk.GetPoints()
        if points is None:
            return []
        places = vtk_to_numpy(points.GetData())[:, :2]
        return [places[ids] for ids in _arrays.lines_of(self.vtk)]

    table: Columns = told(
        "Columns by name, one entry a path: ``path``, ``crack``, ``length``, ``chord``, ``tortuosity``, "
        "``angle``, ``angle_spread``, ``bonds``, ``counted_length``, ``first_event`` ..., ``begins_at``, "
        "``ends_at``, ``begin_x`` ..., ``x_min`` ..., ``share_wall`` ...; in a volume one entry a crack: ``crack``, "
        "``area``, ``normal_x`` ..., ``alignment``, ``first_event`` ..., ``x_min`` ..., ``share_wall`` ...", "vtk_paths")
    pairs: Columns = told(
        "Columns by name, one entry a pair of phases: ``pair``, ``length`` (in a volume ``area``), ``share``, "
        "``bonds``, ``share_of_bonds``, ``counted_length`` (``counted_area``).", "vtk_pairs")

    @property
    def shares(self) -> dict[str, float]:
        """Share of the length (in a volume of the area) by pair of phases, as "wall", "wall-lamella"."""
        pairs = self.pairs
        return {pair: float(share) for pair, share in zip(pairs.get("pair", ()), pairs.get("share", ()))}

    growth: Columns = told(
        "Columns by name, one entry an event: ``event``, ``strain`` or ``time``, ``length``, ``main_length`` (in a "
        "volume ``area``, ``main_area``), in pictures with times ``rate`` and ``main_rate`` [m/s].", "vtk_growth")
    fragments: Columns = told(
        "Columns by name, one entry a fragment, the largest first; empty without an image of phases.", "vtk_fragments")

    @property
    def count(self) -> int | None:
        """Number of cracks: of sets of paths, in a volume of faces of voxels, that hang together."""
        number = self._number("crack_count")
        return None if number is None else int(number)

    length: float | None = told("Length of all paths [m]. None in a volume.", "crack_length")
    area: float | None = told("Area of all surfaces, one side [m²]. None in a picture.", "crack_area")
    main_area: float | None = told("Area of crack 1 [m²]. None in a picture.")
    main_length: float | None = told("Length of the longest crack, its branches included [m]. None in a volume.")

    def _place(self, name):
        place = self._numbers(name)
        return None if place is None or np.isnan(place[0]) else (float(place[0]), float(place[1]))

    tip: tuple[float, float] | None = told(
        "Tip of the longest crack, x and y [m]: the end of it that is farthest, along its paths, from where it "
        "broke first. None where there is no crack or it is closed, and in a volume.", "main_tip", by="_place")
    start: tuple[float, float] | None = told(
        "Where the longest crack broke first, x and y [m]. None as of tip.", "main_start", by="_place")
    extension: float | None = told(
        "Length of the longest crack from start to tip [m]; without a crack 0. None in a volume.", "main_extension")
    through: str | None = told(
        'Axes along which the longest crack leads from side to side, as "x". None in a volume.',
        "main_through", by="_axes")

    @property
    def through_tortuosity(self) -> dict[str, float]:
        """By axis, "x" and "y": length over chord of the shortest way from side to side, over paths and straight across
        voids; only axes along which there is one.
        """
        values = self._numbers("through_tortuosity")
        return {} if values is None else {a: float(v) for a, v in zip("xy", values) if np.isfinite(v)}

    angle: float | None = told(
        "Mean direction of all paths, weighted by length [degrees to x]. None in a volume.", "crack_angle")
    counted: float | None = told(
        "Length [m], in a volume area [m²], that the number of broken bonds stands for.", "counted_size")

    @property
    def normals(self) -> Array:
        """Mean of n n over the cracks by the broken bonds, an array (3, 3)."""
        return np.reshape(self._numbers("crack_normals"), (3, 3))

    broken: float | None = told("Number of broken bonds.", "broken_bonds", by="_count")
    severed: str | None = told(
        'Axes along which no fragment reaches from side to side, as "y"; None without an image of phases.', by="_axes")

    def save(self, path: Path, overwrite: bool = False) -> str:
        """Writes the paths, or in a volume the surfaces, as .vtp, whole or not at all."""
        return _files.save_poly_data(self.vtk, path, overwrite)

    def __repr__(self) -> str:
        if self.length is None:
            return f"<lamella.CrackPathResult: {self.count} cracks, {self.area:.4g} m², {self.broken} broken bonds>"
        return f"<lamella.CrackPathResult: {self.count} cracks, {self.length:.4g} m, {self.broken} broken bonds>"


@declared(vtkCrackPath)
def crack_path(
    broken: FractureResult | DynamicsResult | vtkPolyData,
    phases: Image | None = None,
    settings: Settings | None = None,
    progress: Progress | None = None,
) -> CrackPathResult:
    """Makes lines of broken bonds, in a volume surfaces, and measures them.

    broken          a FractureResult, or vtkPolyData: points at the middles of broken bonds, with the array ``bond``
    phases          a Sample, image or array of whole numbers on their lattice; with it voids and fragments are known.
                    None: the image of the FractureResult
    """
    path = vtkCrackPath()
    if phases is None and hasattr(broken, "vtk_broken"):
        phases = broken.vtk
    path.SetInputData(getattr(broken, "vtk_broken", broken))
    if phases is not None:
        path.SetImageData(as_image(phases))
    settings.give(path)
    run(path, progress)
    return CrackPathResult(path)
