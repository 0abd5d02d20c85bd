# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire --review: the page, its pictures, what it takes, and what it does not answer."""
import json
import os
import pathlib
import re
import socket
import struct
import subprocess
import urllib.error
import urllib.parse
import urllib.request

import cv2
import numpy as np
import pytest

import browser
import solids

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")
BOX = "&lt;b&gt;x&amp;&quot; mug"  # as the page writes it
GREEN, RED = (34, 170, 34), (51, 51, 204)  # BGR
OPENER = urllib.request.build_opener(urllib.request.ProxyHandler({}))


def get(address, data=None):
    with OPENER.open(address, data, timeout=30) as answer:
        return answer.read()


@pytest.fixture
def review(tmp_path):
    """A running `acquire --review` of three mugs, one of a hostile name; the process and its address."""
    for name, mesh in {"mug 1": solids.turned([(0.0, 0.0), (0.4, 0.0), (0.4, 1.0), (0.0, 1.0)]), "mug 2": solids.ball(),
                       "<b>x&\" mug": solids.box(1.0, 0.8, 0.3)}.items():
        solids.write_ply(tmp_path / "in" / f"{name}.ply", mesh)
    command = [PROGRAM, "acquire", "mug", "--sense", "4", "--depth", "0", "--source", tmp_path / "in",
               "--out", tmp_path / "lib", "--review"]
    process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    line = process.stderr.readline()
    assert " to be kept or dropped at http://127.0.0.1:" in line, line
    yield process, line.split()[-1]
    process.kill()
    process.wait()


def test_a_click_keeps_and_drops(review, tmp_path):
    process, address = review
    text = get(address).decode()
    assert text.count('type="checkbox"') == 3 and BOX in text and "<b>x" not in text
    strip = cv2.imdecode(np.frombuffer(get(f"{address}1.png"), np.uint8), cv2.IMREAD_UNCHANGED)
    assert strip.shape == (160, 12 * 160)
    assert all((strip[:, 160 * i:160 * (i + 1)] < 250).mean() > 0.05 for i in range(12))
    base = address.rsplit("/", 2)[0]
    for wrong in (f"{base}/", f"{base}/guess/", f"{address}9.png", f"{address}..%2f..%2fetc/passwd", f"{address}0.png"):
        with pytest.raises(urllib.error.HTTPError):
            get(wrong)
    with pytest.raises(urllib.error.HTTPError):
        get(f"{base}/guess/", b"keep=1")
    assert process.poll() is None
    assert b"2 kept" in get(address, b"keep=1&keep=3&keep=77&keep=x")
    assert process.wait(timeout=30) == 0
    notes = json.loads((tmp_path / "lib/library.json").read_text())
    verdicts = sorted(note["verdict"] for note in notes.values() if "verdict" in note)
    assert verdicts == ["dropped: by hand", "kept", "kept"]


def test_connections_that_say_nothing_or_break_off_hold_nothing_up(review):
    process, address = review
    host, path = urllib.parse.urlsplit(address).netloc.split(":"), urllib.parse.urlsplit(address).path
    with socket.create_connection(host):  # browsers open some ahead of use
        with socket.create_connection(host) as closed:
            closed.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            closed.sendall(f"GET {path}1.png HTTP/1.0\r\n\r\n".encode())
        get(f"{address}2.png")
        get(address, b"keep=1")
        assert process.wait(timeout=10) == 0
    assert "Traceback" not in process.stderr.read()


def view_shown(page, card, views):
    """Which of one turn's views a card shows now; None before the first."""
    shown = page.picture(f"{card} .turning")
    return next((number for number, view in enumerate(views) if np.array_equal(view, shown)), None)


def border(page, card):
    picture = page.picture(card)
    return tuple(picture[picture.shape[0] // 2, 1])


def test_in_a_browser_they_turn_and_clicks_keep_and_drop(review, tmp_path):
    process, address = review
    labels = re.findall(r'value="(\d)".*?"about">\d\. (.*?)<br>', get(address).decode())
    number = {title: value for value, title in labels}
    cylinder, ball, box = (f"label:has([value='{number[title]}'])" for title in ("mug 1", "mug 2", BOX))
    strip = cv2.imdecode(np.frombuffer(get(f"{address}{number[BOX]}.png"), np.uint8), cv2.IMREAD_COLOR)
    views, seen = np.hsplit(strip, 12), set()
    with browser.Browser(tmp_path / "profile") as page:
        page.open(address)
        page.wait_until(lambda: seen.add(view_shown(page, box, views)) or len(seen - {None}) >= 3)
        page.click(f"{ball} .turning")
        page.click(f"{box} .about")
        assert border(page, box) == RED
        page.click(f"{box} input")
        assert (border(page, cylinder), border(page, ball), border(page, box)) == (GREEN, RED, GREEN)
        page.click("button")
        page.wait_until(lambda: page.value("document.querySelector('h1')?.textContent") == "2 kept")
    assert process.wait(timeout=30) == 0
    notes = json.loads((tmp_path / "lib/library.json").read_text())
    models = {note["title"]: (note["verdict"], (tmp_path / "lib" / name).exists())
              for name, note in notes.items() if "verdict" in note}
    assert models == {"mug 1": ("kept", True), "mug 2": ("dropped: by hand", False), "<b>x&\" mug": ("kept", True)}
