"""Small picture files, written byte by byte: what a test needs to be in them is in them, and nothing else."""

import struct
import zlib


def _chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(rows, bits=8, palette=None, colour=None, pixels_per_metre=None, height=None):
    """rows: lists of greys (8 or 16 bits), of palette indices (palette: list of (r, g, b)), or of (r, g, b) (colour).
    height: what the header says, when it is not the number of rows."""
    kind = 3 if palette else 2 if colour else 0
    raw = b""
    for row in rows:
        raw += b"\0"
        if kind == 2:
            raw += bytes(value for pixel in row for value in pixel)
        elif bits == 16:
            raw += struct.pack(">%dH" % len(row), *row)
        else:
            raw += bytes(row)
    out = b"\x89PNG\r\n\x1a\n"
    out += _chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), height or len(rows), bits, kind, 0, 0, 0))
    if pixels_per_metre:
        out += _chunk(b"pHYs", struct.pack(">IIB", pixels_per_metre, pixels_per_metre, 1))
    if palette:
        out += _chunk(b"PLTE", bytes(value for entry in palette for value in entry))
    return out + _chunk(b"IDAT", zlib.compress(raw)) + _chunk(b"IEND", b"")


def cmyk_tiff(width, height):
    """An uncompressed TIFF of four inks."""
    pixels = bytes(4 * width * height)
    entries = [
        (256, 4, 1, width),
        (257, 4, 1, height),
        (258, 3, 4, 8 + len(pixels)),  # bits: 8, 8, 8, 8, stored behind the pixels
        (259, 3, 1, 1),
        (262, 3, 1, 5),  # separated
        (273, 4, 1, 8),
        (277, 3, 1, 4),
        (278, 4, 1, height),
        (279, 4, 1, len(pixels)),
    ]
    directory = 8 + len(pixels) + 8
    out = struct.pack("<2sHI", b"II", 42, directory) + pixels + struct.pack("<4H", 8, 8, 8, 8)
    out += struct.pack("<H", len(entries))
    for tag, kind, count, value in entries:
        out += struct.pack("<HHII", tag, kind, count, value)
    return out + struct.pack("<I", 0)


def stripes(width, height, first=0, second=255, across=True, bands=2):
    """Bands of two greys that alternate across the picture, or down it."""
    return [
        [first if ((x * bands // width) if across else (y * bands // height)) % 2 == 0 else second for x in range(width)]
        for y in range(height)
    ]
