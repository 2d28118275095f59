"""What a command writes is what Python computes with the same settings: array by array, pictures pixel by pixel, for every command."""

import json
import os
import subprocess
import tempfile
import unittest

import lamella
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkTable
from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader

PROGRAM = os.environ["LAMELLA_PROGRAM"]
PHASES = {"lumen": 0.023, "wall": 1.0}
SOFTWOOD = {"size": (48, 40), "seed": 3}
BONDS = {"young": {"wall": 1e10}, "critical_stretch": {"wall": 0.01}}
BOND_WORDS = ["--young", "wall=10GPa", "--critical-stretch", "wall=1%"]


def read(path):
    reader = vtkXMLGenericDataObjectReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def arrays(data):
    """{name: numbers} of points, cells, or rows."""
    found = {}
    for where in ("GetRowData",) if isinstance(data, vtkTable) else ("GetPointData", "GetCellData"):
        attributes = getattr(data, where)()
        for i in range(attributes.GetNumberOfArrays()):
            if attributes.GetArray(i) is not None:
                found[attributes.GetArrayName(i)] = vtk_to_numpy(attributes.GetArray(i))
    return found


def csv(path):
    with open(path, encoding="utf-8") as file:
        names, *rows = [line.rstrip("\n").split(",") for line in file]
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


class SameResults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = cls.scratch.name
        cls.run_program("generate", "softwood", "--size", "48,40", "--seed", "3", "-o", "t.vti")
        cls.sample = lamella.softwood(**SOFTWOOD)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def run_program(cls, *words):
        done = subprocess.run([PROGRAM, *words], cwd=cls.folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(done.stderr)
        return done.stdout

    def same(self, name, data):
        """All arrays of a file, and no other."""
        wrote, made = arrays(read(self.path(name))), arrays(data)
        self.assertEqual(sorted(wrote), sorted(made))
        for key, numbers in wrote.items():
            np.testing.assert_array_equal(numbers, made[key], err_msg=f"{name}: {key}")

    def same_picture(self, name, other):
        """All pixels. @returns how many values there are"""
        wrote, made = (lamella.arrays(lamella.read(self.path(file))) for file in (name, other))
        self.assertEqual(sorted(wrote), sorted(made))
        for key, pixels in wrote.items():
            np.testing.assert_array_equal(pixels, made[key], err_msg=f"{name}: {key}")
        return min(len(np.unique(pixels)) for pixels in wrote.values())

    def same_table(self, name, columns):
        wrote = csv(self.path(name))
        for key, numbers in columns.items():
            if np.asarray(numbers).dtype.kind == "f":
                np.testing.assert_array_equal(np.array(wrote[key], float), numbers, err_msg=f"{name}: {key}")

    def test_generate(self):
        self.same("t.vti", self.sample.vtk)

    def test_micrograph(self):
        self.run_program("generate", "softwood", "--size", "120,90", "--seed", "3", "-o", "w.vti")
        outlines = lamella.contours(lamella.softwood(size=(120, 90), seed=3), smooth=False, tolerance=0.1, least_solidity=0.5)
        words = ["--no-smooth", "--tolerance", "0.1", "--least-solidity", "50%", "--spacing", "0.75um"]
        conductivity = ["--conductivity", "lumen=0.05", "--conductivity", "wall=1", "--conductivity", "lamella=0.4"]
        told = json.loads(self.run_program(
            "micrograph", "w.vti", *words, "--lamella-thickness", "1um", *conductivity, "--direction", "y", "--json",
            "-o", "grown.vti", "--contours", "w.vtp"))  # fmt: skip
        self.same("w.vtp", outlines.vtk)
        self.same("grown.vti", outlines.lattice(7.5e-7, "growth", lamella_thickness=1e-6).vtk)
        found = lamella.outline_diffusion(
            outlines, {"lumen": 0.05, "wall": 1, "lamella": 0.4}, "y", 7.5e-7, lamella_thickness=1e-6)
        self.assertEqual(told["diffusion"]["axes"]["y"]["value"], found.conductivity["y"])
        self.assertEqual(told["diffusion"]["axes"]["y"]["relative_error"], found.error["y"])
        with open(self.path("cells.json"), "w", encoding="utf-8") as file:
            square = [[1, 1], [9, 1], [9, 9], [1, 9]]
            json.dump([[[x + 10 * i, y] for x, y in square] for i in range(3)], file)
        self.run_program("micrograph", "cells.json", "--unit", "1um", "--y-down", "--lamella", "constant", "-o", "cells.vti",
                         "--contours", "cells.vtp")  # fmt: skip
        polygons = lamella.read_polygons(self.path("cells.json"), 1e-6, y_down=True)
        self.same("cells.vtp", polygons.vtk)
        self.same("cells.vti", polygons.lattice(lamella="constant").vtk)

    def test_diffusion(self):
        conductivity = ["--conductivity", "lumen=0.023", "--conductivity", "wall=1"]
        self.run_program("diffusion", "t.vti", *conductivity, "--direction", "y", "--sides", "periodic", "-o", "d.vti")
        found = lamella.diffusion(self.sample, PHASES, direction="y", sides="periodic")
        self.same("d.vti", found.vtk)
        self.run_program("diffusion", "t.vti", *conductivity, "--direction", "x", "--refine", "2", "-o", "r.vti")
        self.same("r.vti", lamella.diffusion(self.sample, PHASES, direction="x", refinement=2).vtk)
        self.run_program("flux-map", "d.vti", "--streamlines", "20", "-o", "map.vti", "-o", "lines.vtp")
        mapped = lamella.flux_map(found, streamlines=20)
        self.same("map.vti", mapped.vtk)

    def test_transient(self):
        self.run_program("transient", "t.vti", "--diffusivity", "wall=1.8e-7", "--diffusivity", "lumen=2.2e-5", "--end-time", "1e-6",
                         "--frames", "2", "-o", "h.vti", "--curve", "h.csv")
        found = lamella.transient(self.sample, {"wall": 1.8e-7, "lumen": 2.2e-5}, 1e-6, 2)
        self.same("h_002.vti", found.states[-1].vtk)

    def test_pores(self):
        self.run_program("pore-flood-fill", "t.vti", "--fill", "lumen", "--connectivity", "8", "--periodic", "x", "-o", "p.vti")
        self.same("p.vti", lamella.pore_flood_fill(self.sample, "lumen", 8, "x").vtk)

    def test_equilibrium(self):
        self.run_program("equilibrium", "t.vti", "--young", "wall=10GPa", "--stress", "--axis", "x", "-o", "e.vti")
        found = lamella.equilibrium(self.sample, {"wall": 1e10}, stress=True, axis="x")
        self.same("e.vti", found.vtk)
        self.run_program("stress-pdf", "e.vti", "--component", "xx", "-o", "pdf.csv")
        self.same_table("pdf.csv", lamella.stress_pdf(found, "xx").density)

    def test_fracture(self):
        self.run_program("fracture", "t.vti", *BOND_WORDS, "--max-broken", "40", "-o", "f.vti", "--broken", "b.vtp")
        found = lamella.fracture(self.sample, max_broken=40, **BONDS)
        self.same("f.vti", found.vtk)
        self.same("b.vtp", found.vtk_broken)
        self.run_program("crack-path", "b.vtp", "-o", "crack.vtp")
        self.same("crack.vtp", lamella.crack_path(found.vtk_broken).vtk)
        # with the image: its voids end cracks, and its fragments are told
        self.run_program("crack-path", "b.vtp", "--phases", "f.vti", "-o", "within.vtp", "--image", "pieces.vti", "--table", "paths.csv")
        within = lamella.crack_path(found.vtk_broken, found)
        self.same("within.vtp", within.vtk)
        self.same("pieces.vti", within.image.vtk)
        self.same_table("paths.csv", lamella.arrays(within.vtk_paths))

    def test_dynamics(self):
        self.run_program("dynamics", "t.vti", *BOND_WORDS, "--density", "1500", "--max-broken", "5", "-o", "m.vti")
        self.same("m.vti", lamella.dynamics(self.sample, density=1500, max_broken=5, **BONDS).vtk)

    def test_stiffness(self):
        self.run_program("stiffness", "t.vti", "--young", "wall=10GPa", "--mean-strain", "xx=0.01", "--mean-stress", "yy=0", "-o", "element.vti",
                         "--constants", "element.csv", "--directions", "element.vtp")
        found = lamella.stiffness(self.sample, {"wall": 1e10}, mean_strain={"xx": 0.01}, mean_stress={"yy": 0})
        self.same("element.vti", found.vtk)
        self.same("element.vtp", found.vtk_directions)
        self.same_table("element.csv", lamella.arrays(found.vtk_constants))

    def same_fit(self, name, told, found):
        """All that --json tells, and all arrays of what was written."""
        for key, attribute in (("value", "values"), *((key, key) for key in ("low", "high", "low_by_measurement", "high_by_measurement"))):
            self.assertEqual({unknown: row[key] for unknown, row in told["unknown"].items()}, getattr(found, attribute))
        for key in ("fitted", "lattice_and_picture"):
            numbers = {quantity: np.nan if row[key] is None else row[key] for quantity, row in told["measured"].items()}
            np.testing.assert_equal(getattr(found, key), numbers)
        self.assertEqual({quantity: (row["value"], row["half_width"]) for quantity, row in told["measured"].items()}, found.measured)
        self.assertEqual([told[key] for key in ("interval", "misfit", "freedom", "solves")], [found.interval, found.misfit, found.freedom, found.solves])
        np.testing.assert_equal(found.chance, np.nan if told["chance"] is None else told["chance"])
        np.testing.assert_array_equal(found.correlation, told["correlation"])
        if told["output"] == [name]:
            self.same(name, found.solution.vtk)
        else:  # one a direction, with names that do not say it
            self.assertEqual(told["output"], [name.replace(".", f"_{axis}.") for axis in "xy"])
            made = arrays(found.solution.vtk)
            for file in told["output"]:
                wrote = arrays(read(self.path(file)))
                self.assertEqual(sorted(wrote), ["flux", "phase", "temperature"])
                for field in ("temperature", "flux"):
                    np.testing.assert_array_equal(wrote[field], made[f"{field}_{file[-5:-4]}"])

    def test_fit_of_conductivities(self):
        self.run_program("generate", "softwood", "--size", "48,40", "--seed", "4", "--solid-fraction", "0.6", "-o", "dense.vti")
        dense = lamella.softwood(size=(48, 40), seed=4, solid_fraction=0.6)
        lumen = ["--conductivity", "lumen=0.023", "--unknown", "wall"]
        told = self.run_program("fit", "diffusion", "t.vti", *lumen, "--measured", "x=0.3±0.01,y=0.28±0.01", "--json", "-o", "fit.vti")
        found = lamella.fit("diffusion", self.sample, "wall", {"x": (0.3, 0.01), "y": (0.28, 0.01)}, conductivity={"lumen": 0.023})
        self.same_fit("fit.vti", json.loads(told), found)
        self.assertEqual(sorted(found.solution.fields), ["flux_x", "flux_y", "temperature_x", "temperature_y"])
        # two samples, two phases, one direction, a start, no error: all of them in words, and as numbers
        first, second = (lamella.diffusion(sample, {"wall": 0.9, "lumen": 0.05}, "y", estimate_error=False).effective[1, 1] for sample in (self.sample, dense))
        words = ["--also", "dense.vti", "--unknown", "wall=0.8", "--unknown", "lumen=0.02", "--direction", "y", "--no-error-estimate"]
        told = self.run_program("fit", "diffusion", "t.vti", *words, "--measured", f"y={first!r}±0.0005", "--measured", f"2/y={second!r}±0.0005",
                                "--json", "-o", "two.vti")
        how = {"also": [dense], "direction": "y", "estimate_error": False}
        for unknown, measured in ((["wall=0.8", "lumen=0.02"], [f"y={first!r}±0.0005", f"2/y={second!r}+-0.0005"]),
                                  ({"wall": 0.8, "lumen": 0.02}, {"y": (first, 0.0005), "2/y": (second, 0.0005)})):
            self.same_fit("two.vti", json.loads(told), lamella.fit("diffusion", self.sample, unknown, measured, **how))
        # without fields, as the command is that writes none
        told = json.loads(self.run_program("fit", "diffusion", "t.vti", *lumen, "--measured", "y=0.28±0.01", "--json"))
        bare = lamella.fit("diffusion", self.sample, {"wall": None}, {"y": (0.28, 0.01)}, conductivity={"lumen": 0.023}, fields=False)
        self.assertEqual(told["unknown"]["conductivity:wall"]["high"], bare.high["conductivity:wall"])
        self.assertEqual(bare.solution.fields, {})

    def test_fit_of_slopes(self):
        words = ["--conductivity", "lumen=0.023", "--unknown", "wall", "--unknown", "slope:wall=0.5", "--measured", "x@0=0.3±0.01,x@0.12=0.33±0.01,y@0.2=0.34±0.01"]
        told = self.run_program("fit", "diffusion", "t.vti", *words, "--json", "-o", "moist.vti")
        found = lamella.fit("diffusion", self.sample, {"wall": None, "slope:wall": 0.5}, {"x@0": (0.3, 0.01), "x@0.12": (0.33, 0.01), "y@0.2": (0.34, 0.01)},
                            conductivity={"lumen": 0.023})
        self.same_fit("moist.vti", json.loads(told), found)

    def test_fit_of_moduli(self):
        made = lamella.stiffness(self.sample, {"wall": 8e9, "lumen": 4e8}, {"wall": 0.2}, estimate_error=False).constants
        measured = {name: (made[name], 0.005 * made[name]) for name in ("E_x", "E_y", "G_xy")}
        words = [word for name, (value, half) in measured.items() for word in ("--measured", f"{name}={value!r}±{half!r}")]
        told = self.run_program("fit", "stiffness", "t.vti", "--poisson", "wall=0.2", "--unknown", "young:wall", "--unknown", "young:lumen=3e8", *words,
                                "--json", "-o", "moduli.vti")
        found = lamella.fit("stiffness", self.sample, {"young:wall": None, "young:lumen": 3e8}, measured, poisson={"wall": 0.2})
        self.same_fit("moduli.vti", json.loads(told), found)
        self.assertEqual(found.solution.constants["E_x"], lamella.stiffness(self.sample, {name[6:]: value for name, value in found.values.items()},
                                                                            {"wall": 0.2}).constants["E_x"])

    def test_bond_stiffness(self):
        self.run_program("bond-stiffness", "t.vti", "--young", "wall=10GPa", "--no-error-estimate", "-o", "s.csv")
        found = lamella.bond_stiffness(self.sample, {"wall": 1e10}, estimate_error=False)
        wrote = csv(self.path("s.csv"))
        tensor = np.array([[float(wrote[name][row]) for name in list(wrote)[1:4]] for row in range(3)])
        np.testing.assert_array_equal(tensor, np.asarray(found.stiffness)[:3, :3])

    def test_compression(self):
        words = ["--strain", "2%", "--rows", "6", "--first-speed", "0.02", "--fit-platens", "--deformation-gradient"]
        self.run_program("compression", "t.vti", *words, "-o", "c.vtp", "--curve", "c.csv")
        found = lamella.compression(self.sample, strain=0.02, rows=6, first_speed=0.02, fit_platens=True, deformation_gradient=True)
        self.same("c.vtp", found.states[-1].vtk)
        self.same_table("c.csv", {"strain": found.strain, "stress": found.stress})
        self.run_program("compression-curve", "c.csv", "--stiffness-range", "0,0.02", "--smoothing", "0", "-o", "energy.csv")
        self.same_table("energy.csv", lamella.compression_curve(found.strain, found.stress, stiffness_range=(0, 0.02), smoothing=0).table)
        self.run_program("collapse-map", "t.vti", "c.vtp", "--share", "99%", "--minimum-size", "3", "-o", "collapse.vti", "--table", "collapse.csv")
        cells = lamella.collapse_map(self.sample, [found.states[-1].vtk], share=0.99, minimum_size=3)
        self.same("collapse.vti", cells.vtk)
        self.same_table("collapse.csv", cells.table)

    def test_convert(self):
        self.run_program("convert", "t.vti", "-o", "greys.tif", "--array", "phase", "--type", "u16", "--range", "0,1")
        lamella.convert(self.path("t.vti"), self.path("same.tif"), array="phase", type="u16", range=(0, 1))
        self.same_picture("greys.tif", "same.tif")  # not byte by byte: each holds its command line
        self.run_program("convert", "greys.tif", "-o", "greys.vti", "--pixel-size", "2um")
        self.same("greys.vti", lamella.read(self.path("greys.tif"), pixel_size=2e-6))

    def test_snapshot(self):
        self.run_program("diffusion", "t.vti", "--conductivity", "lumen=0.023", "--conductivity", "wall=1", "--direction", "x", "-o", "heat.vti")
        heat = lamella.diffusion(self.sample, PHASES, direction="x")
        for name, words, data, settings in (
                ("phases", ["t.vti"], self.sample, {}),
                ("flux", ["heat.vti", "--preset", "flux", "--overlay", "arrows", "--color-map", "inferno"], heat,
                 {"preset": "flux", "overlay": "arrows", "color_map": "inferno"}),
                ("heat", ["heat.vti", "--array", "temperature", "--range", "0.2,0.8", "--title", "Heat"], heat,
                 {"array": "temperature", "value_range": (0.2, 0.8), "title": "Heat"})):
            with self.subTest(name):
                self.run_program("snapshot", *words, "--size", "300,260", "-o", f"{name}.png")
                lamella.snapshot(data, self.path(f"{name}_too.png"), size=(300, 260), **settings)
                self.assertGreater(self.same_picture(f"{name}.png", f"{name}_too.png"), 2)  # something is drawn

    def test_packing_and_bridges(self):
        self.run_program("packing", "--count", "40", "--seed", "5", "-o", "g.vtp", "--contacts", "k.vtp")
        grains = lamella.packing(40, seed=5)
        self.same("g.vtp", grains.vtk)
        self.same("k.vtp", grains.contacts_vtk)
        self.run_program("packing", "--count", "40", "--seeds", "5,6", "--threads", "2", "-o", "g{seed}.vtp")
        for seed, one in zip((5, 6), lamella.packings([5, 6], 40, threads=2)):
            self.same(f"g{seed}.vtp", one.vtk)
        self.run_program("bridges", "g.vtp", "--saturation", "40%", "--nodes", "60", "-o", "b.vti")
        self.same("b.vti", lamella.bridges(grains, saturation=0.4, nodes_across=60).vtk)


if __name__ == "__main__":
    unittest.main()
