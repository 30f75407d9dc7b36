# SPDX-License-Identifier: GPL-3.0-or-later
"""Extracts from TAP output why a test failed, in a few lines: first and last lines are the most informative."""

import os
import re

RESULT = re.compile(r"^(\s*)(not ok|ok)\b\s*(\d*)\s*(?:-\s*)?(.*)$")
MOST_LINES, MOST_CHARACTERS, MOST_PLACES = 7, 180, 3
DIFFERS = re.compile(r"^[+-] {2,}")
FIELD = re.compile(r"^\s*(\w+): ?(.*)$")
SEED = re.compile(r"\bseed\b", re.I)
BEFORE = 3      # lines of output before a C test's result
LAST_WORDS = 5  # last lines of a program that ended without a result
C_PLACE = re.compile(r"^(# )?\S+:\d+: error:|^# Test failed with exception")
# Lines that identify the failure within a long report.
HEADLINE = re.compile(r"ERROR: \w*Sanitizer|WARNING: ThreadSanitizer|runtime error:|SUMMARY: ")


def shortened(lines, most=MOST_LINES):
    kept = [line.rstrip() for line in lines if line.strip()]
    if len(kept) > most:
        kept = kept[:most - 1] + kept[-1:]
    return [line if len(line) <= MOST_CHARACTERS else line[:MOST_CHARACTERS - 3] + "..." for line in kept]


def of_result(lines, at):
    """lines: what the program printed; lines[at]: `not ok ...`."""
    end = next((i for i in range(at + 1, len(lines)) if RESULT.match(lines[i])), len(lines))
    after = lines[at + 1:end]
    return shortened(of_yaml(after) if after and after[0].strip() == "---" else of_c(lines, at, after))


def of_end(lines):
    """Of a program that ended badly, its tests all being well, or without a word of them."""
    heads = [line for line in lines if HEADLINE.search(line)]
    return shortened(heads or [line for line in lines if line.strip()][-LAST_WORDS:])


def of_yaml(block):
    """What node says: the error, and where it was, in helpers and in the test; where nothing says so, where the test begins."""
    fields = read_yaml(block)
    places = [place(text) for text in fields.get("stack", [])]
    places = [text for text in dict.fromkeys(places) if text] or [place(text) for text in fields.get("location", [])]
    error = fields.get("error", [])
    apart = [line for line in error[2:] if DIFFERS.match(line)]  # differing lines of two large values
    what = shortened(error[:1] + apart if apart else error, MOST_LINES - 1)
    return what + ["at " + " < ".join(text for text in places[:MOST_PLACES] if text)]


def read_yaml(block):
    """Fields of the uppermost level, each a list of lines."""
    indent = len(block[0]) - len(block[0].lstrip())
    fields, name = {}, None
    for line in block[1:]:
        own = len(line) - len(line.lstrip()) == indent and FIELD.match(line)
        if line.strip() == "...":
            break
        if own:
            name, text = own.groups()
            fields[name] = [] if text in ("|-", "|", ">-", "") else [text.strip("'\"")]
        elif name:
            fields[name].append(line[indent + 2:])
    return fields


def place(text):
    """tests/e2e/x.mjs:66:12 of a line that names a file of the tests."""
    found = re.search(r"(?:file://)?([\w./-]*\.m?js:\d+:\d+)", text)
    if not found or "node:" in text or "node_modules" in text:
        return None
    path = found.group(1)
    return os.path.relpath(path) if path.startswith("/") else path


def of_c(lines, at, after):
    """What a C test says: what did not hold, what it printed itself, the seed of it all, and where."""
    begin = next((i for i in range(at - 1, -1, -1) if RESULT.match(lines[i]) or C_PLACE.match(lines[i])), -1)
    said = next((i + 1 for i, line in enumerate(after) if C_PLACE.match(line)), 1)
    what = [line for line in after[:said] if line.startswith("#") or C_PLACE.match(line)]
    before = [line for line in lines[begin + 1:at] if not re.match(r"1\.\.\d+$|TAP version", line)][-BEFORE:]
    seed = [line for line in lines[:at] if SEED.search(line)][-1:]
    return what[:-1] + before + [line for line in seed if line not in before] + what[-1:]
