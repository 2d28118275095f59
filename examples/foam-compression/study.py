"""An open-cell foam of a million material points pressed to 30 %: curve, stiffness and a picture of it in four states.

    PYTHONPATH=build/python /usr/bin/python3 examples/foam-compression/study.py

The foam is what a dense packing of spheres leaves once they have grown until neighbours open into each other (foam.py); isotropic elastic
walls, two points along each axis of a cell, pressed along z between platens, sides straight without force. Writes to --output:
  foam.png    the curve, and the foam coloured by the stress along the load
  curve.csv   the curve; foam.csv: one row of numbers
With --checkpoint a run that was stopped goes on where its file stands; states before that are not drawn.
"""

import os
import resource
import sys
import time

import lamella
import numpy as np
from foam import Foam
from matplotlib import pyplot as plt
from picture import Carried, render
from vtkmodules.vtkCommonCore import vtkLogger

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import parser_of, write_csv, write_figure  # noqa: E402

YOUNG, POISSON = 1e9, 0.3  # of the solid [Pa]
CALM = 0.05  # strain from which the ratio of energies is kept
STATES = 3  # after the start


def memory():
    """Most that this process has held [bytes]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def pressed(foam, options):
    """The test, its states and its row of numbers."""
    walls = dict(points_per_node=1, cells_per_node=0.5, young=YOUNG, poisson=POISSON, threads=options.threads)
    row = dict(nodes=" x ".join(map(str, foam.sample.shape[::-1])), solid=foam.solid, loose=foam.loose, growth=foam.growth)
    if not options.no_stiffness:
        begun = time.process_time()
        implicit = lamella.point_stiffness(foam.sample, tolerance=options.tolerance, **walls)
        row.update({f"implicit_{axis}_MPa": implicit.constants[f"E_{axis}"] / 1e6 for axis in "xyz"})
        row.update(iterations=implicit.statistics["iterations"], stiffness_s=round(time.process_time() - begun, 1))
    last = [0.0]

    def progress(share, text):
        if time.monotonic() - last[0] > 60:
            last[0] = time.monotonic()
            print(f"{100 * share:.1f} %  {text}  {time.process_time() - begun:.0f} s of processor time", flush=True)
        return True

    before, begun = memory(), time.process_time()
    strains = options.strain * np.arange(STATES + 1) / STATES
    result = lamella.compression(foam.sample, axis="z", strain=options.strain, energy_ratio=options.energy_ratio, calm_from=CALM,
                                 first_speed=6e-3, rows=options.rows, at_strains=strains,
                                 deformation_gradient=True, stress=True, checkpoint=options.checkpoint,
                                 continue_from=options.checkpoint, progress=progress, **walls)
    spent, numbers = time.process_time() - begun, result.statistics
    curve = lamella.compression_curve(result.strain, result.stress)
    steps = numbers["steps"] - result.continued_at
    calm = result.strain >= min(CALM, 0.5 * options.strain)
    work = result.curve["work"]
    row.update(
        points=numbers["points"], slope_MPa=curve.stiffness / 1e6, slope_over_solid=curve.stiffness / YOUNG,
        end_strain=float(result.strain[-1]), end_MPa=float(result.stress[-1]) / 1e6,
        plateau_MPa=None if curve.plateau_stress is None else curve.plateau_stress / 1e6, densification=curve.densification,
        energy_ratio=result.energy_ratio, imbalance=result.quality["imbalance"], lateral=result.quality["lateral"],
        mean_imbalance=float(np.mean(np.abs(result.curve["imbalance"][calm] / result.stress[calm]))),
        dissipated=float(result.curve["dissipated"][-1] / work[-1]), lateral_strain=float(result.curve["lateral_strain"][-1]),
        steps=numbers["steps"], press_s=round(spent, 1), points_per_s=round(numbers["points"] * steps / spent),
        bytes_per_point=round(numbers["bytes_per_point"]), peak_bytes_per_point=round((memory() - before) / numbers["points"]),
        peak_MB=round(memory() / 1e6))
    return result, row


def draw(foam, result, options):
    """The curve with the states marked on it, beside pictures of them in one scale and one range of colours."""
    states = list({round(state.imposed_strain, 6): state for state in result.states}.values())  # the end was asked for, too
    surface = Carried(foam.surface(), states[0])
    limit = 3 * np.percentile(np.abs(states[-1].array("stress")[:, 2]), 75)
    pictures = [render(surface.at(state), foam.sample.vtk.GetBounds(), limit, options.pixels) for state in states]
    high, wide = pictures[0].shape[:2]
    figure = plt.figure(figsize=(9.2, 2.9 * 2 * high / wide + 0.95))
    axes = figure.add_axes([0.07, 0.15, 0.27, 0.77])
    axes.plot(100 * result.strain, result.stress / 1e6, color="0.1", linewidth=1.2)
    axes.plot([100 * state.imposed_strain for state in states], [state.imposed_stress / 1e6 for state in states], "o", markersize=4,
              color="#b2182b")
    axes.set_xlabel("strain [%]")
    axes.set_ylabel("stress [MPa]")
    axes.set_xlim(-1, 100 * options.strain * 1.03)
    axes.set_ylim(bottom=0)
    for i, (state, picture) in enumerate(zip(states, pictures)):
        shown = figure.add_axes([0.365 + 0.32 * (i % 2), 0.57 - 0.42 * (i // 2), 0.31, 0.37])
        shown.imshow(picture, interpolation="lanczos")
        shown.axis("off")
        shown.set_title(f"{100 * state.imposed_strain:.0f} %", fontsize=9, pad=2)
    scale = figure.add_axes([0.45, 0.125, 0.46, 0.022])
    colours = plt.cm.ScalarMappable(plt.Normalize(-limit / 1e6, limit / 1e6), "RdBu_r")
    figure.colorbar(colours, cax=scale, orientation="horizontal", extend="both")
    scale.tick_params(labelsize=8, pad=1)
    scale.set_xlabel("stress in the solid along the load [MPa], pressed above 0", fontsize=8, labelpad=1)
    write_figure(figure, os.path.join(options.output, "foam.png"), dpi=125, pil_kwargs={"optimize": True})


def study(options):
    """All of it; the row of numbers, which is printed and written too."""
    os.makedirs(options.output, exist_ok=True)
    foam = Foam(options.size, options.pores, options.aspect, options.porosity, options.seed)
    print(f"{foam.sample}, spheres grown by {100 * foam.growth:.1f} %", flush=True)
    result, row = pressed(foam, options)
    result.save_curve(os.path.join(options.output, "curve.csv"), overwrite=True)
    write_csv(os.path.join(options.output, "foam.csv"), [row])
    print("\n".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()))
    for warning in result.warnings:
        print(f"warning: {warning}")
    draw(foam, result, options)
    return result, row


def main():
    parser = parser_of(__doc__, "results/foam-compression")
    parser.add_argument("--size", type=int, default=194, help="nodes along x and y (default: %(default)s)")
    parser.add_argument("--pores", type=int, default=200, help="spheres (default: %(default)s)")
    parser.add_argument("--aspect", type=float, default=0.55, help="height over width (default: %(default)s)")
    parser.add_argument("--porosity", type=float, default=0.75, help="(default: %(default)s)")
    parser.add_argument("--strain", type=float, default=0.3, help="to end at (default: %(default)s)")
    parser.add_argument("--energy-ratio", type=float, default=0.02, help="kinetic over elastic energy allowed (default: %(default)s)")
    parser.add_argument("--rows", type=int, default=75, help="of the curve (default: %(default)s)")
    parser.add_argument("--tolerance", type=float, default=1e-2, help="of the implicit solve (default: %(default)s)")
    parser.add_argument("--no-stiffness", action="store_true", help="no implicit solve")
    parser.add_argument("--pixels", type=int, default=600, help="width of a state's picture (default: %(default)s)")
    parser.add_argument("--checkpoint", help="file that keeps where the run stands, and from which it goes on")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1, help="(default: %(default)s)")
    options = parser.parse_args()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # warnings are printed below the numbers
    study(options)
    print(f"picture and tables: {options.output}")


if __name__ == "__main__":
    main()
