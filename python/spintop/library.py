"""The shared library: where it is, its functions, and its errors as exceptions."""

import ctypes
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from ctypes import CFUNCTYPE, POINTER, c_char_p, c_double, c_int, c_longlong, c_size_t, c_void_p
from functools import cache
from pathlib import Path
from typing import Any

INTERFACE = 1
"""The interface of the library for which this package is written."""
NAME = f"libspintop.so.{INTERFACE}"


class SpintopError(Exception):
    """What the library says is wrong: the message of the program, in one or more lines."""

    code: int
    """The exit code of the program for it."""
    status: str
    """How a motion failed, as in the column `status` of tables; empty for other errors."""
    source: str
    """The input or file with the first wrong place; empty if there is none."""
    line: int
    """The line of that place, from 1; 0 if there is none."""
    column: int
    """Its column, in bytes from 1; 0 if there is none."""

    def __init__(self, message: str, *, code: int = 5, status: str = "") -> None:
        """Make an error without a place."""
        super().__init__(message)
        self.code, self.status, self.source, self.line, self.column = code, status, "", 0, 0


class InputError(SpintopError, ValueError):
    """The input is wrong: nothing was computed."""


class InputWarning(UserWarning):
    """What the program warns of in the input of a top."""


class MotionError(SpintopError):
    """A motion could not be computed up to the last time: `status` says why."""


class OutputError(SpintopError, OSError):
    """A result could not be written."""


EXCEPTIONS = {2: InputError, 3: MotionError, 4: OutputError}


class CError(ctypes.Structure):
    """`spintop_error` of the header."""

    _fields_ = (
        *((name, c_int) for name in ("code", "line", "column", "reserved")),
        *((name, c_char_p) for name in ("status", "message", "source")),
        ("owner", c_void_p),
    )


class CColumn(ctypes.Structure):
    """`spintop_column` of the header."""

    _fields_ = (
        *((name, c_char_p) for name in ("name", "unit", "what")),
        ("values", c_void_p),
        ("words", POINTER(c_char_p)),
        ("word_count", c_longlong),
    )


class CTable(ctypes.Structure):
    """`spintop_table` of the header."""

    _fields_ = (
        ("name", c_char_p),
        ("columns", POINTER(CColumn)),
        *((name, c_longlong) for name in ("column_count", "row_count")),
        ("frame", c_char_p),
    )


class CResult(ctypes.Structure):
    """`spintop_result` of the header."""

    _fields_ = (
        *((name, c_int) for name in ("code", "table_count")),
        ("tables", POINTER(CTable)),
        *((name, c_char_p) for name in ("summary", "warnings")),
        ("owner", c_void_p),
    )


ERROR = POINTER(POINTER(CError))
NAMES = POINTER(c_char_p)
ARRAYS = POINTER(c_void_p)
PROGRESS = CFUNCTYPE(c_int, c_double, c_void_p)
FUNCTIONS = {
    "interface": (c_int,),
    "version": (c_char_p,),
    "error_delete": (None, POINTER(CError)),
    "top_new": (c_void_p, c_char_p, c_char_p, ERROR),
    "top_delete": (None, c_void_p),
    "top_warnings": (c_char_p, c_void_p),
    "top_column_count": (c_int, c_void_p),
    "top_columns": (POINTER(CColumn), c_void_p),
    "top_at": (c_int, c_void_p, c_size_t, c_void_p, c_void_p, ERROR),
    "top_events": (POINTER(CResult), c_void_p, ERROR),
    "on_progress": (None, PROGRESS, c_void_p),
    "run": (POINTER(CResult), c_char_p, c_char_p, c_char_p, c_int, ERROR),
    "sweep": (POINTER(CResult), c_char_p, c_int, NAMES, ARRAYS, c_size_t, c_int, ERROR),
    "result_delete": (None, POINTER(CResult)),
    "tops": (
        *(c_int, c_longlong, c_int, NAMES, ARRAYS, POINTER(c_longlong)),
        *(c_int, NAMES, ARRAYS, c_void_p, c_int, ERROR),
    ),
    "list": (c_void_p, c_char_p, c_int, ERROR),
}
"""The functions of the header without their prefix: the type of the result, those of arguments."""


def places() -> Iterator[Path]:
    """Where the library may be: in SPINTOP_LIBRARY, in this package, in a prefix, in a checkout."""
    if named := os.environ.get("SPINTOP_LIBRARY"):
        yield Path(named)
        return
    here = Path(__file__).resolve().parent
    yield chosen_folder(here) / NAME
    yield Path(sys.prefix) / "lib" / NAME
    yield here.parents[1] / "build" / "shared" / "lib" / NAME


@cache
def library() -> ctypes.CDLL:
    """The library, loaded when it is first needed. Its calls release the GIL."""
    found = next((path for path in places() if path.exists()), None)
    try:
        loaded = ctypes.CDLL(str(found) if found else NAME)
    except OSError as error:
        message = f"{error}: scripts/install makes the library; SPINTOP_LIBRARY names another place"
        raise ImportError(message) from error
    for name, (result, *arguments) in FUNCTIONS.items():
        function = getattr(loaded, f"spintop_{name}")
        function.restype, function.argtypes = result, arguments
    if loaded.spintop_interface() != INTERFACE:
        version = loaded.spintop_version().decode()
        raise ImportError(f"the library is of version {version}, with another interface")
    return loaded


def text_of(letters: bytes | None) -> str:
    """A text of C."""
    return (letters or b"").decode("utf-8", errors="replace")


def bytes_of(text: str) -> bytes:
    """A text for C."""
    encoded = text.encode("utf-8", errors="surrogateescape")
    if b"\0" in encoded:
        raise InputError("a text with a NUL character is no input", code=2)
    return encoded


def ask(name: str, *arguments: Any) -> Any:
    """What a function of the header gives, the last argument of which is the place of an error.

    The error is raised. Texts are given as str, and columns as a dict of arrays of numpy: C has the
    three arguments number, names and addresses.
    """
    given: list[Any] = []
    for argument in arguments:
        if isinstance(argument, str):
            given.append(bytes_of(argument))
        elif isinstance(argument, dict):
            count, places = len(argument), (array.ctypes.data for array in argument.values())
            given += [count, (c_char_p * count)(*map(bytes_of, argument))]
            given.append((c_void_p * count)(*places))
        else:
            given.append(argument)
    place = POINTER(CError)()
    result = getattr(library(), f"spintop_{name}")(*given, place)
    if not place:
        return result
    told = place.contents
    error = EXCEPTIONS.get(told.code, SpintopError)(text_of(told.message))
    error.code, error.line, error.column = told.code, told.line, told.column
    error.status, error.source = text_of(told.status), text_of(told.source)
    library().spintop_error_delete(place)
    raise error


VARIABLE = "SPINTOP_LEVEL"
"""The variable of the environment that chooses a lower level, as for the program."""
LINKER = re.compile(r"/\S+/ld-linux\S+")
"""The dynamic linker of glibc, wherever a system has it, among the files of a process."""


def levels() -> list[str]:
    """The levels of x86-64 that this processor has, from the lowest, as the dynamic linker says."""
    linker = LINKER.search(Path("/proc/self/maps").read_text(errors="surrogateescape"))
    if not linker:
        raise ImportError("spintop is built for processors by their levels, which glibc tells")
    asked = [linker[0], "--help"]
    said = subprocess.run(asked, capture_output=True, text=True, check=False).stdout
    return sorted(re.findall(r"x86-64-(v\d) \(supported", said))


def chosen_folder(package: Path) -> Path:
    """The folder with the library: that of the highest level of the processor, or the package.

    An ImportError says that SPINTOP_LEVEL names no level of the processor, or that the processor
    is older than the oldest for which there is a library.
    """
    if not any(package.glob("v[0-9]")):
        return package
    known = levels()
    if not known:
        raise ImportError("this processor is older than x86-64-v2, for which spintop is built")
    level = os.environ.get(VARIABLE) or known[-1]
    if level not in known:
        message = f"{VARIABLE} is '{level}', but the levels of this processor are: "
        raise ImportError(message + ", ".join(known))
    return package / level
