"""Small .vti and .vtp files, written as text: what a test needs to be in them is in them, and nothing else."""


def array(name, values, kind="Float64", components=1):
    return '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>' % (
        kind, name, components, " ".join(str(value) for value in values))


def _file(kind, body, after=b""):
    return ('<?xml version="1.0"?><VTKFile type="%s" version="0.1" byte_order="LittleEndian" header_type="UInt32">' % kind
            + body).encode() + after + b"</VTKFile>"


def vti(arrays=(), extent="0 9 0 9 0 0", spacing="1 1 1", origin="0 0 0", appended=b""):
    """10 × 10 points, unless another extent is given. appended: the bytes behind <AppendedData>."""
    return _file("ImageData", '<ImageData WholeExtent="%s" Origin="%s" Spacing="%s"><Piece Extent="%s"><PointData>%s'
                 "</PointData></Piece></ImageData>" % (extent, origin, spacing, extent, "".join(arrays)),
                 b'<AppendedData encoding="raw">_' + appended + b"</AppendedData>" if appended else b"")


def vtp(points, lines=(), arrays=(), count=None, line_count=None):
    """count, line_count: how many points and lines the header says there are, when not as many as are given."""
    ends = [sum(len(line) for line in lines[: i + 1]) for i in range(len(lines))]
    return _file("PolyData", '<PolyData><Piece NumberOfPoints="%d" NumberOfVerts="0" NumberOfLines="%d" NumberOfStrips="0" '
                 'NumberOfPolys="0"><PointData>%s</PointData><Points>%s</Points><Lines>%s%s</Lines></Piece></PolyData>' % (
                     count or len(points), line_count or len(lines), "".join(arrays),
                     array("Points", [x for point in points for x in point], components=3),
                     array("connectivity", [i for line in lines for i in line], "Int64"), array("offsets", ends, "Int64")))
