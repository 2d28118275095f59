"""The ParaView plugin."""

import os


def plugin_path():
    """Where the ParaView plugin is: beside this package, in the build tree or in the installation."""
    here = os.path.dirname(os.path.abspath(__file__))
    places = [os.path.join(here, *[".."] * up, "lib", *arch) for up in (2, 4) for arch in ((), ("x86_64-linux-gnu",))]
    places.append(os.path.join(here, "..", "..", ".."))  # the package is installed below the library folder
    for place in places:
        path = os.path.normpath(os.path.join(place, "lamella", "Lamella", "Lamella.so"))
        if os.path.exists(path):
            return path
    raise FileNotFoundError(f"no ParaView plugin beside {here}: build with LAMELLA_BUILD_PLUGIN on")


def load_plugin(namespace=None):
    """Loads the plugin into pvpython or pvbatch, on all ranks: PictureReader, MicrostructureSource, GrainPacking,
    PackingReader, MatrixBridges, MicrographContours, MicrographPolygonReader, MicrographLattice, SteadyDiffusion,
    LatticeBoltzmann, FluxMap, PoreFloodFill, StressPDF, CrackPath, CompressionCurve and CollapseMap then work like ParaView's own. Call it as
    ``lamella.load_plugin(globals())`` after ``from paraview.simple import *``; without a namespace use them as ``paraview.simple.SteadyDiffusion``.
    """
    from paraview import simple  # pylint: disable=import-outside-toplevel

    simple.LoadPlugin(plugin_path(), remote=False, ns=vars(simple) if namespace is None else namespace)
