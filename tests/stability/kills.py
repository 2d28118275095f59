"""Long commands that are killed again and again, and go on from their checkpoints: the same results as if nobody had killed them.

    ./dev bench kills [times=10] [seed=1] [size=large|small] [only=NAME,NAME] [ranks=1,2] [table=FILE.csv]

Every command that keeps checkpoints runs once undisturbed and without any, on one rank and on two. Then it is killed by SIGKILL `times` times
and started anew each time with the same words, which go on from the file that is there. Kills come by turns at a random moment behind a random
number of checkpoints, set-up included, and while a checkpoint is being written. Of two ranks one is killed, or both and their launcher at once.
After every kill the file must be whole by its own checksum, or not there yet. A run that gets to its end is compared with the undisturbed one
and begun anew. Broken bonds in their order, curve and fields are compared as they are stored, which is to the last bit; so are the numbers of
--json, but for times. A compression on several ranks may differ by round-off: every column of its curve and every component of its fields by
1e-9 of the largest value. The exit code is 1 where a file is not whole, something is left behind or a result differs.
"""

import csv
import hashlib
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cli"))
from program import MPIEXEC, PROGRAM  # noqa: E402
from tables import write_table  # noqa: E402

LONGEST = 300  # s of one run, on a machine that does much else
# Points that go on on several ranks are in another order there, in which sums round otherwise; what tests/cli/test_compression.py allows
# between one rank and two, of which the order differs alike.
ROUND_OFF = 1e-9

WALL = ["--young", "wall=1e10", "--critical-stretch", "wall=0.01"]
TWO = ["--young", "matrix=1e10", "--young", "inclusion=1e9", "--like", "inclusion-matrix=inclusion", "--critical-stretch", "matrix=0.01",
       "--critical-stretch", "inclusion=0.01", "--density", "1000"]
YIELDING = ["--law", "plastic", "--plane", "plane-strain", "--yield", "5e7", "--plastic-strain"]
TISSUE = ["generate", "softwood", "--solid-fraction", "0.5", "--seed", "1", "--size"]
STONES = ["generate", "spheres", "--solid-fraction", "0.4", "--size"]
SAMPLES = {
    "large": {"tissue.png": [*TISSUE, "60,60"], "stones.vti": [*STONES, "32,32,32"], "grains.vtp": ["packing", "--count", "60", "--seed", "1", "--quiet"],
              "cemented.vti": ["bridges", "grains.vtp", "--saturation", "34%", "--nodes", "160", "--quiet"]},
    "small": {"tissue.png": [*TISSUE, "40,40"], "stones.vti": [*STONES, "16,16,16"]},
}
GRAINS = ["--young", "matrix=1e9", "--young", "grain=4e9", "--toughness", "matrix=1e5", "--toughness", "grain=4e5", "--like", "matrix-grain=matrix",
          "--like", "grain-grain=matrix"]
HEAT = ["--diffusivity", "wall=1.8e-7", "--diffusivity", "lumen=2.2e-5"]
# name: ranks, what it runs at either size, between checkpoints, ending of its fields, whether it lists broken bonds
COMMANDS = {
    "fracture": ((1, 2), {"large": ["cemented.vti", *GRAINS], "small": ["tissue.png", *WALL]}, "15", "vti", True),
    "fracture-accurate": ((1, 2), {"large": ["tissue.png", *WALL, "--method", "accurate"],
                                   "small": ["tissue.png", *WALL, "--method", "accurate", "--max-broken", "40"]}, "4", "vti", True),
    "compression": ((1, 2), {"large": ["tissue.png", "--fit-platens", "--strain", "0.1"],
                             "small": ["tissue.png", "--fit-platens", "--strain", "0.03", "--first-speed", "1e-2"]}, "100", "vtp", False),
    "compression-yielding": ((1, 2), {"large": ["tissue.png", "--fit-platens", "--strain", "0.03", *YIELDING],
                                      "small": ["tissue.png", "--fit-platens", "--strain", "0.02", "--first-speed", "1e-2", *YIELDING]},
                             "100", "vtp", False),
    "dynamics": ((1, 2), {"large": ["stones.vti", *TWO], "small": ["stones.vti", *TWO]}, "20", "vti", True),
    "transient": ((1, 2), {"large": ["tissue.png", *HEAT, "--at-time", "2e-4"], "small": ["tissue.png", *HEAT, "--at-time", "1e-5"]}, "100", "vti", False),
}
# of what a run prints, what depends on how often it was begun
OTHERWISE = re.compile(r".*_seconds$|seconds$|statistics$|provenance$|continued_at$|states_before$|.*checkpoints?$|updates_per_second$|threads$|"
                       r"warnings?$|written$|(peak_memory_)?bytes$|curve$")  # the curve is compared as a table


def whole(path):
    """Whether a checkpoint is complete, by the length and the SHA-256 that its first 512 bytes tell."""
    data = path.read_bytes()
    told = re.match(rb"Lamella checkpoint\n.*\nbytes (\d+)\nsha256 (\w+)\n", data, re.DOTALL)
    return told is not None and len(data) == 512 + int(told[1]) and hashlib.sha256(data[512:]).hexdigest() == told[2].decode()


def state(pid):
    """The letter of /proc that says what a process does; Z where it has ended."""
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace").rsplit(")", 1)[1].split()[0]
    except OSError:
        return "Z"


def children(pid):
    try:
        return [int(word) for task in pathlib.Path(f"/proc/{pid}/task").iterdir() for word in (task / "children").read_text().split()]
    except OSError:
        return []


def values(found, prefix=""):
    """All numbers and words of a JSON object by their path, but for what may differ."""
    if isinstance(found, dict):
        return {path: value for key, inner in found.items() if not OTHERWISE.match(key) for path, value in values(inner, f"{prefix}/{key}").items()}
    if isinstance(found, list):
        return {path: value for k, inner in enumerate(found) for path, value in values(inner, f"{prefix}/{k}").items()}
    return {prefix: found}


def table(path):
    """The columns of a table of numbers."""
    with open(path, encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    return {name: [float(row[k]) for row in rows] for k, name in enumerate(names)}


def apart(found, expected):
    """The largest difference of two tables, each over the largest value of its column; infinite where they have not the same shape."""
    largest = 0.0
    for name in found.keys() | expected.keys():
        a, b = found.get(name, []), expected.get(name, [])
        if len(a) != len(b):
            return math.inf
        # differences of forces, round-off themselves where these balance: over the stress
        scale = max(map(abs, expected["stress"] if name in ("lateral_stress", "imbalance") else b), default=0)
        largest = max([largest, *(abs(x - y) / scale for x, y in zip(a, b) if x != y)])
    return largest


class Scene:
    """One command on so many ranks, with what it gave when nobody killed it."""

    def __init__(self, program, folder, name, ranks, size):
        _, words, every, ending, breaks = COMMANDS[name]
        self.folder, self.ranks, self.program, self.ending = folder, ranks, program, ending
        self.exact, self.apart = not name.startswith("compression") or ranks == 1, 0.0
        self.kept = folder / "kept"
        self.file = self.kept / "run.h5"
        outputs = ["-o", f"out.{ending}", "--curve", "curve.csv", *(["--broken", "broken.vtp"] if breaks else [])]
        launcher = [*MPIEXEC, str(ranks)] if ranks > 1 else []
        self.command = [*launcher, program, name.split("-")[0], *words[size], "--checkpoint-every", every, *outputs, "--overwrite", "--json"]
        self.tables = [word for word in outputs if word in ("curve.csv", "broken.vtp")]
        # ranks that wait for each other let others work meanwhile
        self.environment = {**os.environ, "OMP_NUM_THREADS": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}
        start = time.monotonic()
        self.expected = self.results(self.ended(self.begin(False)))
        self.seconds = time.monotonic() - start
        self.again()
        # how many checkpoints there are, by a run that writes them: it must give the same
        done = self.ended(self.begin(True))
        self.count = json.loads(done)["checkpoints"]
        self.faults = self.differences(self.results(done), "not killed, with checkpoints")
        self.again()

    def begin(self, checkpoints):
        self.kept.mkdir(exist_ok=True)
        words = ["--checkpoint", "kept/run.h5", "--continue", "kept/run.h5"] if checkpoints else []
        with open(self.folder / "out", "wb") as out, open(self.folder / "err", "wb") as err:
            return subprocess.Popen([*self.command, *words], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, env=self.environment)

    def ended(self, process):
        code = process.wait(timeout=LONGEST)
        if code != 0:
            sys.exit(f"{' '.join(process.args)}: exit code {code}\n" + (self.folder / "err").read_text(errors="replace"))
        return (self.folder / "out").read_text()

    def fields(self):
        return sorted(path.name for path in self.folder.glob(f"out*.{self.ending}"))

    def again(self):
        """Takes away all that a run has left."""
        shutil.rmtree(self.kept)
        for name in [*self.fields(), *self.tables]:
            (self.folder / name).unlink()

    def results(self, out):
        """Arrays of points, cells and fields as they are stored, the text of tables, and what was printed."""
        found = values(json.loads(out))
        if not self.exact:
            subprocess.run([self.program, "convert", *self.fields(), "-o", "fields.csv", "--overwrite"], cwd=self.folder, check=True, stdout=subprocess.DEVNULL)
            whole_numbers = {key: value for key, value in found.items() if isinstance(value, int)}
            return whole_numbers | {name: table(self.folder / name) for name in ("fields.csv", "curve.csv")}
        for name in [*self.fields(), *self.tables]:
            text = (self.folder / name).read_text(encoding="utf-8", errors="replace")
            if name.endswith(".csv"):
                found[name] = text
            else:
                piece = re.search("<Piece.*</Piece>", text, re.DOTALL).group()
                found.update({f"{name} {array}": content for array, content in re.findall(r'<DataArray[^>]* Name="(\w*)"[^>]*>([^<]*)', piece)})
        return found

    def differences(self, found, when):
        faults = []
        for key in sorted(found.keys() | self.expected.keys()):
            a, b = found.get(key), self.expected.get(key)
            if isinstance(a, dict) and isinstance(b, dict):
                far = apart(a, b)
                self.apart = max(self.apart, far)
                if not far <= ROUND_OFF:
                    faults.append(f"{when}: {key} differs by {far:.2g}")
            elif a != b:
                faults.append(f"{when}: {key} differs")
        return faults


def processes(process, ranks):
    """The ranks of a run: itself, or what its launcher has started."""
    return children(process.pid) if ranks > 1 else [process.pid]


def parts(folder):
    """Files that are being written, or that somebody who was killed has left."""
    return {name for name in os.listdir(folder) if name.startswith(".lamella-")}


def kill(scene, process, draw, writing, left):
    """Waits for a moment and kills. `left`: by others before. @return whether it came in time"""
    share = scene.seconds / max(1, scene.count)
    behind = draw.randrange(max(1, min(scene.count, 12)))
    pause = draw.uniform(0, 2 * share) if not writing else draw.uniform(0, 0.002) if draw.random() < 0.5 else 0
    if behind == 0 and not writing:
        pause += draw.uniform(0, 0.3)  # set-up, too
    seen, last = 0, None
    limit = time.monotonic() + LONGEST
    while process.poll() is None and time.monotonic() < limit:
        if seen >= behind and (not writing or parts(scene.kept) - left):
            break
        try:
            now = os.stat(scene.file).st_mtime_ns
            seen += last is not None and now != last
            last = now
        except OSError:
            last = 0
        time.sleep(0.0001)
    if pause:
        time.sleep(pause)
    ranks = processes(process, scene.ranks)
    if process.poll() is not None or not ranks:
        process.wait()
        return False
    victims = [process.pid, *ranks] if scene.ranks > 1 and draw.random() < 0.5 else [draw.choice(ranks)]
    for pid in victims:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.wait(timeout=LONGEST)
    while any(state(pid) != "Z" for pid in ranks):  # a launcher ends the other ranks
        time.sleep(0.001)
    return process.returncode != 0


def row(scene, name, times, draw):
    kills = cut = early = runs = 0
    faults = list(scene.faults)
    while kills < times:
        process = scene.begin(True)
        left = parts(scene.kept)
        if kill(scene, process, draw, kills % 2 == 1, left):
            kills += 1
            cut += bool(parts(scene.kept) - left)
            early += not scene.file.exists()
            if scene.file.exists() and not whole(scene.file):
                faults.append(f"kill {kills}: the checkpoint is not whole")
            if kills < times:
                continue
            process = scene.begin(True)
        # killed often enough, or it was at its end before
        faults += scene.differences(scene.results(scene.ended(process)), f"after {kills} kills")
        runs += 1
        if parts(scene.kept) | parts(scene.folder):
            faults.append(f"after {kills} kills: a file half written is left")
        scene.again()
    for fault in faults:
        print(f"{name}, {scene.ranks} ranks: {fault}", file=sys.stderr)
    return {"command": name, "ranks": scene.ranks, "run [s]": f"{scene.seconds:.1f}", "checkpoints": scene.count, "kills": kills,
            "while writing": cut, "before the first": early, "runs": runs,
            "differs by": f"{scene.apart:.1e}" if scene.apart else "no bit", "faults": len(faults)}


def main():
    keys = dict(word.split("=", 1) for word in sys.argv[1:] if "=" in word)
    program = os.path.abspath(keys.get("lamella", PROGRAM))
    times, size = int(keys.get("times", "10")), keys.get("size", "large")
    only = keys["only"].split(",") if "only" in keys else list(COMMANDS)
    ranks = [int(word) for word in keys.get("ranks", "1,2").split(",")]
    folder = pathlib.Path(tempfile.mkdtemp(prefix="lamella-kills-"))
    rows = []
    try:
        for sample, words in SAMPLES[size].items():
            subprocess.run([program, *words, "-o", sample], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        for name in only:
            for count in [count for count in COMMANDS[name][0] if count in ranks]:
                draw = random.Random(f"{keys.get('seed', '1')} {name} {count}")
                rows.append(row(Scene(program, folder, name, count, size), name, times, draw))
                print(" | ".join(f"{key} {value}" for key, value in rows[-1].items()), flush=True)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    write_table(keys, rows)
    faults = sum(line["faults"] for line in rows)
    print(f"{sum(line['kills'] for line in rows)} kills, {sum(line['while writing'] for line in rows)} of them while a checkpoint was written; faults: {faults}")
    return 0 if rows and faults == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
