"""The same sample in every kind of file that is read gives the same number."""

import gzip
import json
import struct
import unittest

from program import Case

SOLVE = ["--conductivity", "lumen=0.1", "--conductivity", "wall=1", "--direction", "x", "--json"]
GREYS = ["--phase", "0=lumen", "--phase", "255=wall"]


class Kinds(Case):
    def conductivity(self, name, *words):
        return json.loads(self.works("diffusion", name, *SOLVE, *words).out)["effective"]

    def test_every_kind_gives_the_same(self):
        self.works("generate", "softwood", "--size", "40,24", "--seed", "3", "-o", "wood.png")
        wanted = self.conductivity("wood.png")
        for ending in ("tif", "mha", "nrrd", "mhd", "nhdr", "raw", "npy"):
            self.works("convert", "wood.png", "-o", f"{ending}.{ending}")
        with open(self.path("raw.raw"), "rb") as file:
            ids = file.read()
        rows = [bytes(255 * v for v in ids[40 * y:40 * (y + 1)]) for y in range(24)]  # the lowest first
        self.write("wood.pgm", b"P5 40 24 255\n" + b"".join(reversed(rows)))
        self.write("wood.ppm", b"P6 40 24 255\n" + bytes(v for row in reversed(rows) for v in row for _ in range(3)))
        palette = bytes(v for i in range(256) for v in (i, i, i, 0))
        head = struct.pack("<IiiHHIIiiII", 40, 40, 24, 1, 8, 0, 0, 0, 0, 256, 0)
        self.write("wood.bmp", b"BM" + struct.pack("<III", 0, 0, 54 + len(palette)) + head + palette + b"".join(rows))
        nifti = bytearray(352)
        struct.pack_into("<i", nifti, 0, 348)
        struct.pack_into("<8h", nifti, 40, 2, 40, 24, 1, 1, 1, 1, 1)
        struct.pack_into("<hh", nifti, 70, 2, 8)
        struct.pack_into("<f", nifti, 108, 352)
        nifti[344:348] = b"n+1\0"
        self.write("wood.nii", bytes(nifti) + b"".join(rows))
        self.write("wood.nii.gz", gzip.compress(bytes(nifti) + b"".join(rows)))
        legacy = b"# vtk DataFile Version 4.2\nwood\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 40 24 1\nSPACING 1 1 1\nORIGIN 0 0 0\n"
        self.write("wood.vtk", legacy + b"POINT_DATA 960\nSCALARS grey unsigned_char 1\nLOOKUP_TABLE default\n" + b"".join(rows))
        for name, *words in (("tif.tif",), ("npy.npy", "--phase", "0=lumen,1=wall"),
                             ("wood.nii", *GREYS), ("wood.nii.gz", *GREYS), ("wood.vtk", *GREYS), ("wood.pgm", *GREYS), ("wood.ppm", *GREYS), ("wood.bmp", *GREYS),
                             ("mha.mha", "--phase", "0=lumen,1=wall"), ("nrrd.nrrd", "--phase", "0=lumen,1=wall"),
                             ("nhdr.nhdr", "--phase", "0=lumen,1=wall"), ("mhd.mhd", "--phase", "0=lumen,1=wall")):
            with self.subTest(name):
                self.assertEqual(self.conductivity(name, *words), wanted)

    def test_info_names_the_kind(self):
        self.write("a.pgm", b"P2 2 1 255\n0 255\n")
        self.assertEqual(json.loads(self.works("info", "a.pgm", "--json").out)["format"], "PGM")
        self.fails(3, "'b.pgm' is truncated: 1 bytes behind its header cannot hold 2 × 1 pixels", "again", "info",
                   self.write("b.pgm", b"P5 2 1 255\n1"))


if __name__ == "__main__":
    unittest.main()
