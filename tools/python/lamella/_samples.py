"""Samples: pictures of phases, read or generated."""

from __future__ import annotations

import os
import warnings

import numpy as np
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from . import _arrays, _files
from ._arrays import told
from ._errors import LamellaError, collect_warnings, run
from ._settings import Settings, declared
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

    pixel_size_source: str = told('Who says so: "option", an entry of the file, or "none".')
    names: list[str] = told("Names of the phases; the position is the phase's number.", "phase_names")
    phase: Array = told("Numbers of the phases as an array of the image's shape (a view, no copy).")

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

    segmentation: list[str] = told("How read_picture() parted its greys, a line a step; empty where it did not.")

    def __repr__(self) -> str:
        shares = ", ".join(f"{name} {share:.3f}" for name, share in self.fractions.items())
        return f"<lamella.Sample {' x '.join(map(str, self.shape))}: {shares}>"


def _sample(algorithm):
    run(algorithm)
    return Sample(algorithm.GetOutput())


@declared(vtkPictureReader, without=("file_name",),
          first=("phases", "other", "window", "refine", "pixel_size", "segment", "lumen", "threshold", "array", "raw_size", "raw_bits", "raw_header"))
def read_picture(path: Path, settings: Settings) -> Sample:
    """Reads a picture (PNG, JPEG, TIFF, PGM, PPM, BMP), a volume (TIFF stack, slices, raw, MetaImage, NRRD, NumPy, NIfTI) or a .vti.

    Of a .vti the other point arrays come along (with refine only grain and axis). What is doubtful about the file, or about
    what segmenting made of it, is a Python warning.

    path            of slices a pattern, such as slice_%03d.png
    """
    reader = vtkPictureReader()
    reader.SetFileName(os.fspath(path))
    settings.give(reader)
    if settings.values.get("window") is not None and not any(reader.GetWindow()):
        raise LamellaError("the window is empty", "give a width and a height")
    doubts = collect_warnings(reader)
    sample = _sample(reader)
    for doubt in doubts:
        warnings.warn(doubt, stacklevel=3)
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


def _made(settings, dimensions):
    """@param dimensions that a sample of the kind can have"""
    size = tuple(np.ravel(settings["size"]))
    if len(size) not in (2, 3):
        raise ValueError("a size is (nx, ny) or (nx, ny, nz)")
    if (3 if len(size) == 3 and size[2] > 1 else 2) not in dimensions:
        raise ValueError(f"the size is {size}; give {'(nx, ny): it is flat' if dimensions == (2,) else '(nx, ny, nz): it is a volume'}")
    source = vtkMicrostructureSource()
    settings.give(source)
    return _sample(source)


_FRACTION = {"fraction": "solid_fraction"}


def _kind(word, first=("size", "solid_fraction", "cells", "spacing"), defaults=None, formerly=None):
    return declared(vtkMicrostructureSource, first=first, choice=("kind", word), formerly=formerly,
                    defaults={"size": (200, 200), **(defaults or {})})


_TISSUE = ("size", "solid_fraction", "seed", "spacing", "ring_position")


@_kind("softwood", _TISSUE)
def softwood(settings: Settings) -> Sample:
    """Softwood tissue with the phases lumen and wall, in two or three dimensions; x is the radial axis.

    With a look the sample has the array ``micrograph``, too: what a microscope would show.
    """
    return _made(settings, (2, 3))


@_kind("hardwood", _TISSUE, {"size": (400, 400), "solid_fraction": 0.38})
def hardwood(settings: Settings) -> Sample:
    """Hardwood tissue with the phases lumen and wall: vessels among fibres, rays; x is the radial axis.

    With a look the sample has the array ``micrograph``, too: what a microscope would show.
    """
    return _made(settings, (2,))


@_kind("honeycomb")
def honeycomb(settings: Settings) -> Sample:
    """Honeycomb of straight walls: phases lumen and wall."""
    return _made(settings, (2, 3))


@_kind("checkerboard", ("size", "cells", "spacing"))
def checkerboard(settings: Settings) -> Sample:
    """A checkerboard of the phases matrix and inclusion."""
    return _made(settings, (2, 3))


@_kind("inclusions", defaults={"solid_fraction": 0.5, "cells": 1}, formerly=_FRACTION)
def disks(settings: Settings) -> Sample:
    """Disks in a square array: phases matrix and inclusion."""
    return _made(settings, (2,))


@_kind("inclusions", defaults={"size": (64, 64, 64), "solid_fraction": 0.5, "cells": 1}, formerly=_FRACTION)
def spheres(settings: Settings) -> Sample:
    """Spheres in a cubic array: phases matrix and inclusion."""
    return _made(settings, (3,))


@_kind("laminate", ("size", "axis", "solid_fraction", "cells", "spacing"), {"solid_fraction": 0.5}, {**_FRACTION, "periods": "cells"})
def laminate(settings: Settings) -> Sample:
    """Layers: phases matrix and inclusion."""
    return _made(settings, (2, 3))
