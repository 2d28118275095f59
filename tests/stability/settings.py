"""Random settings: samples with files of them, runs of lamella, and what a judge found out about one setting."""

import json
import os
import pathlib
import re
import resource
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
import pictures  # noqa: E402

LONGEST = 90  # seconds of processor time of one run; the settings are made to take a few
MEMORY = 6 << 30  # bytes of address space

# What only programmers say, or what says nothing.
WORDS = re.compile(r"std::|terminate|Traceback|basic_string|vector::|bad_alloc|exception|Assertion|\bvtk[A-Z]|0x[0-9a-f]{6}", re.I)


class Refused(Exception):
    """The program said no, in one line with a hint."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


class Fault(Exception):
    """Something that must not be: the setting is wrong."""


def _no_constant(name):
    raise Fault(f"the JSON holds {name}")


class Setting:
    """One numbered setting: its random numbers, its folder, its runs."""

    def __init__(self, program, folder, seed, number):
        self.program, self.folder = program, pathlib.Path(folder)
        self.random = np.random.default_rng([seed, number])
        self.warnings = []
        self.faults = []
        self.commands = []
        self.reference = []  # what an answer was held against

    # --- random numbers

    def chance(self, share):
        return self.random.random() < share

    def one_of(self, *values):
        return values[int(self.random.integers(len(values)))]

    def magnitude(self, low, high):
        """10 to a power that is evenly spread."""
        return float(f"{10 ** self.random.uniform(low, high):.6g}")

    def whole(self, low, high):
        """Both ends can come."""
        return int(self.random.integers(low, high + 1))

    # --- runs

    def lamella(self, *words):
        """@returns the JSON object that the command prints"""
        words = [str(word) for word in words] + ["--json"]
        self.commands.append("lamella " + " ".join(words))

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST + 5))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        try:
            done = subprocess.run([self.program, *words], cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True,
                                  timeout=20 * LONGEST, check=False, preexec_fn=limit)
        except subprocess.TimeoutExpired:
            raise Fault("hangs without using the processor") from None
        out, err = (text.decode("utf-8", "replace") for text in (done.stdout, done.stderr))
        lines = [line for line in err.splitlines() if line and not line.startswith("note: ")]
        self.warnings += [line for line in lines if line.startswith("warning: ")]
        other = [line for line in lines if not line.startswith("warning: ")]
        if WORDS.search(err):
            raise Fault(f"says a word of programmers: {WORDS.search(err).group()} in {err.strip()[:300]}")
        if done.returncode < 0:
            raise Fault(f"ended by signal {-done.returncode}" + (" (took too long)" if done.returncode in (-24, -9) else ""))
        if done.returncode == 0:
            if other:
                raise Fault(f"success, and yet: {other[0]}")
            return json.loads(out, parse_constant=_no_constant)
        if done.returncode not in range(2, 8):
            raise Fault(f"exit code {done.returncode}: {err.strip()[:300]}")
        if len(other) != 2 or not other[0].startswith("error: ") or not other[1].startswith("hint: "):
            raise Fault(f"exit code {done.returncode} without one error and one hint: {err.strip()[:300]}")
        if re.search(r"\b(nan|inf)\b", other[0]):
            raise Fault(f"refused with a number that is none: {other[0]}")
        raise Refused(done.returncode, other[0])

    # --- judgement

    def must(self, condition, text):
        """Holds in any case."""
        if not condition:
            self.faults.append(text)

    def should(self, condition, text, excuse):
        """Holds unless a warning says otherwise. @param excuse what is in that warning"""
        if not condition and not any(re.search(excuse, line) for line in self.warnings):
            self.faults.append(text)

    def near(self, value, wanted, tolerance, what, floor=0.0):
        self.must(value is not None and abs(value - wanted) <= tolerance * max(abs(wanted), floor),
                  f"{what} is {value}, and {wanted} is right")

    def between(self, value, low, high, what, slack=1e-6):
        low, high = low - slack * abs(low), high + slack * abs(high)
        self.must(value is not None and low <= value <= high, f"{what} is {value}, not between {low} and {high}")

    def against(self, name):
        self.reference.append(name)


# --- samples -----------------------------------------------------------------------------------------------------------

NAMES = ["alpha", "beta", "gamma", "delta"]


class Sample:
    """Phases of nodes, as an array [z,] y, x with y upwards, and a file of it."""

    def __init__(self, setting, nodes, name="sample"):
        self.nodes = nodes
        self.dimension = nodes.ndim
        self.size = nodes.shape[::-1]
        self.present = [int(phase) for phase in np.unique(nodes)]
        greys = (nodes * 60 + 10).astype(np.uint8)
        if self.dimension == 2:
            self.file = f"{name}.png"
            (setting.folder / self.file).write_bytes(pictures.png([list(map(int, row)) for row in greys[::-1]]))
        else:
            self.file = f"{name}_{'x'.join(map(str, self.size))}_u8.raw"
            (setting.folder / self.file).write_bytes(greys.tobytes())

    def words(self, names=NAMES, pixel="1um"):
        """FILE and options that name its phases."""
        given = []
        for phase in self.present:
            given += ["--phase", f"{phase * 60 + 10}={names[phase]}"]
        return [self.file, *given, *(["--pixel-size", pixel] if pixel else [])]

    def share(self, phase):
        return float(np.mean(self.nodes == phase))


def random_size(setting, dimension, least, most):
    kind = setting.one_of("any", "any", "any", "odd", "tiny", "row", "long")
    most = max(most, least)
    size = [setting.whole(least, most) for _ in range(dimension)]
    if kind == "odd":
        size = [n | 1 if (n | 1) <= most else n - 1 for n in size]
    elif kind == "tiny":
        size = [setting.whole(least, max(least, 3)) for _ in size]
    elif kind == "row":
        size[setting.whole(0, dimension - 1)] = 1 if least <= 1 else least
    elif kind == "long" and dimension == 2:
        size = [least, most * 3] if setting.chance(0.5) else [most * 3, least]
    return size


def random_nodes(setting, dimension=None, least=1, most=(20, 8), phases=4):
    """@param most nodes along an axis in two and in three dimensions"""
    dimension = dimension or (2 if setting.chance(0.6) else 3)
    size = random_size(setting, dimension, least, most[dimension - 2])
    shape = size[::-1]
    count = setting.whole(1, phases)
    where = np.indices(shape)
    kind = setting.one_of("noise", "noise", "blobs", "layers", "one", "board", "speck", "wall")
    random = setting.random
    if kind == "noise":
        nodes = random.choice(count, size=shape, p=random.dirichlet(np.ones(count)))
    elif kind == "blobs":
        points = [random.uniform(0, n, size=3 * count) for n in shape]
        distance = sum((axis[..., None] - p) ** 2 for axis, p in zip(where, points))
        nodes = np.argmin(distance, axis=-1) % count
    elif kind == "layers":
        axis = setting.whole(0, dimension - 1)
        nodes = random.integers(0, count, size=shape[axis])[where[axis]]
    elif kind == "one":
        nodes = np.zeros(shape, int)
    elif kind == "board":
        nodes = (sum(where) % 2) * (count - 1)
    elif kind == "speck":
        nodes = np.zeros(shape, int)
        nodes[tuple(setting.whole(0, n - 1) for n in shape)] = count - 1
    else:
        axis = setting.whole(0, dimension - 1)
        nodes = np.where(where[axis] == setting.whole(0, shape[axis] - 1), count - 1, 0)
    return nodes.astype(int)


def crosses(open_nodes, axis, neighbours=None):
    """Whether nodes that are open lead from the first layer along an axis to the last one."""
    shape = open_nodes.shape
    steps = neighbours or [tuple(s if a == b else 0 for b in range(len(shape))) for a in range(len(shape)) for s in (-1, 1)]
    stack = [node for node in zip(*np.nonzero(open_nodes)) if node[axis] == 0]
    seen = set(stack)
    while stack:
        node = stack.pop()
        if node[axis] == shape[axis] - 1:
            return True
        for step in steps:
            other = tuple(a + b for a, b in zip(node, step))
            if all(0 <= a < n for a, n in zip(other, shape)) and other not in seen and open_nodes[other]:
                seen.add(other)
                stack.append(other)
    return False
