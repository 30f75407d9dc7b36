#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a program with the system calls that a unit lets it have: all others give EPERM, as SystemCallErrorNumber says there.

usage: tests/support/confined.py UNIT PROGRAM [ARGUMENT ...]"""

import errno
import os
import subprocess
import sys

import seccomp


def expand(name):
    if not name.startswith("@"):
        return {name}
    lines = subprocess.run(["systemd-analyze", "syscall-filter", name], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    words = [line.strip() for line in lines[1:] if line.strip() and not line.strip().startswith("#")]
    return set().union(*(expand(word) for word in words))


def allowed(unit):
    """As systemd reads the lines: the first is a list of what may be, those after it add, or with ~ take away."""
    calls = expand("@default")
    with open(unit) as f:
        for line in f:
            name, _, words = line.strip().partition("=")
            if name != "SystemCallFilter":
                continue
            named = set().union(*(expand(word) for word in words.lstrip("~").split()))
            calls = calls - named if words.startswith("~") else calls | named
    return calls


def main():
    unit, command = sys.argv[1], sys.argv[2:]
    confined = seccomp.SyscallFilter(seccomp.ERRNO(errno.EPERM))
    for call in allowed(unit):
        try:
            confined.add_rule(seccomp.ALLOW, call)
        except (RuntimeError, ValueError):
            pass  # of another architecture
    os.environ["CONFINED"] = "yes"
    confined.load()
    os.execv(command[0], command)


main()
