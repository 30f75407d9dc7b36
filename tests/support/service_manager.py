#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a program as a service manager does: with a socket for notifications, whose lines it prints as `notify: LINE`, and a watchdog, which
kills the program (exit 99) when it has been ready for a while and no sign of life came. Lines on its own standard input are orders.

usage: tests/support/service_manager.py [--watchdog SECONDS] [--journal] [--socket] PROGRAM [ARGUMENT ...]
orders: freeze THREAD   stops one thread of the program, by name, and nothing else of it
        again           ends the program, and starts it once more

--socket: the program is handed a listening socket, whose port is printed, and which outlives it.

--journal: standard error of the program is taken for the journal's, as JOURNAL_STREAM says."""

import argparse
import ctypes
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import time

PTRACE_SEIZE, PTRACE_INTERRUPT, WALL = 0x4206, 0x4207, 0x40000000


def say(text):
    """In one piece: the program writes to the same place."""
    os.write(1, (text + "\n").encode())


def freeze(pid, name):
    """The thread that was stopped; it is to be waited for once it is dead. None: it could not be."""
    libc = ctypes.CDLL(None, use_errno=True)
    for task in sorted(os.listdir("/proc/%d/task" % pid), key=int):  # child threads inherit the name of the thread that starts them
        with open("/proc/%d/task/%s/comm" % (pid, task)) as file:
            if file.read().strip() != name:
                continue
        for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
            if libc.ptrace(request, int(task), None, None) != 0:
                say("frozen: not: %s" % os.strerror(ctypes.get_errno()))
                return None
        os.waitpid(int(task), WALL)  # returns when the thread has stopped
        say("frozen: %s" % name)
        return int(task)
    say("frozen: not: no thread %s" % name)
    return None


def end(child, frozen):
    child.kill()
    if frozen and frozen != child.pid:
        os.waitpid(frozen, WALL)


def hear(notify):
    """Whether that was it: the program is ready."""
    lines = notify.recv(65536).decode().split("\n")
    say("\n".join("notify: " + line for line in lines))
    return "READY=1" in lines


def listen():
    """At descriptor 3, as systemd has it."""
    listening = socket.create_server(("127.0.0.1", 0), backlog=64)
    say("port: %d" % listening.getsockname()[1])
    return listening


def start(command, variables, listening):
    if listening:  # LISTEN_PID must be the program's process id, which is the shell's before exec
        command = ["/bin/sh", "-c", 'LISTEN_FDS=1 LISTEN_PID=$$ exec "$@" 3<&%d' % listening.fileno(), "sh"] + command
    child = subprocess.Popen(command, env=variables, stdin=subprocess.DEVNULL, start_new_session=True,
                             pass_fds=[listening.fileno()] if listening else [])
    say("started: %d" % child.pid)
    return child


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--watchdog", type=float, default=0)
    parser.add_argument("--journal", action="store_true")
    parser.add_argument("--socket", action="store_true")
    parser.add_argument("command", nargs=argparse.REMAINDER)
    given = parser.parse_args()
    folder = tempfile.TemporaryDirectory(prefix="plantcast-manager-")
    notify = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    notify.bind(os.path.join(folder.name, "notify"))
    variables = dict(os.environ, NOTIFY_SOCKET=notify.getsockname())
    if given.watchdog:
        variables["WATCHDOG_USEC"] = str(int(given.watchdog * 1e6))
    if given.journal:
        stat = os.fstat(2)
        variables["JOURNAL_STREAM"] = "%d:%d" % (stat.st_dev, stat.st_ino)
    listening = listen() if given.socket else None
    child = start(given.command, variables, listening)
    signal.signal(signal.SIGTERM, lambda *_: end(child, frozen) if frozen else child.terminate())
    frozen = None
    ready, fed, orders, killed = False, time.monotonic(), True, False
    while child.poll() is None:
        try:
            readable = select.select([notify] + ([sys.stdin] if orders else []), [], [], 0.1)[0]
        except InterruptedError:
            continue
        if notify in readable:
            ready, fed = hear(notify) or ready, time.monotonic()
        if sys.stdin in readable:
            order = sys.stdin.readline()
            orders = order != ""
            if order.strip() == "again":
                child.terminate()
                child.wait()
                child, ready = start(given.command, variables, listening), False
            if order.startswith("freeze "):
                frozen = freeze(child.pid, order.split()[1])
        if given.watchdog and ready and not killed and time.monotonic() - fed > given.watchdog:
            say("watchdog: killed after %.1f s" % (time.monotonic() - fed))
            killed = True
            end(child, frozen)
    while select.select([notify], [], [], 0)[0]:
        hear(notify)
    sys.exit(99 if killed else child.returncode if child.returncode >= 0 else 128 - child.returncode)


main()
