# SPDX-License-Identifier: GPL-3.0-or-later
"""Many clients of one daemon: memory of each, viewers of one view, a slow link beside a good one, clients that take nothing; and how
soon the first picture is there."""

import os
import re
import subprocess
import time
import urllib.request

from demo_plant import DemoPlant, probe_result
from rows import row

LIMITS = ["address-sessions=1000", "address-connections=1200", "address-messages=100000", "messages=10000", "least-fps=0"]
OPTIONS = [word for limit in LIMITS for word in ("--limit", limit)]
STILL, VIEWERS, VIEWER_HZ, STALLED = 50, 500, 10, 50
SLOW_BYTES_PER_S, SLOW_DELAY_MS = 125000, 100


def resident_mb(plant):
    with open("/proc/%d/status" % plant.running[-1].pid) as f:
        return int(re.search(r"VmRSS:\s+(\d+)", f.read()).group(1)) / 1024


def counters(plant, *names):
    """Sums over their labels."""
    with urllib.request.urlopen(plant.url + "metrics") as answer:
        text = answer.read().decode()
    return [sum(int(value) for value in re.findall(r"^%s(?:\{[^}]*\})? (\d+)" % name, text, re.M)) for name in names]


def still_crowd_rows(plant, codec, goal_mb):
    """Different views that stand still while readings change."""
    label = "still_x%d_%s" % (STILL, codec)
    size = ("--size", "1280x720", "--codec", codec, "--motion", "still")
    one = plant.start_probe("--sessions", 1, "--seconds", 6, *size)
    time.sleep(5)
    alone = resident_mb(plant)
    probe_result(one)
    many = plant.start_probe("--sessions", STILL, "--spread", "--blind", "--seconds", 25, *size)
    time.sleep(22)
    beside = resident_mb(plant)
    found, why = probe_result(many)
    yield row(label + "_mb_each", None if why else round((beside - alone) / (STILL - 1), 1), "MB", ("<=", goal_mb), why=why)
    yield row(label + "_updates_per_s", None if why else round(found["fps_lowest"], 2), "1/s", (">=", 0.95), why=why)


def viewer_rows(plant):
    """All follow the first, whose camera moves; counted once all are there and the quality has settled."""
    names = ("plantcast_renders_total", "plantcast_encodes_total", "plantcast_frames_sent_total")
    probe = plant.start_probe("--sessions", VIEWERS, "--follow", "--blind", "--hz", VIEWER_HZ, "--seconds", 20, "--size", "1280x720")
    time.sleep(7)
    before = counters(plant, *names)
    time.sleep(10)
    after = counters(plant, *names)
    found, why = probe_result(probe)
    if why or not found["behind_leader_ms"]:
        yield row("viewers_%d" % VIEWERS, None, "", why=why or "nobody saw a camera of the one they follow")
        return
    renders, encodes, sent = (new - old for new, old in zip(after, before))
    pictures = max(1, sent / VIEWERS)
    yield row("viewers_%d_fps" % VIEWERS, round(found["fps_lowest"], 1), "1/s", (">=", 0.95 * VIEWER_HZ))
    yield row("viewers_%d_behind_ms" % VIEWERS, round(found["behind_leader_ms"]["max"], 1), "ms", ("<=", 200),
              p95=round(found["behind_leader_ms"]["p95"], 1))
    yield row("viewers_%d_renders_per_frame" % VIEWERS, round(renders / pictures, 1), "", ("<=", 1))
    yield row("viewers_%d_encodes_per_frame" % VIEWERS, round(encodes / pictures, 1), "", ("<=", 1))
    yield row("viewers_%d_kb_per_frame" % VIEWERS, round(found["kb_per_frame"], 1), "kB", ("<=", 60))


def slow_rows(plant, relay_program):
    """One at 1280x720 alone, then beside one on a slow link."""
    fast = ("--size", "1280x720", "--seconds", 8, "--motion", "orbit")
    alone, why = plant.probe(*fast)
    relay = subprocess.Popen([relay_program, str(plant.port), str(SLOW_BYTES_PER_S), str(SLOW_DELAY_MS)], stdin=subprocess.PIPE,
                             stdout=subprocess.PIPE, text=True)
    port = int(relay.stdout.readline().split()[-1])
    command = [os.path.join(plant.bin_folder, "plantcast"), "probe", "http://127.0.0.1:%d/" % port, "--json", "--size", "1280x720",
               "--seconds", "14"]
    slow = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    time.sleep(3)
    beside, why_beside = plant.probe(*fast)
    found, why_slow = probe_result(slow)
    relay.stdin.close()
    relay.wait()
    why = why or why_beside or why_slow
    yield row("slow_beside_fps_kept_percent", None if why else round(100 * beside["fps"] / alone["fps"], 1), "%", (">=", 95), why=why)
    yield row("slow_1mbit_oldest_ms", None if why else round(found["input_to_frame_ms"]["max"], 0), "ms", ("<=", 1000),
              p95=None if why else round(found["input_to_frame_ms"]["p95"], 0), why=why)
    yield row("slow_1mbit_fps", None if why else round(found["fps"], 1), "1/s", why=why)


def stalled_rows(plant):
    """Those who have a picture and then read nothing more, while another moves."""
    awake, why = plant.probe("--sessions", STALLED + 1, "--blind", "--seconds", 4, "--motion", "orbit", "--size", "1280x720")
    before = resident_mb(plant)
    stalled = plant.start_probe("--sessions", STALLED + 1, "--stall", STALLED, "--seconds", 10, "--motion", "orbit", "--size", "1280x720")
    time.sleep(9)
    more = resident_mb(plant) - before
    why = why or probe_result(stalled)[1]
    yield row("stalled_%d_mb" % STALLED, None if why or not awake else round(more, 1), "MB", ("<=", 5), why=why)


def start_rows(bin_folder):
    with DemoPlant(bin_folder) as plant:
        if plant.failed:
            yield row("start_to_first_frame_s", None, "s", ("<=", 1), why=plant.failed)
            return
        started = time.monotonic() - plant.daemon_began
        found, why = plant.probe("--seconds", 0.2, "--size", "1280x720")
        first_s = None if why else started + found["first_frame_ms"]["p50"] / 1000
        yield row("start_to_first_frame_s", None if why else round(first_s, 2), "s", ("<=", 1), why=why)


def crowd_rows(out, bin_folder):
    yield from start_rows(bin_folder)
    for codec, goal_mb in (("jpeg", 20), ("h264", 40)):
        with DemoPlant(bin_folder, *OPTIONS) as plant:
            yield from still_crowd_rows(plant, codec, goal_mb)
    with DemoPlant(bin_folder, *OPTIONS) as plant:
        yield from viewer_rows(plant)
        yield from slow_rows(plant, os.path.join(out, "tests/relay/relay"))
        yield from stalled_rows(plant)
