# SPDX-License-Identifier: GPL-3.0-or-later
"""What streaming the demo plant takes where a GPU draws."""

from demo_plant import DemoPlant
from rows import row

SECONDS = 5
WANTED_FPS = 30
MOST_SESSIONS = 256
LIMITS = ("address-sessions=1000", "address-messages=1000000", "least-fps=0")


def one_session(plant, size, codec):
    label = "gpu_stream_%sp" % size.split("x")[1] + ("" if codec == "h264" else "_" + codec)
    found, why = plant.probe("--seconds", SECONDS, "--motion", "orbit", "--size", size, "--codec", codec)
    if why or not found["input_to_frame_ms"]:
        yield row(label, None, "", why=why or "no frame showed a camera that was sent")
        return
    taken = found["input_to_frame_ms"]
    stages = ", ".join("%s %.1f" % (name, times["p50"]) for name, times in found["stages_ms"].items())
    yield row(label + "_fps", round(found["fps"], 1), "1/s")
    yield row(label + "_input_p50_ms", round(taken["p50"], 1), "ms", ("<=", 10) if label == "gpu_stream_1080p" else None,
              p95=round(taken["p95"], 1), extras={"note": stages})


def most_sessions(plant, codec):
    """Each with a view of its own that moves; nobody decodes, since the clients are on the same machine."""
    served, sessions, note = 0, 4, ""
    while sessions <= MOST_SESSIONS:
        found, why = plant.probe("--sessions", sessions, "--seconds", SECONDS, "--motion", "orbit", "--size", "1920x1080", "--codec", codec,
                                 "--blind")
        if why or found["failures"] or found["fps_lowest"] < WANTED_FPS:
            note = why or "of %d the slowest gets %.1f frames/s" % (sessions, found["fps_lowest"])
            break
        served, sessions = sessions, sessions + max(1, sessions // 4)
    yield row("gpu_stream_1080p_sessions" + ("" if codec == "h264" else "_" + codec), served, "", extras={"note": note})


def gpu_rows(bin_folder):
    with DemoPlant(bin_folder, "--gl", "egl-device", *(word for limit in LIMITS for word in ("--limit", limit))) as plant:
        if plant.failed:
            yield row("gpu_stream", None, "", why=plant.failed)
            return
        for size in ("1920x1080", "1280x720"):
            for codec in ("h264", "jpeg"):
                yield from one_session(plant, size, codec)
        for codec in ("h264", "jpeg"):
            yield from most_sessions(plant, codec)
