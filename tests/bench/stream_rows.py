# SPDX-License-Identifier: GPL-3.0-or-later
"""What streaming the demo plant takes: rates and latencies while cameras move, and what a still view costs."""

import os
import random
import subprocess
import tempfile
import time

from demo_plant import DemoPlant, probe_result
from rows import row

SECONDS = 10
SIGNED_SECONDS = 6
PLAIN_SECONDS, PLAIN_TURNS = 4, 4
SETTLED_S = 3  # as the probe has it
STILL_TAGS = 60


def orbit_rows(plant):
    for sessions, size, codec in ((1, "1280x720", "jpeg"), (1, "1280x720", "h264"), (1, "1920x1080", "jpeg"), (1, "1920x1080", "h264"),
                                  (4, "1280x720", "jpeg")):
        label = "stream_%sp" % size.split("x")[1] + ("_x%d" % sessions if sessions > 1 else "") + ("_h264" if codec == "h264" else "")
        found, why = plant.probe("--sessions", sessions, "--seconds", SECONDS, "--motion", "orbit", "--size", size, "--codec", codec)
        if why or not found["input_to_frame_ms"]:
            yield row(label, None, "", why=why or "no frame showed a camera that was sent")
            continue
        full, one = size == "1920x1080", sessions == 1
        yield row(label + "_fps", round(found["fps"], 1), "1/s", (">=", 60) if one else None)
        yield row(label + "_input_p50_ms", round(found["input_to_frame_ms"]["p50"], 1), "ms", ("<=", 50 if full else 25) if one else None,
                  p95=round(found["input_to_frame_ms"]["p95"], 1))
        yield row(label + "_input_p99_ms", round(found["input_to_frame_ms"]["p99"], 1), "ms", ("<=", 100) if one and full else None)
        yield row(label + "_kb_per_frame", round(found["kb_per_frame"], 1), "kB")


def hold_all(plant):
    plant.hold({tag["name"]: tag["value"] for tag in plant.tags() if tag["value"] is not None})


def change_together(plant, seconds):
    """STILL_TAGS tags of the group that is shown first drift together, once a second."""
    tags = [tag for tag in plant.tags() if tag["value"] is not None]
    shown = [tag for tag in tags if tag["group"] == tags[0]["group"]][:STILL_TAGS]
    values = {tag["name"]: tag["value"] for tag in shown}
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        begun = time.monotonic()
        for name in values:
            values[name] += random.gauss(0, 0.3)
        plant.hold(values)
        time.sleep(max(0, begun + 1 - time.monotonic()))
    return len(values)


def still_rows(plant, label, codec, goals, work):
    """Bytes and processor time of one still view at 1920x1080, once it has settled; work(seconds): what the plant does meanwhile."""
    probe = plant.start_probe("--seconds", SECONDS + SETTLED_S, "--motion", "still", "--size", "1920x1080", "--codec", codec)
    work(SETTLED_S + 1.5)
    began, used = time.monotonic(), plant.daemon_cpu_s()
    work(SECONDS - 3)
    share = (plant.daemon_cpu_s() - used) / (time.monotonic() - began)
    found, why = probe_result(probe)
    kbps, cpu = goals
    yield row(label + "_kbps", None if why else round(found["steady_kbit_per_s"], 1), "kbit/s", kbps, why=why)
    yield row(label + "_cpu_percent", None if why else round(100 * share, 1), "%", cpu, why=why)


def new_key(folder):
    key = os.path.join(folder, "key.pem")
    subprocess.run(["openssl", "genpkey", "-algorithm", "ed25519", "-out", key], check=True, umask=0o077)
    return key


def signed_rows(bin_folder):
    """What frames of moving cameras take that come signed, every one, beside the same without."""
    with tempfile.TemporaryDirectory() as folder:
        with DemoPlant(bin_folder, "--signing-key", new_key(folder)) as plant:
            if plant.failed:
                yield row("signed", None, "", why=plant.failed)
                return
            for sessions, options, label in ((1, (), "x1"), (10, (), "x10"), (10, ("--follow",), "x10_one_view")):
                for signed in (False, True):
                    name = "%s_720p_%s" % ("signed" if signed else "unsigned", label)
                    used = plant.daemon_cpu_s()
                    found, why = plant.probe("--sessions", sessions, "--seconds", SIGNED_SECONDS, "--motion", "orbit", *options,
                                             *(("--signed", "all") if signed else ()))
                    used = plant.daemon_cpu_s() - used
                    if signed and found and found["signed_frames"] != found["frames"]:
                        why = "%d of %d frames are signed" % (found["signed_frames"], found["frames"])
                    yield row(name + "_fps", None if why else round(found["fps"], 1), "1/s", why=why)
                    yield row(name + "_cpu_ms", None if why else round(1000 * used / found["frames"], 1), "ms", why=why)
                    yield row(name + "_kb_per_frame", None if why else round(found["kb_per_frame"], 1), "kB", why=why)


def plain_rows(bin_folder):
    """What a session that asks for none of it takes where the server signs and a group has harmonic and gp, beside where neither is so: both
    in turn."""
    with tempfile.TemporaryDirectory() as folder:
        key = new_key(folder)
        with DemoPlant(bin_folder) as plain, DemoPlant(bin_folder, "--signing-key", key, vibration="prepare: [harmonic, gp]\n"
                                                       "    gp: { range_m: 2, noise: 0.05 }") as all_of_it:
            names = {"alone": plain, "beside": all_of_it}
            used, frames = dict.fromkeys(names, 0), dict.fromkeys(names, 0)
            why = plain.failed or all_of_it.failed
            for plant in () if why else names.values():
                plant.rest()
            for turn in range(0 if why else PLAIN_TURNS + 1):
                for name, plant in sorted(names.items(), reverse=turn % 2 == 1):
                    before = plant.daemon_cpu_s()
                    found, wrong = plant.probe("--seconds", PLAIN_SECONDS, "--motion", "orbit")
                    why = why or wrong
                    if turn > 0 and found:  # the first one warms up
                        used[name] += plant.daemon_cpu_s() - before
                        frames[name] += found["frames"]
            cpu_ms = {name: None if why else 1000 * used[name] / max(frames[name], 1) for name in names}
            for name in names:
                yield row("plain_720p_%s_cpu_ms" % name, None if why else round(cpu_ms[name], 1), "ms", why=why)
            ratio = None if why else round(cpu_ms["beside"] / cpu_ms["alone"], 3)
            yield row("plain_720p_beside_over_alone", ratio, "x", ("<=", 1.05), why=why)


def stream_rows(bin_folder):
    random.seed(60)
    with DemoPlant(bin_folder) as plant:
        if plant.failed:
            yield row("stream", None, "", why=plant.failed)
            return
        plant.rest()  # what a start leaves to be done takes the processor from the first row
        yield from orbit_rows(plant)
        hold_all(plant)
        time.sleep(2)
        yield from still_rows(plant, "still", "h264", (("<=", 100), ("<=", 5)), lambda seconds: change_together(plant, seconds))
        yield from still_rows(plant, "still_jpeg", "jpeg", (None, None), lambda seconds: change_together(plant, seconds))
        time.sleep(2)
        yield from still_rows(plant, "nothing", "h264", (("<=", 0), ("<=", 1)), time.sleep)
    yield from signed_rows(bin_folder)
    yield from plain_rows(bin_folder)
