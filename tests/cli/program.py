"""Runs build/bin/lamella as a user would, in an empty folder, and looks at what comes back."""

import json
import math
import os
import shutil
import subprocess
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.environ.get("LAMELLA_PROGRAM", os.path.join(HERE, "..", "..", "build", "bin", "lamella"))
MPIEXEC = os.environ.get("LAMELLA_MPIEXEC", "mpirun --oversubscribe --bind-to none -n").split()
REAL_DATA = os.environ.get("LAMELLA_REAL_DATA", "")


class Result:
    def __init__(self, done):
        self.code = done.returncode
        self.out = done.stdout.decode("utf-8", "replace")
        self.err = done.stderr.decode("utf-8", "replace")

    def json(self):
        """Standard output, which must be one JSON object and nothing else."""
        value = json.loads(self.out)
        if not isinstance(value, dict):
            raise AssertionError("not one JSON object: " + self.out)
        return value


def processor(process):
    """Seconds of processor time that a process has had; for ever where it has ended."""
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return math.inf if fields[0] == "Z" else (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Case(unittest.TestCase):
    """A test in a folder of its own."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lamella-cli-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return name

    def run_lamella(self, *words, ranks=0, environment=None, **options):
        command = [PROGRAM, *[str(word) for word in words]]
        if ranks:
            command = MPIEXEC + [str(ranks)] + command
        return Result(
            subprocess.run(
                command,
                cwd=self.folder,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env={**os.environ, **(environment or {})},
                timeout=100,
                check=False,
                **options,
            )
        )

    def popen(self, *words):
        """A run that is still going, to be interrupted or killed."""
        return subprocess.Popen([PROGRAM, *words], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def works(self, *words, **options):
        """Runs and expects success and silence on standard error."""
        result = self.run_lamella(*words, **options)
        self.assertEqual(result.code, 0, result.err + result.out)
        self.assertEqual(result.err, "")
        return result

    def fails(self, code, message, hint, *words, keep=(), **options):
        """Runs and expects this exit code, one error line and one hint line with these words, nothing on standard
        output and no new file in the folder."""
        before = sorted(os.listdir(self.folder))
        result = self.run_lamella(*words, **options)
        lines = [line for line in result.err.splitlines() if not line.startswith("warning: ")]
        self.assertEqual(result.code, code, result.err + result.out)
        self.assertEqual(len(lines), 2, "one error and one hint, nothing else:\n" + result.err)
        self.assertTrue(lines[0].startswith("error: "), result.err)
        self.assertTrue(lines[1].startswith("hint: "), result.err)
        self.assertIn(message, lines[0])
        self.assertIn(hint, lines[1])
        self.assertEqual(result.out, "")
        self.assertEqual(sorted(os.listdir(self.folder)), sorted(set(before) | set(keep)), "nothing is left behind")
        return result

    def info(self, name):
        return self.works("info", name, "--json").json()


PHASES = ["--phase", "0=lumen", "--phase", "255=wall"]
CONDUCTIVITIES = ["--conductivity", "lumen=0.1", "--conductivity", "wall=1"]
