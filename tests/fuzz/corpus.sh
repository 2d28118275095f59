#!/usr/bin/env bash
# Small files of all kinds, made by lamella itself, for fuzz to alter: corpus.sh LAMELLA FOLDER
set -euo pipefail
lamella=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
mkdir -p "$2"
cd "$2"
export OMP_NUM_THREADS=1
make() { "$lamella" "$@" --overwrite >/dev/null; }

# Small ones: what an input takes grows with its size.
make generate honeycomb --size 14,12 --cells 2 -o cells.vti
make generate softwood --size 40,40 -o wood.png
make generate softwood --size 32,32 --look magenta -o look.png
make generate spheres --size 5,5,5 --cells 1 -o spheres.tif
make generate spheres --size 5,5,5 --cells 1 -o spheres.vti
for ending in vtkhdf nrrd mha csv; do make convert spheres.vti -o "spheres.$ending"; done
make convert wood.png -o wood.tif
make convert wood.png --type u16 -o wood16.png
for ending in mhd nhdr; do make convert spheres.vti -o "apart-$ending.$ending"; done # their values are in apart-*.raw
make packing --count 12 -o grains.vtp --contacts forces.vtp
for ending in csv vtu vtkhdf; do make convert grains.vtp -o "grains.$ending"; done
make diffusion cells.vti --conductivity lumen=0.1 --conductivity wall=1 --direction x -o solved.vti
make flux-map solved.vti --streamlines 5 -o flux.vti -o lines.vtp
make convert forces.vtp -o forces.vtu
make transient cells.vti --diffusivity lumen=1e-9 --diffusivity wall=2e-9 --end-time 0.001 --checkpoint transient.h5
make fracture cells.vti --young wall=1e9 --critical-stretch wall=1e-3 --horizon 2 --broken broken.vtp --checkpoint fracture.h5 --checkpoint-every 1
# What Lamella reads and does not write: bytes and text, palettes, packed numbers.
/usr/bin/python3 - <<'END'
import gzip, struct, zlib
grey = bytes((37 * i) % 256 for i in range(16 * 12))
colour = bytes((17 * i) % 256 for i in range(16 * 12 * 3))
def keep(name, data):
    with open(name, "wb") as file:
        file.write(data)
keep("bytes.pgm", b"P5\n# a comment\n16 12\n255\n" + grey)
keep("deep.pgm", b"P5\n16 6\n65535\n" + grey)
keep("text.pgm", b"P2\n16 12\n255\n" + b" ".join(b"%d" % v for v in grey) + b"\n")
keep("bytes.ppm", b"P6\n16 12\n255\n" + colour)
keep("text.ppm", b"P3\n16 12\n255\n" + b" ".join(b"%d" % v for v in colour) + b"\n")
def bmp(bits, pixels, palette=b""):
    head = struct.pack("<IiiHHIIiiII", 40, 16, 12, 1, bits, 0, 0, 1000000, 1000000, len(palette) // 4, 0)
    return b"BM" + struct.pack("<III", 54 + len(palette) + len(pixels), 0, 54 + len(palette)) + head + palette + pixels
keep("palette.bmp", bmp(8, grey, bytes(v for i in range(256) for v in (i, i, i, 0))))
keep("colour.bmp", bmp(24, colour))
keep("wide.bmp", bmp(32, grey * 4))
meta = b"ObjectType = Image\nNDims = 3\nCompressedData = %s\nElementSpacing = 1e-6 1e-6 1e-6\nDimSize = 16 6 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
keep("packed.mha", meta % b"True" + zlib.compress(grey))
nrrd = b"NRRD0004\ntype: %s\ndimension: 3\nsizes: 16 6 2\nspace dimension: 3\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace units: \"um\" \"um\" \"um\"\nendian: big\nencoding: gzip\n\n"
keep("packed.nrrd", nrrd % b"uint8" + gzip.compress(grey))
keep("plain.raw", b"0123456789" + grey)
keep("packed.raw", zlib.compress(grey))
keep("packed.mhd", (meta % b"True").replace(b"LOCAL", b"packed.raw"))
keep("skipped.nhdr", (nrrd % b"uint8").replace(b"gzip\n", b"raw\nbyte skip: -1\ndata file: plain.raw\n"))
keep("signed.nrrd", nrrd % b"int16" + gzip.compress(b"".join(struct.pack(">h", v) for v in grey)))
import numpy as np
from vtkmodules.vtkIOLegacy import vtkStructuredPointsWriter
from vtkmodules.vtkIOImage import vtkPNGReader
np.save("volume.npy", np.frombuffer(grey, "u1").reshape(2, 6, 16))
np.save("wide.npy", np.frombuffer(grey, "u1").reshape(2, 6, 16).astype(">i4"))
nifti = bytearray(352)
struct.pack_into("<i", nifti, 0, 348)
struct.pack_into("<8h", nifti, 40, 3, 16, 6, 2, 1, 1, 1, 1)
struct.pack_into("<hh", nifti, 70, 2, 8)
struct.pack_into("<8f", nifti, 76, 1, 1, 1, 1, 0, 0, 0, 0)
struct.pack_into("<f", nifti, 108, 352)
nifti[123], nifti[344:348] = 3, b"n+1\0"
keep("volume.nii", bytes(nifti) + grey)
keep("packed.nii", gzip.compress(bytes(nifti) + grey))
reader, writer = vtkPNGReader(), vtkStructuredPointsWriter()
reader.SetFileName("wood.png")
writer.SetInputConnection(reader.GetOutputPort())
writer.SetFileTypeToBinary()
writer.SetFileName("wood.vtk")
writer.Write()
# JPEG of one scan and of several, with a block of Exif
from vtkmodules.vtkIOImage import vtkJPEGWriter, vtkPNGReader
exif = b"Exif\0\0II*\0\x08\0\0\0" + struct.pack("<H", 3) + struct.pack("<HHII", 274, 3, 1, 6) + struct.pack("<HHII", 282, 5, 1, 50) + \
    struct.pack("<HHII", 296, 3, 1, 2) + struct.pack("<III", 0, 25400, 1)
for name, scans in ("wood", False), ("wood", True), ("look", False), ("look", True):
    reader, writer = vtkPNGReader(), vtkJPEGWriter()
    reader.SetFileName(name + ".png")
    writer.SetInputConnection(reader.GetOutputPort())
    writer.SetProgressive(scans)
    writer.WriteToMemoryOn()
    writer.Write()
    data = bytes(memoryview(writer.GetResult()))
    keep(f"{name}-{'scans' if scans else 'scan'}.jpg", data[:2] + (b"\xff\xe1" + struct.pack(">H", 2 + len(exif)) + exif if scans else b"") + data[2:])
END
printf '{"units": "um", "lumens": [[[0,0],[4,0],[4,3],[0,3]],[[6,0],[9,0],[9,5.5],[6,5]]]}' >cells.json
gzip -kf cells.json
cp "$here"/../../examples/scenes/*.toml .
printf '%s' '{"title": "T", "sections": [{"title": "S", "text": "words", "figures": [{"file": "wood.png", "caption": "c"}], "tables": [{"file": "grains.csv", "caption": "c"}]}]}' >page.plan
rm -f ./*.*.json # what stands beside tables and plain numbers
