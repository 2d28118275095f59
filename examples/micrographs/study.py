"""From micrographs to lattices: outlines, wall directions, cells, middle lamella and diffusion of three tissues.

    PYTHONPATH=build/python /usr/bin/python3 examples/micrographs/study.py

Generates a micrograph each of earlywood, latewood and poplar (stain, blur, noise, uneven light, dirt), finds their lumens
again with nothing tuned by hand, and compares with the labels they were drawn from, as section 2 of the first paper (figures
2 to 5). With LAMELLA_REAL_DATA set and --scale 1 also a real conifer scan and two sets of spruce polygons. Writes to --output:
  scan.png          a part of the earlywood's micrograph with outlines, directions and lamella
  tissues.png       the three tissues side by side
  grid.png, directions.png, growth.png, points.png  after the paper's figures 2 to 5: figures.py
  <name>.vti        the lattice: phase, grain, axis, lumen_share; <name>.json: all numbers; <name>-look.png: the whole picture
  tissues.csv       a row a tissue
"""

import argparse
import json
import os
import subprocess
import sys

from matplotlib import image as mpimg
from matplotlib import pyplot as plt

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, ".."))
from common import write_csv, write_figure  # noqa: E402

sys.path.append(HERE)
import figures  # noqa: E402

PROGRAM = os.environ.get("LAMELLA_PROGRAM", os.path.join(HERE, "..", "..", "build", "bin", "lamella"))
CONDUCT = ["--conductivity", "lumen=0.05", "--conductivity", "wall=1"]

# name, words of lamella generate, pixels (nodes of which walls: 216 000, 109 000 and 174 000), pixel, stain
TISSUES = [
    ("earlywood", ["softwood", "--solid-fraction", "0.40", "--ring-position", "0,0"], (900, 600), 0.5, "magenta"),
    ("latewood", ["softwood", "--solid-fraction", "0.78", "--ring-position", "1,1"], (432, 324), 0.5, "magenta"),
    ("poplar", ["hardwood", "--solid-fraction", "0.38", "--ring-position", "0,0"], (783, 585), 0.75, "blue"),
]


def lamella(*words):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout


def micrograph(file, folder, name, *words):
    """Everything of one picture: files, and the numbers."""
    at = lambda end: os.path.join(folder, name + end)  # noqa: E731
    text = lamella("micrograph", file, *words, "-o", at(".vti"), "--contours", at("-outlines.json.gz"), "--overlay",
                   at("-look.png"), *CONDUCT, "--overwrite", "--json")
    with open(at(".json"), "w", encoding="utf-8") as out:
        out.write(text)
    return json.loads(text)


def row_of(name, answer, truth=None):
    axes = answer["diffusion"]["axes"]
    row = {
        "tissue": name,
        "lumens": answer["lumens"]["count"],
        "vessels": answer["vessels"]["count"] if answer["vessels"] else 0,
        "wall_fraction": answer["wall_fraction"],
        "true_wall_fraction": truth["wall_fraction"] if truth else "",
        "wall_um": 1e6 * answer["wall_thickness"]["median"],
        "true_wall_um": 1e6 * truth["wall_thickness"]["median"] if truth else "",
        "wall_nodes": answer["lattice"]["wall_nodes"],
        "nodes_across_lamella": answer["lamella"]["nodes_across"]["mean"],
        "seconds_to_lattice": answer["lattice"]["seconds"],
    }
    for axis in "xy":
        row["k_" + axis] = axes[axis]["value"]
        row["k_%s_error" % axis] = axes[axis]["error"]
        row["true_k_" + axis] = truth["diffusion"]["axes"][axis]["value"] if truth else ""
    row["seconds_diffusion"] = sum(axes[axis]["seconds"] for axis in "xy")
    return row


def tell(row):
    print("%-16s %5d lumens %3d vessels  wall %.4f%s  %5.2f µm%s  %7d wall nodes  k_x %.5f ± %.5f%s  k_y %.5f ± %.5f%s  "
          "%.2f s + %.2f s" % (
              row["tissue"], row["lumens"], row["vessels"], row["wall_fraction"],
              " (%.4f)" % row["true_wall_fraction"] if row["true_wall_fraction"] else "", row["wall_um"],
              " (%.2f)" % row["true_wall_um"] if row["true_wall_um"] else "", row["wall_nodes"], row["k_x"],
              row["k_x_error"], " (%.5f)" % row["true_k_x"] if row["true_k_x"] else "", row["k_y"], row["k_y_error"],
              " (%.5f)" % row["true_k_y"] if row["true_k_y"] else "", row["seconds_to_lattice"],
              row["seconds_diffusion"]), flush=True)


def side_by_side(pictures, path):
    """Pictures of one height in a row, a letter and a name over each."""
    read = [mpimg.imread(file) for _, file in pictures]
    wide = [image.shape[1] / image.shape[0] for image in read]
    figure, axes = plt.subplots(1, len(read), figsize=(4.2 * sum(wide), 4.5), width_ratios=wide)
    for axis, image, (name, _), letter in zip(axes, read, pictures, "abcdef"):
        axis.imshow(image, interpolation="antialiased")
        axis.set_title(f"({letter}) {name}", fontsize=12)
        axis.axis("off")
    figure.subplots_adjust(wspace=0.03)
    write_figure(figure, path, dpi=150, bbox_inches="tight", pad_inches=0.05)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scale", type=float, default=1, help="of the pictures' edges; smaller is quicker [1]")
    parser.add_argument("--output", default="results/micrographs", help="folder [results/micrographs]")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    there = lambda name: os.path.join(options.output, name)  # noqa: E731

    rows, shown = [], []
    for name, words, size, pixel, stain in TISSUES:
        size = [round(options.scale * n) for n in size]
        box = ["--size", "%d,%d" % tuple(size), "--pixel-size", "%gum" % pixel]
        scan, labels = there(name + "-scan.png"), there(name + "-labels.png")
        lamella("generate", *words, *box, "--look", stain, "--truth", labels, "-o", scan, "--overwrite")
        answer = micrograph(scan, options.output, name)
        truth = json.loads(lamella("micrograph", labels, *CONDUCT, "--json"))
        rows.append(row_of(name, answer, truth))
        tell(rows[-1])
        # A part of each, 150 µm or so across, so that single strokes can be seen.
        part = [round(min(n, edge / pixel)) for n, edge in zip(size, (200, 150))]
        window = ["--window", "%d,%d,%d,%d" % (*[(n - p) // 2 for n, p in zip(size, part)], *part)]
        lamella("micrograph", scan, *window, "--overlay", there(name + "-part.png"), "--overlay-width", 1200, "--overwrite")
        shown.append((name, there(name + "-part.png")))
    os.replace(there("earlywood-part.png"), there("scan.png"))
    shown[0] = ("earlywood", there("scan.png"))
    side_by_side(shown, there("tissues.png"))
    figures.draw(there, TISSUES[0][3], {row["tissue"]: row["wall_fraction"] for row in rows})

    real = os.environ.get("LAMELLA_REAL_DATA")
    if real and options.scale == 1:
        for name, file, words in [
            ("conifer", "conifer_roxas_scan.jpg", ["--pixel-size", "0.441um"]),
            ("spruce-earlywood", "spruce_EW_polygons.json.gz", ["--spacing", "0.5um"]),
            ("spruce-latewood", "spruce_LW_polygons.json.gz", ["--spacing", "0.25um"]),
        ]:
            rows.append(row_of(name, micrograph(os.path.join(real, file), options.output, name, *words)))
            tell(rows[-1])
    write_csv(there("tissues.csv"), rows)
    for row in rows[: len(TISSUES)]:
        assert abs(row["wall_fraction"] - row["true_wall_fraction"]) < 0.03, "the walls' share is far from the truth"
    print(f"files in {options.output}")


if __name__ == "__main__":
    main()
