# SPDX-License-Identifier: BSD-3-Clause
"""Models of Sketchfab by its data API, version 3: a search, and archives of single models that a token may fetch."""
import os
import pathlib
import re
import shutil
import urllib.parse

from voxid.acquire import source
from voxid.acquire.archive import unpack_mesh
from voxid.acquire.web import Remote, Web, origin_of
from voxid.failure import BAD_USE, DAMAGED, Failure

API = "https://api.sketchfab.com/v3"
TOKEN, URL = "VOXID_SKETCHFAB_TOKEN", "VOXID_SKETCHFAB_URL"
PAGE = 24  # the most that the API gives at once
MOST_PAGES = 40  # of one word
ARCHIVES = ("glb", "gltf")  # that the API offers and voxid reads, best first


def query_in(title, queries):
    """Titles of people's own ("Mug - low poly (free)") name the thing in one of their parts."""
    found = (source.query_for(part, queries) for part in re.split(r"[|,;:()\[\]/]|\s[-–—]\s", title))
    return next(filter(None, found), None)


class Sketchfab(source.Source):
    """`parts` is a folder where what has come of a file waits for the next run."""

    name = "sketchfab"

    def __init__(self, parts, timeout_s=30, environment=os.environ):
        self._token = environment.get(TOKEN, "").strip()
        if not self._token:
            raise Failure(f"sketchfab wants a token: put yours (it is in your profile's settings there) into the "
                          f"environment as {TOKEN}", BAD_USE)
        if not re.fullmatch(r"[\x21-\x7e]+", self._token):
            raise Failure(f"{TOKEN} holds what no token has: spaces or other than ASCII", BAD_USE)
        self._base = (environment.get(URL) or API).rstrip("/")
        self._web = Web(timeout_s, {"Accept": "application/json", "User-Agent": "voxid"})
        self._parts = pathlib.Path(parts)

    def search(self, queries, synsets):
        seen = set()
        for query in queries:
            for found in self._results(query.word):
                if found.get("uid") in seen:
                    continue
                seen.add(found.get("uid"))
                candidate = self._candidate(found, queries)
                if candidate is not None:
                    yield candidate

    def _results(self, word):
        """Page by page: who wants no more of them does not ask for the next."""
        options = urllib.parse.urlencode({"type": "models", "q": word, "downloadable": "true", "count": PAGE})
        url = f"{self._base}/search?{options}"
        for _ in range(MOST_PAGES):
            page = self._web.json(url, self._token)
            results, following = page.get("results"), page.get("next")
            if not isinstance(results, list):
                raise Failure(f"{self._base}: an answer without results", DAMAGED)
            yield from (result for result in results if isinstance(result, dict))
            if not following or not results:
                return
            if not isinstance(following, str) or origin_of(following) != origin_of(self._base):
                raise Failure(f"{self._base}: the next page is on another host", DAMAGED)
            url = following

    def _candidate(self, found, queries):
        uid, title = found.get("uid"), found.get("name")
        if not isinstance(title, str) or not isinstance(uid, str) or not re.fullmatch(r"[A-Za-z0-9]{1,64}", uid):
            return None
        query = query_in(title, queries)
        if query is None or found.get("isDownloadable") is False:
            return None
        archives = _object(found, "archives")
        format_ = next((name for name in ARCHIVES if isinstance(archives.get(name), dict)), "gltf")
        user = _object(found, "user")
        author = user.get("displayName") or user.get("username")
        return source.Candidate("Sketchfab", source.file_name(uid), _text(title), format_,
                                _bytes_of(_object(archives, format_)), _text(_object(found, "license").get("label")),
                                _text(author), _text(found.get("viewerUrl")), query, uid)

    def fetch(self, candidate, target, limit_bytes):
        offered = self._web.json(f"{self._base}/models/{candidate.place}/download", self._token)
        archive = _object(offered, candidate.format)
        if not isinstance(archive.get("url"), str):
            raise Failure(f"{candidate.format} is not offered for download")
        self._parts.mkdir(parents=True, exist_ok=True)
        came = self._parts / f"{candidate.id}.{candidate.format}"
        self._web.download(Remote(archive["url"], _bytes_of(archive)), came, limit_bytes)
        try:
            self._unpack(came, target, candidate.format, limit_bytes)
        finally:
            came.unlink(missing_ok=True)

    @staticmethod
    def _unpack(came, target, format_, limit_bytes):
        if format_ == "glb":
            shutil.move(came, target)
            return
        found, data = unpack_mesh(came, limit_bytes)
        if found != format_:
            raise Failure(f"the archive holds {found}, expected {format_}", DAMAGED)
        target.write_bytes(data)


def _object(holder, field):
    value = holder.get(field)
    return value if isinstance(value, dict) else {}


def _bytes_of(archive):
    size = archive.get("size")
    return size if isinstance(size, int) and size > 0 else 0


def _text(value):
    return value if isinstance(value, str) else ""
