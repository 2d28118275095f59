"""lamella convert: from format to format, what would be lost, bad files, memory, interruption.

Every pair of formats is walked through by tests/plugin/files.py, in one process.
"""

import gzip
import json
import math
import os
import random
import re
import resource
import signal
import struct
import subprocess
import time
import unittest

import grids
import pictures
from program import HERE, PROGRAM, Case
from test_fracture_checkpoints import EVERY, WORDS

IMAGES = ["png", "tif", "raw", "mhd", "mha", "nhdr", "nrrd", "npy", "vti", "hdf", "csv"]
POINTS = ["vtp", "vtu", "hdf", "csv"]


def values(count, kind):
    if kind == "Float32":
        return [struct.unpack("f", struct.pack("f", math.sin(i) / 3))[0] for i in range(count)]
    if kind == "Float64":
        return [math.sin(i) / 3 for i in range(count)]
    return [i * 7 % 256 for i in range(count)] if kind == "UInt8" else [i * 977 % 32768 for i in range(count)]


class Convert(Case):
    def image(self, name="a.vti", kind="UInt8", size=(5, 4, 3), extra=(), array="grain"):
        extent = "0 %d 0 %d 0 %d" % tuple(n - 1 for n in size)
        self.write(name, grids.vti([grids.array(array, values(size[0] * size[1] * size[2], kind), kind), *extra],
                                   extent=extent, spacing="4e-6 4e-6 4e-6", origin="2e-6 3e-6 1e-6"))
        return name

    def table(self, name, *words):
        """The rows of a file and its notes, by way of a table: what all formats come to."""
        self.works("convert", name, "-o", "look.csv", "--overwrite", "--quiet", *words)
        with open(self.path("look.csv"), encoding="utf-8") as file:
            rows = [line.rstrip("\n").split(",") for line in file]
        with open(self.path("look.csv.json"), encoding="utf-8") as file:
            notes = json.load(file)
        # HDF5 lists arrays by their names: so does this.
        order = sorted(range(len(rows[0])), key=lambda i: rows[0][i] if i > 2 else "")
        notes["arrays"].sort(key=lambda array: array["name"])
        return [rows[0][i] for i in order], [[float(row[i]) for i in order] for row in rows[1:]], notes

    def same(self, name, expected, *words):
        names, rows, notes = self.table(name, *words)
        self.assertEqual((names, rows), expected[:2], name)
        for key in ["arrays", "image", "points"]:
            self.assertEqual(notes.get(key), expected[2].get(key), name)
        for key, field in expected[2]["fields"].items():
            self.assertEqual(notes["fields"].get(key), field, name)

    def chain(self, formats, start, slices=False):
        """From one format to the next; in the end all is as it was."""
        expected = self.table(start)
        before = start
        for i, ending in enumerate(formats):
            folder = "step%d" % i
            os.makedirs(self.path(folder))
            now = os.path.join(folder, ("v_%d." if slices and ending == "png" else "v.") + ending)
            self.works("convert", before, "-o", now, "--quiet")
            before = now
        self.same(before, expected)


class RoundTrips(Convert):
    def test_pictures_through_every_format(self):
        self.chain(IMAGES, self.image(size=(7, 5, 1)))
        self.image("line.vti", size=(7, 1, 1))
        self.fails(3, "a single line of points", ".vti", "convert", "line.vti", "-o", "x.hdf")

    def test_volumes_through_every_format(self):
        self.chain(IMAGES, self.image(kind="UInt16", size=(4, 3, 5)), slices=True)

    def test_points_through_every_format(self):
        self.write("a.csv", b"x,y,z,radius,force:0,force:1,force:2\n" + b"".join(
            b"%r,%r,%r,%r,%d,%r,1e300\n" % (i / 3, i * i / 7, -i, 1e-6 * i, i, 1 / (i + 1)) for i in range(20)))
        self.chain(POINTS, "a.csv")

    def test_cells(self):
        self.write("a.vtp", grids.vtp([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1), (1, 2, 3)],
                                      [grids.array("radius", [1, 2, 3, 4])]))
        for i, ending in enumerate(["vtp", "vtu", "hdf", "vtp", "hdf", "vtu", "vtp"]):
            before = "v%d" % (i - 1) if i else "a.vtp"
            before = next((n for n in os.listdir(self.folder) if n.startswith(before + ".")), before)
            self.works("convert", before, "-o", "v%d.%s" % (i, ending), "--quiet")
            last = "v%d.%s" % (i, ending)
        report = self.works("convert", last, "-o", "end.vtp", "--json").json()
        self.assertEqual((report["points"], report["cells"]), (4, 2))
        self.assertEqual(report["arrays"], [{"name": "radius", "type": "f64", "components": 1, "in": "points"}])
        self.assertEqual(self.info("end.vtp")["cells"], 2)

    def test_phases_names_units_and_provenance(self):
        self.works("generate", "softwood", "--size", "60,40", "-o", "a.png", "--pixel-size", "0.5um")
        before = self.info("a.png")
        self.works("convert", "a.png", "-o", "a.vti")
        info = self.info("a.vti")
        self.assertEqual([phase["name"] for phase in info["phases"]], ["lumen", "wall"])
        self.assertEqual(info["spacing"], [5e-7, 5e-7])
        self.assertEqual(info["provenance"]["parameters"]["made_from"]["seed"], before["provenance"]["seed"])
        self.assertIn("lamella convert a.png", info["provenance"]["command"])
        for name in ["b.tif", "b.raw", "m.mhd", "b.png"]:
            self.works("convert", "a.vti", "-o", name)
            self.works("convert", name, "-o", "c.vti", "--overwrite")
            again = self.info("c.vti")
            for key in ["phases", "spacing", "origin", "point_arrays"]:
                self.assertEqual(again[key], info[key], name)
        # What solvers take is what it was.
        self.assertEqual(self.info("b.png")["greys"], before["greys"])
        conduct = ["--conductivity", "lumen=0.1", "--conductivity", "wall=1", "--json"]
        numbers = [self.works("diffusion", name, *conduct).json()["effective"] for name in ["a.png", "b.tif", "c.vti"]]
        self.assertTrue(all(number == numbers[0] for number in numbers), numbers)

    def test_cells_of_an_image_become_pixels(self):
        data = grids.vti(extent="0 3 0 2 0 0", spacing="2 2 2", origin="0 0 0").replace(
            b"</PointData>", b"</PointData><CellData>" + grids.array("grain", range(6), "UInt8").encode() + b"</CellData>")
        self.write("a.vti", data)
        self.works("convert", "a.vti", "-o", "a.png")
        rows = self.table("a.png")[1]
        self.assertEqual(rows[0], [1, 1, 0, 0])
        self.assertEqual([row[3] for row in rows], [0, 1, 2, 3, 4, 5])

    def test_tables_of_a_grid_become_images(self):
        lines = ["%g,%g,%d" % (x * 0.5, y * 0.25, 10 * y + x) for x in range(4) for y in range(3)]
        self.write("a.csv", ("x,y,height\n" + "\n".join(lines) + "\n").encode())
        self.works("convert", "a.csv", "-o", "a.vti")
        info = self.info("a.vti")
        self.assertEqual((info["size"], info["spacing"]), ([4, 3], [0.5, 0.25]))
        self.assertEqual([row[3] for row in self.table("a.vti")[1]], [0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23])
        self.write("b.csv", ("x,y,height\n" + "\n".join(lines[:-1]) + "\n").encode())
        self.fails(3, "11 points have 4 × 3 × 1 places", ".vtp", "convert", "b.csv", "-o", "b.vti")

    def test_colours(self):
        self.write("a.png", pictures.png([[(1, 2, 3), (4, 5, 6)], [(7, 8, 9), (255, 0, 1)]], colour=True))
        self.works("convert", "a.png", "-o", "a.vti")
        self.assertEqual(self.table("a.vti")[1][0][3:], [7, 8, 9])  # the lower row comes first
        for name in ["b.tif", "b.mhd", "b.png"]:
            self.works("convert", "a.vti", "-o", name)
            self.assertEqual(self.table(name)[1], self.table("a.vti")[1], name)


class Info(Convert):
    """lamella info of all that is read."""

    def test_every_format(self):
        self.image(kind="Float64", size=(4, 3, 5), array="temperature")
        for ending in ["tif", "raw", "mhd", "mha", "nhdr", "nrrd", "vti", "hdf", "csv"]:
            self.works("convert", "a.vti", "-o", "v." + ending, "--quiet", "--overwrite")
            info = self.info("v." + ending)
            self.assertEqual((info["kind"], info["size"], info["spacing"]), ("vtkImageData", [4, 3, 5], [4e-6] * 3), ending)
            array = info["point_arrays"][0]
            numbers = values(60, "Float64")
            self.assertEqual((array["name"], array["range"]), ("temperature", [[min(numbers), max(numbers)]]), ending)
            self.assertIn("lamella convert a.vti", info["provenance"]["command"])
            self.assertIn("temperature", self.works("info", "v." + ending).out)
        self.image("s.vti", kind="UInt16", size=(4, 3, 5))
        for name in ["s_%d.png", "s.tif", "s.raw"]:
            self.works("convert", "s.vti", "-o", name, "--quiet")
            info = self.info(name)
            self.assertEqual((info["kind"], info["size"], info["bits"]), ("volume", [4, 3, 5], 16), name)
        self.write("p.csv", b"x,y,z,radius\n0,0,0,1\n1,0,0,2\n")
        for name, kind in [("p.csv", "vtkPolyData"), ("p.vtp", "vtkPolyData"), ("p.vtu", "vtkUnstructuredGrid"), ("p.hdf", "vtkUnstructuredGrid")]:
            if name != "p.csv":
                self.works("convert", "p.csv", "-o", name, "--quiet")
            info = self.info(name)
            self.assertEqual((info["kind"], info["points"]), (kind, 2))
            self.assertEqual(info["point_arrays"][0]["range"], [[1, 2]])

    def test_a_raw_volume_of_any_type(self):
        self.write("v.bin", struct.pack(">6h", 1, -2, 3, 400, 5, 6))
        raw = ["--raw-size", "3,2,1", "--raw-type", "i16", "--raw-order", "big"]
        info = self.works("info", "v.bin", *raw, "--json").json()
        self.assertEqual((info["size"], info["point_arrays"][0]["range"]), ([3, 2], [[-2, 400]]))
        self.fails(3, "the size of the raw volume 'v.bin' is not known", "raw size", "info", "v.bin")

    def test_series(self):
        for i in range(3):
            self.image("s_%d.vti" % i, size=(4, 3, 2 + i))
        self.works("convert", "s_*.vti", "-o", "t.pvd", "--quiet")
        info = self.info("t.pvd")
        self.assertEqual((info["steps"], info["times"], info["size"]), (3, [0, 1, 2], [4, 3, 2]))
        self.assertIn("steps: 3, at 0 to 2", self.works("info", "t.pvd").out)
        self.assertEqual(self.works("info", "s_*.vti", "--step", "2", "--json").json()["size"], [4, 3, 4])
        self.fails(2, "step 3 is none of the 3 steps", "0 to 2", "info", "t.pvd", "--step", "3")

    def test_bad_files(self):
        for ending in ["mhd", "nrrd", "hdf", "h5", "pvd", "csv", "vtu"]:
            self.write("empty." + ending, b"")
            self.fails(3, "'empty.%s'" % ending, "", "info", "empty." + ending)
            self.fails(3, "there is no file 'no.%s'" % ending, "check the name", "info", "no." + ending)


class Series(Convert):
    def series(self):
        for i in range(3):
            self.image("s_%d.vti" % i, size=(4, 3, 2 + i))
        steps = "".join('<DataSet timestep="%s" file="s_%d.vti"/>' % (0.1 * i, i) for i in range(3))
        self.write("s.pvd", ('<VTKFile type="Collection" version="0.1"><Collection>%s</Collection></VTKFile>' % steps).encode())

    def test_steps_and_times(self):
        self.series()
        report = self.works("convert", "s.pvd", "-o", "h_%02d.hdf", "--json").json()
        self.assertEqual(report["files"], ["h_00.hdf", "h_01.hdf", "h_02.hdf"])
        self.assertEqual(report["times"], [0, 0.1, 0.2])
        again = self.works("convert", "h_*.hdf", "-o", "t.pvd", "--json").json()
        self.assertEqual(again["files"], ["t_000.vti", "t_001.vti", "t_002.vti", "t.pvd"])
        self.assertEqual(again["times"], [0, 0.1, 0.2])
        with open(self.path("t.pvd"), encoding="utf-8") as file:
            self.assertEqual(re.findall(r'timestep="([^"]*)"', file.read()), ["0", "0.1", "0.2"])
        self.assertEqual(self.table("t_002.vti")[1], self.table("s_2.vti")[1])
        self.works("convert", "t.pvd", "--step", "1", "-o", "one_%d.png")
        self.assertEqual(self.table("one_%d.png")[1], self.table("s_1.vti")[1])

    def test_missing_steps(self):
        self.series()
        self.fails(2, "a series of 3 steps", "--step", "convert", "s.pvd", "-o", "x.hdf")
        self.fails(2, "step 3 is none of the 3 steps", "0 to 2", "convert", "s.pvd", "--step", "3", "-o", "x.hdf")
        os.remove(self.path("s_1.vti"))
        self.fails(3, "names 's_1.vti', which is not there (1 of 3 steps)", "--lossy", "convert", "s.pvd", "-o", "x.pvd")
        self.fails(3, "1 of the steps 0 to 2 is missing", "--lossy", "convert", "s_*.vti", "-o", "x.pvd")
        result = self.run_lamella("convert", "s.pvd", "-o", "x.pvd", "--lossy", "--json")
        self.assertEqual(result.code, 0, result.err)
        self.assertIn("1 steps are missing and left out", result.err)
        self.assertEqual(result.json()["times"], [0, 0.2])
        self.write("bad.pvd", b"<VTKFile>")
        self.fails(3, "not a whole .pvd file", "again", "convert", "bad.pvd", "-o", "y.pvd")


class Losses(Convert):
    def test_what_would_be_lost(self):
        self.image(kind="Float64", size=(4, 3, 1), array="temperature",
                   extra=[grids.array("phase", [i % 2 for i in range(12)], "UInt8")])
        self.fails(3, "holds 2 arrays ('temperature' and 'phase'), and .png takes one", "--array", "convert", "a.vti", "-o", "x.png")
        self.fails(2, "--array 'fase'", "did you mean 'phase'?", "convert", "a.vti", "--array", "fase", "-o", "x.png")
        one = ["convert", "a.vti", "--array", "temperature"]
        self.fails(3, "'temperature' holds f64 values, and .png holds u8, u16", "--range", *one, "-o", "x.png")
        self.fails(3, "which is no u8", "--lossy", *one, "--type", "u8", "-o", "x.raw")
        self.fails(3, "which is no f32", "--lossy", *one, "--type", "f32", "-o", "x.raw")
        self.fails(2, "JPEG blurs", ".png", *one, "-o", "x.jpg")
        self.fails(3, "holds an image, and .vtp holds points", ".hdf", *one, "-o", "x.vtp")
        self.fails(2, "has no ending of a format", "did you mean '.vti'?", *one, "-o", "x.vit")
        self.works(*one, "--range", "-0.4,0.4", "-o", "x.png")
        greys = [row[3] for row in self.table("x.png")[1]]
        self.assertEqual(greys, [round((v + 0.4) / 0.8 * 255) for v in values(12, "Float64")])
        self.works(*one, "--type", "f32", "--lossy", "-o", "x.raw")
        single = [struct.unpack("f", struct.pack("f", row[3]))[0] for row in self.table("x.raw")[1]]
        self.assertEqual(single, values(12, "Float32"))

    def test_whole_numbers_that_fit_lose_nothing(self):
        self.image(kind="Int32", size=(4, 3, 1))
        expected = self.table("a.vti")
        self.works("convert", "a.vti", "-o", "b.png")
        self.assertEqual(self.info("b.png")["bits"], 16)
        self.same("b.png", expected)
        self.write("c.vti", grids.vti([grids.array("grain", [-1] * 100, "Int32")]))
        self.fails(3, "whole numbers from -1 to -1", "--range", "convert", "c.vti", "-o", "c.png")

    def test_cells_in_a_table(self):
        self.write("a.vtp", grids.vtp([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1, 2)]))
        self.fails(3, "has 1 cells, of which a table keeps nothing", "--lossy", "convert", "a.vtp", "-o", "x.csv")
        self.works("convert", "a.vtp", "-o", "x.csv", "--lossy")
        self.fails(3, "holds points with 1 cells, and .vti holds an image", ".vtu", "convert", "a.vtp", "-o", "x.vti")

    def test_large_whole_numbers_in_a_table(self):
        self.write("a.vti", grids.vti([grids.array("id", [2**60 + i for i in range(100)], "Int64")], extent="0 4 0 4 0 3"))
        self.fails(3, "whole numbers up to 2^53", ".hdf", "convert", "a.vti", "-o", "x.csv")
        self.works("convert", "a.vti", "-o", "x.hdf")
        self.works("convert", "x.hdf", "-o", "x.raw")
        with open(self.path("x.raw"), "rb") as file:
            self.assertEqual(struct.unpack("<100q", file.read())[99], 2**60 + 99)


class BadFiles(Convert):
    def test_raw_volumes(self):
        self.write("v.raw", bytes(23))
        self.fails(3, "the size of the raw volume 'v.raw' is not known", "raw size", "convert", "v.raw", "-o", "x.vti")
        sized = ["convert", "v.raw", "--raw-size", "2,3,4"]
        self.fails(3, "type of the values in 'v.raw' is not known", "raw type", *sized, "-o", "x.vti")
        self.fails(3, "has 23 bytes, but 2 × 3 × 4 voxels of u16 take 48", "truncated", *sized, "--raw-type", "u16", "-o", "x.vti")
        self.fails(2, "raw type 'u12'", "did you mean", *sized, "--raw-type", "u12", "-o", "x.vti")
        self.write("big_2x3x1_i16.raw", struct.pack(">6h", 1, -2, 3, 400, 5, 6))
        self.works("convert", "big_2x3x1_i16.raw", "--raw-order", "big", "-o", "x.vti", "--pixel-size", "1um")
        names, rows, notes = self.table("x.vti")
        self.assertEqual([row[3] for row in rows], [1, -2, 3, 400, 5, 6])
        self.assertEqual(notes["arrays"][0]["type"], "i16")
        self.assertEqual(notes["image"]["spacing"], [1e-6] * 3)
        self.write("n.raw", bytes(24))
        self.write("n.raw.json", b'{"provenance": {}, "image": {"extent": [0]}}')
        self.fails(3, "notes of the file are damaged", "remove", "convert", "n.raw", "-o", "y.vti")

    def test_headers(self):
        def refused(name, text, message, hint):
            self.write(name, text)
            self.fails(3, message, hint, "convert", name, "-o", "x.vti")

        refused("a.mhd", b"", "'a.mhd' is empty", "again")
        refused("a.mhd", b"\x89PNG\r\n\x1a\n" + bytes(100), "no DimSize", "whole")
        good = "NDims = 3\nDimSize = 2 2 2\nElementType = %s\nElementDataFile = %s\n"
        refused("a.mhd", (good % ("MET_UCHAR", "a.raw")).encode(), "there is no file 'a.raw'", "check the name")
        refused("a.mhd", (good % ("MET_OTHER", "LOCAL")).encode(), "ElementType is 'MET_OTHER'", "64 bits")
        refused("a.mha", (good % ("MET_UCHAR", "LOCAL")).encode() + bytes(7), "has 7 bytes after its header", "truncated")
        refused("a.mhd", (good % ("MET_UCHAR", "LIST")).encode(), "several files", "stack")
        refused("a.nrrd", b"NRRE0004\n", "is not an NRRD file", "NRRD0004")
        head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: %s\n\n"
        refused("a.nrrd", (head % "bzip2").encode(), "encoding is 'bzip2'", "gzip")
        refused("a.nrrd", (head % "gzip").encode() + gzip.compress(bytes(5)), "3 bytes short", "")
        refused("a.nrrd", (head % "gzip").encode() + b"nonsense", "cannot be unpacked", "")

    def test_packed_volumes_of_other_tools(self):
        voxels = bytes(range(60))
        self.write("a.nrrd", b"NRRD0005\n# made by another tool\ntype: unsigned char\ndimension: 3\nsizes: 5 4 3\n"
                   b"spacings: 2 2 4\nunits: \"mm\" \"mm\" \"mm\"\nencoding: gzip\nspace origin: (1,2,3)\n\n" + gzip.compress(voxels))
        names, rows, notes = self.table("a.nrrd")
        self.assertEqual([row[3] for row in rows], list(voxels))
        self.assertEqual(notes["image"]["spacing"], [0.002, 0.002, 0.004])
        self.assertEqual(notes["image"]["origin"], [0.001, 0.002, 0.003])

    def test_stacks(self):
        for i in (0, 1, 3):
            self.write("s_%d.png" % i, pictures.png(pictures.stripes(8, 6)))
        self.fails(3, "is missing, the first is 2", "add them", "convert", "s_%d.png", "-o", "x.vti")
        self.fails(3, "1 of the slices 0 to 3 is missing", "--lossy", "convert", "s_*.png", "-o", "x.vti")
        self.write("s_2.png", pictures.png(pictures.stripes(8, 7)))
        self.fails(3, "'s_2.png' is 8 × 7 pixels of 8 bits, the first slice is 8 × 6", "alike", "convert", "s_*.png", "-o", "x.vti")
        self.write("s_2.png", pictures.png(pictures.stripes(8, 6))[:-30])
        self.fails(3, "s_2.png", "", "convert", "s_*.png", "-o", "x.vti")
        self.image("v.vti", size=(4, 4, 2))
        self.fails(2, "a PNG holds one picture, and this is a volume of 2 layers", "x_%04d.png", "convert", "v.vti", "-o", "x.png")

    def test_vtkhdf(self):
        self.image()
        self.works("convert", "a.vti", "-o", "a.hdf")
        with open(self.path("a.hdf"), "rb") as file:
            good = file.read()
        self.write("b.hdf", b"")
        self.fails(3, "'b.hdf' is empty", "again", "convert", "b.hdf", "-o", "x.vti")
        self.write("b.hdf", b"not at all HDF5")
        self.fails(3, "is not an HDF5 file", "again", "convert", "b.hdf", "-o", "x.vti")
        self.write("b.hdf", good[: len(good) * 2 // 3])
        self.fails(3, "'b.hdf'", "again", "convert", "b.hdf", "-o", "x.vti")
        version = good.find(struct.pack("<qq", 1, 0))
        self.assertGreater(version, 0)
        self.write("b.hdf", good[:version] + struct.pack("<qq", 2, 1) + good[version + 16:])
        self.fails(3, "'b.hdf' is VTKHDF 2.1, and versions up to 1 can be read", ".vti", "convert", "b.hdf", "-o", "x.vti")
        self.write("b.hdf", good.replace(b"VTKHDF", b"VTKHDX"))
        self.fails(3, "is an HDF5 file, but no VTKHDF", "ParaView", "convert", "b.hdf", "-o", "x.vti")

    def test_others(self):
        self.fails(3, "there is no file 'nothing.vti'", "check the name", "convert", "nothing.vti", "-o", "x.hdf")
        self.fails(2, "FILE is missing", "--help", "convert", "-o", "x.hdf")
        self.image()
        self.fails(2, "-o is missing", "add -o FILE", "convert", "a.vti")
        self.write("b.vti", b"<VTKFile type='ImageData'>")
        self.fails(3, "'b.vti'", "again", "convert", "b.vti", "-o", "x.hdf")
        self.write("b.csv", b"a,b\n1,2\n")
        self.fails(3, "lacks", "", "convert", "b.csv", "-o", "x.vtp")
        self.write("b.csv", b"x,y,r\n1,2,3\n1,wall,3\n")
        self.fails(3, "row 3", "", "convert", "b.csv", "-o", "x.vtp")


class Checkpoints(Convert):
    def test_arrays_of_a_checkpoint(self):
        rows = [[100 if abs(y - 40 - x // 10) < 3 else 255 for x in range(60)] for y in range(88)]
        self.write("strip.png", pictures.png(rows, pixels_per_metre=100000))
        self.works(*WORDS, *EVERY, "--max-broken", "40", "--checkpoint", "c.h5", "--quiet")
        self.fails(2, "checkpoint of a run", "--array", "convert", "c.h5", "-o", "x.csv")
        self.fails(2, "have no place, and .vti needs one", ".csv", "convert", "c.h5", "--array", "displacement", "-o", "x.vti")
        info = self.info("c.h5")
        self.assertEqual((info["kind"], info["run"]), ("checkpoint", "quasi-static fracture"))
        self.assertIn("displacement", [array["name"] for array in info["arrays"]])
        self.assertIn("displacement", self.works("info", "c.h5").out)
        self.works("convert", "c.h5", "--array", "displacement", "-o", "x.csv")
        with open(self.path("x.csv"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertTrue(lines[0].startswith("displacement"), lines[0])
        self.assertGreater(len(lines), 20)


class Large(Convert):
    def test_slabs_take_little_memory(self):
        # 144 MiB; what the program takes without any volume is about 100 MB.
        size = 144 * 2**20
        with open(self.path("v_1024x1024x144_u8.raw"), "wb") as file:
            block = bytes(range(256)) * 4096
            for _ in range(size // len(block)):
                file.write(block)
        small = self.peak("convert", self.image(), "-o", "small.vti")
        before = "v_1024x1024x144_u8.raw"
        for name in ["v.hdf", "v.vti", "v.nrrd", "v.tif", "back.raw"]:
            peak = self.peak("convert", before, "-o", name, "--quiet")
            # Two slabs of 16 MiB, one of the source and one of the target, and what packs them.
            self.assertLess(peak - small, 112 * 2**20, "%s to %s: %d MB" % (before, name, peak / 1e6))
            before = name
        with open(self.path("back.raw"), "rb") as file:
            for _ in range(size // len(block)):
                self.assertEqual(file.read(len(block)), block)

    def peak(self, *words):
        """Bytes that a run had in memory at most."""
        code = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True);"
                "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
        done = subprocess.run(["/usr/bin/python3", "-c", code, PROGRAM, *words, "--quiet"], cwd=self.folder, check=True,
                              stdout=subprocess.PIPE)
        return int(done.stdout.split()[-1]) * 1024

    def test_an_interrupted_run_leaves_nothing(self):
        with open(self.path("v_512x512x512_u16.raw"), "wb") as file:
            file.truncate(512**3 * 2)
        for name in ["x.vti", "x.hdf", "x_%04d.png", "x.mhd"]:
            process = subprocess.Popen([PROGRAM, "convert", "v_512x512x512_u16.raw", "-o", name], cwd=self.folder,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            while len(os.listdir(self.folder)) == 1 and process.poll() is None:  # until it writes
                time.sleep(0.02)
            process.send_signal(signal.SIGINT)
            _, error = process.communicate(timeout=30)
            self.assertEqual(process.returncode, 130, error)
            self.assertEqual(os.listdir(self.folder), ["v_512x512x512_u16.raw"])

    def test_an_interrupted_run_ends_soon(self):
        with open(self.path("v_512x512x320_u8.raw"), "wb") as file:  # noise, which HDF5 takes long to compress
            file.write(random.Random(1).randbytes(512 * 512 * 320))

        def run(moment):
            """Processor time up to the signal that is sent at such a moment, and from then on."""
            process = subprocess.Popen([PROGRAM, "convert", "v_512x512x320_u8.raw", "-o", "x.hdf", "--quiet"], cwd=self.folder,
                                       stderr=subprocess.DEVNULL)
            used = 0
            while used < moment:
                time.sleep(0.01)
                with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
                    used = sum(map(int, file.read().rsplit(")", 1)[1].split()[11:13])) / os.sysconf("SC_CLK_TCK")
            if moment > 0:
                process.send_signal(signal.SIGINT)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(process.returncode, 130 if moment > 0 else 0)
            return used, usage.ru_utime + usage.ru_stime - used

        _, whole = run(0)
        os.remove(self.path("x.hdf"))
        used, after = run(whole / 3)
        # a fifth of the file, a slab, may be finished; what would go on to the end took two thirds of the whole
        self.assertLess(after, 0.5 * whole, f"{used} of {whole} s before")


class Outputs(Convert):
    def test_nothing_is_overwritten_without_leave(self):
        self.image()
        for name in ["x.hdf", "x.raw.json", "x_1.png", "x.mhd"]:
            self.write(name, b"precious")
        for name, there in [("x.hdf", "x.hdf"), ("x.raw", "x.raw.json"), ("x_%d.png", "x_1.png"), ("x.mhd", "x.mhd")]:
            self.fails(7, "'%s' exists already" % there, "--overwrite", "convert", "a.vti", "-o", name)
            with open(self.path(there), "rb") as file:
                self.assertEqual(file.read(), b"precious")
        self.works("convert", "a.vti", "-o", "x_%d.png", "--overwrite")
        self.works("convert", "a.vti", "-o", "a.vti", "--overwrite")
        self.fails(7, "there is no folder 'deep'", "mkdir -p deep", "convert", "a.vti", "-o", "deep/x.hdf")

    def test_a_full_disk(self):
        self.image(kind="Float64", size=(40, 40, 20))

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        for name in ["x.vti", "x.hdf", "x.tif", "x.raw", "x.mhd", "x.nrrd", "x.csv"]:
            self.fails(7, "cannot write '%s': File too large" % name.replace(".mhd", ".raw"), "make room", "convert", "a.vti", "-o", name,
                       preexec_fn=limit)
        self.write("b.vti", grids.vti([grids.array("grain", [1] * 1000, "UInt8")], extent="0 9 0 9 0 9"))
        for name in ["x.stl", "x.ply"]:
            self.fails(7, "cannot write '%s': File too large" % name, "make room", "convert", "b.vti", "--phase", "1", "-o", name, preexec_fn=limit)


class Surfaces(Convert):
    H = 0.5e-6  # edge of a voxel

    def phases(self, wanted, size):
        """s.vti, with phases that wanted(x, y, z) tells by number, and how many voxels each has."""
        ids = [wanted(x, y, z) for z in range(size[2]) for y in range(size[1]) for x in range(size[0])]
        head = "NDims = 3\nDimSize = %d %d %d\nElementSpacing = 5e-7 5e-7 5e-7\nOffset = 1e-6 2e-6 3e-6\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
        self.write("s.mha", (head % size).encode() + bytes(ids))
        return [ids.count(i) for i in range(max(ids) + 1)]

    def surface(self, *words):
        """Writes an STL; its triangles, which are closed: its area, its volume, and the report."""
        report = self.works("convert", "s.mha", "-o", "s.stl", "--overwrite", "--json", *words).json()["surface"]
        with open(self.path("s.stl"), "rb") as file:
            data = file.read()
        count = struct.unpack("<I", data[80:84])[0]
        self.assertEqual((len(data), count), (84 + 50 * count, report["triangles"]))
        edges, area, volume, least = {}, 0, 0, [math.inf] * 3
        for at in range(84, len(data), 50):
            number = struct.unpack("<12f", data[at: at + 48])
            a, b, c = number[3:6], number[6:9], number[9:12]
            for one, two in ((a, b), (b, c), (c, a)):
                edges[one, two] = edges.get((one, two), 0) + 1
            u, v = [[p[i] - a[i] for i in range(3)] for p in (b, c)]
            cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
            self.assertGreater(sum(cross[i] * number[i] for i in range(3)), 0, "the normal is that of the triangle")
            area += math.hypot(*cross) / 2
            volume += sum(a[i] * cross[i] for i in range(3)) / 6
            least = [min(least[i], a[i], b[i], c[i]) for i in range(3)]
        # Closed: each edge lies in two triangles, which run along it in opposite directions.
        self.assertTrue(all(n == 1 and (two, one) in edges for (one, two), n in edges.items()))
        # Coordinates of STL have 24 bits, and the box reaches to some 30 voxels from the origin.
        self.assertAlmostEqual(report["area"] / area, 1, delta=1e-5)
        self.assertAlmostEqual(report["volume"] / volume, 1, delta=1e-5)  # above 0: normals point out
        return area / self.H**2, volume / self.H**3, least

    def test_a_box_that_fills_the_volume(self):
        a, b, c = 10, 8, 6
        self.phases(lambda x, y, z: 1, (a, b, c))
        area, volume, least = self.surface("--phase", "1")
        # Planes half a voxel outside the border's nodes; edges of voxels are cut off through the middles of their
        # faces, where a prism of 1/8 a voxel goes, and at corners 5/48.
        edges = 4 * (a + b + c - 3)
        self.assertAlmostEqual(volume, a * b * c - edges / 8 - 8 * 5 / 48, delta=1e-3)
        faces = 2 * ((a - 1) * (b - 1) + (b - 1) * (c - 1) + (a - 1) * (c - 1))
        self.assertAlmostEqual(area, faces + edges * math.sqrt(0.5) + 8 * math.sqrt(3) / 8, delta=1e-3)
        for found, first in zip(least, (1e-6, 2e-6, 3e-6)):
            self.assertAlmostEqual(found / self.H, first / self.H - 0.5, delta=1e-4)

    def test_a_sphere(self):
        r = 12
        count = self.phases(lambda x, y, z: int((x - 14) ** 2 + (y - 14) ** 2 + (z - 14) ** 2 < r * r), (29, 29, 29))[1]
        area, volume, _ = self.surface("--phase", "1")
        # The corners of voxels that stick out are cut off, those that are missing filled: what the count has, nearly.
        self.assertAlmostEqual(volume / count, 1, delta=0.005)
        self.assertGreater(area / (4 * math.pi * r * r), 1.05)  # the terraces of voxels have more surface than a sphere
        smooth, volume, _ = self.surface("--phase", "1", "--smooth", "20")
        self.assertAlmostEqual(smooth / (4 * math.pi * r * r), 1, delta=0.02)
        self.assertAlmostEqual(volume / count, 1, delta=0.01)

    def test_any_phases(self):
        # Noise has every neighbourhood that there is; several phases are one body.
        draw = random.Random(3)
        self.phases(lambda x, y, z: draw.choice([0, 0, 1, 7]), (12, 12, 12))
        self.surface("--phase", "1")
        self.surface("--phase", "1", "--phase", "7")

    def test_names_units_and_other_formats(self):
        self.works("generate", "spheres", "--size", "12,12,12", "--pixel-size", "1um", "-o", "a.vti")
        said = self.works("convert", "a.vti", "--phase", "inclusion", "-o", "a.stl").out
        self.assertRegex(said, r"closed surface of 'inclusion': area \S+e-1\d m², volume \S+e-16 m³")
        with open(self.path("a.stl.json"), encoding="utf-8") as file:
            self.assertIn("lamella convert a.vti", json.load(file)["provenance"]["command"])
        self.works("convert", "a.vti", "--phase", "inclusion", "-o", "a.vtp")
        self.assertEqual(self.info("a.vtp")["cells"], (os.path.getsize(self.path("a.stl")) - 84) // 50)
        self.works("convert", "a.vtp", "-o", "b.stl")
        with open(self.path("a.stl"), "rb") as one, open(self.path("b.stl"), "rb") as other:
            self.assertEqual(one.read(), other.read())

    def test_what_has_no_surface(self):
        self.works("generate", "softwood", "--size", "30,20", "-o", "flat.vti")
        self.works("generate", "spheres", "--size", "8,8,8", "-o", "a.vti")
        self.fails(3, "this is a picture", "micrograph FILE --contours", "convert", "flat.vti", "--phase", "wall", "-o", "x.stl")
        self.fails(2, "--phase 'inclusoin': there is none", "did you mean 'inclusion'?", "convert", "a.vti", "--phase", "inclusoin", "-o", "x.stl")
        self.fails(3, "holds an image, and .ply holds surfaces", "--phase NAME", "convert", "a.vti", "-o", "x.ply")
        self.fails(3, "a.vti' holds points with", ".vtp", "convert", "a.vti", "--phase", "inclusion", "-o", "x.png")
        self.fails(2, "smooth 3 without a phase", "--phase NAME", "convert", "a.vti", "--smooth", "3", "-o", "x.stl")
        self.write("c.mha", b"NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + bytes(8))
        self.fails(2, "--phase 'wall': the phases of this file have no names", "--phase 1", "convert", "c.mha", "--phase", "wall", "-o", "x.stl")
        self.fails(3, "no voxel is of these phases", "lamella info", "convert", "c.mha", "--phase", "1", "-o", "x.stl")
        self.write("t.stl", b"solid")
        self.fails(3, "'t.stl': STL, PLY is written and not read", "made from", "convert", "t.stl", "-o", "x.vtp")
        self.fails(3, "is written and not read", "made from", "info", "t.stl")
        self.write("p.csv", b"x,y,z\n0,0,0\n1,0,0\n")
        self.fails(3, "and .stl keeps polygons alone", "--lossy", "convert", "p.csv", "-o", "x.stl")
        self.fails(3, "there is no surface", "--phase", "convert", "p.csv", "-o", "x.stl", "--lossy")


class Words(Convert):
    def test_the_page_has_the_table_of_formats(self):
        table = self.works("convert", "--formats").out
        with open(os.path.join(HERE, "..", "..", "docs", "commands", "convert.md"), encoding="utf-8") as file:
            self.assertIn(table, file.read())

    def test_every_format_of_the_table_is_gone_through(self):
        endings = re.findall(r"`\.(\w+)`", self.works("convert", "--formats").out)
        others = {"tiff", "bin", "jpg", "jpeg", "pgm", "ppm", "pnm", "bmp", "vtkhdf", "h5", "hdf5", "pvd", "nii", "hdr", "vtk",
                  "xdmf", "xmf", "stl", "ply"}  # other names of the same, read only, series
        self.assertEqual(set(endings) - others, set(IMAGES) | set(POINTS))


if __name__ == "__main__":
    unittest.main()
