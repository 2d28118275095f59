"""Damaged .vti and .vtp files: whatever VTK's reader would not survive, or would make something else of, is one line."""

import base64
import re
import struct
import unittest
import zlib

import grids
from program import Case

VALUES = [i % 2 for i in range(100)]
PHASE = grids.array("phase", VALUES, "UInt8")
POINTS = [(0, 0, 0), (1, 1, 0), (2, 0, 0)]
COMMANDS = [["info"], ["snapshot", "-o", "x.png"], ["stress-pdf", "-o", "x.csv"], ["flux-map", "-o", "x.vti"],
            ["convert", "-o", "y.csv"], ["equilibrium", "--young", "a=1", "-o", "x.vti"],
            ["diffusion", "--conductivity", "a=1", "-o", "x.vti"]]


def field(body, count=1, kind="String", name="note"):
    return '<FieldData><Array type="%s" Name="%s" NumberOfTuples="%s" format="ascii">%s</Array></FieldData>' % (
        kind, name, count, body)


def with_field(body, **options):
    return grids.vti([PHASE]).replace(b"<Piece", field(body, **options).encode() + b"<Piece")


def letters(*texts):
    return " ".join(str(c) for text in texts for c in [*text.encode(), 0])


def binary(data, kind="UInt8", name="phase", more=""):
    return '<DataArray type="%s" Name="%s" format="binary"%s>%s</DataArray>' % (kind, name, more, data)


def plain(values, told=None):
    return base64.b64encode(struct.pack("<I", len(values) if told is None else told) + bytes(values)).decode()


def packed(values, blocks=1, block=None, last=None, size=None):
    data = zlib.compress(bytes(values))
    head = struct.pack("<4I", blocks, len(values) if block is None else block, 0 if last is None else last,
                       len(data) if size is None else size)
    return base64.b64encode(head).decode() + base64.b64encode(data).decode()


def compressed(data):
    return grids.vti([binary(data)]).replace(b'header_type="UInt32"', b'header_type="UInt32" '
                                             b'compressor="vtkZLibDataCompressor"')


class DamagedGrids(Case):
    def refused(self, what, data, name="d.vti", commands=(["info"],)):
        self.write(name, data)
        for words in commands:
            self.fails(3, what, "", words[0], name, *words[1:])

    def sound(self, data, name="d.vti"):
        self.write(name, data)
        return self.works("info", name, "--json").json()

    def test_what_is_right_is_read(self):
        self.sound(with_field(letters("one", "two"), count=2))
        self.sound(grids.vti([binary(plain(VALUES))]))
        self.sound(compressed(packed(VALUES)))
        self.sound(compressed(packed(VALUES)).replace(b"\"binary\">", b"\"binary\">\n   "))
        self.sound(grids.vti(['<DataArray type="UInt8" Name="phase" format="appended" offset="0"/>'],
                             appended=struct.pack("<I", 100) + bytes(100)))
        self.sound(grids.vti([grids.array("a", ["nan", "-inf", "1e-400", "+3"] * 25)]))
        self.sound(grids.vtp(POINTS, [(0, 1), (1, 2)]), "d.vtp")

    def test_field_data_beyond_its_end(self):
        for data in [with_field("1 2", kind="Strng"), with_field("1 2", kind="")]:
            self.refused("is of type '", data, commands=COMMANDS)
        self.refused("holds 40 texts where 1 are told", with_field(letters(*["text"] * 40)), commands=COMMANDS)
        self.refused("holds 2 texts where 3 are told", with_field(letters("one", "two"), count=3))
        self.refused("holds 1 texts where 1 are told", with_field("65 66"))
        self.refused("holds 3 values where 1 are told", with_field("1 2 3", kind="Float64"), commands=COMMANDS)
        self.refused("its NumberOfTuples is -1", with_field("1", count="-1"))
        self.refused("cannot hold the 9000000000000 values of field data", with_field("1", count=9 * 10**12))

    def test_arrays_that_have_not_what_they_are_said_to(self):
        for values, what in [(VALUES[1:], "99 values where 100 are told"), (VALUES + [1], "101 values where 100 are told"),
                             (VALUES[1:] + [300], "holds '300', which is no UInt8"),
                             (VALUES[1:] + [-1], "holds '-1', which is no UInt8"),
                             (VALUES[1:] + ["1e5"], "holds '1e5', which is no UInt8")]:
            self.refused(what, grids.vti([grids.array("phase", values, "UInt8")]))
        self.refused("holds '1e999', which is no Float32", grids.vti([grids.array("a", ["1e999"] * 100, "Float32")]))
        self.refused("holds 100 values where 200 are told", grids.vti([PHASE.replace('Components="1"', 'Components="2"')]))
        for components in ["0", "-3", "2147483647", "many"]:
            self.refused("has %s components" % components, grids.vti([PHASE.replace('Components="1"',
                                                                                    'Components="%s"' % components)]))
        self.refused("is of type 'Float65'", grids.vti([PHASE.replace("UInt8", "Float65")]), commands=COMMANDS)
        self.refused("two arrays 'phase'", grids.vti([PHASE, PHASE]))
        self.refused("an array in it has no name", grids.vti([PHASE.replace('Name="phase"', "")]))

    def test_binary_arrays(self):
        for data, what in [(plain(VALUES[1:]), "99 values where 100"), (plain(VALUES, 99), "not written in base64"),
                           (plain(VALUES, 10**9), "ends before its last value"),
                           (plain(VALUES)[:-8], "ends before its last value"), (plain(VALUES) + "AAAA", "goes on behind"),
                           ("!" + plain(VALUES)[1:], "ends before its"), ("", "ends before its first value")]:
            self.refused(what, grids.vti([binary(data)]))
        for data, what in [(packed(VALUES, block=0), "blocks of 0 bytes"), (packed(VALUES, last=101), "the last of 101"),
                           (packed(VALUES, blocks=10**9), "1000000000 blocks"),
                           (packed(VALUES, blocks=0), "goes on behind"), (packed(VALUES, size=10**9), "of 1000000000 bytes"),
                           (packed(VALUES, block=2**32 - 1), "blocks of 4294967295"),
                           (packed(VALUES[1:]), "99 values where 100")]:
            self.refused(what, compressed(data), commands=COMMANDS if "0 bytes" in what else (["info"],))
        damaged = bytearray(base64.b64decode(packed(VALUES)[24:]))
        damaged[10] ^= 255
        self.refused("cannot be unpacked", compressed(packed(VALUES)[:24] + base64.b64encode(damaged).decode()),
                     commands=COMMANDS)
        self.refused("packed by vtkZipDataCompressor", compressed(packed(VALUES)).replace(b"vtkZLib", b"vtkZip"))

    def test_appended_arrays(self):
        def vti(*offsets, data=struct.pack("<I", 100) + bytes(100)):
            return grids.vti(['<DataArray type="UInt8" Name="a%d" format="appended" offset="%s"/>' % (i, offset)
                              for i, offset in enumerate(offsets)], appended=data)
        for offset in ["1000000", "-8", "x"]:
            self.refused("has its data at %s, where there are none" % offset, vti(offset))
        self.refused("ends before its", vti("102")) # reads the tag behind the data as a length
        self.refused("holds 0 values where 100 are told", vti("90"))
        self.refused("holds 0 values where 100", vti("4"))
        two = struct.pack("<I", 100) + bytes(100)
        self.sound(vti("0", "104", data=two + two))
        self.refused("share a part of their bytes", vti(
            "0", "52", data=struct.pack("<I", 100) + bytes(48) + struct.pack("<I", 100) + bytes(100)))
        self.refused("in no known encoding", vti("0").replace(b'"raw"', b'"row"'))

    def test_extents(self):
        for extent in ["0 -2147483648 0 9 0 0", "-2147483648 2147483647 0 9 0 0", "-2147483648 -2147483639 0 9 0 0",
                       "0 9 0 9 0 99999999999", "0 9 0 9 0", "0 9 0 9 0 0 0", "0 9 0 9.5 0 0"]:
            self.refused("holds no points: its extent is " + extent, grids.vti([PHASE], extent=extent), commands=COMMANDS)

        def pieces(*extents, count=50):
            body = "".join('<Piece Extent="%s"><PointData>%s</PointData></Piece>' % (
                extent, grids.array("phase", [1] * count, "UInt8")) for extent in extents)
            return re.sub(b"<Piece.*</Piece>", body.encode(), grids.vti())
        self.sound(pieces("0 9 0 4 0 0", "0 9 5 9 0 0"))
        self.refused("its pieces are not the whole", pieces("0 9 0 4 0 0", "0 9 0 4 0 0"), commands=COMMANDS)
        self.refused("its pieces are not the whole", pieces("0 9 0 4 0 0"))
        self.refused("lies outside of the whole", pieces("0 9 0 4 0 0", "0 9 6 10 0 0"))
        self.refused("its extent is missing", pieces("0 9 0 4 0 0", "0 9 5 9 0 0").replace(b'Extent="0 9 5', b'X="0 9 5'))
        self.refused("different arrays", pieces("0 9 0 4 0 0", "0 9 5 9 0 0").replace(b"UInt8", b"Int8", 1))
        self.refused("the direction of 'd.vti' is 1 0", grids.vti([PHASE]).replace(b"WholeE", b'Direction="1 0" WholeE'))

    def test_cells(self):
        good = grids.vtp(POINTS, [(0, 1), (1, 2)]).decode()
        for old, new, what in [(">2 4<", ">2 5<", "holds 4 values where 5 are told"),
                               (">2 4<", ">4 2<", "begin and end where there are none"),
                               (">2 4<", ">-2 4<", "begin and end where there are none"),
                               (">2 4<", ">2<", "holds 1 values where 2 are told"),
                               (">2 4<", ">2 4000000000000<", "4 values where 4000000000000"),
                               ("offsets", "offset", "its lines have no 'offsets'"),
                               ('Lines="2"', 'Lines="1"', "holds 2 values where 1 are told"),
                               ('Lines="2"', 'Lines="0"', "holds 2 values where 0 are told"),
                               ('Lines="2"', 'Lines="-1"', "its NumberOfLines is -1"),
                               ('Verts="0"', 'Verts="1"', "its 1 vertices are missing"),
                               ('Points="3"', 'Points="2"', "holds 9 values where 6 are told"),
                               (' NumberOfPoints="3"', "", "its NumberOfPoints is missing"),
                               ('"Points" NumberOfComponents="3"', '"Points" NumberOfComponents="1"', "three coordinates"),
                               (">0 0 0 1", ">nan 0 0 1", "its point 0 is at nan"),
                               ('type="Int64" Name="off', 'type="Float64" Name="off', "are no whole numbers"),
                               ("0 1 1 2", "0 1 1 3", "a cell has point 3, and there are 3 points")]:
            self.assertIn(old, good)
            self.refused(what, good.replace(old, new, 1).encode(), "d.vtp",
                         [["info"], ["bridges", "-o", "x.vti"], ["flux-map", "-o", "x.vti"], ["convert", "-o", "y.csv"]])

    def test_xml(self):
        good = grids.vti([PHASE])
        self.refused("damaged or cut short", good[:-20], commands=COMMANDS)
        self.refused("", good.replace(b"<Piece", b"<a>" * 100000 + b"<Piece").replace(b"</Piece>", b"</Piece>" +
                                                                                      b"</a>" * 100000))
        self.refused("several times in one file", good.replace(b"WholeExtent", b'TimeValues="0 1" WholeExtent'))
        self.refused("holds no ImageData", good.replace(b"<ImageData", b"<Image").replace(b"</ImageData", b"</Image"))
        self.refused("has a '>' in its tag", good.replace(b'Name="phase"', b'Name="a>b"'))
        self.refused("holds", good.replace(b">0 1 0", b">0 1 <!-- 0 --> 0"))


if __name__ == "__main__":
    unittest.main()
