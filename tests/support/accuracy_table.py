# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of distances along surfaces, as the tests print them, in a table of shape and fault."""
import re

FAULTS = ["clean", "triangle soup", "hair gaps", "repeated, turned", "hanging vertices", "non-manifold"]
LINE = re.compile(r"^# (.+?)\s+(%s)\s.*?mean ([\d.]+) %%\s+worst ([\d.]+) %%" % "|".join(FAULTS))


def read(outputs):
    """{shape: {fault: (mean, worst)}} in percent of the largest distance, the largest of each that the outputs hold."""
    found = {}
    for output in outputs:
        for shape, fault, mean, worst in (m.groups() for m in map(LINE.match, output.splitlines()) if m):
            cell = found.setdefault(shape, {}).get(fault, (0, 0))
            found[shape][fault] = max(cell[0], float(mean)), max(cell[1], float(worst))
    return found


def rows(found):
    """Lists of text, the head first."""
    yield ["shape"] + FAULTS
    for shape, cells in found.items():
        yield [shape] + ["%.3f / %.2f" % cells[fault] if fault in cells else "" for fault in FAULTS]
