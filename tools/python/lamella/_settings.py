"""Settings of the classes as keywords of functions: all that a class declares in its header, declared here no second time."""

from __future__ import annotations

import collections
import difflib
import functools
import inspect
import os
import warnings

import numpy as np

from ._declared import BASES, CLASSES, WITHOUT
from ._errors import ParameterError, entries, last_failure, number
from .vtkLamellaSolversVTK import vtkSampleAlgorithm

_PROGRESS = "progress        called as progress(share, text); return False to cancel (raises Cancelled)"

Setting = collections.namedtuple("Setting", "keyword setter kind types default words columns word hint lines when rest flat")


def pair(name):
    """A pair of phases as the classes write it."""
    return "-".join(map(str, name)) if isinstance(name, tuple) else str(name)


class Settings:
    """What one call was given of a class's settings, as it was written there. None stands for the class's own default."""

    def __init__(self, table, values):
        self.table, self.values = table, values

    def __getitem__(self, keyword):
        """What was given, or the default."""
        value = self.values.get(keyword)
        return self.table[keyword].default if value is None else value

    def give(self, algorithm, check_names=None):
        """Sets them. @param check_names called with names of pairs, or of phases, and whether they are pairs"""
        for keyword, value in self.values.items():
            if value is not None:
                setting = self.table[keyword]
                getattr(self, "_" + setting.kind)(algorithm, setting, value, check_names)
        for keyword, value in self.values.items():
            setting = self.table[keyword]
            if value is not None and setting.when and not np.array_equal(value, setting.default):
                self._require(algorithm, setting)

    def _require(self, algorithm, setting):
        """Refuses what was given and does not count, in the words of every front end."""
        other, counts, said = setting.when
        found = self.table.get(other)
        getter = getattr(algorithm, "Get" + found.setter[3:], None) if found else None
        if getter is not None and int(getter()) not in counts:
            name = setting.word.replace("-", " ")
            raise ParameterError(f"{name} counts only with {said}", f"leave {name} out, or choose {said}")

    @staticmethod
    def _switch(algorithm, setting, value, _check):
        getattr(algorithm, setting.setter)(bool(value))

    @staticmethod
    def _whole(algorithm, setting, value, _check):
        value = (setting.words or {}).get(value, value) if isinstance(value, str) else value
        getattr(algorithm, setting.setter)(_whole(value, setting.keyword))

    def _number(self, algorithm, setting, value, check):
        if isinstance(value, dict) or (hasattr(value, "keys") and hasattr(value, "items")):
            self._by_phase(algorithm, setting, value, check)
        else:
            getattr(algorithm, setting.setter)(number(value, setting.keyword))

    @staticmethod
    def _by_phase(algorithm, setting, table, check):
        """Of a number of the whole sample: one for each of some phases."""
        constant = getattr(algorithm, "SetPhaseConstant", None)
        single = getattr(algorithm, "SetPhase" + setting.setter[3:], None)
        if constant is None and single is None:
            raise TypeError(f"{setting.keyword} is of type {type(table).__name__}; give a number")
        if check is not None and single is not None:
            check([str(phase) for phase in table], False)
        for phase, value in table.items():
            found = number(value, f"{setting.keyword} of {phase!r}")
            if single is not None:
                single(str(phase), found)
            else:
                constant(str(phase), setting.word, found)

    @staticmethod
    def _known(algorithm, setting, value):
        """A word that the setting has. @raises ParameterError"""
        word = value.lower() if isinstance(value, str) else str(value)
        if word not in setting.words:
            vtkSampleAlgorithm.ForgetLastFailure()
            vtkSampleAlgorithm.FindChoice(algorithm.GetClassName(), setting.word, word)
            raise last_failure() or ParameterError(f"{setting.keyword} is {value!r}", f"it can be {', '.join(setting.words)}")
        return word

    @staticmethod
    def _choice(algorithm, setting, value, _check):
        getattr(algorithm, setting.setter)(setting.words[Settings._known(algorithm, setting, value)])

    @staticmethod
    def _text(algorithm, setting, value, _check):
        getattr(algorithm, setting.setter)(Settings._known(algorithm, setting, value) if setting.words else pair(value))

    @staticmethod
    def _file(algorithm, setting, value, _check):
        getattr(algorithm, setting.setter)(os.fspath(value))

    @staticmethod
    def _vector(algorithm, setting, value, _check):
        whole = setting.types[0] == "whole"
        value = np.ravel(value).tolist() if setting.rest is not None else value
        if setting.rest is not None and len(value) == len(setting.types) - 1:
            value = [*value, value[-1] if setting.rest == "same" else setting.rest]
        if setting.flat and len(value) == len(setting.types) - len(setting.flat):
            value = list(value)
            for place in setting.flat:
                value.insert(place, 0)
        values = [_whole(part, setting.keyword) if whole else number(part, setting.keyword) for part in value]
        if len(values) != len(setting.types):
            raise ValueError(f"{setting.keyword} has {len(values)} numbers; give {len(setting.types)}"
                             + (f": {', '.join(setting.columns)}" if setting.columns else ""))
        getattr(algorithm, setting.setter)(*values)

    @staticmethod
    def _axes(algorithm, setting, value, _check):
        if set(value) - set("xyz"):
            raise ValueError(f"{setting.keyword} is {value!r}; it names axes, as 'xy'")
        getattr(algorithm, setting.setter)(*(int(axis in value) for axis in "xyz"))

    @staticmethod
    def _list(algorithm, setting, value, check):
        setter = getattr(algorithm, setting.setter)
        named = setting.types[0] == "text"
        if named and len(setting.types) == 1:
            for name in [value] if isinstance(value, (str, int)) else value:
                setter(str(name))
        elif named and len(setting.types) == 2:
            numbers = setting.types[1] == "number"
            rows = entries(value, setting.keyword, f"{{{setting.columns[0].lower()}: {'value' if numbers else setting.columns[1].lower()}}}")
            if check is not None and setting.columns[0] in ("Bonds", "Phase"):
                check([pair(name) for name, _ in rows], setting.columns[0] == "Bonds")
            for name, other in rows:
                setter(pair(name), number(other, f"{setting.keyword} of {name!r}") if numbers else pair(other))
        elif len(setting.types) == 1:
            for part in np.ravel(value):
                setter(int(part) if setting.types[0] == "whole" else float(part))
        else:
            for row in value:
                parts = [float(part) for part in np.ravel(row)]
                if len(parts) == 9 and hasattr(algorithm, setting.setter + "InSpace"):
                    getattr(algorithm, setting.setter + "InSpace")(parts[:3], parts[3:6], parts[6:])
                elif len(parts) == len(setting.types):
                    setter(*parts)
                else:
                    raise ValueError(f"a {setting.word} has {len(parts)} numbers; give {', '.join(setting.columns)}")


def _whole(value, what):
    found = number(value, what)
    if found != int(found):
        raise ValueError(f"{what} is {value!r}; give a whole number")
    return int(found)


def keywords_of(kind, words):
    """Keywords of a class's settings, by their words in a command; of words that it does not have none."""
    found, name = [], kind.__name__
    while name in CLASSES:
        found += [row.keyword for row in (Setting(*row) for row in CLASSES[name]) if row.word in words]
        name = BASES.get(name)
    return found


def declared(kind, first=(), without=(), defaults=None, formerly=None, choice=None, hints=None):
    """Gives a function the settings of a class as keywords, in place of its parameter ``settings``, which is then a Settings.

    first     keywords of settings that may be given by position, behind the parameters before ``settings``
    without   keywords of settings that the function has no use for, or sees to itself
    choice    (keyword, word) that the function has taken: settings that do not count with it are left out
    defaults  {keyword: value} where the function's is not the class's
    hints     {keyword: hint of its type} where the function takes more than the class
    formerly  {word of an earlier version: keyword, or a function that makes {keyword: value} of its value}
    """
    table, name, gone = {}, kind.__name__, ()
    while name in CLASSES:
        gone += WITHOUT.get(name, ())
        rows = [Setting(*row) for row in CLASSES[name]]
        if choice:
            value = next(row.words[choice[1]] for row in rows if row.keyword == choice[0])
            rows = [row for row in rows if not row.when or row.when[0] != choice[0] or value in row.when[1]]
        table = {**{row.keyword: row for row in rows}, **table}
        name = BASES.get(name)
    fixed = {choice[0]: choice[1]} if choice else {}
    whole = {keyword: setting for keyword, setting in table.items() if keyword not in without and keyword not in gone}
    table = {keyword: setting for keyword, setting in whole.items() if keyword not in fixed}
    table.update({keyword: table[keyword]._replace(default=value) for keyword, value in (defaults or {}).items()})
    table.update({keyword: table[keyword]._replace(hint=hint) for keyword, hint in (hints or {}).items()})

    def decorate(function):
        own = inspect.signature(function)
        parameters, later, others = [], [], []
        for parameter in own.parameters.values():
            if parameter.name == "settings":
                parameters += [_parameter(table[keyword], inspect.Parameter.POSITIONAL_OR_KEYWORD) for keyword in first]
                later = [_parameter(setting, inspect.Parameter.KEYWORD_ONLY) for name, setting in table.items() if name not in first]
            elif parameter.kind is inspect.Parameter.VAR_KEYWORD:
                others.append(parameter)
            elif later:
                later.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            else:
                parameters.append(parameter)
        signature = own.replace(parameters=parameters + later + others)

        @functools.wraps(function)
        def call(*given, **keywords):
            for old, new in (formerly or {}).items():
                if old in keywords:
                    value = keywords.pop(old)
                    found = new(value) if callable(new) else {new: value}
                    warnings.warn(f"{function.__name__}(): {old} is now called {', '.join(found)}; the next version does not know {old} any more",
                                  FutureWarning, stacklevel=2)
                    keywords = {**found, **keywords}
            for name in keywords:
                if name not in signature.parameters and not others:
                    near = difflib.get_close_matches(name, signature.parameters, 1)
                    hint = f"; did you mean {near[0]!r}?" if near else f"; it takes {', '.join(signature.parameters)}"
                    raise TypeError(f"{function.__name__}() got an unexpected keyword argument {name!r}{hint}")
            try:
                bound = signature.bind(*given, **keywords).arguments
            except TypeError as error:
                raise TypeError(f"{function.__name__}(): {error}; give settings by name") from None
            values = {**fixed, **(defaults or {}), **{name: value for name, value in bound.items() if name in table}}
            mine = {name: value for name, value in bound.items() if name not in table}
            for parameter in others:
                mine.update(mine.pop(parameter.name, {}))
            return function(settings=Settings({**table, **{name: whole[name] for name in fixed}}, values), **mine)

        call.__signature__ = signature
        told = inspect.cleandoc(function.__doc__ or "")  # Python 3.13 keeps docstrings without their margin
        lines = [_PROGRESS] if "progress" in own.parameters and "\nprogress " not in told else []
        lines += [line for name in [*first, *(name for name in table if name not in first)] for line in table[name].lines]
        call.__doc__ = "\n".join([told, "", *lines])
        return call

    return decorate


def _parameter(setting, kind):
    return inspect.Parameter(setting.keyword, kind, default=setting.default, annotation=setting.hint)
