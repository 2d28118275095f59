"""The plugin in the ParaView window itself, under Xvfb: it loads, its pipeline runs and draws.

window.py XVFB_RUN PARAVIEW
"""

import os
import subprocess
import sys
import tempfile

xvfb, paraview = sys.argv[1:3]
if not os.access(xvfb, os.X_OK) or not os.access(paraview, os.X_OK):
    print("xvfb-run or paraview is not installed")
    sys.exit(77)

SCRIPT = """
import os
try:
    import lamella
    import paraview.simple as pv
    lamella.load_plugin()
    tissue = pv.MicrostructureSource(Size=[80, 60, 1])
    flux = pv.FluxMap(Input=pv.SteadyDiffusion(Input=tissue))
    view = pv.GetActiveViewOrCreate("RenderView")
    pv.Show(flux, view)
    pv.ResetCamera(view)
    pv.SaveScreenshot({picture!r}, view)
    answer = "lines %d, installed %s" % (
        pv.servermanager.Fetch(flux, idx=1).GetNumberOfLines(), lamella.vtkOffScreenWindows.IsInstalled())
except BaseException as error:
    answer = repr(error)
with open({answer!r}, "w") as file:
    file.write(answer)
os._exit(0)
"""

with tempfile.TemporaryDirectory() as folder:
    picture = os.path.join(folder, "picture.png")
    answer = os.path.join(folder, "answer.txt")
    script = os.path.join(folder, "script.py")
    with open(script, "w", encoding="utf-8") as file:
        file.write(SCRIPT.format(picture=picture, answer=answer))
    subprocess.run(
        [xvfb, "-a", "-s", "-screen 0 1280x1024x24", paraview, f"--script={script}"], check=False, timeout=150
    )
    with open(answer, encoding="utf-8") as file:
        text = file.read()
    print(text)
    # Where a display works, the windows stay ParaView's own.
    assert text == "lines 60, installed False", text
    assert os.path.getsize(picture) > 3000, "the view is empty"
