"""Reads what a VTK class declares of its settings from its header: the one place where a setting is told.

A setting is a public setter: vtkSettingMacro(Name, type, default) and its kin (vtkSetting.h, VTK's own), `void SetName(...)` of a
number that has a getter, or `void AddName(...)`, `void SetName(const char*, ...)` beside a `RemoveAllNames()` of things that
are listed. Where the macro does not tell it, its default is the member's own initialiser. The comment above it says in a sentence
or two what it does, to those who set it in any front end, and then, in lines that begin with @:

    @word at-time, at_times       what it is called in a command, and in Python if that differs, where the rule's word will not do
    @off no-rivals: Do not look   of a switch that is on by itself: the option that switches it off (by itself no-WORD), and what that does
    @group Load                   title under which it stands
    @unit Pa                      unit of its numbers
    @range [0, 1)                 what is allowed; numbers are finite unless it says inf]
    @rest 1                       of a vector: its last number where people leave it out; same: as the one before
    @flat z, depth               of a vector: its parts that are 0 where people leave them out, all of them
    @unset 0                      what stands for a number that is not given, out of its range: a default that nobody can give
    @choice Loads                 the enum of what it can be, or its enumerators, if it cannot be all of them
    @words viridis inferno        of a text: what it can be
    @names -1 = magnitude; 0 = x  words for some of the whole numbers that it can be
    @colour                       its last three numbers are a colour, which people write as #RRGGBB or by a name
    @values 2 = disks; 3 = spheres  whole numbers that it can be, and what they mean
    @title Toughness of bonds     of what is listed: the heading of its table
    @uncertainty young            of what is listed by name: how far the numbers of the list of that word may be off; a command
                                  takes both there, NAME=VALUE±HALF
    @columns Bonds, Modulus [Pa]  names of the parts of what is listed, or of a vector
    @when Load BIAXIAL            only of account where another setting is one of these
    @files Checkpoints (*.h5)     the name of a file, and of which
    @advanced                     seldom needed
    @default -1                   where no member has an initialiser
    @panel off                    of a switch or a choice: how a panel begins, where a live pipeline should not pay for the default

The comment of a class may say @default Name value of a setting of its base, and @without Name Name of those that make no sense for it. A further paragraph is for programmers alone. What a comment between ///@{ and ///@} says holds for all setters in there.
Where it begins with "As vtkX.", all that it does not say is as that class has it.
"""

import dataclasses
import math
import pathlib
import re

NUMBERS = {"int": "whole", "vtkIdType": "whole", "double": "number", "bool": "switch", "std::string": "text"}


class HeaderError(Exception):
    """A header that is not understood; says where and why."""


@dataclasses.dataclass
class Range:
    """An interval; an end that does not belong to it is open. Infinity may belong to it."""

    low: float = -math.inf
    high: float = math.inf
    low_open: bool = True
    high_open: bool = True


@dataclasses.dataclass
class Choice:
    """One of several words. `name` is the enumerator, `word` what people write, `text` what it means, `label` how a panel shows it.

    All follow from the enumerator and the comment behind it, which begins with the label where that is another: ///< "FLIP": ...
    """

    name: str
    word: str
    value: int
    text: str = ""
    label: str = ""


@dataclasses.dataclass
class Setting:
    """One setting. `kind` is switch, whole, number, choice, text, file, vector or list; of the last two `types` has more."""

    name: str  # as the property is called
    setter: str
    kind: str
    text: str = ""
    types: tuple = ()  # of the values that one call of the setter takes: whole, number, text, switch
    parameters: tuple = ()
    clear: str = ""  # of a list: what empties it
    getter: str = ""
    default: object = None
    range: Range = dataclasses.field(default_factory=Range)
    choices: list = dataclasses.field(default_factory=list)
    columns: list = dataclasses.field(default_factory=list)
    word: str = ""  # in a command, after --
    keyword: str = ""  # in Python
    off: str = ""  # of a switch that is on by itself: the option that switches it off
    off_text: str = ""  # and what that does
    wholes: tuple = ()  # C++ types of whole numbers, by parameter
    group: str = ""
    title: str = ""
    unit: str = ""
    when: tuple = ()
    files: str = ""
    advanced: bool = False
    unset: object = None
    names: list = dataclasses.field(default_factory=list)  # words for some of its numbers: (word, number)
    colour: bool = False
    rest: object = None
    flat: tuple = ()  # indices
    uncertainty: str = ""  # the word of the list whose numbers may be off by its own
    panel: str = ""  # how a panel begins: on or off; empty: with the default
    owner: str = ""


@dataclasses.dataclass
class Class:
    """What a header says of a class, base classes left out. `tags` are those of the class's own comment."""

    name: str
    base: str
    header: str
    brief: str = ""
    abstract: bool = True
    settings: list = dataclasses.field(default_factory=list)
    tells: dict = dataclasses.field(default_factory=dict)  # of getters without a setter: (type, count, text)
    enums: dict = dataclasses.field(default_factory=dict)
    defaults: dict = dataclasses.field(default_factory=dict)
    changes: dict = dataclasses.field(default_factory=dict)  # defaults of settings of a base class that differ
    without: tuple = ()  # settings of a base class that make no sense


def sentence(lines):
    return " ".join(" ".join(lines).split())


def parse_comment(text):
    """First paragraph and tags, a dictionary, of a comment; each tag may go on over lines."""
    lines = [re.sub(r"^\s*\*? ?", "", line).rstrip() for line in text.strip().splitlines()]
    words, tags, last, told = [], {}, None, False
    for line in lines:
        tag = re.match(r"@(\w+)\s*(.*)", line)
        if tag:
            last = tag[1]
            tags[last] = [tag[2]]
        elif not line.strip():
            told = told or bool(words)
            last = None
        elif last is not None:
            tags[last].append(line)
        elif not told:
            words.append(line)
    return sentence(words), {name: sentence(lines) for name, lines in tags.items()}


def parse_range(text):
    found = re.fullmatch(r"([\[(])\s*(\S+?)\s*,\s*(\S+?)\s*([\])])", text)
    if not found:
        raise HeaderError(f"@range {text} is no interval, such as [0, 1)")
    low, high = float(found[2]), float(found[3])
    if not low < high:
        raise HeaderError(f"@range {text} is empty")
    return Range(low, high, found[1] == "(", found[4] == ")")


def words_of(name):
    """MaximumIterations -> maximum iterations."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name).lower()


def word_of(setting):
    """SetMaximumIterations -> maximum-iterations; SetComputeFlux, a switch -> flux; AddVoid -> void."""
    word = words_of(setting.setter[3:]).replace(" ", "-")
    return word[len("compute-"):] if setting.kind == "switch" and word.startswith("compute-") else word


def choice_word(enumerator, setting):
    """AUTO_LATTICE of Lattice -> auto; NO_MIXING of Mixing -> none; VON_MISES -> von-mises."""
    parts = enumerator.split("_")
    ending = re.findall(r"[A-Z][a-z0-9]*", setting)[-1].upper()
    if len(parts) > 1 and parts[-1] == ending:
        parts = parts[:-1]
    word = "-".join(parts).lower()
    return "none" if word == "no" else word


def choice(setting, name, value, text):
    word = choice_word(name, setting)
    label = re.match(r'"([^"]*)"(?::\s*)?', text)
    if label:
        return Choice(name, word, value, text[label.end():], label[1])
    label = word if word in ("x", "y", "z") else word.replace("-", " ").capitalize() if word != "auto" else "Automatic"
    brief = text.split(";")[0]
    return Choice(name, word, value, text, f"{label}: {brief}" if brief else label)


def arguments(text):
    """Types and names of the parameters of a function."""
    parts, depth, start = [], 0, 0
    for i, letter in enumerate(text + ","):
        depth += letter in "<([" and 1 or 0
        depth -= letter in ">)]" and 1 or 0
        if letter == "," and depth == 0:
            parts.append(text[start:i].strip())
            start = i + 1
    found = []
    for part in filter(None, parts):
        named = re.fullmatch(r"(.+?[\s*&])(\w+)((?:\[\d+\])?)", part)
        found.append((named[1].strip() + named[3], named[2]) if named else (part, ""))
    return found


TEXTS = ("const char*", "const std::string&")


def kind_of(kind):
    if kind in TEXTS:
        return "text"
    return NUMBERS.get(kind)


def value_of(text, enumerators):
    text = text.strip()
    if text in enumerators:
        return enumerators[text]
    if text in ("true", "false"):
        return text == "true"
    if text in ("nullptr", '""', ""):
        return ""
    if text.startswith('"'):
        return text[1:-1]
    if text == "VTK_DOUBLE_MAX":
        return math.inf
    try:
        return int(text) if re.fullmatch(r"[+-]?\d+", text) else float(text)
    except ValueError:
        return None


class Reader:
    """Reads one header. @raises HeaderError with the file and line of what is not understood"""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        text = self.path.read_text(encoding="utf-8")
        head = re.search(r"^class (?:\w+_EXPORT )?(\w+) : public (\w+)\s*\{", text, re.MULTILINE)
        if not head:
            raise HeaderError(f"{path}: has no class")
        brief = re.search(r"@brief\s+(.*?)\n \*\n", text, re.DOTALL)
        self.found = Class(head[1], head[2], self.path.name, brief=sentence(re.sub(r"\n \* ?", " ", brief[1]).split()) if brief else "")
        self.found.changes = dict(re.findall(r"^ \* @default (\w+) (.+)$", text[: head.start()], re.MULTILINE))
        self.found.without = tuple(" ".join(re.findall(r"^ \* @without (.+)$", text[: head.start()], re.MULTILINE)).split())
        self.text, self.start = text, head.end()
        self.enum, self.comment, self.grouped = None, None, False
        self.members, self.getters, self.clears = {}, {}, {}

    def fail(self, at, why):
        line = self.text.count("\n", 0, at) + 1
        raise HeaderError(f"{self.path}:{line}: {why}")

    def statements(self):
        """What stands in the class: comments, groups, and declarations up to their semicolon or closing brace, each with its place."""
        text, at = self.text, self.start
        while True:
            at += re.compile(r"\s*").match(text, at).end() - at
            if text[at] == "}":
                return
            comment = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL).match(text, at)
            access = re.compile(r"(?:public|protected|private):").match(text, at)
            end = (comment or access).end() if comment or access else self.end_of(at)
            yield at, text[at:end]
            at = end

    def end_of(self, at):
        """Where a declaration ends."""
        depth = 0
        for token in re.compile(r"//[^\n]*|[(){};]").finditer(self.text, at):
            if token[0] in "({":
                depth += 1
            elif token[0] in ")}":
                depth -= 1
                rest = re.compile(r"\s*;").match(self.text, token.end())
                if token[0] == "}" and depth == 0 and not rest:
                    return token.end()  # the body of a function
            elif token[0] == ";" and depth == 0:
                return token.end()
        return self.fail(at, "a declaration does not end")

    def read(self):
        access = "private"
        for at, text in self.statements():
            if re.fullmatch(r"\w+:", text):
                access = text[:-1]
            elif access == "public":
                self.public(text, at)
            else:
                member = re.fullmatch(r"([\w:]+)\s*(\*?)\s*(\w+)(\[\d+\])?(?:\s*=\s*([^;]*?))?\s*;", text)
                if member and member[1] not in ("class", "struct", "friend", "using"):
                    self.members[member[3]] = (member[1] + member[2], member[4], member[5])
        self.finish()
        return self.found

    ENUM = re.compile(r"enum\s+(?P<enum_name>\w+)\s*\{(?P<enum_body>.*)\}\s*;", re.DOTALL)
    MACRO = re.compile(r"vtk(?P<which>\w*Macro)\((?P<macro_arguments>.*)\)\s*;?", re.DOTALL)
    METHOD = re.compile(r"(?P<returns>[\w:<>*&\s]+?[\s*&])(?P<method_name>\w+)\((?P<parameters>[^()]*)\)(?P<rest>(?:[\w\s]|=\s*\w+)*)(?:;|\{.*\})", re.DOTALL)

    def public(self, text, at):
        if text.startswith("///@{"):
            self.grouped, self.comment = True, None
        elif text.startswith("///@}"):
            self.grouped, self.comment = False, None
        elif text.startswith("/**") or (text.startswith("///") and not text.startswith("///<")):
            self.comment = text[3:-2] if text.startswith("/**") else text[3:]
        elif not text.startswith("/"):
            for kind, read in ((self.ENUM, self.read_enum), (self.MACRO, self.read_macro), (self.METHOD, self.read_method)):
                found = kind.fullmatch(text)
                if found:
                    read(found, at)
                    return

    def read_enum(self, item, _at):
        entries = []
        value = -1
        for name, number, told in re.findall(r"^\s*(?:///[^\n]*\n\s*)*(\w+)\s*(?:=\s*(-?\d+))?\s*,?[ \t]*(?:///<[ ]*([^\n]*(?:\n\s*///<[^\n]*)*))?",
                                             item["enum_body"], re.MULTILINE):
            value = int(number) if number else value + 1
            entries.append((name, value, sentence(re.sub(r"\n\s*///<", " ", told).split())))
        self.found.enums[item["enum_name"]] = entries
        self.enum = item["enum_name"]
        self.comment = None

    def read_macro(self, item, at):
        which = item["which"]
        parts = [part.strip() for part in item["macro_arguments"].split(",")]
        name = parts[0]
        size = re.search(r"Vector(\d?)", which)
        count = int(size[1] or parts[2]) if size else 1
        if which == "SwitchMacro":
            which, parts = "SettingMacro", [name, "bool", *parts[1:]]
        if which.startswith("Setting"):  # vtkSetting.h: the setter, the getter and the member
            self.getters[name] = "Get" + name
            value = ", ".join(parts[2:])
            self.members[name] = (parts[1], f"[{count}]", f"{{ {value} }}") if size else (parts[1], None, value)
        if which.startswith("Get"):
            self.getters[name] = "Get" + name
            kind = "text" if re.match(r"Get(String|FilePath)", which) else kind_of(parts[1]) if len(parts) > 1 else None
            if not which.startswith(("GetObject", "GetSmartPointer")) and kind:
                self.found.tells[name] = (kind, count, parse_comment(self.comment or "")[0])
        elif which.startswith("Set") and not which.startswith(("SetObject", "SetSmartPointer")):
            kind = "text" if re.match(r"Set(String|FilePath)", which) else kind_of(parts[1])
            if kind is None:
                self.fail(at, f"{which} of {parts[1]} is not understood")
            kinds = (kind,) * count
            wholes = () if kind == "text" else (parts[1],) * count
            self.add(at, Setting(name, "Set" + name, "vector" if count > 1 else kind, types=kinds, wholes=wholes))
        elif which not in ("TypeMacro", "BooleanMacro", "AbstractTypeMacro", "TypeRevisionMacro", "SetObjectMacro", "SetSmartPointerMacro"):
            self.fail(at, f"{which} is not understood")
        if not self.grouped:
            self.comment = None

    def read_method(self, item, at):
        name = item["method_name"]
        given = arguments(item["parameters"])
        if name == "New" and item["returns"].startswith("static"):
            self.found.abstract = False
        elif re.match(r"(RemoveAll|Clear|Reset)[A-Z]", name) and not given:
            self.clears[re.sub(r"^(RemoveAll|Clear|Reset)", "", name)] = name
        elif re.match(r"Get[A-Z]", name) and not given:
            self.getters[name[3:]] = name
        elif re.match(r"(Set|Add)[A-Z]", name) and "void" in item["returns"] and "override" not in item["rest"]:
            kinds = tuple(kind_of(kind) for kind, _ in given)
            if kinds and all(kinds):  # objects and arrays that are handed over are for programmers alone
                kind = "list" if name.startswith("Add") or len(kinds) > 1 else kinds[0]
                self.add(at, Setting(name[3:], name, kind, types=kinds, parameters=tuple(label for _, label in given),
                                     wholes=tuple(cxx for cxx, _ in given)))
        if not self.grouped:
            self.comment = None

    def add(self, at, setting):
        setting.text, tags = parse_comment(self.comment or "")
        setting.owner = self.found.name
        setting.enum = self.enum
        setting.tags, setting.at = tags, at
        self.found.settings.append(setting)

    def finish(self):
        seen = {}
        for setting in self.found.settings:
            if setting.setter in seen:  # an overload: the first counts
                continue
            seen[setting.setter] = setting
        self.found.settings = list(seen.values())
        for name, (_, _, value) in self.members.items():
            self.found.defaults[name] = value
        for setting in self.found.settings:
            self.found.tells.pop(setting.name, None)
            self.found.tells.pop(setting.setter[3:], None)


class Declarations:
    """All classes of some headers, with what they inherit."""

    def __init__(self, paths):
        self.classes = {}
        self.clears, self.getters, self.members = {}, {}, {}
        for path in paths:
            reader = Reader(path)
            read = reader.read()
            self.classes[read.name] = read
            self.clears[read.name], self.getters[read.name] = reader.clears, reader.getters
            self.members[read.name] = reader.members
            for setting in read.settings:
                setting.fail = reader.fail
        self.completed = set()
        for name in self.classes:
            self.complete(name)

    def chain(self, name):
        """The class and its bases, the outermost first."""
        found = []
        while name in self.classes:
            found.insert(0, self.classes[name])
            name = self.classes[name].base
        return found

    def enumerators(self, name):
        return {entry[0]: entry for kind in self.chain(name) for entries in kind.enums.values() for entry in entries}

    def told_by(self, kind, name, text, find):
        """What a text begins with, "As vtkX. Rest.", of the same name there, and the rest; else None and the text."""
        found = re.match(r"As (vtk\w+)\. ?", text)
        if not found:
            return None, text
        other = self.classes.get(found[1])
        if other:
            self.complete(other.name)
        there = find(other) if other else None
        if there is None:
            raise HeaderError(f"{kind.header}: {name} is as {found[1]} has it, which has none")
        return there, text[found.end():]

    def complete(self, name):
        if name in self.completed:
            return
        self.completed.add(name)
        kind = self.classes[name]
        chain = self.chain(name)
        for base in chain[:-1]:
            self.complete(base.name)
        for told, (*rest, text) in kind.tells.items():
            there, text = self.told_by(kind, told, text, lambda other: other.tells.get(told))
            kind.tells[told] = (*rest, text or there[-1] if there else text)
        inherited = {setting.setter: setting for base in chain[:-1] for setting in base.settings}
        getters = {key: value for base in chain for key, value in self.getters[base.name].items()}
        clears = {key: value for base in chain for key, value in self.clears[base.name].items()}
        enums = {key: found for base in chain for key, found in base.enums.items()}
        entries = self.enumerators(name)
        values = {key: entry[1] for key, entry in entries.items()}
        for setting in kind.settings:
            tags, setting.getter = dict(setting.tags), getters.get(setting.setter[3:], "")
            there, setting.text = self.told_by(kind, setting.setter, setting.text, lambda other: next(
                (found for found in other.settings if found.setter == setting.setter), None))
            base = there or inherited.get(setting.setter)
            if setting.kind == "list" and setting.setter.startswith("Set") and "text" not in setting.types:
                setting.kind = "vector"  # several numbers that nothing tells, and none by itself
            elif setting.kind == "list" or setting.setter.startswith("Add"):
                setting.kind = "list"
                singular = setting.setter[3:]
                plural = next((key for key in clears if stem(key) == stem(singular)), None)
                if plural is None:
                    setting.fail(setting.at, f"{setting.setter} lists something that no RemoveAll... takes away")
                setting.name, setting.clear = plural, clears[plural]
            else:
                setting.default = self.default(setting, chain, values)
            if base is not None:
                inherit(setting, base, tags)
                setting.default = base.default if setting.default is None else setting.default
            self.apply(setting, tags, enums, entries)
            if setting.default is None and setting.kind != "list" and (setting.kind != "vector" or setting.getter):
                setting.fail(setting.at, f"the default of {setting.name} is not told: give its member an initialiser")

    def default(self, setting, chain, values):
        for base in reversed(chain):
            if setting.setter[3:] in self.members[base.name]:
                _, count, text = self.members[base.name][setting.setter[3:]]
                if count:
                    found = [value_of(part, values) for part in (text or "").strip("{} ").split(",")]
                    return None if None in found or text is None else found
                if text is None:
                    return "" if setting.kind == "text" else None
                return value_of(text, values)
        return "" if setting.kind == "text" else None

    @staticmethod
    def apply(setting, tags, enums, entries):
        fail = lambda why: setting.fail(setting.at, why)  # noqa: E731
        known = {"word", "off", "group", "title", "unit", "range", "choice", "values", "columns", "when", "files", "advanced", "default", "panel", "unset", "rest", "flat", "names", "words", "colour", "uncertainty"}
        for tag in set(tags) - known:
            fail(f"@{tag} is not understood; there are {', '.join(sorted(known))}")
        word, _, keyword = tags.get("word", setting.word).partition(",")
        setting.word = word or word_of(setting)
        setting.keyword = keyword.strip() or (setting.keyword if "word" not in tags else "") or setting.word.replace("-", "_")
        off, _, off_text = tags.get("off", setting.off).partition(":")
        setting.off_text = off_text.strip() or setting.off_text
        setting.off = off or (f"no-{setting.word}" if setting.kind == "switch" and setting.default else "")
        setting.group, setting.title = tags.get("group", setting.group), tags.get("title", setting.title)
        setting.unit = tags.get("unit", setting.unit)
        setting.advanced = setting.advanced or "advanced" in tags
        setting.panel = tags.get("panel", setting.panel)
        setting.uncertainty = tags.get("uncertainty", setting.uncertainty)
        setting.unset = float(tags["unset"]) if "unset" in tags else setting.unset
        setting.colour = setting.colour or "colour" in tags
        if "words" in tags:
            setting.choices = [Choice("", word, i) for i, word in enumerate(tags["words"].split())]
        if "names" in tags:
            setting.names = [tuple(part.strip() for part in name.split("=")) for name in tags["names"].split(";")]
        setting.rest = float(tags["rest"].replace("same", "inf")) if "rest" in tags else setting.rest
        setting.columns = [part.strip() for part in tags["columns"].split(",")] if "columns" in tags else setting.columns
        if "flat" in tags:
            setting.flat = tuple(setting.columns.index(part.strip()) for part in tags["flat"].split(","))
        if "range" in tags:
            try:
                setting.range = parse_range(tags["range"])
            except (HeaderError, ValueError) as error:
                fail(str(error))
        if "files" in tags:
            setting.kind, setting.files = "file", tags["files"]
        if "when" in tags:
            other, *words = tags["when"].split()
            setting.when = (other, *words)
        if "choice" in tags:
            names = tags["choice"].split()
            if len(names) == 1 and names[0] in enums:
                names = [entry[0] for entry in enums[names[0]]]
            missing = [name for name in names if name not in entries]
            if missing:
                fail(f"@choice {missing[0]} is no enumerator")
            setting.kind = "choice"
            setting.choices = [choice(setting.name, *entries[name]) for name in names]
        if "values" in tags:
            setting.kind = "choice"
            for part in tags["values"].split(";"):
                value, _, label = part.partition("=")
                setting.choices.append(Choice("", value.strip(), int(value), "", label.strip() or value.strip()))
        words = ["on", "off"] if setting.kind == "switch" else [entry.word for entry in setting.choices]
        if setting.panel and setting.panel not in words:
            fail(f"@panel {setting.panel} is none of {', '.join(words) or 'its words'}")
        if "default" in tags:
            setting.default = value_of(tags["default"], {name: entry[1] for name, entry in entries.items()})

    def settings(self, name):
        """All settings of a class, those of its bases first, each where it was first declared."""
        found = {}
        for base in self.chain(name):
            for setting in base.settings:
                found[setting.setter] = setting
            for left in base.without:
                gone = [setter for setter, setting in found.items() if setting.name == left]
                if not gone:
                    raise HeaderError(f"{base.header}: @without {left}: there is no such setting")
                del found[gone[0]]
            for changed, text in base.changes.items():
                if f"Set{changed}" not in found:
                    raise HeaderError(f"{base.header}: @default {changed}: there is no such setting")
                values = {key: entry[1] for key, entry in self.enumerators(name).items()}
                setting = dataclasses.replace(found[f"Set{changed}"], default=value_of(text, values))
                if setting.kind == "switch":
                    setting.off = (setting.off or f"no-{setting.word}") if setting.default else ""
                found[f"Set{changed}"] = setting
        return list(found.values())

    def other(self, name, setting):
        """The setting that `when` names, the values of it that count, and how people say so: (setting, [2], "load biaxial")."""
        word, *names = setting.when
        found = next((other for other in self.settings(name) if other.name == word), None)
        if found is None:
            return None
        if found.kind == "switch":
            off = names == ["0"]
            return found, [0 if off else 1], ("no " if off else "") + words_of(found.name)
        entries = {entry.name: entry for entry in found.choices}
        chosen = [entries[name] for name in names if name in entries]
        return found, [entry.value for entry in chosen], f"{words_of(found.word.replace('-', ' '))} {' or '.join(entry.word for entry in chosen)}"

    def own(self, name):
        """What a class declares itself, or changes of what its bases declare."""
        changed = {f"Set{setting}" for setting in self.classes[name].changes}
        return [setting for setting in self.settings(name) if setting.owner == name or setting.setter in changed]

    def tells(self, name):
        found = {}
        for base in self.chain(name):
            found.update(base.tells)
        for setting in self.settings(name):
            found.pop(setting.setter[3:], None)
        return found


def inherit(setting, base, tags):
    """A setter that a subclass declares again says what differs."""
    setting.name = base.name
    for field in ("text", "word", "keyword", "off", "off_text", "group", "title", "unit", "range", "choices", "columns", "when", "files", "advanced", "panel", "unset", "rest", "flat", "names", "colour", "clear"):
        if not getattr(setting, field) or (field == "range" and "range" not in tags):
            setattr(setting, field, getattr(base, field))
    if base.kind in ("choice", "file"):
        setting.kind = base.kind


def stem(word):
    """YoungsModuli and YoungsModulus, Notches and Notch, StatesAtStrains and StateAtStrain: the same."""
    parts = re.findall(r"[A-Z][a-z0-9]*", word)
    return tuple(re.sub(r"(ies|ys|y|us|i|es|(?<!s)s|e)$", "", part) for part in parts)
