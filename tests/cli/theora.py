"""Films in Ogg Theora, decoded by libtheora, which ParaView brings along; the pages of the file are read here."""

import ctypes


class _Info(ctypes.Structure):
    _fields_ = [(name, ctypes.c_ubyte) for name in ("major", "minor", "subminor")] + [
        (name, ctypes.c_uint32)
        for name in ("frame_width", "frame_height", "pic_width", "pic_height", "pic_x", "pic_y", "rate", "rate_denominator",
                     "aspect", "aspect_denominator")
    ] + [(name, ctypes.c_int) for name in ("colours", "format", "bitrate", "quality", "shift")]


class _Comment(ctypes.Structure):
    _fields_ = [("comments", ctypes.c_void_p), ("lengths", ctypes.c_void_p), ("count", ctypes.c_int), ("vendor", ctypes.c_void_p)]


class _Packet(ctypes.Structure):
    _fields_ = [("data", ctypes.c_char_p), ("bytes", ctypes.c_long), ("first", ctypes.c_long), ("last", ctypes.c_long),
                ("granule", ctypes.c_int64), ("number", ctypes.c_int64)]


class _Plane(ctypes.Structure):
    _fields_ = [("width", ctypes.c_int), ("height", ctypes.c_int), ("stride", ctypes.c_int), ("data", ctypes.POINTER(ctypes.c_ubyte))]


def _packets(data):
    """Packets of the one stream of an Ogg file."""
    at, packet = 0, b""
    while at < len(data):
        if data[at : at + 5] != b"OggS\0":
            raise ValueError(f"no page at byte {at}")
        sizes = data[at + 27 : at + 27 + data[at + 26]]
        at += 27 + len(sizes)
        for size in sizes:
            packet += data[at : at + size]
            at += size
            if size < 255:
                yield packet
                packet = b""


class Film:
    def __init__(self, path):
        with open(path, "rb") as file:
            self._packets = list(_packets(file.read()))
        self._library = ctypes.CDLL("libtheoradec.so.1")
        self._library.th_decode_alloc.restype = ctypes.c_void_p
        self._info, comment, setup = _Info(), _Comment(), ctypes.c_void_p()
        self._library.th_info_init(ctypes.byref(self._info))
        self._library.th_comment_init(ctypes.byref(comment))
        for number in range(3):
            if self._library.th_decode_headerin(ctypes.byref(self._info), ctypes.byref(comment), ctypes.byref(setup),
                                                ctypes.byref(self._packet(number))) <= 0:
                raise ValueError(f"header {number} of the film is none")
        self._decoder = ctypes.c_void_p(self._library.th_decode_alloc(ctypes.byref(self._info), setup))
        self.width, self.height = self._info.pic_width, self._info.pic_height
        self.rate = self._info.rate / self._info.rate_denominator

    def _packet(self, number):
        data = self._packets[number]
        return _Packet(data, len(data), number == 0, number + 1 == len(self._packets), -1, number)

    def frames(self):
        """Luma (16 to 235) of the pixels of each, row by row from the top."""
        found = []
        for number in range(3, len(self._packets)):
            if self._library.th_decode_packetin(self._decoder, ctypes.byref(self._packet(number)), None) < 0:
                raise ValueError(f"frame {len(found)} of the film cannot be decoded")
            planes = (_Plane * 3)()
            self._library.th_decode_ycbcr_out(self._decoder, planes)
            luma, left = planes[0], self._info.pic_x
            top = self._info.pic_y
            found.append([luma.data[y * luma.stride + x] for y in range(top, top + self.height) for x in range(left, left + self.width)])
        return found
