"""The main crack of a notched sample: the way from the notch's tip to the far side.

Vertices are the points of the paths that lamella.crack_path() finds, edges what joins them:
- along a path, at its length;
- across a void, straight, from the end of a path to that of another one at the same void, at its length;
- through solid that holds, from the end of a path to a point of another path not farther than two horizons, at ten times its length.
From the notch's tip to a path, and from a path to the far side, the way goes like that, too: through a void that the tip lies in or that touches the side,
or through two horizons of solid at most. It is the shortest of such ways.
"""

import heapq
from itertools import combinations

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree
from scipy.stats import spearmanr
from vtkmodules.util.numpy_support import vtk_to_numpy

VOID, WALL, MIDDLE = 0, 1, 2  # phases; MIDDLE: middle lamella
SOLID_COSTS = 10


class Ways:
    """A graph of places, with what each edge is made of."""

    def __init__(self):
        self.edges = {}

    def join(self, a, b, length, kind, costs=1):
        """Both ways; of two edges between the same places the cheaper one stays."""
        known = self.edges.get(a, {}).get(b)
        if known is None or length * costs < known[0]:
            self.edges.setdefault(a, {})[b] = (length * costs, length, kind)
            self.edges.setdefault(b, {})[a] = (length * costs, length, kind)

    def shortest(self, start, end):
        """[(place, length of the edge to it, its kind)] from start to end, without start; None where nothing joins them."""
        best, before, heap = {start: 0.0}, {}, [(0.0, start)]
        while heap:
            so_far, place = heapq.heappop(heap)
            if place == end:
                way = []
                while place != start:
                    last = before[place]
                    way.append((place, *self.edges[last][place][1:]))
                    place = last
                return way[::-1]
            if so_far > best[place]:
                continue
            for other, (costs, _, _) in self.edges.get(place, {}).items():
                if so_far + costs < best.get(other, np.inf):
                    best[other], before[other] = so_far + costs, place
                    heapq.heappush(heap, (so_far + costs, other))
        return None


def kind_at(phases, between):
    """Where a path runs: 'lamella' within it, on its border or between the walls of two cells; 'wall' within the wall of one cell."""
    return "lamella" if MIDDLE in phases or between else "wall"


def way_from_notch(path, phase, spacing, notch, horizon):
    """The main crack as above; a dictionary.

    path     lamella.CrackPathResult
    phase    #rows by #columns with the bottom row first: 0 void, 1 wall, 2 middle lamella
    notch    (x, y, x, y) of its mouth on the left side and of its tip [m]
    horizon  [spacings]

    reaches   whether there is a way from the notch's tip to the right side
    length    of it [m]; 'wall', 'void' (across lumens) and 'solid' (what still holds) are shares of that
    lamella   share of what is cracked, walls and lamella, that lies in the lamella
    first     where on the way it broke first: 0 at the notch, 1 at the far side
    order     Spearman's rank correlation of place and event along the way: 1 where it broke point after point from the notch on
    points    #points by 2, the way [m]
    """
    none = {"reaches": False, "length": np.nan, "lamella": np.nan, "wall": np.nan, "void": np.nan, "solid": np.nan, "first": np.nan,
            "order": np.nan, "points": np.empty((0, 2))}
    if not path.lines:
        return none
    high, wide = phase.shape
    reach = 2 * horizon * spacing
    places = vtk_to_numpy(path.vtk.GetPoints().GetData())[:, :2]
    cells = path.vtk.GetLines()
    offsets, ids = vtk_to_numpy(cells.GetOffsetsArray()), vtk_to_numpy(cells.GetConnectivityArray())
    arrays = {name: vtk_to_numpy(path.vtk.GetPointData().GetArray(name)) for name in ("event", "phases", "between_grains")}
    voids, _ = ndimage.label(phase == VOID)

    def void_at(place):
        """Number of the void within two spacings of a place; 0 where there is none."""
        column, row = (place / spacing).astype(int)
        near = voids[max(0, row - 2) : row + 3, max(0, column - 2) : column + 3]
        return int(near.max(initial=0))

    ways, start, end = Ways(), "notch", "side"
    tree, line_of, ends = cKDTree(places), {}, []
    for number, (low, high_id) in enumerate(zip(offsets[:-1], offsets[1:])):
        line = ids[low:high_id]
        for a, b in zip(line[:-1], line[1:]):
            ways.join(int(a), int(b), float(np.hypot(*(places[b] - places[a]))), kind_at(arrays["phases"][b], arrays["between_grains"][b]))
        for one in map(int, line):
            line_of.setdefault(one, set()).add(number)
        ends += [int(line[0]), int(line[-1])]

    at_void = {}
    for one in set(ends):
        if void := void_at(places[one]):
            at_void.setdefault(void, []).append(one)
        for other in tree.query_ball_point(places[one], reach):
            if not line_of[one] & line_of[other]:
                ways.join(one, other, float(np.hypot(*(places[one] - places[other]))), "solid", SOLID_COSTS)
    for void, there in at_void.items():
        for a, b in combinations(there, 2):
            ways.join(a, b, float(np.hypot(*(places[a] - places[b]))), "void")
        columns = np.flatnonzero((voids == void).any(axis=0))
        if columns[-1] == wide - 1:
            for one in there:
                ways.join(one, end, wide * spacing - places[one][0], "void")
    for one in np.flatnonzero(places[:, 0] > wide * spacing - reach):
        ways.join(int(one), end, max(0.0, wide * spacing - places[one][0]), "solid", SOLID_COSTS)

    tip = np.array(notch[2:])
    for one in tree.query_ball_point(tip, reach):
        ways.join(start, one, float(np.hypot(*(places[one] - tip))), "solid", SOLID_COSTS)
    row, column = min(high - 1, int(tip[1] / spacing)), min(wide - 1, int(tip[0] / spacing))
    for one in at_void.get(int(voids[row, column]), ()):
        ways.join(start, one, float(np.hypot(*(places[one] - tip))), "void")

    way = ways.shortest(start, end)
    if way is None:
        return none
    lengths = {"lamella": 0.0, "wall": 0.0, "void": 0.0, "solid": 0.0}
    along, event, so_far = [], [], 0.0
    for place, length, kind in way:
        lengths[kind] += length
        so_far += length
        if place != end and kind in ("lamella", "wall"):
            along.append(so_far)
            event.append(arrays["event"][place])
    whole = sum(lengths.values())
    cracked = lengths["lamella"] + lengths["wall"]
    return {
        "reaches": True, "length": whole, "lamella": lengths["lamella"] / cracked if cracked else np.nan, "wall": lengths["wall"] / whole,
        "void": lengths["void"] / whole, "solid": lengths["solid"] / whole,
        "first": along[int(np.argmin(event))] / whole if along else np.nan,
        "order": float(spearmanr(along, event).statistic) if len(set(event)) > 1 else np.nan,
        "points": np.array([tip, *(places[place] for place, _, _ in way if place != end)]),
    }
