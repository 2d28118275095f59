"""The words on the command line: help, version, what is close to a word that is not known, exit codes."""

import json
import os
import re
import subprocess
import unittest

import pictures
from program import CONDUCTIVITIES, HERE, PHASES, Case

COMMANDS = ["generate", "micrograph", "diffusion", "fit", "transient", "flux-map", "packing", "bridges", "equilibrium", "fracture", "dynamics", "stiffness", "bond-stiffness",
            "pore-flood-fill", "stress-pdf", "crack-path", "compression", "compression-curve", "collapse-map", "snapshot", "convert", "run", "report", "info"]


class Words(Case):
    def test_version_names_version_commit_vtk_and_mpi(self):
        lines = self.works("--version").out.splitlines()
        self.assertRegex(lines[0], r"^lamella \d+\.\d+\.\d+ \(commit [0-9a-z-]+\)$")
        self.assertRegex(lines[1], r"^VTK 9\.\d")
        self.assertRegex(lines[2], r"^MPI .*\d+\.\d+")
        self.assertEqual(len(lines), 3)

    def test_help_of_everything_has_examples(self):
        self.assertIn("Examples:", self.works("--help").out)
        for command in COMMANDS:
            text = self.works(command, "--help").out
            self.assertIn("Usage: lamella " + command, text)
            self.assertIn("Examples:", text)
        text = self.works("generate", "softwood", "--help").out
        self.assertIn("Usage: lamella generate softwood", text)
        self.assertIn("--seed", text)

    def test_help_fits_a_terminal(self):
        for words in [[], *[[command] for command in COMMANDS], ["generate", "softwood"], ["generate", "hardwood"]]:
            text = self.works(*words, "--help").out
            for line in text[: text.index("Examples:")].splitlines():
                self.assertLessEqual(len(line), 100, line)

    def test_the_pages_know_every_option(self):
        folder = os.path.join(HERE, "..", "..", "docs", "commands")
        kinds = {"generate": ["softwood", "hardwood", "honeycomb", "checkerboard", "disks", "spheres", "laminate"], "fit": ["diffusion", "stiffness"]}
        self.assertEqual(sorted(os.listdir(folder)), sorted([command + ".md" for command in COMMANDS] + ["README.md"]))
        options = {}
        for command in COMMANDS:
            options[command] = set()
            for kind in kinds.get(command, [""]):
                text = self.works(command, *kind.split(), "--help").out
                for names in re.findall(r"^  (?:-\w, )?(--[\w-]+(?:, --[\w-]+)*)", text, re.MULTILINE):
                    options[command] |= set(names.split(", "))
        every = set().union(*options.values())
        for command in COMMANDS:
            with open(os.path.join(folder, command + ".md"), encoding="utf-8") as file:
                page = file.read()
            for option in options[command] - {"--help"}:
                self.assertRegex(page, re.escape(option) + r"(?![\w-])", command + ".md")
            for option in re.findall(r"(?<![\w-])--[a-z][\w-]*(?![\w.-])", page):
                self.assertIn(option, every, command + ".md")

    def test_the_manual_page_has_every_option(self):
        page = self.works("--man").out.replace("\\-", "-")
        self.assertTrue(page.startswith(".TH LAMELLA 1"))
        for command in [*COMMANDS, "generate softwood"]:
            self.assertIn(".SS lamella " + command + "\n", page)
            text = self.works(*command.split(), "--help").out
            for option in re.findall(r"^  (?:-\w, )?(--[\w-]+)", text, re.MULTILINE):
                self.assertIn(option, page)
        for line in page.splitlines():  # requests are those that man knows
            if line.startswith((".", "'")):
                self.assertRegex(line, r"^\.(TH|SH|SS|TP|B|PP|EX|EE)( |$)")

    def test_shells_complete_commands_options_and_values(self):
        script = self.works("--completion", "bash").out
        self.write("completion.sh", script.encode())

        def completed(*words):
            line = " ".join(f"'{word}'" for word in words)
            asked = f"source ./completion.sh; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _lamella; echo ${{COMPREPLY[*]}}"
            return subprocess.run(["bash", "-c", asked], cwd=self.folder, capture_output=True, text=True, check=True).stdout.split()

        self.assertEqual({word for word in completed("lamella", "") if not word.startswith("-")}, set(COMMANDS), "all commands are tested here")
        self.assertEqual(completed("lamella", "diff"), ["diffusion"])
        self.assertEqual(completed("lamella", "generate", "soft"), ["softwood"])
        self.assertEqual(completed("lamella", "generate", "softwood", "--see"), ["--seed"])
        self.assertEqual(completed("lamella", "diffusion", "p.png", "--sides", ""), ["insulated", "periodic", "mixed"])
        self.assertEqual(completed("lamella", "diffusion", "p.p"), [])  # then the shell offers files
        self.assertIn("complete -c lamella", self.works("--completion", "fish").out)
        self.fails(2, "--completion 'basch' is not a shell", "did you mean 'bash'?", "--completion", "basch")

    def test_nothing_is_a_question_for_help(self):
        result = self.run_lamella()
        self.assertEqual(result.code, 2)
        self.assertIn("Usage: lamella", result.out)

    def test_did_you_mean(self):
        self.write("p.png", pictures.png(pictures.stripes(8, 8)))
        known = ["p.png", *PHASES, *CONDUCTIVITIES]
        self.fails(2, "'difusion' is not a command", "did you mean 'diffusion'?", "difusion", "p.png")
        self.fails(2, "'flux' is not a command", "did you mean 'flux-map'?", "flux", "p.png")
        self.fails(2, "'softwod' is not a command", "did you mean 'softwood'?", "generate", "softwod", "-o", "x.png")
        self.fails(2, "'--refin' is not an option", "did you mean '--refine'?", "diffusion", *known, "--refin", "2")
        self.fails(2, "'--pixelsize'", "did you mean '--pixel-size'?", "diffusion", *known, "--pixelsize=1um")
        self.fails(2, "sides 'insulted'", "did you mean 'insulated'?", "diffusion", *known, "--sides", "insulted")
        self.fails(2, "lattice 'd2q8'", "did you mean 'd2q", "diffusion", *known, "--lattice", "d2q8")
        self.fails(2, "method 'multgrid'", "did you mean 'multigrid'?", "diffusion", *known, "--method", "multgrid")
        self.fails(2, "-o 'x.pgn'", "did you mean '.png'?", "generate", "softwood", "-o", "x.pgn")
        self.fails(2, "names 'wal'", "did you mean 'wall'?", "diffusion", "p.png", *PHASES, "--conductivity", "wal=1")

    def test_words_that_are_close_to_nothing(self):
        self.write("p.png", pictures.png(pictures.stripes(8, 8)))
        known = ["p.png", *PHASES, *CONDUCTIVITIES]
        self.fails(2, "'--zebra' is not an option", "see lamella diffusion --help", "diffusion", *known, "--zebra")
        self.fails(2, "'paint' is not a command", "there are 'generate', 'diffusion'", "paint")
        self.fails(2, "direction 'w'", "all (3)", "diffusion", *known, "--direction", "w")
        self.fails(2, "names 'stone'", "'lumen' and 'wall'", "diffusion", "p.png", *PHASES, "--conductivity", "stone=1")

    def test_options_of_another_command(self):
        self.write("p.png", pictures.png(pictures.stripes(8, 8)))
        self.fails(2, "'--conductivity' is not an option of lamella info", "option of lamella diffusion",
                   "info", "p.png", "--conductivity", "wall=1")
        self.fails(2, "'--seed' is not an option of lamella generate disks", "option of lamella generate softwood",
                   "generate", "disks", "--seed", "3", "-o", "d.png")

    def test_words_that_are_missing_or_too_many(self):
        self.write("p.png", pictures.png(pictures.stripes(8, 8)))
        self.fails(2, "FILE is missing", "lamella diffusion --help", "diffusion")
        self.fails(2, "--conductivity is missing", "--conductivity NAME=VALUE", "diffusion", "p.png")
        self.fails(2, "-o is missing", "add -o FILE", "generate", "softwood")
        self.fails(2, "which command?", "'softwood'", "generate")
        self.fails(2, "'q.png' is one word too many", "--help", "diffusion", "p.png", "q.png", *PHASES, *CONDUCTIVITIES)

    def test_numbers_that_are_none(self):
        self.write("p.png", pictures.png(pictures.stripes(8, 8)))
        known = ["diffusion", "p.png", *PHASES, *CONDUCTIVITIES]
        self.fails(2, "refine '1.5' is not a whole number", "--refine NUMBER", *known, "--refine", "1.5")
        self.fails(2, "refine 'x' is not a number", "--refine NUMBER", *known, "--refine", "x")
        self.fails(2, "refine 0 is below 1", "1 or more", *known, "--refine", "0")
        self.fails(2, "tolerance nan is not a number", "1e-12 to 0.1", *known, "--tolerance", "nan")
        self.fails(2, "threads -1 is below 0", "0 or more", *known, "--threads=-1")
        self.fails(2, "target error 0 is not above 0", "above 0", *known, "--target-error", "0")
        self.fails(2, "--pixel-size '1 mile'", "0.5um", *known, "--pixel-size", "1 mile")
        self.fails(2, "pixel size -1 is not above 0", "above 0", *known, "--pixel-size=-1")
        self.fails(2, "--phase 'wall' is not GREY=NAME", "GREY=NAME", *known, "--phase", "wall")
        self.fails(2, "'-3' is not a grey value", "0 to 255", *known, "--phase=-3=wall")
        self.fails(2, "phase gives '0' two values, lumen and wall", "one value", *known, "--phase", "0=wall")

    def test_options_that_contradict_each_other(self):
        self.write("p.png", pictures.png(pictures.stripes(8, 8)))
        known = ["diffusion", "p.png", *PHASES, *CONDUCTIVITIES]
        self.fails(2, "contradict", "leave the target out", *known, "--target-error", "1%", "--no-error-estimate")
        self.fails(2, "segmentation and phases contradict", "name no phases", *known, "--segment")
        self.fails(2, "lumen counts only with segment", "choose segment", *known, "--lumen", "dark")
        self.fails(2, "lattice d3q7 does not fit", "d2q5", *known, "--lattice", "d3q7")
        self.fails(2, "direction z of a two-dimensional image", "x or y", *known, "--direction", "z")

    def test_json_is_one_object_and_quiet_is_silent(self):
        made = self.works("generate", "honeycomb", "-o", "h.png", "--json").json()
        self.assertEqual(made["size"], [200, 200])
        result = self.works("diffusion", "h.png", *CONDUCTIVITIES, "--quiet")
        self.assertEqual(result.out, "")
        result = self.works("diffusion", "h.png", *CONDUCTIVITIES, "--quiet", "--json")
        self.assertIn("x", result.json()["effective"])
        # JSON knows no NaN and no infinity; Python's reader would let them pass.
        json.loads(result.out, parse_constant=self.fail)


if __name__ == "__main__":
    unittest.main()
