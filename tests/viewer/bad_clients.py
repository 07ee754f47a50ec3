#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Clients that mean no good, or no sense, against `adit view`: each is refused or bounded, and counted at the end.

Usage: bad_clients.py ADIT. All the while a good client gets its tiles.
"""

import gzip
import json
import pathlib
import re
import signal
import socket
import struct
import sys
import tempfile
import time

from viewing import Viewing, refusals, require, square, write_ply
from websocket import BINARY, CLOSE, TEXT, Refused, WebSocket


def ask(port, request, timeout=15):
    """All that comes back for these bytes."""
    with socket.create_connection(("127.0.0.1", port), timeout=timeout) as line:
        answer = b""
        try:
            line.sendall(request)
            while data := line.recv(1 << 16):
                answer += data
        except (ConnectionError, socket.timeout):
            pass
        return answer


def get(port, path, *headers, host=None, method="GET"):
    lines = [f"{method} {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", *headers]
    return ask(port, ("\r\n".join(lines) + "\r\n\r\n").encode())


def status(answer):
    found = re.match(rb"HTTP/1\.1 (\d+)", answer)
    return int(found.group(1)) if found else None


def greeting(client):
    """Scene and graph, as every client gets them."""
    scene, graph = (json.loads(client.receive()[1]) for _ in range(2))
    require(scene["type"] == "scene" and graph["type"] == "graph", "the greeting is another", scene, graph)
    return scene, graph


def good_client(port, *arguments, **options):
    """A whole visit: the page, and the first tile with its points. Returns the scene."""
    client = WebSocket(port, *arguments, **options)
    scene, _ = greeting(client)
    client.send('{"tiles": [0]}')
    kind, tile = client.receive()
    number, count = struct.unpack("<2I", tile[:8])
    require(kind == BINARY and number == 0 and len(tile) == 8 + 12 * count and count == scene["tiles"]["points"][0],
            "the first tile is another", kind, number, count)
    client.close()
    return scene


def closed_for(client, code):
    """The client is told to go, for that reason (RFC 6455, 7.4.1)."""
    while True:
        kind, data = client.receive()
        if kind == CLOSE:
            require(struct.unpack(">H", data[:2])[0] == code, "closed for another reason", data)
            client.close()
            return


def check_page(port):
    answer = get(port, "/")
    head, body = answer.split(b"\r\n\r\n", 1)
    page = gzip.decompress(body)
    require(status(answer) == 200 and b"nosniff" in head and page.startswith(b"<!DOCTYPE html>"), "no page", head)
    require(b"Content-Security-Policy" in page, "the page may load what it likes")
    return len(body), len(page)


def check_requests(port):
    """Each of these is refused; returns how many of which kind there were."""
    for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/map.adit", "/.git/config", "/socket", "*"):
        require(status(get(port, path)) == 404, f"{path} was served")
    for host in ("evil.example", f"evil.example:{port}", "localhost.evil.example", ""):
        require(status(get(port, "/", host=host or " ")) == 403, f"Host {host!r} was served")
    for origin in ("http://evil.example", "null", "http://127.0.0.1:1", "file://"):
        require(status(get(port, "/", f"Origin: {origin}")) == 403, f"{origin} got the page")
        try:
            WebSocket(port, origin=origin)
            require(False, f"{origin} was let in")
        except Refused as refused:
            require("403" in refused.args[0], "refused for another reason", refused)
    malformed = [b"\x00" * 64, b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", b"GET\r\n\r\n", b"\xff" * 3000 + b"\r\n\r\n",
                 b"GET / HTTP/9.9\r\n\r\n"]
    for garbage in malformed:
        require(status(ask(port, garbage)) in (400, None), f"{garbage[:12]} was understood")
    require(status(get(port, "/", method="POST")) == 400, "POST was served")
    large = [b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + b"a" * 100_000 + b"\r\n\r\n",
             b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n",
             b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000000000\r\n\r\n" + b"a" * 100_000]
    for request in large:
        require(status(ask(port, request)) in (413, None), f"{request[:12]} was taken")
    return {"unknown path": 7, "foreign host name": 4, "foreign origin": 8, "malformed": 6, "too large": 3}


def check_messages(port):
    def told(message, opcode=TEXT):
        client = WebSocket(port)
        greeting(client)
        client.send(message, opcode)
        return client

    nonsense = ["", "no json", "[]", "{}", '{"tiles": [0], "more": 1}', '{"tiles": [-1]}', '{"tiles": [4294967296]}',
                '{"tiles": ["0"]}', '{"tiles": [999999]}', '{"revoke": "1"}', '{"open": "/etc/passwd"}', '{"place": [1, 2]}',
                '{"place": [1, 2, "3"]}', '{"place": [1, 2, 1e999]}', "[" * 16000]
    for message in nonsense:
        closed_for(told(message), 1008)
    closed_for(told(b'{"tiles": [0]}', BINARY), 1003)
    closed_for(told(json.dumps({"tiles": [0] * 3000})), 1008)
    # Who promises a message of 1 GB is not listened to.
    client = told("", PING_THEN_NOTHING)
    client.socket.sendall(bytes([0x81, 0xff]) + struct.pack(">Q", 1 << 30) + b"abcd")
    closed_for(client, 1009)
    client = told("{\"revoke\": 1}")
    reply = json.loads(client.receive()[1])
    require(reply["type"] == "told" and reply["problem"] and "--edit" in reply["text"], "edited without leave", reply)
    client.close()
    return {"malformed": len(nonsense) + 1, "too many": 1, "too large": 1}


PING_THEN_NOTHING = 9
SILENCE = 32  # s: who answers no ping is dropped after 20, who sends no request after 10


def check_crowd(port):
    """200 at once that say nothing: some are kept waiting, the others are sent away, and then there is room again."""
    crowd = []
    for _ in range(200):
        line = socket.socket()
        line.setblocking(False)
        line.connect_ex(("127.0.0.1", port))
        crowd.append(line)
    time.sleep(1)
    away = 0
    for line in crowd:
        line.settimeout(0.2)
        try:
            away += line.recv(64)[:12] in (b"HTTP/1.1 503", b"")
        except ConnectionError:
            away += 1
        except socket.timeout:
            pass
    require(away == 200 - 32, f"{away} of 200 were sent away, 168 expected")
    for line in crowd:
        line.close()
    time.sleep(0.3)
    good_client(port)
    return {"too many": 168}


def check_token(adit, cloud):
    viewing = Viewing(adit, cloud, "--listen", "0.0.0.0")
    token = re.search(r"\?token=([0-9a-f]{32})$", viewing.link)
    require(token, "the link has no token", viewing.link)
    said = "".join(viewing.said)
    require("numeric address" in said and "Whoever has the link" in said, "not said", said)
    port, token = viewing.port, token.group(1)
    for query in ("", "?token=", "?token=" + "0" * 32, "?token=" + token[:-1], "?token=" + token + "0", "?Token=" + token):
        require(status(get(port, "/" + query)) == 403, f"let in by {query}")
    try:
        WebSocket(port)
        require(False, "a socket without a token was let in")
    except Refused:
        pass
    require(status(get(port, "/?token=" + token)) == 200, "not let in by the token")
    require(status(get(port, "/?token=" + token, host="adit.evil.example")) == 403, "called by a foreign name")
    require(status(get(port, "/?token=" + token, host=f"192.168.1.5:{port}")) == 200, "its own address is refused")
    good_client(port, f"/socket?token={token}")
    text = viewing.end(signal.SIGINT)
    require("7 wrong token" in text and "1 foreign host name" in text, "counted otherwise", text)


def never_reading(port):
    """Asks for as much as it may and takes nothing."""
    client = WebSocket(port, receive_buffer=4096)
    for _ in range(4):
        client.send(json.dumps({"tiles": [i % 20 for i in range(120)]}))
    return client


def never_reading_foxglove(port):
    """The same by Foxglove's protocol: the whole cloud, and it takes nothing of it."""
    client = WebSocket(port, "/", receive_buffer=4096, protocol="foxglove.websocket.v1")
    client.send('{"op": "subscribe", "subscriptions": [{"id": 0, "channelId": 0}]}')
    return client


def main():
    adit = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        cloud = pathlib.Path(folder) / "square.ply"
        write_ply(cloud, square(20.0, 0.02) + [(0.0, 0.0, 4.0, 100.0)])
        viewing = Viewing(adit, cloud)
        scene = good_client(viewing.port)
        require(sum(scene["tiles"]["points"]) == scene["points"] == 1_000_001, "points are missing", scene["points"])
        packed, whole = check_page(viewing.port)
        print(f"page: {packed} bytes packed, {whole} bytes")
        before = viewing.memory()
        began = time.monotonic()
        silent = [never_reading(viewing.port) for _ in range(8)] + [never_reading_foxglove(viewing.port) for _ in range(4)]
        slow = socket.create_connection(("127.0.0.1", viewing.port))
        slow.sendall(b"GET / HTTP/1.1\r\n")
        expected = {}
        for checked in (check_requests(viewing.port), check_messages(viewing.port), {"too slow": len(silent) + 1}):
            for name, count in checked.items():
                expected[name] = expected.get(name, 0) + count
        grown = viewing.memory() - before
        require(grown < 40e6, f"memory has grown by {grown} bytes for clients that read nothing")
        good_client(viewing.port)
        # The silent ones are dropped when they have answered no ping for 20 s.
        while time.monotonic() - began < SILENCE:
            good_client(viewing.port)
            time.sleep(1)
        for name, count in check_crowd(viewing.port).items():
            expected[name] = expected.get(name, 0) + count
        text = viewing.end()
        counted = refusals(text)
        require(counted == expected, "counted otherwise", f"expected {expected}", f"counted  {counted}", text)
        print(text, end="")
        print(f"memory grew by {grown / 1e6:.1f} MB")
        check_token(adit, cloud)
    print("bad_clients: all refused, bounded and counted")


if __name__ == "__main__":
    main()
