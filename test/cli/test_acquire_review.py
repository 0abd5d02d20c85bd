# SPDX-License-Identifier: BSD-3-Clause
"""voxid acquire --review: the page, its pictures, what it takes, and what it does not answer."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import urllib.error
import urllib.request

import cv2
import numpy as np
import pytest

import solids

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("VOXID", pathlib.Path(os.environ.get("VOXID_BUILD", "build")) / "bin" / "voxid")
sys.path.insert(0, str(ROOT / "python"))
from voxid.acquire import meaning  # noqa: E402

pytestmark = pytest.mark.skipif(not (meaning.DATABASE / "data.noun").exists(), reason="wordnet-base is not installed")
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
    command = [PROGRAM, "acquire", "mug", "--sense", "4", "--depth", "0", "--source", tmp_path / "in", "--out", tmp_path / "lib", "--review"]
    process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    line = process.stderr.readline()
    assert "wait to be kept or dropped at http://127.0.0.1:" in line, line
    yield process, line.split()[-1]
    process.kill()
    process.wait()


def test_a_click_keeps_and_drops(review, tmp_path):
    process, address = review
    text = get(address).decode()
    assert text.count('type="checkbox"') == 3 and "&lt;b&gt;x&amp;&quot; mug" in text and "<b>x" not in text
    strip = cv2.imdecode(np.frombuffer(get(f"{address}1.png"), np.uint8), cv2.IMREAD_UNCHANGED)
    assert strip.shape == (160, 12 * 160) and all((strip[:, 160 * i:160 * (i + 1)] < 250).mean() > 0.05 for i in range(12))
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
    assert sorted(note["verdict"] for note in notes.values() if "verdict" in note) == ["dropped: by hand", "kept", "kept"]


def test_a_browser_shows_the_page(review, tmp_path):
    browser = shutil.which("chromium")
    if browser is None:
        pytest.skip("chromium is not installed")
    picture = tmp_path / "page.png"
    command = [browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-proxy-server", f"--user-data-dir={tmp_path / 'profile'}",
               "--window-size=700,500", f"--screenshot={picture}", review[1]]
    subprocess.run(command, capture_output=True, timeout=90, env={**os.environ, "HOME": str(tmp_path)})
    page = cv2.imread(str(picture))
    green = (page[..., 1] > 140) & (page[..., 0] < 80) & (page[..., 2] < 80)
    assert green.sum() > 3 * 160  # three cards, each with a border that says kept
    grey = (np.ptp(page.astype(int), axis=2) < 5) & (page[..., 0] > 60) & (page[..., 0] < 220)
    assert grey.sum() > 3 * 2000  # and a shaded view
