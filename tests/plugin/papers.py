"""The page of a paper at a quick size: every figure in its place, numbers from the tables of the run; a run that goes on, and one that is
interrupted.

    papers.py PAPER FOLDER
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = os.path.join(HERE, "..", "..", "examples")
sys.path.append(os.path.join(HERE, "..", "cli"))
from pages import Page  # noqa: E402


def run(paper, *words, code=0):
    command = [sys.executable, "-B", os.path.join(EXAMPLES, paper, "run.py"), *words]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", check=False)
    print(done.stdout, done.stderr, file=sys.stderr)
    assert done.returncode == code, (done.returncode, done.stderr)
    return done


def check_page(page, figures):
    assert page.faults() == [], page.faults()
    sections = re.split(r'<section id="s\d+">', page.source)[1:]
    assert len(sections) == len(figures)
    numbers = 0
    for section, figure in zip(sections, figures):
        assert f"<h2>{figure['number']}: " in section, figure["number"]
        assert ("<img" in section) == bool(figure.get("figures")), figure["number"]
        assert ("Not made." in section) == ("not_made" in figure)
        rows = re.findall(r"<tr><td>.*?</td><td[^>]*>(.*?)</td><td[^>]*>(.*?)</td><td>(.*?)</td><td class=\"wide\">", section)
        assert len(rows) == len(figure.get("comparison", ())), (figure["number"], rows)
        for (_, ours, difference), row in zip(rows, figure.get("comparison", ())):
            number = re.fullmatch(r"−?[\d.]+( ± [\d.]+)?( × 10<sup>−?\d+</sup>)?( \S+)?", ours)
            assert number or ours == "not in this run", (row["what"], ours)
            compared = number and isinstance(row["paper"], (int, float))  # the same number: "0"
            assert bool(difference) == bool(compared), (row["what"], difference)
            numbers += bool(number)
    return numbers


def main(paper, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.environ["LAMELLA_REAL_DATA"] = ""  # real outlines take longer
    with open(os.path.join(EXAMPLES, paper, "paper.json"), encoding="utf-8") as file:
        about = json.load(file)
    planned = run(paper, "--quick", "--dry-run", "--output", folder)
    assert planned.stdout.count("not run yet") == len(about["studies"]) and not os.path.exists(folder), planned.stdout
    run(paper, "--quick", "--output", folder)
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
        numbers = check_page(Page(file.read()), about["figures"])
    rows = sum(len(figure.get("comparison", ())) for figure in about["figures"])
    print(f"{numbers} of {rows} rows have a number")
    assert numbers >= 0.6 * rows  # a quick run has one horizon of seven, and not every tissue

    # What is done is not done again, and a part of the figures makes a smaller page.
    made = {name: os.stat(os.path.join(folder, name)).st_mtime_ns for name in about["studies"]}
    again = run(paper, "--quick", "--figures", "5, 11", "--output", folder)
    assert again.stdout.count("done already") in (1, 2) and "==" not in again.stdout, again.stdout
    assert made == {name: os.stat(os.path.join(folder, name)).st_mtime_ns for name in made}
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
        check_page(Page(file.read()), [figure for figure in about["figures"] if figure["number"] in ("Figure 5", "Figure 11")])

    # Ctrl-C: the study that was running leaves nothing, the others stay.
    first, *others = about["studies"]
    shutil.rmtree(os.path.join(folder, first))
    child = subprocess.Popen([sys.executable, "-B", os.path.join(EXAMPLES, paper, "run.py"), "--quick", "--output", folder],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")
    while "==" not in child.stdout.readline():
        assert child.poll() is None
    child.send_signal(signal.SIGINT)
    _, said = child.communicate()
    assert child.returncode == 130 and "finished studies are kept" in said, (child.returncode, said)
    assert not os.path.exists(os.path.join(folder, first)) and all(os.path.isdir(os.path.join(folder, name)) for name in others)

    for words, what, hint in [(["--figures", "99"], "'99' is none of the paper's", "there are 1, 2"),
                              (["--take", "x=."], "names no study", first),
                              (["--take", f"{first}=/none"], "there is no folder '/none'", "--take STUDY=FOLDER"),
                              (["--take", f"{first}={HERE}"], f"{HERE} lacks", "--output")]:
        failed = run(paper, *words, "--quick", "--output", folder, code=1)
        lines = failed.stderr.splitlines()
        assert len(lines) == 2 and what in lines[0] and hint in lines[1], failed.stderr


if __name__ == "__main__":
    main(*sys.argv[1:])
