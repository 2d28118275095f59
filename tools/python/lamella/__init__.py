"""Lamella: from a picture of a material made of cells or grains to its conductivity.

    import lamella

    tissue = lamella.softwood(size=(400, 400), solid_fraction=0.4, seed=1)
    result = lamella.diffusion(tissue, {"wall": 1, "lumen": 0.023})
    print(result.effective)             # numpy array, 2 by 2
    print(result.fields["temperature_x"])

The package runs in ``pvpython``, in ``pvbatch`` and in Debian's own ``python3``. Importing it also lets ParaView draw
where there is no display: import it before the first view is made. (LAMELLA_RENDERER=x in the environment switches that
off.)

It is a thin layer: every function sets up one of the VTK classes that the package also holds (``vtkPictureReader``,
``vtkMicrostructureSource``, ``vtkGrainPacking``, ``vtkMatrixBridges``, ``vtkMicrographContours``,
``vtkMicrographLattice``, ``vtkOutlineDiffusion``, ``vtkSteadyDiffusion``, ``vtkLatticeBoltzmann``, ``vtkFluxMap``, ``vtkPoreFloodFill``,
``vtkBondEquilibrium``, ``vtkBondFracture``, ``vtkBondDynamics``, ``vtkBondStiffness``, ``vtkVoxelStiffness``, ``vtkPointCompression``,
``vtkPointStiffness``, ``vtkMaterialFit``, ``vtkStressPDF``, ``vtkCrackPath``, ``vtkCompressionCurve``, ``vtkCollapseMap``,
``vtkFileConverter`` ...),
runs it and hands its output out as numpy arrays.

Arrays of a picture have the picture's order, ``[row, column]`` with row 0 at the top; arrays of a volume are
``[z, y, x]``. Vectors have their components along x (left to right), y (upwards in a picture) and z in the last axis.
"""

import os as _os

if "OMP_WAIT_POLICY" not in _os.environ:
    # GNU's OpenMP library, which is loaded next, spins for milliseconds else: slow where others use the machine too
    _os.environ.setdefault("GOMP_SPINCOUNT", "2000")

from ._version import __version__

try:
    from .vtkLamellaSolversVTK import *  # noqa: F401,F403 - the VTK classes
except ImportError as _error:
    import sys as _sys

    from ._version import PYTHON, VTK

    raise ImportError(
        f"lamella {__version__} was built for Python {PYTHON} with {VTK}, and this is Python "
        f"{_sys.version_info[0]}.{_sys.version_info[1]} ({_sys.executable}): run it with /usr/bin/python3 or pvpython ({_error})"
    ) from None
from .vtkLamellaFilters import *  # noqa: F401,F403
from .vtkLamellaConvert import *  # noqa: F401,F403

try:
    from .vtkLamellaRendering import *  # noqa: F401,F403
    from .vtkLamellaRendering import vtkOffScreenWindows as _windows
except ModuleNotFoundError:  # built without pictures
    _windows = None
else:
    _windows.Install()  # does nothing where a display works

from ._bond_stiffness import BondStiffnessResult, bond_stiffness
from ._collapse import CollapseMapResult, CompressionCurveResult, collapse_map, compression_curve
from ._compression import CompressionResult, PointState, PointStiffnessResult, compression, point_stiffness
from ._contours import Contours, LatticeSample, OutlineDiffusionResult, contours, outline_diffusion, read_polygons
from ._convert import arrays, convert, read, read_steps, write
from ._cracks import CrackPathResult, crack_path
from ._dynamics import DynamicsResult, MotionState, dynamics
from ._equilibrium import BondStressResult, EquilibriumResult, bond_stress, equilibrium
from ._errors import (
    Cancelled,
    DivergenceError,
    InputError,
    LamellaError,
    NoPathError,
    OutOfMemoryError,
    ParameterError,
)
from ._fit import FitResult, fit
from ._flux import FluxMapResult, flux_map
from ._fracture import FractureResult, FractureState, fracture
from ._packings import CementedSample, Packing, bridges, packing, packings, read_packing
from ._paraview import load_plugin, load_presets, plugin_path, use_preset
from ._pictures import snapshot
from ._pores import PoreFloodFillResult, pore_flood_fill
from ._samples import (
    Sample,
    checkerboard,
    disks,
    from_array,
    hardwood,
    honeycomb,
    laminate,
    read_picture,
    softwood,
    spheres,
)
from ._solve import DiffusionResult, diffusion
from ._stiffness import StiffnessResult, stiffness
from ._stresses import StressPDFResult, stress_pdf
from ._transient import TransientResult, TransientState, lattice_boltzmann, transient

__all__ = [
    "BondStiffnessResult",
    "BondStressResult",
    "Cancelled",
    "CementedSample",
    "CollapseMapResult",
    "CompressionCurveResult",
    "CompressionResult",
    "Contours",
    "CrackPathResult",
    "DiffusionResult",
    "DivergenceError",
    "DynamicsResult",
    "EquilibriumResult",
    "FitResult",
    "FluxMapResult",
    "FractureResult",
    "FractureState",
    "InputError",
    "LamellaError",
    "LatticeSample",
    "MotionState",
    "NoPathError",
    "OutOfMemoryError",
    "OutlineDiffusionResult",
    "Packing",
    "ParameterError",
    "PointState",
    "PointStiffnessResult",
    "PoreFloodFillResult",
    "Sample",
    "StiffnessResult",
    "StressPDFResult",
    "TransientResult",
    "TransientState",
    "arrays",
    "bond_stiffness",
    "bond_stress",
    "bridges",
    "checkerboard",
    "collapse_map",
    "compression",
    "compression_curve",
    "contours",
    "convert",
    "crack_path",
    "diffusion",
    "disks",
    "dynamics",
    "equilibrium",
    "fit",
    "flux_map",
    "fracture",
    "from_array",
    "hardwood",
    "honeycomb",
    "laminate",
    "load_plugin",
    "load_presets",
    "outline_diffusion",
    "packing",
    "packings",
    "plugin_path",
    "point_stiffness",
    "pore_flood_fill",
    "read",
    "read_packing",
    "read_picture",
    "read_polygons",
    "read_steps",
    "snapshot",
    "softwood",
    "spheres",
    "stiffness",
    "stress_pdf",
    "transient",
    "use_preset",
    "write",
]
