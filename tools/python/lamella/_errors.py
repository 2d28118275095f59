"""Errors, and running a VTK algorithm so that its errors become exceptions."""

from __future__ import annotations

import re
from collections.abc import Mapping

from vtkmodules.vtkCommonCore import VTK_OBJECT

from .vtkLamellaSolversVTK import vtkSampleAlgorithm


class LamellaError(RuntimeError):
    """Something that you can mend. ``hint`` says how."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(f"{message} ({hint})" if hint else message)
        self.message = message
        self.hint = hint


class InputError(LamellaError):
    """A file, picture, table or array that cannot be used as it is."""


class ParameterError(LamellaError, ValueError):
    """A value out of its range, a word that is none, or values that contradict each other."""


class NoPathError(LamellaError):
    """The problem has no answer: nothing conducts, or carries the load, from end to end."""


class OutOfMemoryError(LamellaError, MemoryError):
    """More memory is needed than there is; the message says how much."""


class DivergenceError(LamellaError):
    """An iteration that diverged or stagnated."""


_KINDS = {
    vtkSampleAlgorithm.INPUT_FAILURE: InputError,
    vtkSampleAlgorithm.PARAMETER_FAILURE: ParameterError,
    vtkSampleAlgorithm.NO_PATH_FAILURE: NoPathError,
    vtkSampleAlgorithm.MEMORY_FAILURE: OutOfMemoryError,
    vtkSampleAlgorithm.DIVERGENCE_FAILURE: DivergenceError,
}


def last_failure():
    """What the classes ended with last, as the exception that stands for it; None: nothing. It is forgotten."""
    kind = vtkSampleAlgorithm.LastFailure()
    if kind == vtkSampleAlgorithm.NO_FAILURE:
        return None
    error = _KINDS.get(kind, LamellaError)(vtkSampleAlgorithm.LastMessage(), vtkSampleAlgorithm.LastHint())
    vtkSampleAlgorithm.ForgetLastFailure()
    return error


class Cancelled(LamellaError):
    """The ``progress`` function returned False; nothing was kept."""


def _parse(text):
    """What vtkErrorMacro was given, without VTK's own words around it."""
    text = re.sub(r"^(ERROR|Warning): In .*?, line \d+\n", "", text.strip())
    text = re.sub(r"^vtk\w+ \(0x[0-9a-f]+\): ", "", text)
    message, _, hint = text.partition("\nhint: ")
    return message.strip(), hint.strip()


def collect_warnings(algorithm):
    """A list that fills with what an algorithm warns of while it runs, which is not printed then."""
    texts = []

    def on_warning(_caller, _event, text):
        texts.append(_parse(text)[0])

    on_warning.CallDataType = "string0"
    algorithm.AddObserver("WarningEvent", on_warning)
    return texts


def choose(table, value, what):
    """The entry of a table, or an error that names all of them."""
    try:
        return table[value.lower() if isinstance(value, str) else value]
    except (KeyError, TypeError):
        known = ", ".join(repr(key) for key in table)
        named = str(value) if isinstance(value, str) else value  # NumPy 2 would say np.str_('…')
        raise ValueError(f"{what} is {named!r}; it can be {known}") from None


def entries(table, what, form):
    """Keys and values of a dictionary, none of None, or an error that says what it is to hold."""
    if table is None:
        return []
    if not isinstance(table, Mapping):
        raise TypeError(f"{what} is of type {type(table).__name__}; give a dictionary, {form}")
    return list(table.items())


def number(value, what):
    """A number as VTK takes it, or an error that says which it was."""
    try:
        return float(value)
    except (TypeError, ValueError):
        kind = TypeError if not isinstance(value, str) else ValueError
        raise kind(f"{what} is {value!r}; give a number") from None


def run(algorithm, progress=None, on_step=None, state=None):
    """Updates an algorithm. Raises LamellaError for what it reports, and what ``progress`` or Ctrl-C raised.

    ``progress(share, text)`` is called with the share done, from 0 to 1; returning False cancels.

    ``on_step(state(data))`` is called with each state that the run comes to, data being its vtkDataObject; of the states
    only the last one is kept then.
    """
    errors = []  # of VTK's own classes, in its words
    stopped = []

    def on_error(_caller, _event, text):
        errors.append(_parse(text))

    on_error.CallDataType = "string0"

    def on_progress(caller, _event):
        try:  # an exception must not vanish in VTK
            if progress is not None and progress(caller.GetProgress(), caller.GetProgressText() or "") is False:
                stopped.append(Cancelled("cancelled"))
        except BaseException as exception:  # pylint: disable=broad-except
            stopped.append(exception)
        if stopped:
            caller.SetAbortExecute(1)

    def on_state(caller, _event, data):
        if stopped:
            return
        try:
            on_step(data if state is None else state(data))
        except BaseException as exception:  # pylint: disable=broad-except
            stopped.append(exception)
            caller.SetAbortExecute(1)

    on_state.CallDataType = VTK_OBJECT

    executive = algorithm.GetExecutive()
    tags = [
        (algorithm, algorithm.AddObserver("ErrorEvent", on_error)),
        (executive, executive.AddObserver("ErrorEvent", lambda *_: None)),  # only says that the algorithm failed
        (algorithm, algorithm.AddObserver("ProgressEvent", on_progress)),
    ]
    if on_step is not None:
        algorithm.KeepStatesOff()
        tags.append((algorithm, algorithm.AddObserver(vtkSampleAlgorithm.STEP_EVENT, on_state)))
    vtkSampleAlgorithm.ForgetLastFailure()
    try:
        algorithm.Update()
    finally:
        for caller, tag in tags:
            caller.RemoveObserver(tag)
        algorithm.SetAbortExecute(0)
    if stopped:
        raise stopped[0]
    failure = last_failure()
    if failure is not None:
        raise failure
    if errors:
        raise LamellaError(*errors[0])
