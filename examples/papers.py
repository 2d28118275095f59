"""What the pages of the papers share: studies that run once, what a paper says beside what this run found, the page.

A paper is a paper.json: its studies (script, arguments, what they took when last measured) and its figures in order, each as a section of
report.json (docs/commands/report.md) whose files are of the study's folder. Besides, a figure has
  study        whose files are shown; without one "not_made" says why. A part of a figure may name another study of its own
  discussion   paragraphs of Markdown files, by the words that they begin with: one text for the study's page and this one
and "ours" of a comparison may be {"derived": NAME}: what a function of run.py makes of the tables. The paper's "differences" name the heading
of a Markdown file whose list the page begins with.
"""

import argparse
import csv
import datetime
import json
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

EXAMPLES = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.environ.get("LAMELLA_PROGRAM", os.path.join(EXAMPLES, "..", "build", "bin", "lamella"))
RECORD = "done.json"  # in the folder of a study that is finished
NOT_HERE = "not in this run"


class Failure(Exception):
    def __init__(self, message, hint):
        super().__init__(message)
        self.hint = hint


def machine():
    """Processor, cores, memory; no names of hosts or users."""
    model = "unknown processor"
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                model = " ".join(line.split(":", 1)[1].split())
                break
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 1e9
    return f"{model}, {len(os.sched_getaffinity(0))} cores for this run, {memory:.0f} GB of memory"


def version():
    """Version and commit of the program. It and the Python package are of one build."""
    try:
        words = subprocess.run([PROGRAM, "--version"], check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout.split()
    except (OSError, subprocess.CalledProcessError) as error:
        raise Failure(f"cannot run {PROGRAM}: {error}", "build it first (./dev build), or set LAMELLA_PROGRAM to it") from None
    return words[1], words[3].rstrip(")")


def environment():
    """The studies find the Python package of the build that the program is of."""
    beside = os.path.join(os.path.dirname(PROGRAM), "..", "python")
    paths = [path for path in (os.environ.get("PYTHONPATH"), os.path.abspath(beside)) if path]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}


def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(text):
    """Of a cell; NaN where there is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def alike(cell, wanted):
    return cell == str(wanted) or number(cell) == number(str(wanted))


def rows_where(table, **wanted):
    return [row for row in table if all(alike(row[key], value) for key, value in wanted.items())]


def the_row(table, **wanted):
    """The only such row; KeyError where this run has none."""
    rows = rows_where(table, **wanted)
    if len(rows) != 1:
        raise KeyError(f"{len(rows)} rows with {wanted}")
    return rows[0]


class Tables:
    """The tables of the finished studies, by study and file."""

    def __init__(self, folders):
        self.folders = folders
        self.read = {}

    def __call__(self, study, file):
        if study not in self.folders:
            raise KeyError(study)
        if (study, file) not in self.read:
            self.read[study, file] = read_table(os.path.join(self.folders[study], file))
        return self.read[study, file]


# --- studies ---------------------------------------------------------------------------------------------------------


def done(folder):
    """What a finished study wrote down, or None."""
    try:
        with open(os.path.join(folder, RECORD), encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


def finish(part, folder, record):
    """The study's files appear whole or not at all."""
    with open(os.path.join(part, RECORD), "w", encoding="utf-8") as file:
        json.dump(record, file, indent=2)
        file.write("\n")
    shutil.rmtree(folder, ignore_errors=True)
    os.replace(part, folder)


def record_of(study, words, seconds, processor_seconds, real):
    release, commit = version()
    return {
        "arguments": words, "seconds": seconds, "processor_seconds": processor_seconds, "machine": machine(), "real_data": real,
        "provenance": {"program": study["script"], "version": release, "commit": commit,
                       "command": " ".join(["examples/" + study["script"], *words]),
                       "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")},
    }


def run_study(name, study, words, folder):
    """Runs a study beside its place. Ctrl-C ends it, and it will run again from its start."""
    part = folder + ".part"
    shutil.rmtree(part, ignore_errors=True)
    os.makedirs(part)
    begun, spent = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    child = subprocess.Popen([sys.executable, os.path.join(EXAMPLES, study["script"]), "--output", part, *words], env=environment(),
                             start_new_session=True)
    try:
        code = child.wait()
    except KeyboardInterrupt:
        os.killpg(child.pid, signal.SIGTERM)
        child.wait()
        raise
    if code != 0:
        raise Failure(f"the study {name} ended with code {code}", "its own words above say why; what was finished before is kept")
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = now.ru_utime + now.ru_stime - spent.ru_utime - spent.ru_stime
    real = bool(os.environ.get("LAMELLA_REAL_DATA"))
    finish(part, folder, record_of(study, words, time.perf_counter() - begun, processor, real))


def take_study(name, study, source, folder):
    """The files of a study that was run by hand."""
    lacking = [file for file in study["files"] if not os.path.isfile(os.path.join(source, file))]
    if lacking:
        raise Failure(f"{source} lacks {', '.join(lacking)} of the study {name}", "give the folder that it wrote to with --output")
    part = folder + ".part"
    shutil.rmtree(part, ignore_errors=True)
    os.makedirs(part)
    for file in sorted(os.listdir(source)):
        if file.endswith((".csv", ".png")):
            shutil.copy2(os.path.join(source, file), part)
    known = done(source)
    taken = known or {"arguments": [], "seconds": None, "processor_seconds": None, "machine": None, "real_data": True}
    finish(part, folder, {**taken, "taken": True})


def state_of(study, words, folder, keep):
    """None where the study's results can be used, else why it must run."""
    known = done(folder)
    if known is None:
        return "not run yet"
    if keep or known.get("taken"):
        return None
    if known["arguments"] != words:
        return "run before with other arguments"
    release, commit = version()
    made = known["provenance"]
    if (made["version"], made["commit"]) != (release, commit):
        return f"run before with commit {made['commit']}, this is {commit} (--keep takes it as it is)"
    if not known["real_data"] and os.environ.get("LAMELLA_REAL_DATA") and study.get("real_data"):
        return "run before without LAMELLA_REAL_DATA"
    return None


# --- the page --------------------------------------------------------------------------------------------------------


def paragraph(file, begins):
    """A paragraph or item of a Markdown file under examples/, as one line."""
    blocks = [[]]
    with open(os.path.join(EXAMPLES, file), encoding="utf-8") as lines:
        for line in lines:
            if not line.strip() or line.startswith(("- ", "#", "|", "![", "```")):
                blocks.append([])
            if line.strip():
                blocks[-1].append(line.strip())
    blocks = [" ".join(block) for block in blocks if block]
    found = [i for i, block in enumerate(blocks) if block.startswith(begins)]
    if len(found) != 1:
        raise Failure(f"{len(found)} paragraphs of examples/{file} begin with '{begins}'", "mend the discussion in paper.json")
    after = (blocks + [""])[found[0] + 1]
    leads = blocks[found[0]].endswith(":") and after.startswith(("|", "!["))
    return blocks[found[0]] + (" *(there)*" if leads else "")


def items_below(file, heading):
    """A heading of a Markdown file under examples/ and the list below it, as one text."""
    with open(os.path.join(EXAMPLES, file), encoding="utf-8") as lines:
        text = lines.read().split(f"\n## {heading}\n")
    if len(text) != 2:
        raise Failure(f"examples/{file} has {len(text) - 1} headings '{heading}'", "mend 'differences' in paper.json")
    return f"**{heading}**\n\n" + text[1].split("\n## ")[0].strip()


def np_free(value):
    """A value, or a value and its error, as numbers of Python."""
    return tuple(float(one) for one in (value if isinstance(value, tuple) else (value,)))


def ours_of(said, folder, derived, tables):
    """A number of a table as report.json has it, or one made from tables. NOT_HERE where a smaller run has none."""
    if not isinstance(said, dict):
        return said
    try:
        if "derived" in said:
            value, error = (*np_free(derived[said["derived"]](tables)), math.nan)[:2]
            return NOT_HERE if math.isnan(value) else {"value": value} | ({} if math.isnan(error) else {"error": error})
        row = the_row(read_table(os.path.join(folder, said["file"])), **said.get("where", {}))
        if math.isnan(number(row[said["column"]])):
            return NOT_HERE
    except (KeyError, FileNotFoundError, ZeroDivisionError):
        return NOT_HERE
    return {**said, "file": os.path.join(os.path.basename(folder), said["file"])}


def studies_of(figure):
    """Names of the studies whose files a figure of paper.json shows."""
    parts = [figure, *(part for key in ("figures", "curves", "tables") for part in figure.get(key, ()))]
    return {part["study"] for part in parts if "study" in part}


def section_of(figure, folders, derived, tables, quick):
    """A figure of paper.json as a section of the page."""
    folder = folders.get(figure.get("study"), "")
    title = f"{figure['number']}: {figure['title']}"
    section = {"title": title, "text": [f"**The paper:** {figure['paper']}"] if "paper" in figure else []}
    if "text" in figure:
        section["text"].append(figure["text"])
    if "not_made" in figure:
        section["text"].append(f"*Not made.* {figure['not_made']}")
    section["comparison"] = [
        {key: value for key, value in row.items() if key != "at"} | {"ours": ours_of(row["ours"], folder, derived, tables)}
        for row in figure.get("comparison", ())
    ]
    for key in ("figures", "curves", "tables"):
        section[key] = []
        for part in figure.get(key, ()):
            of = folders.get(part.get("study"), folder)
            there = of and os.path.isfile(os.path.join(of, part["file"]))
            if there or not (quick or part.get("real_data")):  # what a full run lacks, the page names as missing
                part = {name: value for name, value in part.items() if name not in ("real_data", "study")}
                section[key].append({**part, "file": os.path.join(os.path.basename(of), part["file"])})
    discussion = [paragraph(one["file"], begins) for one in figure.get("discussion", ()) for begins in one["begins"]]
    if discussion:
        files = ", ".join(dict.fromkeys(f"`examples/{one['file']}`" for one in figure["discussion"]))
        section["discussion"] = [f"*Of the run that {files} documents:*", *discussion]
    return section


def numbers_of(figures):
    """'figures 3 and 4' of 'Figure 3' and 'Figure 4'; others by their names."""
    short = [figure["number"].removeprefix("Figure ") for figure in figures]
    names = short if all(figure["number"].startswith("Figure ") for figure in figures) else [figure["number"] for figure in figures]
    listed = names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
    return listed if names != short else f"{'figures' if len(names) > 1 else 'figure'} {listed}"


def page_of(paper, figures, folders, derived, quick):
    tables = Tables(folders)
    records = {name: done(folder) for name, folder in folders.items()}
    sections = [section_of(figure, folders, derived, tables, quick) for figure in figures]
    times = []
    for name, record in records.items():
        mine = [figure for figure in figures if name in studies_of(figure)]
        note = "taken from a run by hand" if record.get("taken") else ""
        times.append({"what": f"{paper['studies'][name]['about']}: {numbers_of(mine)}", "seconds": record["seconds"],
                      "processor_seconds": record["processor_seconds"], "note": note})
    made = [figure for figure in figures if "not_made" not in figure]
    part = len(figures) < len(paper["figures"])
    asked = f"Of the paper's {len(paper['figures'])} figures and tables, these {len(figures)} were asked for; {len(made)} of them" if part else (
        f"Of the paper's {len(figures)} figures and tables {len(made)}")
    text = [paper["about"], f"{asked} are made, in the paper's order. Numbers under *ours* are read from the tables of this run, which lie beside "
            "this page; a difference is ours less the paper's, over the paper's."]
    if "differences" in paper:
        text.append(items_below(**paper["differences"]))
    if quick:
        text.append("**A quick run:** samples are few, small and coarse, to show that all of it works. Its numbers are not to be compared with "
                    "the paper's; the discussion is of the full run.")
    if any(paper["studies"][name].get("real_data") for name in folders) and not all(record["real_data"] for record in records.values()):
        text.append("LAMELLA_REAL_DATA was not set: generated tissue only, none of real outlines.")
    machines = list(dict.fromkeys(record["machine"] for record in records.values() if record["machine"]))
    return {"title": paper["title"], "text": text, "machine": "; ".join(machines), "sections": sections, "times": times}


# --- the command -----------------------------------------------------------------------------------------------------


def options_of(doc, paper, name):
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--figures", metavar="LIST", help="only these, by number: 3,4 or table1 (default: all)")
    parser.add_argument("--quick", action="store_true", help="small samples: shows in less than two minutes that everything works")
    parser.add_argument("--output", default=f"results/{name}", help="folder of the studies' results and the page (default: %(default)s)")
    parser.add_argument("--take", action="append", default=[], metavar="STUDY=FOLDER",
                        help="use the results of a study that was run by hand: " + ", ".join(paper["studies"]))
    parser.add_argument("--keep", action="store_true", help="use results of earlier runs whatever version and arguments made them")
    parser.add_argument("--dry-run", action="store_true", help="say what would run, and end")
    return parser.parse_args()


def chosen_figures(paper, words):
    if not words:
        return paper["figures"]
    short = {figure["number"].lower().replace("figure", "").replace(" ", ""): figure for figure in paper["figures"]}
    wanted = [word.strip().lower().replace(" ", "") for word in words.split(",")]
    for word in wanted:
        if word not in short:
            raise Failure(f"--figures '{word}' is none of the paper's", "there are " + ", ".join(short))
    return [figure for key, figure in short.items() if key in wanted]


def taken_folders(paper, words):
    taken = {}
    for word in words:
        name, _, folder = word.partition("=")
        if name not in paper["studies"]:
            raise Failure(f"--take '{word}' names no study", "there are " + ", ".join(paper["studies"]))
        if not os.path.isdir(folder):
            raise Failure(f"--take '{word}': there is no folder '{folder}'", "write it as --take STUDY=FOLDER")
        taken[name] = folder
    return taken


def minutes(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


def make(doc, home, derived):
    with open(os.path.join(home, "paper.json"), encoding="utf-8") as file:
        paper = json.load(file)
    options = options_of(doc, paper, os.path.basename(home))
    figures = chosen_figures(paper, options.figures)
    taken = taken_folders(paper, options.take)
    folders, waiting = {}, []
    for name, study in paper["studies"].items():
        if not any(name in studies_of(figure) for figure in figures):
            continue
        folder = folders[name] = os.path.join(options.output, name)
        words = study["quick"] if options.quick else study.get("arguments", [])
        why = "taken" if name in taken else state_of(study, words, folder, options.keep)
        usual = f"{minutes(study['processor_seconds'])} of processor time when last measured"
        if name in taken:
            print(f"{name}: taken from {taken[name]}")
        elif why is None:
            print(f"{name}: done already")
        else:
            print(f"{name}: {study['about']}; {why}; " + ("a quick run" if options.quick else usual))
            waiting.append((name, study, words, folder))
    if options.dry_run:
        print(f"measured: {paper['measured']}")
        return
    os.makedirs(options.output, exist_ok=True)
    for name, source in taken.items():
        if name in folders:
            take_study(name, paper["studies"][name], source, folders[name])
    if waiting and subprocess.run([sys.executable, "-c", "import lamella"], env=environment(), check=False).returncode:
        raise Failure(f"{sys.executable} cannot import lamella", "build it first (./dev build) and use /usr/bin/python3")
    for count, (name, study, words, folder) in enumerate(waiting, 1):
        print(f"\n== {name} ({count} of {len(waiting)})", flush=True)
        run_study(name, study, words, folder)
    with open(os.path.join(options.output, "report.json"), "w", encoding="utf-8") as file:
        json.dump(page_of(paper, figures, folders, derived, options.quick), file, indent=2, ensure_ascii=False)
    page = os.path.join(options.output, "report.html")
    print(flush=True)
    if subprocess.run([PROGRAM, "report", options.output, "-o", page, "--overwrite", "--strict"], check=False).returncode:
        raise Failure("the page lacks something", "its warnings above name it")


def interrupted(*_):
    raise KeyboardInterrupt


def main(doc, file, derived):
    for number_of_signal in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number_of_signal, interrupted)
    try:
        make(doc, os.path.dirname(os.path.abspath(file)), derived)
    except Failure as failure:
        sys.exit(f"error: {failure}\nhint: {failure.hint}")
    except OSError as error:
        sys.exit(f"error: {error}\nhint: choose a folder that you can write to with --output")
    except KeyboardInterrupt:
        print("\ninterrupted: finished studies are kept, the others run again from their start", file=sys.stderr)
        sys.exit(130)
