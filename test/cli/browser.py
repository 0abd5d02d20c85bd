# SPDX-License-Identifier: BSD-3-Clause
"""A page in a real browser, looked at and clicked as a person does: chromium-headless-shell, which scripts/install_deps
installs, driven over a pipe by the DevTools protocol (https://chromedevtools.github.io/devtools-protocol)."""
import base64
import json
import os
import select
import shutil
import signal
import subprocess
import time

import cv2
import numpy as np

PROGRAM = "chromium-headless-shell"
OPTIONS = ("--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-background-networking",
           "--disable-component-update", "--no-first-run", "--no-proxy-server", "--window-size=800,600",
           "--remote-debugging-pipe")
PATIENCE_S = 30


class Browser:
    def __init__(self, folder):
        """`folder`: where it may write. Fails where the browser is not installed."""
        assert shutil.which(PROGRAM), f"{PROGRAM} is not installed; scripts/install_deps test installs it"
        # It reads requests from descriptor 3 and answers to 4, each ended by a zero byte.
        command = ["sh", "-c", 'exec "$@" 3<&0 4>&1 <&- >&2', "sh", PROGRAM, *OPTIONS, f"--user-data-dir={folder}"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                         stderr=subprocess.DEVNULL, start_new_session=True,
                                         env={**os.environ, "HOME": str(folder)})
        self._received, self._asked, self._page = b"", 0, {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.communicate()

    def open(self, address):
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self._page = {"sessionId": self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]}
        self.ask("Page.navigate", url=address)
        self.wait_until(lambda: self.value("document.readyState") == "complete")

    def ask(self, method, **parameters):
        self._asked += 1
        request = {"id": self._asked, "method": method, "params": parameters, **self._page}
        self._process.stdin.write(json.dumps(request).encode() + b"\0")
        self._process.stdin.flush()
        deadline = time.monotonic() + PATIENCE_S
        while (answer := self._next(deadline)).get("id") != self._asked:
            pass  # events, which nobody waits for
        assert "error" not in answer, (method, answer)
        return answer["result"]

    def _next(self, deadline):
        pipe = self._process.stdout.fileno()
        while b"\0" not in self._received:
            assert select.select([pipe], [], [], max(0, deadline - time.monotonic()))[0], f"{PROGRAM} does not answer"
            data = os.read(pipe, 1 << 16)
            assert data, f"{PROGRAM} ended"
            self._received += data
        message, _, self._received = self._received.partition(b"\0")
        return json.loads(message)

    def value(self, expression):
        """Of a JavaScript expression, in the page."""
        answer = self.ask("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def wait_until(self, true):
        deadline = time.monotonic() + PATIENCE_S
        while not true():
            assert time.monotonic() < deadline, "waited in vain"
            time.sleep(0.05)

    def place(self, selector):
        """x, y, width, height in pixels of the window."""
        return self.value("(r => [r.x, r.y, r.width, r.height])"
                          f"(document.querySelector({json.dumps(selector)}).getBoundingClientRect())")

    def picture(self, selector):
        """What is seen of an element: rows x columns x BGR."""
        clip = dict(zip(("x", "y", "width", "height"), map(round, self.place(selector))), scale=1)
        data = base64.b64decode(self.ask("Page.captureScreenshot", clip=clip)["data"])
        return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)

    def click(self, selector):
        """By mouse, on the element's middle."""
        x, y, width, height = self.place(selector)
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            button = {} if kind == "mouseMoved" else {"button": "left", "clickCount": 1}
            self.ask("Input.dispatchMouseEvent", type=kind, x=x + width / 2, y=y + height / 2, **button)
