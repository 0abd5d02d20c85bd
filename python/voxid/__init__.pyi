# SPDX-License-Identifier: BSD-3-Clause
"""numpy in and out; nothing is copied that need not be. The global lock is released while something is computed, so
threads run beside one another. ValueError: a wrong argument. OSError: a file that cannot be read or written;
DamagedError: one that is not whole."""
import os
from typing import Callable, List, Optional, Sequence, Tuple, Union, overload

import numpy as np
import numpy.typing as npt

Camera = Tuple[float, float, float, float]
"""fx, fy, cx, cy in pixels; the centre of the first pixel is 0, 0."""
Path = Union[str, bytes, os.PathLike]
Mesh = Union[Path, Tuple[npt.ArrayLike, npt.ArrayLike]]
"""A file of a format that `voxid build` reads, or vertices (n, 3) and triangles (m, 3)."""

@overload
def describe(points: npt.NDArray, *, pairs: int = 10000, seed: int = 1) -> npt.NDArray[np.uint8]:
    """The paper's 416 bins of points (n, 3): metres, or micrometres if int32 (then without a copy)."""
@overload
def describe(depth: Union[npt.NDArray[np.uint16], npt.NDArray[np.float32]], mask: Optional[npt.NDArray[np.bool_]],
             camera: Camera) -> npt.NDArray[np.uint8]:
    """The 48 bytes of descriptor `default`, by the shipped projection, of an object in a depth image (rows, columns):
    uint16 millimetres, 0 = none, or float32 metres. `mask` says which pixels are the object; None: all with depth."""

@overload
def describe(mesh: Mesh, *, pairs: int = 10000, seed: int = 1) -> npt.NDArray[np.uint8]:
    """The paper's 416 bins of a whole model, by points that are spread evenly over its surface."""
def describe_views(mesh: Mesh, every: int = 1) -> npt.NDArray[np.uint8]:
    """Descriptor `default` of every `every`-th of the model's 80 views, made as those of an index are, a row a view;
    one that shows nothing is left out."""
def numbers(codes: npt.NDArray[np.uint8]) -> npt.NDArray[np.int8]:
    """What codes of `default` hold, two numbers a byte of the last axis: codes are compared by the squared Euclidean
    distance of these."""

def read_mesh(path: Path) -> Tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]:
    """Vertices (n, 3) and triangles (m, 3): those that have an area, and the vertices that these use."""
def render(mesh: Mesh, view: int = 0, *, clean: bool = False, seed: int = 1) -> Tuple[npt.NDArray[np.uint16], Camera]:
    """A depth image in millimetres (480 x 640) of a mesh from one of the 80 directions, and its camera. Size, distance,
    roll and noise follow from `seed`, as in `voxid render --seed`; `clean`: without noise. A file is read in a child
    process."""

class DamagedError(OSError):
    """A file that is empty, cut, or not what it says it is."""

class BuildReport:
    @property
    def categories(self) -> int:
        """In the index, as `bytes`; 0 of a part."""
    @property
    def models(self) -> int: ...
    @property
    def views(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    @property
    def skipped(self) -> List[Tuple[str, str]]:
        """Models (`category/file`) that could not be used, and why."""

def build(models: Path, out: Path, *, part: Optional[Tuple[int, int]] = None, resume: bool = False,
          jobs: Optional[int] = None, views_every: int = 1, keep_points: bool = False, descriptor: str = "default",
          projection: Optional[Path] = None, pairs: Optional[int] = None, code_bytes: Optional[int] = None,
          on_progress: Optional[Callable[[int, int, int], None]] = None) -> BuildReport:
    """What `voxid build` does, with its options (`code_bytes`: --bytes); the index has the same bytes. `part=(k, n)`:
    every n-th model from number k on, which is left in OUT.parts; `resume=True` takes what is there and writes the
    index. `jobs`: processes, by default as many as processors. `on_progress(done, models, views)` is called some ten
    times a second; what it raises, and Ctrl-C while models are drawn, ends the build, which `resume` continues. The
    processes are forked: no other thread may be in a function of this module meanwhile."""
def merge(indices: Sequence[Path], out: Path, *, replace: bool = False) -> None:
    """Writes what all the indices hold to `out`, which may be one of them, as `voxid merge` does. A model that two of
    them have is refused, or with `replace` taken from the later one."""

class Index:
    """A .vxi file, mapped; its searches may be asked by several threads at once."""

    @staticmethod
    def open(path: Path) -> "Index": ...
    def describe(self, depth: Union[npt.NDArray[np.uint16], npt.NDArray[np.float32]],
                 mask: Optional[npt.NDArray[np.bool_]],
                 camera: Camera) -> npt.NDArray[np.uint8]:
        """The code that this index is asked with: 48 bytes in `default`, or 32; the 416 bins in `paper`."""
    def nearest(self, code: npt.NDArray[np.uint8], count: int = 20, *, exact: bool = True,
                lists: int = 32) -> Tuple[npt.NDArray[np.uint32], npt.NDArray[np.uint32]]:
        """Numbers of the nearest views, nearest first, and their distances. `count`: 1 to 64. `exact=False`: only the
        nearest `lists` lists of `default`, or the paper's buckets, are compared."""
    def place_of(self, view: int) -> Tuple[int, int, int]:
        """Category and model of a view, as numbers into `categories` and `models`, and its direction (0 to 79)."""
    @property
    def codes(self) -> npt.NDArray[np.uint8]:
        """All codes, a row a view: the mapped file itself, read-only."""
    @property
    def categories(self) -> List[str]: ...
    @property
    def models(self) -> List[str]: ...
    def __len__(self) -> int:
        """Number of views."""
