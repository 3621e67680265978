"""The last line of a complete table: the number of its rows, and the CRC-32 of its data.

    # end: 20 rows, CRC-32 9C2E1F05

The CRC-32 is that of zlib, over all bytes from the line of names to the last line. In NetCDF the
attribute `end` says the same of the rows as 64-bit numbers, row by row.
"""

import re
import zlib

import numpy as np

END = re.compile(r"(\d+) rows, CRC-32 ([0-9A-F]{8})")
KEY = b"# end: "


def problem_of_text(data: bytes) -> str | None:
    """What is wrong with a table; None if nothing is known to be, as there is no such line.

    The answer is empty for a table that is as it was written.
    """
    data = data.replace(b"\r\n", b"\n")
    start = 0 if data.startswith(KEY) else data.rfind(b"\n" + KEY) + 1
    if not data[start:].startswith(KEY):
        return None
    last = data[start:].decode("ascii", errors="replace")
    if last.count("\n") != 1 or not last.endswith("\n"):
        return 'was changed after it was written: lines follow the one that begins with "# end:"'
    first = 0
    while data[first : first + 1] == b"#":
        first = data.index(b"\n", first) + 1
    rows = sum(not line.startswith(b"#") for line in data[first:start].split(b"\n")[:-1]) - 1
    return compare(last.removeprefix("# end: ").strip(), rows, zlib.crc32(data[first:start]))


def problem_of_cells(said: str, cells: list[np.ndarray]) -> str:
    """What is wrong with the columns of a NetCDF table; empty if they are as they were written."""
    rows = np.column_stack([column.astype("<f8") for column in cells])
    return compare(said, len(rows), zlib.crc32(rows.tobytes()))


def compare(said: str, rows: int, crc: int) -> str:
    """How the end of a table differs from what is there; empty if it does not."""
    match = END.fullmatch(said)
    if match and int(match[1]) == rows and int(match[2], 16) == crc:
        return ""
    if match and int(match[1]) != rows:
        difference = f"it has {rows} rows, and its end says {match[1]}"
    else:
        difference = "its rows do not have the CRC-32 of its end"
    return f"was changed after it was written: {difference}"
