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


def luma(data):
    """Luma (Rec. 601, 16 to 235) of the pixels of a PNG of 8 bits and three or four colours, row by row."""
    width, height, bits, kind = struct.unpack(">IIBB", data[16:26])
    assert bits == 8 and kind in (2, 6)
    at, packed = 8, b""
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at : at + 8])
        packed += data[at + 8 : at + 8 + size] if name == b"IDAT" else b""
        at += 12 + size
    raw = zlib.decompress(packed)
    step = 3 if kind == 2 else 4
    found, above = [], bytearray(width * step)
    for y in range(height):
        start = y * (width * step + 1)
        row = bytearray(raw[start + 1 : start + 1 + width * step])
        for i, value in enumerate(row):
            left = row[i - step] if i >= step else 0
            corner = above[i - step] if i >= step else 0
            nearest = min((left, above[i], corner), key=lambda p, q=left + above[i] - corner: abs(q - p))
            row[i] = (value + (0, left, above[i], (left + above[i]) // 2, nearest)[raw[start]]) & 255
        found += [16 + (65.481 * row[i] + 128.553 * row[i + 1] + 24.966 * row[i + 2]) / 255 for i in range(0, len(row), step)]
        above = row
    return found


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
