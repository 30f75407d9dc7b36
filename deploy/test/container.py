#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes BUNDLE/config.json, with which runc runs the unpacked image IMAGE (OCI layout; its files are in BUNDLE/rootfs) as podman would: read-only
root, no capabilities, an empty /tmp, DATA as its volume, and its own command, or another. The network is the caller's, and so are cgroups. The
environment's CONTAINER_UID replaces the image's user and group.

usage: deploy/test/container.py IMAGE BUNDLE DATA [COMMAND...]"""
import json
import os
import sys


def blob(image, digest):
    with open(os.path.join(image, "blobs", *digest.split(":")), encoding="utf-8") as file:
        return json.load(file)


def main():
    image, bundle, data, *command = sys.argv[1:]
    with open(os.path.join(image, "index.json"), encoding="utf-8") as file:
        manifest = blob(image, json.load(file)["manifests"][0]["digest"])
    own = blob(image, manifest["config"]["digest"])["config"]
    other = os.environ.get("CONTAINER_UID")
    user, group = map(int, (f"{other}:{other}" if other else own["User"]).split(":"))
    closed = ["nosuid", "noexec", "nodev"]
    config = {
        "ociVersion": "1.0.0", "hostname": "plant", "root": {"path": "rootfs", "readonly": True},
        "process": {"terminal": False, "user": {"uid": user, "gid": group}, "args": command or own["Entrypoint"] + own["Cmd"],
                    "env": own["Env"], "cwd": own["WorkingDir"], "capabilities": {}, "noNewPrivileges": True},
        "mounts": [{"destination": "/proc", "type": "proc", "source": "proc"},
                   {"destination": "/dev", "type": "tmpfs", "source": "tmpfs", "options": ["nosuid", "mode=755"]},
                   {"destination": "/sys", "type": "sysfs", "source": "sysfs", "options": closed + ["ro"]},
                   {"destination": "/tmp", "type": "tmpfs", "source": "tmpfs", "options": closed[:1] + ["nodev", "mode=1777"]},
                   {"destination": list(own["Volumes"])[0], "type": "bind", "source": data, "options": ["bind", "rw"]}],
        "linux": {"namespaces": [{"type": kind} for kind in ("pid", "ipc", "uts", "mount")], "readonlyPaths": ["/proc/sys"]}}
    with open(os.path.join(bundle, "config.json"), "w", encoding="utf-8") as file:
        json.dump(config, file)


main()
