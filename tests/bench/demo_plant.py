# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo plant, served on free ports from a folder of its own, with hands on its simulated PLC."""

import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import urllib.request

DEMO = "build/demo/plant.yaml"


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def wait_for(process, prefix, seconds=60):
    """Reads the program's output up to the line with that beginning."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        line = process.stdout.readline()
        if not line:
            return False
        if line.startswith(prefix):
            return True
    return False


class DemoPlant:
    """with DemoPlant("build") as plant: plant.failed says what did not start; else plant.port serves. vibration: what else the plant file
    says of that group; the plant is prepared with it first."""

    def __init__(self, bin_folder, *daemon_options, vibration=None):
        self.bin_folder = bin_folder
        self.options = list(daemon_options)
        self.vibration = vibration
        self.running = []
        self.failed = None

    def __enter__(self):
        self.folder = tempfile.mkdtemp()
        plant = os.path.join(self.folder, "plant.yaml")
        modbus, self.port, self.control = free_port(), free_port(), free_port()
        shutil.copytree(os.path.dirname(DEMO), self.folder, dirs_exist_ok=True)
        with open(DEMO) as f:
            text = f.read()
        with open(plant, "w") as f:
            text = text.replace("port: 1502", "port: %d" % modbus)
            f.write(text.replace("  - id: vibration\n", "  - id: vibration\n    %s\n" % self.vibration) if self.vibration else text)
        if self.vibration:
            subprocess.run([os.path.join(self.bin_folder, "plantcast-prep"), plant], check=True, stdout=subprocess.DEVNULL)
        for command, ready in (
            (["plantcast-sim", plant, "--control", str(self.control)], "plantcast-sim: listening"),
            (["plantcastd", plant, "--port", str(self.port)] + self.options, "plantcastd: ready"),
        ):
            self.daemon_began = time.monotonic()  # of the last of them
            process = subprocess.Popen([os.path.join(self.bin_folder, command[0])] + command[1:], stdout=subprocess.PIPE,
                                       stderr=subprocess.DEVNULL, text=True)
            self.running.append(process)
            if not wait_for(process, ready):
                self.failed = "%s did not start" % command[0]
                break
        return self

    def __exit__(self, *_):
        for process in reversed(self.running):
            process.send_signal(signal.SIGTERM)
            process.wait()
        shutil.rmtree(self.folder)

    @property
    def url(self):
        return "http://127.0.0.1:%d/" % self.port

    def tags(self):
        """As /api/v1/tags has them."""
        with urllib.request.urlopen(self.url + "api/v1/tags") as answer:
            return json.load(answer)["tags"]

    def hold(self, values):
        """{tag: value}: the PLC has them from now on."""
        with socket.create_connection(("127.0.0.1", self.control)) as s:
            lines = s.makefile("rw")
            for tag, value in values.items():
                lines.write("set %s %.9g\n" % (tag, value))
                lines.flush()
                answer = lines.readline()
                if not answer.startswith("ok"):
                    raise RuntimeError("set %s: %s" % (tag, answer.strip()))

    def daemon_cpu_s(self):
        """User and system time of the daemon so far."""
        with open("/proc/%d/stat" % self.running[-1].pid) as f:
            fields = f.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def rest(self, seconds=120):
        """Waits until the daemon has worked out what it does after its start."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            used = self.daemon_cpu_s()
            time.sleep(2)
            if self.daemon_cpu_s() - used < 0.1:
                return

    def start_probe(self, *options):
        command = [os.path.join(self.bin_folder, "plantcast"), "probe", self.url, "--json"] + [str(option) for option in options]
        return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)

    def probe(self, *options):
        """What it found, and None; or None, and why."""
        return probe_result(self.start_probe(*options))


def probe_result(process):
    text = process.communicate()[0]
    try:
        return json.loads(text), None
    except ValueError:
        return None, "plantcast probe: exit status %d" % process.returncode
