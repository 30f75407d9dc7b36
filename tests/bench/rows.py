# SPDX-License-Identifier: GPL-3.0-or-later
"""One row of the bench's table, and how many instances and sensors the paper's experiments have there."""

COUNTS = {"instances": (1, 5, 25, 100, 400), "sensors": (5, 10, 20, 32, 64, 128, 256, 512, 1024, 4096)}
EXTRAS = ("cpu", "tier", "coverage", "triangles", "columns_per_s", "frames", "values_per_s", "kept_percent", "note")


def row(name, value, unit, goal=None, p95=None, why=None, extras=None):
    """goal: (relation, number), relation one of <= and >=. extras: more that a row tells, by the names in EXTRAS."""
    ok = value is not None and (goal is None or (value <= goal[1] if goal[0] == "<=" else value >= goal[1]))
    found = {"name": name, "value": value, "p95": p95, "unit": unit, "goal": "%s %g" % goal if goal else None, "ok": ok}
    if why:
        found["why"] = why
    found.update(extras or {})
    return found
