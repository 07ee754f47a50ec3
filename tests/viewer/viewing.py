# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""`adit view` as a child of a test, and clouds with known points."""

import atexit
import re
import signal
import struct
import subprocess
import sys


def require(condition, what, *shown):
    if not condition:
        sys.exit("\n".join([f"FAILED: {what}", *map(str, shown)]))


def foxglove_link(line):
    """That for Foxglove, where the line has it."""
    found = re.search(r"Foxglove WebSocket: +(ws://\S+)", line)
    return found and found.group(1)


class Viewing:
    """A running `adit view`; port and link are those it has printed."""

    def __init__(self, adit, what, *options, port=0):
        self.process = subprocess.Popen([str(adit), "view", str(what), "--port", str(port), *map(str, options)],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)  # where a test ends before it
        self.said, self.foxglove = [], None
        for line in self.process.stdout:
            self.said.append(line)
            found = re.search(r"open +(http://\S+?:(\d+)/\S*)", line)
            if found:
                self.link, self.port = found.group(1), int(found.group(2))
            self.foxglove = foxglove_link(line) or self.foxglove
            if line.startswith("Ctrl-C"):
                return
        sys.exit(f"adit view {what} did not start:\n{''.join(self.said)}{self.process.stderr.read()}")

    def memory(self):
        """Bytes that are resident."""
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
            return 1024 * int(re.search(r"VmRSS:\s+(\d+)", status.read()).group(1))

    def end(self, how=signal.SIGTERM):
        """Ends it in good order; returns all that it has printed."""
        self.process.send_signal(how)
        out, err = self.process.communicate(timeout=20)
        text = "".join(self.said) + out
        require(self.process.returncode == 0, f"adit view ended with exit code {self.process.returncode}", text, err)
        return text


def refusals(text):
    """How many were refused for which reason, by what a program says at its end."""
    line = text.split("refused ", 1)[1].split(": ", 1)[1] if "refused " in text else ""
    return {name: int(number) for number, name in re.findall(r"(\d+) ([a-z ]+?)(?:,|$)", line, re.MULTILINE)}


def write_ply(file, points):
    """Points of float32 x, y, z, intensity."""
    with open(file, "wb") as stream:
        stream.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                     b"property float z\nproperty float intensity\nend_header\n" % len(points))
        stream.write(b"".join(struct.pack("<4f", *point) for point in points))


def square(edge, step):
    """A level square at z = 0 about the origin."""
    half, count = edge / 2, round(edge / step)
    at = [-half + step * (i + 0.5) for i in range(count)]
    return [(x, y, 0.0, float(i % 100)) for i, x in enumerate(at) for y in at]
