"""Micrographs: outlines of lumens, and lattices made from them."""

from __future__ import annotations

import gzip
import json
import os

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from . import _arrays, _files
from ._arrays import told
from ._errors import LamellaError, run
from ._samples import Sample
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, Image, Name, Path, Progress
from .vtkLamellaSolversVTK import vtkMicrographContours, vtkMicrographLattice, vtkMicrographPolygonReader, vtkOutlineDiffusion

class Contours(_arrays.FieldData):
    """Outlines of lumens. Lengths are in metres; x points right and y up from the picture's lower left corner."""

    def __init__(self, outlines, cells=None, picture=None) -> None:
        #: vtkPolyData: a poly-line a chain
        self.vtk = outlines
        #: vtkImageData: the picture that they were found in; None where they are from none
        self.picture_vtk = picture
        #: vtkPolyData: the same of the cells' outlines; None where they are not known
        self.cells_vtk = cells

    def _values(self, name):
        return vtk_to_numpy(self.vtk.GetCellData().GetArray(name))

    def __len__(self) -> int:
        return self.vtk.GetNumberOfLines()

    def _chains(self, data):
        if data is None or data.GetNumberOfLines() == 0:
            return []
        points = vtk_to_numpy(data.GetPoints().GetData())[:, :2]
        chains = []
        for chain in _arrays.lines_of(data):
            chain = chain[: len(chain) - (chain[-1] == chain[0])]
            first, last = chain[0], chain[-1]
            whole = last - first == len(chain) - 1 and np.array_equal(chain, np.arange(first, last + 1))
            chains.append(points[first : last + 1] if whole else points[chain])
        return chains

    @property
    def chains(self) -> list[Array]:
        """A list of #points by 2 [m], with the lumen on the left; closed ones do not repeat their first point. Views."""
        return self._chains(self.vtk)

    @property
    def cells(self) -> list[Array]:
        """The outlines of the cells, outside their walls, #points by 2 [m] each; an empty list where they are not known."""
        return self._chains(self.cells_vtk)

    lumens: np.ndarray = told(
        "#chains: number of the lumen, from 1; chains of a lumen that the border cuts share it (a view).", "lumen", by="_values")

    @property
    def closed(self) -> Array:
        """#chains: False for those that end on the picture's border."""
        return self._values("closed").astype(bool)

    areas: np.ndarray = told("#chains: of the whole lumen [m^2] (a view).", "area", by="_values")
    solidities: np.ndarray = told(
        "#chains: area of the whole lumen over that of its convex hull (a view).", "solidity", by="_values")
    equivalent_diameters: np.ndarray = told(
        "#chains: of the circle as large as the lumen [m] (a view).", "equivalent_diameter", by="_values")
    size: Array = told("Width and height of the picture, 2 numbers [m].", by="_numbers")

    @property
    def corner(self) -> Array:
        """Where the picture's lower left corner lies: x, y [m]."""
        return _arrays.numbers(self.vtk, "corner")[:2]

    wall_fraction: float = told("Share of the picture that no outline encloses.")
    report: list[str] = told("What finding them did, a line for each step.")

    @declared(vtkMicrographLattice, first=("spacing", "lamella"), formerly={"thickness": "lamella_thickness", "radius": "lamella_radius"})
    def lattice(self, settings: Settings) -> LatticeSample:
        """Puts the outlines on a lattice and returns a LatticeSample.
        """
        source = vtkMicrographLattice()
        source.SetInputData(self.vtk)
        if self.picture_vtk is not None:
            source.SetPictureData(self.picture_vtk)
        settings.give(source)
        run(source)
        return LatticeSample(source.GetOutput())

    def _as_json(self, data, corner):
        cells = data.GetCellData()
        closed = vtk_to_numpy(cells.GetArray("closed")).astype(bool).tolist()
        lumens = vtk_to_numpy(cells.GetArray("lumen")).tolist()
        return [
            {"closed": c, "lumen": number, "points": (points - corner).tolist()}
            for c, number, points in zip(closed, lumens, self._chains(data))
        ]

    def save(self, path: Path, overwrite: bool = False) -> str:
        """Writes a .vtp, .json or .json.gz file, whole or not at all. A .vtp does not hold the cells."""
        path = _files.new_path(path, overwrite)
        if path.lower().endswith(".vtp"):
            _files.write_poly_data(self.vtk, path)
        elif path.lower().endswith((".json", ".json.gz")):
            content = {
                "units": "metre",
                "size": self.size.tolist(),
                "contours": self._as_json(self.vtk, self.corner),
            }
            if self.cells_vtk is not None:
                content["cells"] = self._as_json(self.cells_vtk, self.corner)
            text = (json.dumps(content, separators=(",", ":")) + "\n").encode()
            _files.write_bytes(gzip.compress(text, mtime=0) if path.lower().endswith(".gz") else text, path)
        else:
            raise ValueError(f"{path}: outlines are written as .vtp, .json or .json.gz")
        return path

    def __repr__(self) -> str:
        return f"<lamella.Contours {len(self)} chains: wall fraction {self.wall_fraction:.4f}>"


class LatticeSample(Sample):
    """Outlines on a lattice: phases lumen, wall and, where there is one, middle lamella."""

    def _numbers(self, name):
        values = _arrays.numbers(self.vtk, name)
        if values is None:
            raise LamellaError(f"there is no {name.replace('_', ' ')}", 'make the lattice with lamella="growth"')
        return values

    def _tuple(self, name):
        return tuple(self._numbers(name).tolist())

    grain: Array = told("Number of the cell at each node: the lumen, and in the wall the nearest lumen (a view).")
    axis: Array = told(
        "rows by columns by 3: unit vector along the wall, whose sign means nothing; 0 in lumens (a view).")
    lumen_share: Array = told("Lumen's exact share of each pixel (a view).")
    wall_fraction: float = told("Share of the box outside the outlines, exact.")
    wall_thickness: tuple[float, float] = told(
        "From lumen to lumen: what 5 % of the outlines' length falls below, and the median.", by="_tuple")
    lamella_thickness: float = told("As used.")
    lamella_nodes_across: tuple[float, float] = told(
        "Nodes across the middle lamella: the mean, and what 5 % of it fall below.", by="_tuple")
    lamella_share: float = told("Share of the wall's nodes that are middle lamella.")


class OutlineDiffusionResult(_arrays.FieldData):
    """What outlines conduct, by direction. ``vtk`` is the outlines with all numbers as field data."""

    def __init__(self, outlines) -> None:
        #: vtkPolyData: the outlines
        self.vtk = outlines

    def _by_direction(self, name, step=1):
        values = _arrays.numbers(self.vtk, name)[::step]
        return {axis: float(values[i]) for i, axis in enumerate("xy") if self.vtk.GetFieldData().HasArray("lattices_" + axis)}

    @property
    def conductivity(self) -> dict[str, float]:
        """Effective conductivity by direction, in the unit of the phases'."""
        return self._by_direction("effective_conductivity", 4)

    error: dict[str, float] = told(
        "Relative error bar by direction, of both parts; NaN where the picture's is not known.",
        "estimated_error_by_direction", by="_by_direction")
    lattice_error: dict[str, float] = told(
        "The part of it that the lattices leave, which a smaller spacing mends.",
        "lattice_error_by_direction", by="_by_direction")
    picture_error: dict[str, float] = told(
        "The part of it that the picture's pixels leave; 0 where the outlines are taken as they are.",
        "picture_error_by_direction", by="_by_direction")

    @property
    def lattices(self) -> dict[str, Array]:
        """By direction #lattices by 2: distance of nodes [m] and conductivity, the coarsest first."""
        data = self.vtk.GetFieldData()
        return {axis: vtk_to_numpy(data.GetArray("lattices_" + axis)) for axis in self.conductivity}

    @property
    def target(self) -> str | None:
        """How a target error ended: "reached", "picture too coarse" or "memory short"; None without one."""
        return _arrays.text(self.vtk, "target") or None

    def __repr__(self) -> str:
        each = zip(self.conductivity.items(), self.error.values())
        numbers = ", ".join(f"k_{axis} {value:.6g} ± {100 * error:.2g} %" for (axis, value), error in each)
        return f"<lamella.OutlineDiffusionResult {numbers}>"


@declared(vtkMicrographContours, first=(
    "smooth", "wavelength", "tolerance", "smallest_area", "least_solidity"), without=("basis", "level", "lumen_phase"))
def contours(
    sample: Image,
    lumen: Name | None = None,
    settings: Settings | None = None,
    array: str | None = None,
    level: float | None = None,
    shares: bool = False,
) -> Contours:
    """Finds the outlines of lumens in a picture of phases, or of numbers, and returns Contours.

    sample          a Sample, a vtkImageData, or phases or numbers as an array (spacing 1)
    lumen           the phase of the lumens, its name or number; None: the first called void, pore, lumen or air
    array           which point array holds the phases ("phase"), or the numbers ("lumen_share")
    level           a number: lumens are where numbers that vary smoothly are above it; unsigned ones of 8 and 16 bits
                    count as parts of the largest one. Not smoothed, areas of second order in the pixel
    shares          True: the numbers are lumen's share of each pixel, 0 to 1; the same, and finer
    """
    if level is not None and shares:
        raise ValueError("give a level or shares, not both")
    numbers = level is not None or shares
    if numbers and lumen is not None:
        raise ValueError("lumen is a phase's name: leave it out with a level or shares")
    if settings["lumen_below"] and not numbers:
        raise ValueError("lumen_below goes with a level or shares")
    image = getattr(sample, "vtk", sample)
    if not hasattr(image, "IsA"):
        image = _arrays.to_image(sample, 1.0, "lumen_share" if numbers else "phase")
    source = vtkMicrographContours()
    source.SetInputData(image)
    if numbers:
        source.SetBasis(source.SHARES if shares else source.LEVEL)
        source.SetLevel(0.5 if level is None else level)
    if array is not None:
        source.SetInputArrayToProcess(1 if numbers else 0, 0, 0, 0, array)
    if lumen is not None:
        source.SetLumenPhase(str(lumen))
    settings.give(source)
    run(source)
    return Contours(source.GetOutput(), picture=image)


@declared(vtkMicrographPolygonReader, first=("unit", "window", "y_down", "least_diameter", "least_solidity"), without=("file_name",))
def read_polygons(path: Path, settings: Settings) -> Contours:
    """Reads outlines of cells and lumens.

    path            a JSON file of polygons, packed by gzip or not, or the .vtp of Contours
    """
    reader = vtkMicrographPolygonReader()
    reader.SetFileName(os.fspath(path))
    settings.give(reader)
    run(reader)
    cells = reader.GetCells()
    return Contours(reader.GetOutput(), cells if cells.GetNumberOfCells() > 0 else None)


@declared(vtkOutlineDiffusion, first=("conductivity", "direction", "spacing"))
def outline_diffusion(
    outlines: Contours,
    settings: Settings,
    picture: Image | bool | None = None,
    progress: Progress | None = None,
) -> OutlineDiffusionResult:
    """Solves steady diffusion through outlines, with an error bar, and returns an OutlineDiffusionResult.

    outlines        Contours, or a vtkPolyData like theirs
    picture         the picture that they were found in, whose pixels leave an error. None: the one that they remember;
                    False: they are taken as they are
    """
    solver = vtkOutlineDiffusion()
    solver.SetInputData(getattr(outlines, "vtk", outlines))
    if picture is None:
        picture = getattr(outlines, "picture_vtk", None)
    if picture is not None and picture is not False:
        solver.SetPictureData(as_image(picture))
    settings.give(solver)
    run(solver, progress)
    return OutlineDiffusionResult(solver.GetOutput())
