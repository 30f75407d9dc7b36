#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""So many operators on one core and some renderers, each in a network of its own (needs root): what each node takes of a processor, and the
bytes of its network, by operators of the kinds of deploy/pages/CAPACITY.md: of ten, one moves the camera, three follow, six stand still.

    tests/bench/operators.py build OPERATORS RENDERERS [SECONDS]

Run by hand; `make demo` first. Processor time, not elapsed time, and bytes: true also where other programs run."""

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request

from demo_plant import DEMO, probe_result, wait_for

LIMITS = ["address-sessions=2000", "address-connections=2400", "address-messages=100000", "messages=10000", "least-fps=0", "sessions=1000"]
SETTLE_S = 8
TICKS = os.sysconf("SC_CLK_TCK")


def run(*words):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)


class Networks:
    """A bridge 10.77.0.1, and behind it one network for each name."""

    def __init__(self, names):
        self.prefix = "pc%d" % (os.getpid() % 10000)
        self.bridge = self.prefix + "b"
        self.names = names

    def __enter__(self):
        run("ip", "link", "add", self.bridge, "type", "bridge")
        run("ip", "addr", "add", "10.77.0.1/24", "dev", self.bridge)
        run("ip", "link", "set", self.bridge, "up")
        for i, name in enumerate(self.names):
            space, outer = self.prefix + name, self.prefix + "v%d" % i
            run("ip", "netns", "add", space)
            run("ip", "link", "add", outer, "type", "veth", "peer", "name", "eth0", "netns", space)
            run("ip", "link", "set", outer, "master", self.bridge, "up")
            for words in (["addr", "add", "10.77.0.%d/24" % (10 + i), "dev", "eth0"], ["link", "set", "eth0", "up"],
                          ["link", "set", "lo", "up"]):
                run("ip", "netns", "exec", space, "ip", *words)
        return self

    def __exit__(self, *_):
        for name in self.names:
            subprocess.run(["ip", "netns", "del", self.prefix + name])
        subprocess.run(["ip", "link", "del", self.bridge])

    def within(self, name):
        return ["ip", "netns", "exec", self.prefix + name]

    def address(self, name):
        return "10.77.0.%d" % (10 + self.names.index(name))

    def bytes_sent(self, name):
        """By that node."""
        with open("/sys/class/net/%sv%d/statistics/rx_bytes" % (self.prefix, self.names.index(name))) as f:
            return int(f.read())


def cpu_s(process):
    with open("/proc/%d/stat" % process.pid) as f:
        fields = f.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def start(networks, name, ready, *words):
    process = subprocess.Popen(networks.within(name) + list(words), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    if not wait_for(process, ready):
        raise RuntimeError("%s did not start" % words[0])
    return process


def probe(bin_folder, url, *options):
    words = [os.path.join(bin_folder, "plantcast"), "probe", url, "--json", "--blind"] + [str(option) for option in options]
    return subprocess.Popen(words, stdout=subprocess.PIPE, text=True)


def shares(operators, renderers):
    """Of each renderer: (moving, following, still)."""
    moving, following = -(-operators // 10), operators * 3 // 10
    still = operators - moving - following
    return [tuple(count // renderers + (i < count % renderers) for count in (moving, following, still)) for i in range(renderers)]


def start_operators(bin_folder, url, share, seconds):
    """One probe for each who moves, with the followers of that one; one for all who stand still."""
    moving, following, still = share
    probes = {"moving": [], "following": [], "still": []}
    for i in range(moving):
        followers = following // moving + (i < following % moving)
        common = ("--motion", "orbit", "--hz", 30, "--seconds", seconds, "--size", "1280x720")
        probes["moving"].append(probe(bin_folder, url, "--sessions", 1 + followers, *(["--follow"] if followers else []), *common))
    if still:
        probes["still"].append(probe(bin_folder, url, "--sessions", still, "--spread", "--motion", "still", "--seconds", seconds, "--size",
                                     "1280x720"))
    return probes


PROXY = """global
    maxconn 4000
defaults
    mode http
    timeout connect 2s
    timeout client 60s
    timeout server 60s
    timeout tunnel 1h
frontend operators
    bind %s:8000
    http-request set-header Host 127.0.0.1:8000
    default_backend node
backend node
    server node 127.0.0.1:8000
"""


def start_node(networks, folder, running, name, *words):
    """A daemon, and HAProxy before it, which brings operators from other networks."""
    node = start(networks, name, "plantcastd: ready", *words, "--port", "8000", *[word for limit in LIMITS for word in ("--limit", limit)])
    running.append(node)
    file = os.path.join(folder, name + ".cfg")
    with open(file, "w") as f:
        f.write(PROXY % networks.address(name))
    running.append(subprocess.Popen(networks.within(name) + ["/usr/sbin/haproxy", "-db", "-f", file], stderr=subprocess.DEVNULL))
    for _ in range(100):
        with socket.socket() as s:
            if s.connect_ex((networks.address(name), 8000)) == 0:
                return node
        time.sleep(0.1)
    raise RuntimeError("HAProxy did not start")


def measure(bin_folder, operators, renderers, seconds):
    names = ["core"] + ["r%d" % i for i in range(renderers)]
    folder = tempfile.mkdtemp()
    running = []
    plant, program = os.path.join(folder, "plant.yaml"), lambda name: os.path.join(bin_folder, name)
    shutil.copytree(os.path.dirname(DEMO), folder, dirs_exist_ok=True)
    with Networks(names) as networks:
        try:
            running.append(start(networks, "core", "plantcast-sim: listening", program("plantcast-sim"), plant))
            nodes = {"core": start_node(networks, folder, running, "core", program("plantcastd"), plant, "--role", "core")}
            for name in names[1:]:
                nodes[name] = start_node(networks, folder, running, name, program("plantcastd"), plant, "--role", "render", "--node", name,
                                         "--core", "ws://%s:8000" % networks.address("core"))
            return observe(bin_folder, networks, nodes, shares(operators, renderers), seconds)
        finally:
            for process in reversed(running):
                process.terminate()
                process.wait()
            shutil.rmtree(folder)


def counters(networks, name):
    with urllib.request.urlopen("http://%s:8000/metrics" % networks.address(name)) as answer:
        lines = answer.read().decode().splitlines()
    pick = ("plantcast_renders_total", "plantcast_encodes_total", "plantcast_frames_sent_total")
    return {key: sum(float(line.rsplit(" ", 1)[1]) for line in lines if line.startswith((key + " ", key + "{"))) for key in pick}


def observe(bin_folder, networks, nodes, all_shares, seconds):
    probes = [start_operators(bin_folder, "http://%s:8000/" % networks.address(name), share, seconds + SETTLE_S + 4)
              for name, share in zip(list(nodes)[1:], all_shares)]
    time.sleep(SETTLE_S)
    look = lambda: (time.monotonic(), {name: (cpu_s(node), networks.bytes_sent(name), counters(networks, name))
                                       for name, node in nodes.items()})
    (began, before), _ = look(), time.sleep(seconds)
    ended, after = look()
    took = ended - began
    result = {"seconds": round(took, 1), "load": os.getloadavg()[0], "nodes": {}, "operators": []}
    for name in nodes:
        (cpu0, bytes0, counts0), (cpu1, bytes1, counts1) = before[name], after[name]
        result["nodes"][name] = {"processors": round((cpu1 - cpu0) / took, 3), "mbit_per_s": round((bytes1 - bytes0) * 8e-6 / took, 3),
                                 **{key: round((counts1[key] - counts0[key]) / took, 1) for key in counts0}}
    for share, kinds in zip(all_shares, probes):
        found = {"moving, following, still": share}
        for kind, some in kinds.items():
            answers = [probe_result(one) for one in some]
            found[kind] = [{key: answer[key] for key in ("fps", "fps_lowest", "kb_per_frame") if key in answer} if answer else why
                           for answer, why in answers]
        result["operators"].append(found)
    return result


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    print(json.dumps(measure(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]) if len(sys.argv) > 4 else 30), indent=1))
