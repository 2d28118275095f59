"""Samples: pictures of phases, read or generated."""

from __future__ import annotations

import os
import warnings

import numpy as np
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from . import _arrays, _files
from ._errors import LamellaError, choose, collect_warnings, entries, run
from ._types import Any, Array, ArrayLike, Mapping, Path, Sequence
from .vtkLamellaSolversVTK import vtkMicrostructureSource, vtkPictureReader, vtkVTKHDFWriter


class ImageBase(_arrays.FieldData):
    """An image on a lattice and what it carries."""

    def __init__(self, image) -> None:
        #: the vtkImageData itself
        self.vtk = image

    @property
    def spacing(self) -> float:
        """Distance of neighbouring nodes in metres (1 where nobody knows it: see ``pixel_size_source``)."""
        return self.vtk.GetSpacing()[0]

    @property
    def shape(self) -> tuple[int, ...]:
        """(rows, columns) of a picture, (z, y, x) of a volume."""
        nx, ny, nz = self.vtk.GetDimensions()
        return (ny, nx) if nz == 1 else (nz, ny, nx)

    @property
    def pixel_size_source(self) -> str:
        """Who says so: "option", an entry of the file, or "none"."""
        return _arrays.text(self.vtk, "pixel_size_source")

    @property
    def names(self) -> list[str]:
        """Names of the phases; the position is the phase's number."""
        return _arrays.texts(self.vtk, "phase_names")

    @property
    def phase(self) -> Array:
        """Numbers of the phases as an array of the image's shape (a view, no copy)."""
        return self.array("phase")

    def array(self, name: str) -> Array:
        """A point array by its name, in the order of pictures (a view, no copy)."""
        array = self.vtk.GetPointData().GetArray(name)
        if array is None:
            data = self.vtk.GetPointData()
            there = ", ".join(data.GetArrayName(i) for i in range(data.GetNumberOfArrays()))
            raise KeyError(f"no array '{name}'; there are: {there}")
        return _arrays.to_numpy(self.vtk, array)

    def set_array(self, name: str, values: ArrayLike, copy: bool | None = None) -> None:
        """Adds a point array, or replaces it: numbers of the image's shape, in the order of pictures.

        Vectors and tensors have their components in the last axis; of vectors of a picture two are enough. Names and
        units that solvers look for: ``grain`` (whole numbers, 0 none), ``axis`` (unit vectors), ``displacement`` [m],
        ``velocity`` [m/s], ``stress`` [Pa]. ``copy`` as of from_array(), for any type of numbers.
        """
        given = _arrays.checked(values, name, "give numbers of 1, 2, 4 or 8 bytes")
        dimension = len(self.shape)
        tail = given.shape[dimension:]
        if given.shape[:dimension] != self.shape or len(tail) > 1 or 0 in tail:
            raise ValueError(f"{name} has the shape {given.shape}; the sample's is {self.shape}, with components behind it")
        ordered = _arrays.in_vtk_order(given, dimension)
        if tail == (2,):
            ordered = np.concatenate([ordered, np.zeros((*self.shape, 1), given.dtype)], axis=-1)
            tail = (3,)
            if copy is False:
                raise ValueError(f"{name} needs a copy: VTK's vectors have three components; give three, or say copy=None")
        self.vtk.GetPointData().AddArray(_arrays.to_vtk(ordered, name, tail, copy))

    def save(self, path: Path, overwrite: bool = False) -> str:
        """Writes a .vti file, or VTKHDF where the path ends in .hdf or .vtkhdf, whole or not at all."""
        path = _files.new_path(path, overwrite)
        with _files.replacing(path) as part:
            if path.endswith((".hdf", ".vtkhdf")):
                writer = vtkVTKHDFWriter()
            else:
                writer = vtkXMLImageDataWriter()
                writer.SetDataModeToBinary()  # inline: VTK 9.2 with a new Expat cannot read "appended" data back
            writer.SetInputData(self.vtk)
            writer.SetFileName(part)
            if writer.Write() != 1 or os.path.getsize(part) == 0:
                raise OSError(f"cannot write {path}: is the disk full?")
        return path


class Sample(ImageBase):
    """A picture or volume of phases. ``numpy.asarray(sample)`` gives their numbers."""

    def __array__(self, dtype: Any = None) -> Array:
        return np.asarray(self.phase, dtype=dtype)

    @property
    def fractions(self) -> dict[str, float]:
        """Share of each phase by its name."""
        count = np.bincount(self.phase.ravel(), minlength=len(self.names))
        names = self.names or [str(i) for i in range(len(count))]
        return {name: float(n) / self.phase.size for name, n in zip(names, count)}

    @property
    def segmentation(self) -> list[str]:
        """How read_picture() parted its greys, a line a step; empty where it did not."""
        return _arrays.texts(self.vtk, "segmentation")

    def __repr__(self) -> str:
        shares = ", ".join(f"{name} {share:.3f}" for name, share in self.fractions.items())
        return f"<lamella.Sample {' x '.join(map(str, self.shape))}: {shares}>"


def _sample(algorithm):
    run(algorithm)
    return Sample(algorithm.GetOutput())


def read_picture(
    path: Path,
    phases: Mapping[int | str, str] | None = None,
    other: str | None = None,
    window: Sequence[int] | None = None,
    refine: int = 1,
    pixel_size: float | None = None,
    segment: bool = False,
    lumen: str = "auto",
    threshold: float | None = None,
    array: str | None = None,
    raw_size: Sequence[int] | None = None,
    raw_bits: int | None = None,
    raw_header: int = 0,
) -> Sample:
    """Reads a picture (PNG, JPEG, TIFF, PGM, PPM, BMP), a volume (TIFF stack, slices, raw, MetaImage, NRRD) or a .vti file.

    path        of slices a pattern, such as slice_%03d.png
    phases      {grey value or range of them: name}: 255, "90..255", "90..", "..89", both ends in it; "..otsu" and "otsu.."
                part the greys where the picture says, "..otsu1", "otsu1..otsu2" and "otsu2.." into three. None: every grey
                value is a phase of its own, named by its value
    other       name for all greys that are not listed; none: such a grey is an error
    window      (x, y, width, height) in pixels from the top left; of a volume (x, y, z, width, height, depth)
    refine      splits each pixel into refine x refine nodes
    pixel_size  metres; wins over what the file says
    segment     a raw scan: find the phases lumen and wall in a picture; void and solid, or those of phases, in a volume
    lumen       with segment: "auto", "bright" or "dark" lumens; of a volume the void, and "auto" is dark
    threshold   with segment: grey between the two once the light is even, of a picture 0 to 255; None: found
    array       .vti files: which array; the other point arrays come along (with refine only grain and axis)
    raw_size, raw_bits, raw_header   raw volumes: (nx, ny, nz), 8 or 16, bytes to skip

    What is doubtful about the file, or about what segmenting made of it, is a Python warning.
    """
    reader = vtkPictureReader()
    reader.SetFileName(os.fspath(path))
    for grey, name in entries(phases, "phases", "{grey value: name}"):
        reader.SetPhase(grey if isinstance(grey, str) else str(int(grey)), name)
    reader.SetOtherPhase(other)
    if window is not None:
        window = [int(value) for value in window]
        if len(window) == 4:
            x, y, width, height = window
            window = [x, y, 0, width, height, 0]
        if len(window) != 6:
            raise ValueError("a window is (x, y, width, height) or (x, y, z, width, height, depth)")
        reader.SetWindow(*window)
        if not any(window):
            raise LamellaError("the window is empty", "give a width and a height")
    reader.SetRefinement(refine)
    if pixel_size is not None:
        if not pixel_size > 0:
            raise LamellaError(f"the pixel size is {pixel_size}", "give it in metres, above 0")
        reader.SetPixelSize(pixel_size)
    reader.SetSegment(bool(segment))
    reader.SetLumen(choose({"auto": 0, "bright": 1, "dark": 2}, lumen, "lumen"))
    if threshold is not None:
        reader.SetThreshold(threshold)
    reader.SetArrayName(array)
    if raw_size is not None:
        reader.SetRawSize(*raw_size)
    if raw_bits is not None:
        reader.SetRawBits(raw_bits)
    reader.SetRawHeader(raw_header)
    doubts = collect_warnings(reader)
    sample = _sample(reader)
    for doubt in doubts:
        warnings.warn(doubt, stacklevel=2)
    return sample


def from_array(
    phase: ArrayLike,
    names: Sequence[str] | Mapping[int, str] | None = None,
    spacing: float = 1.0,
    copy: bool | None = None,
) -> Sample:
    """A sample from whole numbers: ``phase[row, column]`` with row 0 at the top, or ``phase[z, y, x]``.

    names    names of the phases, a list by number or {number: name}
    spacing  metres
    copy     None: the sample shares the array's memory where it can, and keeps it alive. It can with a volume of
             numpy.uint8 that is contiguous and writeable, and with a picture of that type whose *last* row comes first
             in memory, as ``numpy.empty((rows, columns), numpy.uint8)[::-1]`` and the arrays of this package have it.
             True: always a copy. False: an error where one is needed
    """
    image = _arrays.to_image(phase, spacing, copy=copy)
    if names is not None:
        if isinstance(names, dict):
            names = [names.get(i, str(i)) for i in range(max(names) + 1)]
        array = vtkStringArray()
        array.SetName("phase_names")
        for name in names:
            array.InsertNextValue(name)
        image.GetFieldData().AddArray(array)
    return Sample(image)


def _source(kind, size, spacing):
    source = vtkMicrostructureSource()
    source.SetKind(kind)
    size = [int(n) for n in size]
    if len(size) not in (2, 3):
        raise ValueError("a size is (nx, ny) or (nx, ny, nz)")
    source.SetSize(*(size + [1])[:3])
    source.SetSpacing(spacing)
    return source


def softwood(
    size: Sequence[int] = (200, 200),
    solid_fraction: float = 0.4,
    seed: int = 1,
    spacing: float = 1e-6,
    ring_position: Sequence[float] = (0.0, 0.0),
    tangential_diameter: float = 30e-6,
    radial_diameter: Sequence[float] = (36e-6, 15e-6),
    ray_distance: float = 240e-6,
    tracheid_length: float = 200e-6,
    scatter: float = 0.12,
) -> Sample:
    """Softwood tissue with the phases lumen and wall.

    size            (nx, ny) or (nx, ny, nz) nodes, x the radial axis
    solid_fraction  share of the walls
    seed            another seed gives another tissue
    spacing         distance of the nodes [m]
    ring_position   place in the annual ring of the left and the right edge, 0 earlywood to 1 latewood
    tangential_diameter  of the tracheids across the radial files, along y [m]
    radial_diameter  along the files, in earlywood and in latewood [m]
    ray_distance    mean distance between rays [m]; 0: none
    tracheid_length  in three dimensions, along z [m]
    scatter         relative standard deviation of the diameters
    """
    source = _source(vtkMicrostructureSource.SOFTWOOD, size, spacing)
    source.SetSolidFraction(solid_fraction)
    source.SetSeed(seed)
    source.SetRingPosition(*ring_position)
    source.SetTangentialDiameter(tangential_diameter)
    source.SetRadialDiameter(*radial_diameter)
    source.SetRayDistance(ray_distance)
    source.SetTracheidLength(tracheid_length)
    source.SetScatter(scatter)
    return _sample(source)


def hardwood(
    size: Sequence[int] = (400, 400),
    solid_fraction: float = 0.38,
    seed: int = 1,
    spacing: float = 1e-6,
    ring_position: Sequence[float] = (0.0, 0.0),
    fibre_diameter: float = 16e-6,
    vessel_diameter: Sequence[float] = (64e-6, 40e-6),
    vessel_share: Sequence[float] = (0.32, 0.15),
    early_end: float = 0.6,
    multiples: float = 0.45,
    ray_distance: float = 95e-6,
    scatter: float = 0.12,
) -> Sample:
    """Hardwood tissue with the phases lumen and wall: vessels among fibres, rays.

    size            (nx, ny) nodes, x the radial axis
    solid_fraction  share of the walls
    seed            another seed gives another tissue
    spacing         distance of the nodes [m]
    ring_position   place in the annual ring of the left and the right edge, 0 its start to 1 its end
    fibre_diameter  between the middles of the walls [m]
    vessel_diameter, vessel_share  of the vessels at the start and at the end of the ring [m], share of the picture
    early_end       place in the ring where late vessels begin (0.25 in ring-porous wood)
    multiples       share of the groups of vessels that are radial files of two to four
    ray_distance    mean distance between rays [m]; 0: none
    scatter         relative standard deviation of the diameters
    """
    if len(size) != 2:
        raise ValueError("hardwood is a cross-section: give a size (nx, ny)")
    source = _source(vtkMicrostructureSource.HARDWOOD, size, spacing)
    source.SetSolidFraction(solid_fraction)
    source.SetSeed(seed)
    source.SetRingPosition(*ring_position)
    source.SetFibreDiameter(fibre_diameter)
    source.SetVesselDiameter(*vessel_diameter)
    source.SetVesselShare(*vessel_share)
    source.SetEarlyEnd(early_end)
    source.SetMultiples(multiples)
    source.SetHardwoodRayDistance(ray_distance)
    source.SetScatter(scatter)
    return _sample(source)


def honeycomb(
    size: Sequence[int] = (200, 200),
    solid_fraction: float = 0.4,
    cells: int = 4,
    spacing: float = 1e-6,
) -> Sample:
    """Honeycomb of straight walls: phases lumen and wall.

    size            (nx, ny) or (nx, ny, nz) nodes
    solid_fraction  share of the walls
    cells           along x
    spacing         distance of the nodes [m]
    """
    source = _source(vtkMicrostructureSource.HONEYCOMB, size, spacing)
    source.SetSolidFraction(solid_fraction)
    source.SetCells(cells)
    return _sample(source)


def checkerboard(size: Sequence[int] = (200, 200), cells: int = 4, spacing: float = 1e-6) -> Sample:
    """A checkerboard of the phases matrix and inclusion.

    size     (nx, ny) or (nx, ny, nz) nodes
    cells    fields along each axis
    spacing  distance of the nodes [m]
    """
    source = _source(vtkMicrostructureSource.CHECKERBOARD, size, spacing)
    source.SetCells(cells)
    return _sample(source)


def disks(size: Sequence[int] = (200, 200), fraction: float = 0.5, cells: int = 1, spacing: float = 1e-6) -> Sample:
    """Disks in a square array: phases matrix and inclusion.

    size      (nx, ny) nodes
    fraction  share of the disks
    cells     disks along each axis
    spacing   distance of the nodes [m]
    """
    if len(size) != 2:
        raise ValueError("disks lie in a picture: give a size (nx, ny), or make spheres")
    source = _source(vtkMicrostructureSource.INCLUSIONS, size, spacing)
    source.SetSolidFraction(fraction)
    source.SetCells(cells)
    return _sample(source)


def spheres(size: Sequence[int] = (64, 64, 64), fraction: float = 0.5, cells: int = 1, spacing: float = 1e-6) -> Sample:
    """Spheres in a cubic array: phases matrix and inclusion.

    size      (nx, ny, nz) nodes
    fraction  share of the spheres
    cells     spheres along each axis
    spacing   distance of the nodes [m]
    """
    if len(size) != 3:
        raise ValueError("spheres lie in a volume: give a size (nx, ny, nz), or make disks")
    source = _source(vtkMicrostructureSource.INCLUSIONS, size, spacing)
    source.SetSolidFraction(fraction)
    source.SetCells(cells)
    return _sample(source)


def laminate(
    size: Sequence[int] = (200, 200),
    axis: str = "x",
    fraction: float = 0.5,
    periods: int = 4,
    spacing: float = 1e-6,
) -> Sample:
    """Layers: phases matrix and inclusion.

    size      (nx, ny) or (nx, ny, nz) nodes
    axis      "x", "y" or "z": across the layers
    fraction  share of the phase inclusion
    periods   pairs of layers
    spacing   distance of the nodes [m]
    """
    source = _source(vtkMicrostructureSource.LAMINATE, size, spacing)
    source.SetAxis("xyz".index(axis))
    source.SetSolidFraction(fraction)
    source.SetCells(periods)
    return _sample(source)
