# SPDX-License-Identifier: BSD-3-Clause
"""Is a file a model worth keeping? Each is read in a process of its own, with limits: a mesh that crashes the
reader costs itself."""
import base64
import collections
import json
import pathlib
import resource
import signal
import subprocess
import sys
import zlib

import numpy as np

import voxid
from voxid.acquire.look import NOT_LOADED
from voxid.acquire.source import counted
from voxid.failure import Failure

SECONDS, MEMORY_BYTES = 90, 6 << 30  # the reader's own child has 60 s and 4 GiB (doc/build.md)
LOOK = [sys.executable, "-B", "-E", "-s", "-X", "utf8", str(pathlib.Path(__file__).with_name("look.py"))]
TRIANGLES = (4, 2_000_000)
THINNEST = 1e-3  # the second longest side, as a share of the longest; less is a line
# See difference(). Turned and scaled copies stay below it, other shapes above (doc/acquisition.md).
SAME_SHAPE = 0.03
NEIGHBOURS = 3
FARTHEST = 254 * 64 ** 0.5  # between two codes of signed bytes

# `reason` says why a candidate was dropped, empty if it was not; `shape` is its Shape.
Verdict = collections.namedtuple("Verdict", "reason triangles shape thumbnail")
# `bins`: the 416 of the whole model; `views`: codes of some of its views, a row a view.
Shape = collections.namedtuple("Shape", "bins views")


class NoReader(Failure):
    """voxid itself, or a part of it, cannot be started: says nothing of a mesh, and ends the run."""


def _limit():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(words, mesh):
    """(what the child printed, reason): one of the two is None or empty; the reason is one sentence about how it ended.
    NoReader if it could not begin."""
    try:
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                              timeout=SECONDS, preexec_fn=_limit)
    except subprocess.TimeoutExpired:
        return None, f"not read within {SECONDS} s"
    if done.returncode < 0:
        return None, f"its reader died of {signal.Signals(-done.returncode).name}"
    if done.returncode > 0:
        lines = done.stderr.strip().splitlines() or [f"its reader ended with {done.returncode}"]
        reason = lines[-1].removeprefix("voxid: ").removeprefix(f"{mesh}: ")
        if reason.startswith("cannot start") or done.returncode == NOT_LOADED:
            raise NoReader(reason)
        return None, reason
    return done.stdout, ""


def look(mesh):
    """(what look.py prints of a mesh, reason)."""
    folders = [str(pathlib.Path(part).parent) for part in voxid.__path__]
    out, reason = run([*LOOK, str(mesh), *folders], mesh)
    return (None, reason) if reason else (json.loads(out), "")


def opencv():
    """Loaded when the first picture is made: that takes long, and senses and words need none."""
    import cv2
    return cv2


def shaded(depth_mm, size_px=160, fill=True):
    """A depth image as a grey picture, lit from the camera; with `fill` cut to the object."""
    rows, columns = np.nonzero(depth_mm)
    if not len(rows):
        return np.full((size_px, size_px), 255, np.uint8)
    if fill:
        depth_mm = depth_mm[rows.min():rows.max() + 1, columns.min():columns.max() + 1]
    cut = np.pad(depth_mm.astype(np.float32), ((0, 1), (0, 1)), "edge")  # one row has no slope
    slope_y, slope_x = np.gradient(cut)
    light = 40 + 190 / np.sqrt(1 + 0.3 * (slope_x ** 2 + slope_y ** 2))
    picture = np.where(cut > 0, light, 255).astype(np.uint8)
    side = max(picture.shape)
    square = np.full((side, side), 255, np.uint8)
    top, left = (side - picture.shape[0]) // 2, (side - picture.shape[1]) // 2
    square[top:top + picture.shape[0], left:left + picture.shape[1]] = picture
    cv2 = opencv()
    return cv2.resize(square, (size_px, size_px), interpolation=cv2.INTER_AREA)


def depth_of(picture):
    """Millimetres, as look.picture() packed them."""
    pixels = zlib.decompress(base64.b64decode(picture["deflated"]))
    return np.frombuffer(pixels, np.uint16).reshape(picture["shape"])


def _wrong_with(seen, depth_mm):
    triangles, extents = seen["triangles"], sorted(seen["extents"])
    if not TRIANGLES[0] <= triangles <= TRIANGLES[1]:
        return f"{counted(triangles, 'triangle')}, expected {TRIANGLES[0]} to {TRIANGLES[1]:,}".replace(",", " ")
    if extents[1] < THINNEST * extents[2]:
        return "a line, not a body"
    return "" if depth_mm.any() else "shows nothing"


def shape_of(seen):
    return Shape(np.array(seen["bins"], np.int32), np.array(seen["views"], np.int8).reshape(len(seen["views"]), -1))


def judge(mesh):
    """What a mesh file is, by what look.py sees of it."""
    seen, reason = look(mesh)
    if reason:
        return Verdict(reason, 0, None, None)
    depth_mm = depth_of(seen["thumbnail"])
    return Verdict(_wrong_with(seen, depth_mm), seen["triangles"], shape_of(seen), shaded(depth_mm))


def difference(a, b):
    """L1 distance of two descriptors as a share of the most that is possible, the sum of both: 0 to 1."""
    return float(np.abs(a - b).sum()) / max(1, int(a.sum() + b.sum()))


def view_difference(a, b):
    """Each view's Euclidean distance to the other model's nearest, averaged over the views of both: 0 to 1."""
    if not len(a) or not len(b):
        return 1.0
    a, b = a.astype(np.float32), b.astype(np.float32)
    squares = (a ** 2).sum(1)[:, None] + (b ** 2).sum(1)[None] - 2 * a @ b.T
    table = np.sqrt(np.maximum(squares, 0))
    return float(table.min(1).mean() + table.min(0).mean()) / 2 / FARTHEST


def duplicate_of(bins, others):
    """Of (name, bins): the name of the nearest that is the same shape, or None."""
    near = min(((difference(bins, other), name) for name, other in others), default=(1.0, None))
    return near[1] if near[0] < SAME_SHAPE else None


def strangeness(all_views):
    """For each of a class its mean distance to its three nearest others; the outliers have the largest. What has no
    views is as strange as can be."""
    count = len(all_views)
    if count < 2:
        return [0.0] * count
    table = np.full((count, count), np.inf)
    for i in range(count):
        for k in range(i):
            table[i, k] = table[k, i] = view_difference(all_views[i], all_views[k])
    nearest = np.sort(table, axis=1)[:, :min(NEIGHBOURS, count - 1)]
    return nearest.mean(axis=1).tolist()


def contact_sheet(pictures, columns=6, size_px=160):
    """(caption, thumbnail or None) in rows, each with its caption under it."""
    cv2, rows = opencv(), []
    for first in range(0, len(pictures), columns):
        row = np.full((size_px + 22, columns * size_px), 255, np.uint8)
        for place, (caption, picture) in enumerate(pictures[first:first + columns]):
            left = place * size_px
            if picture is not None:
                row[:size_px, left:left + size_px] = picture
            cv2.putText(row, caption[:22], (left + 4, size_px + 14), cv2.FONT_HERSHEY_SIMPLEX, 0.38, 0, 1, cv2.LINE_AA)
        rows.append(row)
    return np.vstack(rows) if rows else np.full((size_px, columns * size_px), 255, np.uint8)
