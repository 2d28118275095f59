"""What the type hints of the package say. Shapes and units are in the docstrings."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike
from vtkmodules.vtkCommonDataModel import vtkImageData

__all__ = ["Any", "Array", "ArrayLike", "Columns", "HasImage", "Image", "Iterator", "Mapping", "Name", "Names", "OnStep", "Pairs", "Path", "Progress", "Sequence"]


class HasImage(Protocol):
    """A Sample, or a result that carries an image."""

    vtk: vtkImageData


Array = np.ndarray
#: of a table: numpy arrays, lists of texts
Columns = dict[str, Union[np.ndarray, list[str]]]
#: a Sample, a result, a vtkImageData, or an array of whole numbers in the order of pictures
Image = Union[HasImage, vtkImageData, ArrayLike]
#: of a phase: its name, or its number where phases have no names
Name = Union[str, int]
Names = Union[Name, Sequence[Name]]
#: by pair of phases: "grain", "matrix-grain" or ("matrix", "grain")
Pairs = Mapping[Union[Name, tuple[Name, Name]], float]
Path = Union[str, os.PathLike[str]]
#: called with each state as it comes, a VTK data object
OnStep = Callable[[Any], Any]
#: called with the share that is done, 0 to 1, and words; returning False cancels
Progress = Callable[[float, str], Any]
