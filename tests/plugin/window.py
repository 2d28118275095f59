"""The plugin in the ParaView window itself, under Xvfb: a fracture that runs live, a number changed in its panel, Apply pressed
again; what ran again, and a picture of the whole window. Then the menu of filters, with a group open.

window.py XVFB_RUN PARAVIEW SOURCES [PICTURE.png MENU.png]
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np
from matplotlib import image

xvfb, paraview, sources = sys.argv[1:4]
if not os.access(xvfb, os.X_OK) or not os.access(paraview, os.X_OK):
    print("xvfb-run or paraview is not installed")
    sys.exit(77)

WIDTH, HEIGHT = 1500, 1100
# Runs in the window, after the example; the panel then changes what the events say.
SCRIPT = """
import json, traceback
log = open({log!r}, "a", buffering=1)
try:
    exec(compile(open({example!r}, encoding="utf-8").read(), {example!r}, "exec"))
    objects = {{"packing": grains, "bridges": cemented, "fracture": torn}}
    def record(name, proxy):
        def ended(caller, event):
            data = caller.GetOutputDataObject(0).GetFieldData()
            number = lambda key: data.GetArray(key).GetTuple1(0) if data.GetArray(key) else None
            times = data.GetArray("seconds")
            run = [times.GetTuple1(i) for i in range(times.GetNumberOfTuples())] if times else None
            log.write(json.dumps([name, number("total_broken"), number("broken_bonds"), run,
                                  caller.GetOutputDataObject(0).GetPointData().HasArray("strain_energy")]) + "\\n")
        proxy.GetClientSideObject().AddObserver("EndEvent", ended)
    for name, proxy in objects.items():
        record(name, proxy)
    log.write(json.dumps(["ready", lamella.vtkOffScreenWindows.IsInstalled()]) + "\\n")
except BaseException:
    log.write(json.dumps(["failed", traceback.format_exc()]) + "\\n")
"""
PANEL = "pqClientMainWindow/propertiesDock/propertiesPanel"
FIELD = PANEL + "/scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/PropertiesFrame/ProxyPanel"
MENU = "pqClientMainWindow/menubar"
EVENTS = f"""<?xml version="1.0" ?>
<pqevents>
  <pqevent object="{FIELD}/ComputeStrainEnergy/CheckBox" command="set_boolean" arguments="true" />
  <pqevent object="{PANEL}/Accept" command="activate" arguments="" />
  <pqevent object="{FIELD}/StopShare/DoubleRangeWidget/DoubleLineEdit" command="set_string" arguments="0.5" />
  <pqevent object="{PANEL}/Accept" command="activate" arguments="" />
  <pqevent object="pqClientMainWindow" command="pause" arguments="8000" />
  <pqevent object="{MENU}" command="activate" arguments="menuFilters" />
  <pqevent object="{MENU}/menuFilters" command="activate" arguments="Lamella: Elasticity and Fracture (Peridynamics)" />
</pqevents>
"""


def screen(path):
    """What Xvfb shows, in X's dump format: rows by columns by red, green, blue."""
    with open(path, "rb") as file:
        raw = file.read()
    header = np.frombuffer(raw[:100], ">u4")
    size, width, height, order, row, colours = header[[0, 4, 5, 7, 12, 19]]
    begin = int(size) + 12 * int(colours)
    pixels = np.frombuffer(raw[begin : begin + int(row) * int(height)], np.uint8).reshape(int(height), -1, 4)[:, : int(width)]
    return np.ascontiguousarray(pixels[..., 2::-1] if order == 0 else pixels[..., 1:])


def nodes(picture):
    """Pixels in the blue of the nodes in the icon of the group that is opened: its five entries have more than 50 each."""
    return (np.abs(picture.astype(int) - (31, 78, 121)).max(axis=2) < 20).sum()


def entries(path):
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        return [json.loads(line) for line in file if line.endswith("\n")]


def wait(what, ready, process, seconds):
    end = time.monotonic() + seconds
    while not ready():
        if process.poll() is not None:
            sys.exit(f"paraview ended before {what}")
        if time.monotonic() > end:
            sys.exit(f"no {what} within {seconds} s")
        time.sleep(0.2)


def runs(log, name):
    """The runs of one of the three, without those that only show what there is: a run has times of its own."""
    found = []
    for entry in entries(log):
        if entry[0] == name and (entry[3] is None or entry[3] not in [run[3] for run in found]):
            found.append(entry)
    return found


with tempfile.TemporaryDirectory() as folder:
    def inside(name, text=None):
        path = os.path.join(folder, name)
        if text is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        return path

    log = inside("log.txt")
    settings = os.path.join(folder, "home", ".config", "ParaView")
    os.makedirs(settings)
    os.chmod(os.path.join(folder, "home"), 0o700)
    pvpython = os.path.join(os.path.dirname(paraview), "pvpython")
    version = re.search(r"\d[\d.]+", subprocess.run([pvpython, "--version"], capture_output=True, text=True).stdout)[0]
    with open(os.path.join(settings, f"ParaView{version}.ini"), "w", encoding="ascii") as file:
        file.write("[General]\nGeneralSettings.ShowWelcomeDialog=false\n")
    os.mkdir(inside("screen"))
    example = os.path.join(sources, "examples", "paraview", "live_fracture.py")
    # The name of the sheet of styles is Qt's own option: it makes the panel wide enough to be read.
    command = [
        xvfb, "-a", "-s", f"-screen 0 {WIDTH}x{HEIGHT}x24 -fbdir {inside('screen')}", paraview,
        "--script=" + inside("script.py", SCRIPT.format(log=log, example=example)),
        "--test-script=" + inside("events.xml", EVENTS), "-qwindowgeometry", f"{WIDTH}x{HEIGHT}+0+0",
        "-stylesheet", inside("panel.qss", "pqPropertiesPanel { min-width: 480px; }"),
    ]
    environment = {**os.environ, "LAMELLA_SCALE": "0.3", "HOME": inside("home"), "XDG_RUNTIME_DIR": inside("home")}
    with open(inside("output.txt"), "w", encoding="utf-8") as output:
        process = subprocess.Popen(command, env=environment, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            wait("sample", lambda: entries(log), process, 300)
            assert entries(log)[0][0] == "ready", entries(log)[0]
            assert entries(log)[0][1] is False, "where a display works, the windows stay ParaView's own"
            wait("second Apply", lambda: len(runs(log, "fracture")) == 2, process, 240)
            time.sleep(3)  # for the window to draw it
            picture = screen(inside("screen/Xvfb_screen0"))
            wait("menu with icons", lambda: nodes(screen(inside("screen/Xvfb_screen0"))) > nodes(picture) + 150, process, 60)
            menu = screen(inside("screen/Xvfb_screen0"))
        except SystemExit:
            print(entries(log))
            if len(sys.argv) > 4 and os.path.exists(inside("screen/Xvfb_screen0")):
                image.imsave(sys.argv[5], screen(inside("screen/Xvfb_screen0")))
            with open(inside("output.txt"), encoding="utf-8") as said:
                print(said.read()[-3000:])
            raise
        finally:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait(30)
    with open(inside("output.txt"), encoding="utf-8") as output:
        messages = output.read()
    assert "Couldn't find" not in messages and "Failed to locate" not in messages, messages[:2000]
    for entry in entries(log):
        print(entry)
    shown, again = runs(log, "fracture")
    # The first Apply, of a field, ran nothing: it only showed what the run before had; the second ran the fracture alone.
    assert shown[4] == 1, "the first Apply shows the strain energy"
    assert again[1] < shown[1], (shown, again)
    assert not runs(log, "packing") and not runs(log, "bridges"), entries(log)
    # The picture: most of it is the window, with colours of the sample, of the curve and of the panel.
    grey = (np.ptp(picture.astype(int), axis=2) < 12).mean()
    colours = len(np.unique(picture.reshape(-1, 3), axis=0))
    print(f"{grey:.2f} of the window is grey, {colours} colours")
    assert picture.shape == (HEIGHT, WIDTH, 3) and (picture.max(axis=2) > 0).mean() > 0.9, "the window does not fill the screen"
    assert grey < 0.97 and colours > 300, "the views are empty"
    if len(sys.argv) > 4:
        image.imsave(sys.argv[4], picture)
        image.imsave(sys.argv[5], menu)
