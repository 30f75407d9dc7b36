# SPDX-License-Identifier: GPL-3.0-or-later
"""One picture over the displays of a wall, whose camera moves (wall_tiles.mjs)."""

import json
import os
import subprocess

from rows import row


def script_rows(bin_folder, name, script, *args):
    env = dict(os.environ, PLANTCAST_BIN=bin_folder)
    done = subprocess.run(["node", "tests/bench/" + script] + list(args), stdout=subprocess.PIPE, text=True, env=env)
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not lines:
        yield row(name, None, "", why="exit status %d, %d rows" % (done.returncode, len(lines)))
    for found in lines:
        goal = found.get("goal")
        extras = {"note": found["note"]} if "note" in found else None
        yield row(found["name"], found["value"], found["unit"], tuple(goal) if goal else None, found.get("p95"), found.get("why"), extras)


def wall_rows(bin_folder):
    for codec in ("h264", "jpeg"):
        yield from script_rows(bin_folder, "wall_3x2_1080p_%s" % codec, "wall_tiles.mjs", codec)
