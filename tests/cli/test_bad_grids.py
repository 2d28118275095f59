"""Bad .vti and .vtp files: one clear line, one remedy, at once, nothing left behind; never the end of the program."""

import os
import random
import struct
import unittest

import grids
import pictures
from program import Case

PHASE = grids.array("phase", [i % 2 for i in range(100)], "UInt8")
POINTS = [(0, 0, 0), (1, 1, 0), (2, 0, 0)]


def readers(name):
    """Every command that reads a .vti or .vtp, with what it needs."""
    return [["info", name], ["snapshot", name, "-o", "x.png"], ["stress-pdf", name, "-o", "x.csv"],
            ["flux-map", name, "-o", "x.vti"]] + (
                [["bridges", name, "-o", "x.vti"], ["snapshot", "image.vti", "--lines", name, "-o", "x.png"]]
                if name.endswith(".vtp") else
                [["equilibrium", name, "--young", "a=1", "-o", "x.vti"], ["bond-stiffness", name, "--young", "a=1"],
                 ["diffusion", name, "--conductivity", "a=1", "-o", "x.vti"]])


class BadGrids(Case):
    def setUp(self):
        super().setUp()
        self.write("image.vti", grids.vti([PHASE]))

    def refused(self, message, hint, name, data):
        self.write(name, data)
        for words in readers(name):
            self.fails(3, message, hint, *words)

    def test_more_than_the_bytes_can_hold(self):
        for extent, size in [("0 3999 0 3999 0 3999", "4000 × 4000 × 4000"),
                             ("0 2000000000 0 2000000000 0 0", "2000000001 × 2000000001 × 1")]:
            self.refused("B cannot hold the " + size + " points it speaks of", "again", "v.vti",
                         grids.vti([PHASE], extent=extent))
        self.refused("cannot hold the 4000000000000 points and 1 cells it speaks of", "again", "p.vtp",
                     grids.vtp(POINTS, [(0, 1)], count=4 * 10**12))
        self.refused("cannot hold the 3 points and 400000000000 cells it speaks of", "again", "p.vtp",
                     grids.vtp(POINTS, [(0, 1)], line_count=4 * 10**11))

    def test_cells_of_points_that_are_not_there(self):
        self.refused("a cell has point 7000000, and there are 3 points", "again", "p.vtp",
                     grids.vtp(POINTS, [(0, 7000000)]))
        self.refused("a cell has point -1, and there are 3 points", "again", "p.vtp", grids.vtp(POINTS, [(-1, 1)]))

    def test_images_without_points_or_lengths(self):
        self.refused("holds no points: its extent is 0 -1 0 -1 0 -1", "what wrote it", "v.vti",
                     grids.vti([], extent="0 -1 0 -1 0 -1"))
        for spacing in ["0 0 0", "-1 -1 -1", "nan nan nan", "1e300 1e300 1e300", "1 1"]:
            self.refused("the spacing of 'v.vti' is " + spacing, "three positive lengths", "v.vti",
                         grids.vti([PHASE], spacing=spacing))
        self.refused("the origin of 'v.vti' is inf 0 0", "three lengths", "v.vti", grids.vti([PHASE], origin="inf 0 0"))

    def test_appended_data_beyond_the_end(self):
        data = grids.vti(['<DataArray type="UInt8" Name="phase" format="appended" offset="1000000"/>'],
                         appended=struct.pack("<I", 100) + bytes(100))
        self.refused("has its data at 1000000, where there are none", "again", "v.vti", data)

    def test_other_kinds_of_files(self):
        noise = random.Random(1)
        for ending in ["vti", "vtp"]:
            name = "y." + ending
            for data in [bytes(noise.randrange(256) for _ in range(2000)), b"Dear diary, " * 40,
                         pictures.png([[0] * 9] * 9), grids.vtp(POINTS) if ending == "vti" else grids.vti([PHASE])]:
                self.write(name, data)
                for words in readers(name):
                    self.fails(3, "'" + name + "' is not a", "", *words)
            os.remove(self.path(name))
            os.mkdir(self.path(name))
            for words in [["info", name], ["stress-pdf", name], ["flux-map", name]]:
                self.fails(3, "is a folder, not a file", "a file in it", *words)
            os.rmdir(self.path(name))

    def test_lines_of_something_else(self):
        snapshot = ["snapshot", "image.vti", "--lines", "p.vtp", "-o", "x.png"]
        self.write("p.vtp", grids.vtp(POINTS))
        self.fails(3, "'p.vtp' holds no lines", "flux-map", *snapshot)
        self.write("p.vtp", grids.vtp([(0, 0, 0), (5e6, 0, 0)], [(0, 1)]))
        self.fails(3, "the lines given lead far out of the picture", "made of these data", *snapshot)
        self.write("p.vtp", grids.vtp([(20, 20, 0), (30, 20, 0)], [(0, 1)]))
        self.fails(3, "none of the lines given is in the picture", "made of these data", *snapshot)
        self.write("p.vtp", grids.vtp([(2, 2, 0), (8, 3, 0)], [(0, 1)]))
        self.works(*snapshot)

    def test_flux_of_any_size_and_conductivities_that_are_none(self):
        def solved(flux, conductivity):
            text = grids.vti([PHASE, grids.array("flux", [flux, flux, 0] * 100, components=3)]).decode()
            field = "<FieldData>" + grids.array("phase_conductivity", conductivity).replace(
                "<DataArray", '<DataArray NumberOfTuples="2"') + "</FieldData><Piece"
            return text.replace("<Piece", field).encode()
        self.write("f.vti", solved(1, ["nan", 1]))
        self.fails(3, "'phase_conductivity' holds nan", "Steady Diffusion", "flux-map", "f.vti", "-o", "x.vti")
        self.write("f.vti", solved(1e300, [1, 1]))  # its square is no number
        self.assertIn("|flux|", self.works("flux-map", "f.vti").out)

    def test_an_id_that_is_none(self):
        self.write("v.vti", grids.vti([grids.array("grain", ["1e300"] * 100)]))
        self.fails(3, "'grain' has the value 1e+300, which is no id", "scalar", "snapshot", "v.vti", "--preset", "grain",
                   "-o", "x.png")


if __name__ == "__main__":
    unittest.main()
