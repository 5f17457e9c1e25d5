# SPDX-License-Identifier: BSD-3-Clause
"""Keywords of an input of CalculiX or Abaqus, with their lines; faults are collected and told all at once."""

import math
from dataclasses import dataclass, field
from pathlib import Path

MOST_INCLUDES = 20  # of files within files
LARGEST = 2**52  # whole numbers beyond are not exact


class InpError(Exception):
    """What cannot be converted; each fault with its file and line."""

    def __init__(self, faults):
        super().__init__("\n".join(faults))
        self.faults = faults


def number_of(text, place):
    """A finite number, also with Fortran's exponent D. Raises ValueError with the place."""
    try:
        value = float(text.replace("D", "E"))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{place}: \"{text}\" is not a number")
    return value


@dataclass
class Row:
    """A line of data: where it is, and its texts between commas; upper case, without blanks, which
    mean nothing in names either."""

    place: str
    texts: list

    def number(self, k, default=None):
        """Number k of the line. Raises ValueError, with the place, where it is none."""
        text = self.texts[k] if k < len(self.texts) else ""
        if text == "":
            if default is not None:
                return default
            raise ValueError(f"{self.place}: number {k + 1} of the line is missing")
        return number_of(text, self.place)

    def integer(self, k, default=None):
        value = self.number(k, default)
        if value != int(value) or abs(value) > LARGEST:
            raise ValueError(f"{self.place}: \"{self.text(k)}\" is not a whole number")
        return int(value)

    def text(self, k):
        return self.texts[k] if 0 <= k < len(self.texts) else ""


@dataclass
class Keyword:
    """*NAME, OPTION=VALUE, FLAG and its lines of data."""

    name: str  # "SOLID SECTION", without the star
    options: dict  # upper case; flags have the value ""
    place: str
    rows: list = field(default_factory=list)

    @property
    def key(self):
        """The name without blanks, hyphens and underscores, which may be left out."""
        return self.name.replace(" ", "").replace("-", "").replace("_", "")

    def option(self, name, default=""):
        return self.options.get(name, default)


def _keyword(line, place):
    head, *rest = [" ".join(text.split()) for text in line[1:].split(",")]
    options = {}
    for text in rest:
        name, _, value = text.partition("=")
        if name.strip():
            options[name.strip().upper()] = "".join(value.split()).strip('"').upper()
    return Keyword(head.upper(), options, place)


def read(path, depth=0):
    """All keywords of a file and of those that it includes. Raises InpError, OSError."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise InpError([f"{path}: cannot be read: {error.strerror}"]) from None
    keywords, pending, start = [], "", 0
    for number, line in enumerate(text.splitlines(), 1):
        line = line.strip()
        if line.startswith("**") or not line:
            continue
        place = f"{path.name}, line {start if pending else number}"
        if line.startswith("*") or pending:
            pending, start = pending + line, start if pending else number
            if line.endswith(","):  # goes on in the next line
                continue
            keyword, pending = _keyword(pending, place), ""
            if keyword.name == "INCLUDE":
                keywords += _included(keyword, path, depth)
            else:
                keywords.append(keyword)
        elif keywords:
            texts = ["".join(part.split()).upper() for part in line.split(",")]
            while texts and texts[-1] == "":
                texts.pop()
            keywords[-1].rows.append(Row(place, texts))
        else:
            raise InpError([f"{place}: data before the first keyword; is this an input of CalculiX?"])
    return keywords


def _included(keyword, path, depth):
    if depth >= MOST_INCLUDES:
        raise InpError([f"{keyword.place}: files include each other without end"])
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    name = lines[int(keyword.place.rsplit(" ", 1)[1]) - 1].partition("=")[2].strip().strip('"')
    try:
        return read(path.parent / name, depth + 1)
    except InpError as error:
        raise InpError([f"{keyword.place}: {fault}" for fault in error.faults]) from None
