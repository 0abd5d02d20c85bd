# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire --review: a page on this machine's loopback that shows candidates turning, to keep or drop by click.

Plain HTML: a card is the label of a check box, a strip of views moves behind a window of one. The address holds a
secret, so that other pages and other users of the machine do not decide."""
import html
import http.server
import pathlib
import secrets
import tempfile
import threading
import urllib.parse

import numpy as np

from voxid.acquire import judge
from voxid.acquire.source import counted

TURNS, SIZE_PX = 12, 160
MOST_FORM_BYTES = 1 << 20

STYLE = f"""
body {{ font: 15px sans-serif; margin: 24px; background: #f4f4f2; color: #222 }}
form {{ display: flex; flex-wrap: wrap; gap: 12px }}
label {{ width: {SIZE_PX}px; background: #fff; border: 3px solid #c33; border-radius: 6px; cursor: pointer }}
label {{ overflow: hidden }}
label:has(:checked) {{ border-color: #2a2 }}
label:not(:has(:checked)) .turning {{ opacity: 0.35 }}
input:checked + span::after {{ content: 'kept'; color: #171 }}
input:not(:checked) + span::after {{ content: 'dropped'; color: #a22 }}
.turning {{ width: {SIZE_PX}px; height: {SIZE_PX}px; animation: turn 3s steps({TURNS}) infinite }}
@keyframes turn {{ to {{ background-position: -{TURNS * SIZE_PX}px 0 }} }}
.about {{ padding: 4px 6px; font-size: 12px; line-height: 1.35 }}
p {{ flex-basis: 100%; margin: 0 }} button {{ font-size: 16px; padding: 6px 16px }}
.last {{ position: sticky; bottom: 0; padding: 12px 0; background: #f4f4f2 }}
"""


def document(body):
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>voxid</title>'
            f'<style>{STYLE}</style></head><body>{body}</body></html>')


def page(word, passed, secret):
    cards = []
    for number, (strange, one) in enumerate(passed, 1):
        about = [f"{number}. {one.candidate.title}", one.candidate.licence or "licence not stated",
                 one.candidate.author, f"strangeness {strange:.2f}"]
        cards.append(f'<label><input type="checkbox" name="keep" value="{number}" checked><span></span>'
                     f'<div class="turning" style="background-image: url(/{secret}/{number}.png)"></div>'
                     f'<div class="about">{"<br>".join(html.escape(line) for line in about if line)}</div></label>')
    title = f"{html.escape(word)}: {counted(len(passed), 'candidate')}"
    return document(f'<h1>{title}</h1><form method="post" action="/{secret}/">'
                    f'<p>Green is kept, red is dropped; a click changes it. The strangest are last.</p>{"".join(cards)}'
                    f'<p class="last"><button>Keep the green ones</button></p></form>')


def strip(program, mesh):
    """The views of one turn side by side, all in one scale; PNG."""
    cv2 = judge.opencv()
    with tempfile.TemporaryDirectory(prefix="voxid-turn-") as folder:
        _, reason = judge.run([program, "render", str(mesh), "--turn", str(TURNS), "--out", folder], mesh)
        files = [] if reason else sorted(pathlib.Path(folder).glob("*_turn_*.png"))
        images = [cv2.imread(str(file), cv2.IMREAD_UNCHANGED) for file in files]
    if not images:
        images = [np.zeros((8, 8), np.uint16)] * TURNS
    rows, columns = np.nonzero(np.max(images, axis=0))
    window = (slice(None), slice(None))
    if len(rows):
        window = (slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1))
    pictures = [judge.shaded(image[window], SIZE_PX, fill=False) for image in images]
    return cv2.imencode(".png", np.hstack(pictures))[1].tobytes()


POLICY = "default-src 'none'; img-src 'self'; style-src 'unsafe-inline'; form-action 'self'"


class Handler(http.server.BaseHTTPRequestHandler):
    timeout = 30

    def log_message(self, *_):
        pass

    def send(self, data, kind="text/html; charset=utf-8", code=200):
        self.send_response(code)
        for name, text in (("Content-Type", kind), ("Content-Length", str(len(data))), ("Cache-Control", "no-store"),
                           ("Content-Security-Policy", POLICY),
                           ("X-Frame-Options", "DENY"), ("Referrer-Policy", "no-referrer")):
            self.send_header(name, text)
        self.end_headers()
        self.wfile.write(data)

    def place(self):
        """What follows the secret in the path, or None."""
        begin = f"/{self.server.secret}/"
        return self.path[len(begin):] if self.path.startswith(begin) else None

    def do_GET(self):
        review, place = self.server.review, self.place()
        if place == "":
            return self.send(review.page(self.server.secret).encode())
        number = place[:-4] if place is not None and place.endswith(".png") else ""
        if number.isascii() and number.isdigit() and 1 <= int(number[:6]) <= len(review.passed):
            return self.send(review.picture(int(number[:6])), "image/png")
        self.send(b"not here", "text/plain", 404)

    def do_POST(self):
        length = self.headers.get("Content-Length") or ""
        if self.place() != "" or not length.isdigit() or int(length[:9]) > MOST_FORM_BYTES:
            return self.send(b"not here", "text/plain", 404)
        fields = urllib.parse.parse_qs(self.rfile.read(int(length[:9])).decode("ascii", "replace"))
        numbers = {int(text) for text in fields.get("keep", []) if text.isascii() and text.isdigit() and len(text) < 7}
        self.server.review.chosen = numbers & set(range(1, len(self.server.review.passed) + 1))
        kept = len(self.server.review.chosen)
        try:
            self.send(document(f"<h1>{kept} kept</h1><p>You may close this page.</p>").encode())
        finally:
            self.server.shutdown()


class Server(http.server.ThreadingHTTPServer):
    """A thread a connection: browsers open some that they do not use yet."""

    def handle_error(self, *_):
        """A page that was closed before its pictures came wants no answer."""


class Review:
    """`passed`: (strangeness, found), in the order of the contact sheet."""

    def __init__(self, program, word, passed):
        self._program, self._word, self.passed = program, word, passed
        self._pictures, self._drawing, self.chosen = {}, threading.Lock(), None

    def page(self, secret):
        return page(self._word, self.passed, secret)

    def picture(self, number):
        with self._drawing:
            if number not in self._pictures:
                self._pictures[number] = strip(self._program, self.passed[number - 1][1].mesh)
            return self._pictures[number]

    def ask(self, announce):
        """The numbers that were kept. `announce` is told the address; it ends with the request that decides."""
        with Server(("127.0.0.1", 0), Handler) as server:
            server.secret, server.review = secrets.token_urlsafe(16), self
            announce(f"http://127.0.0.1:{server.server_address[1]}/{server.secret}/")
            server.serve_forever(poll_interval=0.1)
        return self.chosen
