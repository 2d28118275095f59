"""The first paper's figures 2 to 5 of the tissues that study.py has found in its micrographs: a grid of points, the direction that two
contours give a point, growth of the middle lamella, and the three sets of points."""

import os
import sys

import lamella
import numpy as np
from matplotlib import image as mpimg
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import write_figure  # noqa: E402

UM = 1e6
BLUE, RED, YELLOW = "#3b6fb6", "#c8382e", "#f7c325"  # lumens, secondary wall, middle lamella: the paper's colours
LUMEN, WALL, LAMELLA = range(3)


class Part:
    """Outlines, and a lattice of theirs, in a window [µm]: low x, low y, high x, high y from the picture's lower left corner."""

    def __init__(self, outlines, window, spacing, **growth):
        self.left, self.low, self.right, self.high = window
        self.chains = [chain * UM for chain in outlines.chains]
        self.closed = outlines.closed
        self.lumens = outlines.lumens
        lattice = outlines.lattice(spacing / UM, lamella="growth", **growth)
        phase, grain, axis = (array[::-1] for array in (lattice.phase, lattice.grain, lattice.axis))  # bottom row first
        self.spacing = lattice.spacing * UM
        columns, rows = (slice(int(low / self.spacing), int(np.ceil(high / self.spacing)))
                         for low, high in ((self.left, self.right), (self.low, self.high)))
        self.phase, self.grain, self.axis = (array[rows, columns] for array in (phase, grain, axis))
        self.x, self.y = ((one.start + 0.5 + np.arange(n)) * self.spacing for one, n in zip((columns, rows), self.phase.shape[::-1]))

    def segments(self, lumen=None):
        """Of the outlines, or of one lumen's: #segments by 2 ends by 2."""
        parts = []
        for chain, closed, number in zip(self.chains, self.closed, self.lumens):
            if lumen is None or number == lumen:
                ends = np.vstack([chain, chain[:1]]) if closed else chain
                parts.append(np.stack([ends[:-1], ends[1:]], axis=1))
        return np.concatenate(parts)

    def draw_outlines(self, axes, colour, width, dots=0):
        axes.add_collection(LineCollection(self.segments(), colors=colour, linewidths=width, capstyle="round"))
        if dots:
            ends = self.segments()[:, 0]
            axes.plot(*ends.T, ".", markersize=dots, color=colour)

    def frame(self, axes, bar=None):
        """The window alone, with a scale bar [µm] below it at the left."""
        axes.set_xlim(self.left, self.right)
        axes.set_ylim(self.low, self.high)
        axes.set_aspect("equal")
        axes.set_xticks([])
        axes.set_yticks([])
        if bar:
            scale_bar(axes, bar)


def scale_bar(axes, length, unit=1):
    """Below the axes; unit: of the data in µm."""
    left, right = axes.get_xlim()
    end = length / unit / (right - left)
    axes.plot([0, end], [-0.035, -0.035], color="black", linewidth=2.5, solid_capstyle="butt", transform=axes.transAxes, clip_on=False)
    axes.text(end + 0.015, -0.035, f"{length} µm", transform=axes.transAxes, va="center", fontsize=8)


def window_about(outlines, size, centre=None):
    """A window of that size [µm] about a point, or in the middle, within the picture."""
    low = []
    for length, whole, at in zip(size, outlines.size * UM, outlines.size * UM / 2 if centre is None else centre):
        low.append(min(max(at - length / 2, 0), max(whole - length, 0)))
    return (*low, *(min(at + length, whole) for at, length, whole in zip(low, size, outlines.size * UM)))


def nearest(point, segments):
    """The place on the segments that is nearest to a point, and the unit tangent there: across the way to it."""
    begin, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    share = np.clip(np.sum((point - begin) * along, axis=1) / np.sum(along * along, axis=1), 0, 1)
    foot = begin + share[:, None] * along
    foot = foot[np.argmin(np.sum((foot - point) ** 2, axis=1))]
    across = np.array([point[1] - foot[1], foot[0] - point[0]])
    return foot, across / max(np.linalg.norm(across), 1e-12)


def distances(points, segments):
    """From each point to the segments."""
    begin, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    square = np.sum(along * along, axis=1)
    found = np.empty(len(points))
    for k in range(0, len(points), 2000):
        gap = points[k:k + 2000, None] - begin
        share = np.clip(np.sum(gap * along, axis=2) / square, 0, 1)
        found[k:k + 2000] = np.sqrt(np.min(np.sum((gap - share[..., None] * along) ** 2, axis=2), axis=1))
    return found


def draw_grid(scan, pixel, outlines, window, path):
    """Figure 2: micrograph, contours, a coarse grid of points."""
    part = Part(outlines, window, 2)
    figure, axes = plt.subplots(1, 3, figsize=(10.8, 3.35))
    picture = mpimg.imread(scan)
    high, wide = picture.shape[:2]
    columns, rows = (slice(round(low / pixel), round(end / pixel)) for low, end in (
        (part.left, part.right), (high * pixel - part.high, high * pixel - part.low)))
    axes[0].imshow(picture[rows, columns], extent=(part.left, part.right, part.low, part.high), interpolation="antialiased")
    part.draw_outlines(axes[1], "#1f5fae", 0.9, dots=1.6)
    part.draw_outlines(axes[2], "0.65", 0.7)
    x, y = np.meshgrid(part.x, part.y)
    solid = part.phase != LUMEN
    axes[2].plot(x[~solid], y[~solid], ".", markersize=1.5, color="#7fa3d1")
    axes[2].plot(x[solid], y[solid], ".", markersize=2.6, color=RED)
    for place, title in zip(axes, ("(a) micrograph", "(b) contours of the lumens", f"(c) points {part.spacing:.0f} µm apart")):
        part.frame(place)
        place.set_title(title, fontsize=10, loc="left")
    scale_bar(axes[0], 20)
    figure.legend(handles=[Line2D([], [], linestyle="", marker=".", markersize=6, color=RED, label="cell wall"),
                           Line2D([], [], linestyle="", marker=".", markersize=5, color="#7fa3d1", label="void")],
                  loc="lower right", bbox_to_anchor=(0.99, -0.01), ncols=2, frameon=False, fontsize=9)
    figure.subplots_adjust(left=0.005, right=0.995, top=0.92, bottom=0.08, wspace=0.03)
    write_figure(figure, path, dpi=150)


def feet_of(part, point):
    """The two nearest places on contours of different lumens: distance, place, tangent; and how far the third is."""
    found = sorted(((np.linalg.norm(foot - point), foot, tangent) for lumen in near_lumens(part, point)
                    for foot, tangent in [nearest(point, part.segments(lumen))]), key=lambda one: one[0])
    return found[:2], found[2][0] if len(found) > 2 else np.inf


def instructive(part, point):
    """How well a point of the wall shows how its direction comes about: by two contours alone, one nearer than the other, at an angle."""
    feet, third = feet_of(part, point)
    if len(feet) < 2:
        return (False, 0)
    (first, _, one), (second, _, other) = feet
    turn = np.degrees(np.arccos(min(1, abs(one @ other))))
    return (third > 1.6 * second and 0.4 < first / second < 0.8 and turn < 30, turn)


def draw_directions(outlines, region, path, size=(26, 21)):
    """Figure 3: the two contours that are nearest to a point, and the direction that they give it and its neighbours.
    @param region  where the point is looked for @param size of the picture about it [µm]"""
    part = Part(outlines, region, 1)
    x, y = np.meshgrid(part.x, part.y)
    solid = part.phase != LUMEN
    places, axes_of = np.stack([x[solid], y[solid]], axis=1), part.axis[solid][:, :2]
    chosen = max(range(len(places)), key=lambda i: instructive(part, places[i]))
    point, axis = places[chosen], axes_of[chosen]
    part = Part(outlines, window_about(outlines, size, point), 1)

    figure, axes = plt.subplots(figsize=(6.2, 5.2))
    axes.set_facecolor("#f6e3e1")
    for chain, closed in zip(part.chains, part.closed):
        if closed:
            axes.fill(*chain.T, color="white", zorder=1)
    part.draw_outlines(axes, "#1f5fae", 1.6)
    x, y = np.meshgrid(part.x, part.y)
    solid = part.phase != LUMEN
    places, along = np.stack([x[solid], y[solid]], axis=1), 0.38 * part.spacing * part.axis[solid][:, :2]
    axes.add_collection(LineCollection(np.stack([places - along, places + along], axis=1), colors="0.35", linewidths=1.1, zorder=3))
    axes.plot(*places.T, ".", markersize=3, color="0.35", zorder=3)
    for label, (_, foot, tangent) in zip("12", feet_of(part, point)[0]):
        axes.plot(*np.array([point, foot]).T, "--", color="black", linewidth=1, zorder=4)
        axes.add_collection(LineCollection([[foot - 2.2 * tangent, foot + 2.2 * tangent]], colors=BLUE, linewidths=3, zorder=5))
        axes.plot(*foot, "o", markersize=5, color=BLUE, zorder=6)
        out = (foot - point) / np.linalg.norm(foot - point)
        axes.text(*(foot + 2.4 * out), f"contour {label}", color="#1f5fae", ha="center", va="center", fontsize=10, zorder=6)
    axes.add_collection(LineCollection([[point - 2.2 * axis, point + 2.2 * axis]], colors=RED, linewidths=3, zorder=7))
    axes.plot(*point, "o", markersize=6, color=RED, zorder=8)
    part.frame(axes, 5)
    figure.legend(handles=[Line2D([], [], marker="o", markersize=5, color=RED, linewidth=3, label="point and its direction"),
                           Line2D([], [], marker="o", markersize=5, color=BLUE, linewidth=3, label="nearest places, tangents"),
                           Line2D([], [], marker=".", color="0.35", linewidth=1.1, label="the other points")],
                  loc="lower right", bbox_to_anchor=(0.995, 0.0), ncols=3, frameon=False, fontsize=8, columnspacing=1, handlelength=1.6)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.99, bottom=0.09)
    write_figure(figure, path, dpi=150)


def near_lumens(part, point, reach=12):
    """Numbers of the lumens with a corner of their outlines within a reach [µm]."""
    return sorted({number for chain, number in zip(part.chains, part.lumens) if np.min(np.sum((chain - point) ** 2, axis=1)) < reach ** 2})


def draw_growth(outlines, window, path, gap=1.0, step=0.8):
    """Figure 4: contours of the lumens, contours that have grown from them, phases of the points. @param gap, step [µm]"""
    part = Part(outlines, window, 0.1, lamella_thickness=gap / UM)
    coarse = Part(outlines, window, 0.5, lamella_thickness=gap / UM)
    figure, axes = plt.subplots(1, 3, figsize=(10.8, 3.9))
    for place in axes[:2]:
        place.set_facecolor(RED)
        for chain in part.chains:
            place.fill(*chain.T, color=BLUE, linewidth=0)
    part.draw_outlines(axes[0], "black", 1.1)

    # What a lumen's contour encloses after it has come a distance: what is as near to the lumen, within what the lumen has at the end.
    # The end is where lamella begins; a contour has stopped where its line meets it.
    x, y = np.meshgrid(part.x, part.y)
    axes[1].contourf(part.x, part.y, part.phase == LAMELLA, levels=[0.5, 1.5], colors=YELLOW)
    for lumen in np.unique(part.grain[part.phase == WALL]):
        own = (part.grain == lumen) & (part.phase == WALL)
        away = np.full(own.shape, np.nan)
        away[own] = distances(np.stack([x[own], y[own]], axis=1), part.segments(lumen))
        axes[1].contour(part.x, part.y, away, levels=np.arange(step, np.nanmax(away), step), colors="white", linewidths=0.6)
    axes[1].contour(part.x, part.y, part.phase == LAMELLA, levels=[0.5], colors="black", linewidths=0.9)
    part.draw_outlines(axes[1], "black", 1.1)

    x, y = np.meshgrid(coarse.x, coarse.y)
    for phase, colour in ((LUMEN, BLUE), (WALL, RED), (LAMELLA, YELLOW)):
        axes[2].plot(x[coarse.phase == phase], y[coarse.phase == phase], ".", markersize=3.4, markeredgewidth=0, color=colour)
    titles = ("(a) contours of the lumens", f"(b) contours that grow, each {step:g} µm", f"(c) points {coarse.spacing:.1f} µm apart")
    for place, title in zip(axes, titles):
        part.frame(place)
        place.set_title(title, fontsize=10, loc="left")
    scale_bar(axes[0], 10)
    colours = (("lumen", BLUE), ("secondary wall", RED), ("middle lamella", YELLOW))
    figure.legend(handles=[Patch(color=colour, label=name) for name, colour in colours],
                  loc="lower right", bbox_to_anchor=(0.995, -0.01), ncols=3, frameon=False, fontsize=9)
    figure.subplots_adjust(left=0.005, right=0.995, top=0.93, bottom=0.075, wspace=0.03)
    write_figure(figure, path, dpi=150)


def draw_points(tissues, path, edge=30):
    """Figure 5: all points of the walls of three tissues, and a square of each [µm] enlarged.
    @param tissues  name, lattice, solid fraction, whether the lamella is told apart (not in the paper's poplar)"""
    wide = [lattice.shape[1] / lattice.shape[0] for _, lattice, *_ in tissues]
    figure, axes = plt.subplots(2, len(tissues), figsize=(3.05 * sum(wide), 6.6), width_ratios=wide, height_ratios=(3, 2.6))
    for (above, below), (name, lattice, solid, apart), letter in zip(axes.T, tissues, "abc"):
        phase = np.where(lattice.phase == LAMELLA, LAMELLA if apart else WALL, lattice.phase)
        spacing = lattice.spacing * UM
        high, across = phase.shape
        colours = ListedColormap(["white", RED, YELLOW])
        above.imshow(phase, cmap=colours, vmin=0, vmax=2, extent=(0, across * spacing, 0, high * spacing), interpolation="antialiased",
                     interpolation_stage="rgba")
        count = f"{np.count_nonzero(phase):,}".replace(",", "\u202f")
        above.set_title(f"({letter}) {name}: {count} points, $\\varepsilon_s$ = {100 * solid:.0f} %", fontsize=10, loc="left")
        # enlarged, a dot a point: the square whose share of wall is nearest to that of all
        n = min(round(edge / spacing), high, across)
        row, column = min(((i, j) for i in range(0, high - n + 1, max(n // 3, 1)) for j in range(0, across - n + 1, max(n // 3, 1))),
                          key=lambda at: abs(np.mean(phase[at[0]:at[0] + n, at[1]:at[1] + n] > 0) - np.mean(phase > 0)))
        square = phase[row:row + n, column:column + n]
        rows, columns = np.nonzero(square)
        x, y = (column + columns + 0.5) * spacing, (high - row - rows - 0.5) * spacing
        size = 3.4 * 0.5 * 60 / n
        for kind, colour in ((WALL, RED), (LAMELLA, YELLOW)):
            these = square[rows, columns] == kind
            below.plot(x[these], y[these], "o", markersize=size, markeredgewidth=0, color=colour)
        left, low, side = column * spacing, (high - row - n) * spacing, n * spacing
        above.add_patch(plt.Rectangle((left, low), side, side, fill=False, edgecolor="black", linewidth=1.2))
        below.set_xlim(left, left + side)
        below.set_ylim(low, low + side)
        below.set_aspect("equal")
        for place, bar in ((above, 50), (below, 10)):
            place.set_xticks([])
            place.set_yticks([])
            scale_bar(place, bar)
    figure.legend(handles=[Patch(color=RED, label="secondary wall; in poplar the wall"), Patch(color=YELLOW, label="middle lamella")],
                  loc="lower right", ncols=2, frameon=False, fontsize=9)
    figure.subplots_adjust(left=0.005, right=0.995, top=0.96, bottom=0.06, wspace=0.03, hspace=0.14)
    write_figure(figure, path, dpi=120)


def draw(there, pixel, solids):
    """All four. @param there gives the path of a file in the study's folder @param pixel of the earlywood's micrograph [µm]
    @param solids  solid fractions by tissue"""
    outlines = lamella.read_polygons(there("earlywood-outlines.json.gz"))
    draw_grid(there("earlywood-scan.png"), pixel, outlines, window_about(outlines, (110, 88)), there("grid.png"))
    draw_directions(outlines, window_about(outlines, (50, 40)), there("directions.png"))
    draw_growth(outlines, window_about(outlines, (50, 54)), there("growth.png"))
    draw_points([(name, lamella.read_picture(there(name + ".vti")), solid, name != "poplar") for name, solid in solids.items()],
                there("points.png"))
