# SPDX-License-Identifier: BSD-3-Clause
"""HTTP for sources on the net: bounded in bytes, time and tries; a token never leaves its host."""
import base64
import collections
import hashlib
import http.client
import json
import os
import pathlib
import re
import time
import urllib.error
import urllib.parse
import urllib.request

from voxid.failure import DAMAGED, Failure

TRIES = 4
LONGEST_WAIT_S = 120  # what a Retry-After may ask for
MOST_JSON_BYTES = 16 << 20
BLOCK_BYTES = 1 << 16

# Where a file lies and what it is to be: `size` in bytes, 0 if not known.
Remote = collections.namedtuple("Remote", "url size")


class Unreached(Failure):
    """The source could not be reached, or broke off: another run may do better."""


class Again(Exception):
    """Worth another try, after `wait_s` if the server named a time."""

    def __init__(self, sentence, wait_s=None):
        super().__init__(sentence)
        self.wait_s = wait_s


def origin_of(url):
    parts = urllib.parse.urlsplit(url)
    return parts.scheme, parts.hostname, parts.port


class _Redirects(urllib.request.HTTPRedirectHandler):
    """To http and https only, never from https to http, and without the token to another host."""

    def redirect_request(self, request, answer, code, message, headers, url):
        scheme, was = urllib.parse.urlsplit(url).scheme, urllib.parse.urlsplit(request.full_url).scheme
        if scheme not in ("http", "https") or (was, scheme) == ("https", "http"):
            raise Failure(f"{host_of(request.full_url)} sends on to {scheme}:, which is not followed")
        following = super().redirect_request(request, answer, code, message, headers, url)
        if following is not None and origin_of(url) != origin_of(request.full_url):
            following.remove_header("Authorization")
        return following


def host_of(url):
    return urllib.parse.urlsplit(url).netloc.rpartition("@")[2]


def _opener():
    """http and https; what urllib knows besides (file:, ftp:, data:) is left out."""
    opener = urllib.request.OpenerDirector()
    for handler in (urllib.request.ProxyHandler, urllib.request.HTTPHandler, urllib.request.HTTPSHandler, _Redirects,
                    urllib.request.HTTPErrorProcessor, urllib.request.HTTPDefaultErrorHandler):
        opener.add_handler(handler())
    return opener


def _wait_of(headers):
    """Seconds that a Retry-After asks for; the form with a date counts as not given."""
    text = (headers.get("Retry-After") or "").strip()
    return int(text) if re.fullmatch(r"\d{1,6}", text) else None


def _refusal(error, host):
    """What an answer above 399 means."""
    reasons = {401: "the token is not accepted", 403: "the token does not allow this", 404: "it is not there"}
    reason = reasons.get(error.code, error.reason)
    sentence = f"{host}: {error.code}, {reason}"
    if 300 <= error.code < 400:
        return Failure(f"{host}: {error.code}, it sends on to where nothing is fetched from")
    if error.code == 429 or error.code >= 500:
        return Again(sentence, _wait_of(error.headers))
    return Failure(sentence) if error.code in (404, 410) else Unreached(sentence)


class Web:
    """`timeout_s`: without a byte for so long a try ends; twenty times that is the most for one file. Waits
    between tries begin with a thirtieth of it and double."""

    def __init__(self, timeout_s=30, headers=None):
        self._timeout_s, self._headers, self._opener = timeout_s, headers or {}, _opener()

    def json(self, url, token=""):
        """The object that a URL answers with."""
        def once():
            with self._open(url, token) as answer:
                text = answer.read(MOST_JSON_BYTES + 1)
            if len(text) > MOST_JSON_BYTES:
                raise Failure(f"{host_of(url)}: an answer of more than {MOST_JSON_BYTES} bytes", DAMAGED)
            try:
                value = json.loads(text)
            except (ValueError, RecursionError):
                raise Unreached(f"{host_of(url)}: the answer is no JSON", DAMAGED) from None
            if not isinstance(value, dict):
                raise Unreached(f"{host_of(url)}: the answer is no JSON object", DAMAGED)
            return value
        return self._tried(once, url)

    def download(self, remote, target, limit_bytes):
        """Writes the file to `target`. What came before a broken line, in this run or an earlier one, is not fetched
        again: it waits in `target`.part until the file is whole."""
        if remote.size > limit_bytes:
            raise Failure(f"{remote.size} bytes, more than the limit of {limit_bytes}")
        part = _Part(target)
        self._tried(lambda: self._more(remote, part, limit_bytes, time.monotonic() + 20 * self._timeout_s), remote.url)
        part.finish()

    def _more(self, remote, part, limit_bytes, deadline):
        headers = {"Range": f"bytes={part.size()}-", "If-Range": part.etag} if part.resumable() else {}
        try:
            answer = self._open(remote.url, "", headers)
        except urllib.error.HTTPError as error:
            if error.code != 416:
                raise
            error.close()
            part.drop()  # nothing comes after it: a run was killed between its last byte and its end
            raise Again(f"{host_of(remote.url)}: 416, {error.reason}") from None
        with answer:
            part.begin(answer)
            self._copy(answer, part, limit_bytes, deadline, host_of(remote.url))
        if part.expected is not None and part.size() != part.expected:
            raise Again(f"{host_of(remote.url)}: the line broke after {part.size()} of {part.expected} bytes")
        wrong = part.wrong(remote.size)
        if wrong:
            part.drop()
            raise Unreached(f"{host_of(remote.url)}: {wrong}", DAMAGED)

    def _copy(self, answer, part, limit_bytes, deadline, host):
        while block := answer.read1(BLOCK_BYTES):
            part.add(block)
            if part.size() > limit_bytes:
                part.drop()
                raise Failure(f"{host}: more than the limit of {limit_bytes} bytes")
            if time.monotonic() > deadline:
                raise Unreached(f"{host}: not there within {20 * self._timeout_s:g} s; {part.size()} bytes came")

    def _open(self, url, token, headers=None):
        if urllib.parse.urlsplit(url).scheme not in ("http", "https"):
            raise Failure(f"'{url[:60]}' is no http or https address")
        request = urllib.request.Request(url, headers={**self._headers, **(headers or {})})
        if token:
            request.add_unredirected_header("Authorization", f"Token {token}")
        return self._opener.open(request, timeout=self._timeout_s)

    def _tried(self, once, url):
        host = host_of(url)
        for number in range(TRIES):
            try:
                return once()
            except urllib.error.HTTPError as error:
                error.close()
                problem = _refusal(error, host)
            except Again as again:
                problem = again
            except (urllib.error.URLError, http.client.HTTPException, TimeoutError, ConnectionError,
                    ValueError) as error:
                problem = Again(f"{host}: {_reason(error, self._timeout_s)}")
            if isinstance(problem, Failure):
                raise problem
            wait_s = problem.wait_s if problem.wait_s is not None else self._timeout_s / 30 * 2 ** number
            if wait_s > LONGEST_WAIT_S:
                raise Unreached(f"{problem}; it asks to wait {wait_s:g} s, try again then")
            if number + 1 < TRIES:
                time.sleep(wait_s)
        raise Unreached(f"{problem}; tried {TRIES} times")


def _reason(error, timeout_s):
    inner = getattr(error, "reason", error)
    if isinstance(inner, TimeoutError) or "timed out" in str(inner):
        return f"nothing came for {timeout_s:g} s"
    return getattr(inner, "strerror", None) or str(inner) or type(inner).__name__


class _Part:
    """A file on its way: `target`.part, and `target`.etag, which says of what it is a part."""

    def __init__(self, target):
        self._target = pathlib.Path(target)
        self._file, self._etag = (self._target.with_name(self._target.name + end) for end in (".part", ".etag"))
        self._digests, self.expected = {}, None

    @property
    def etag(self):
        return self._etag.read_text() if self._etag.exists() else ""

    def size(self):
        return self._file.stat().st_size if self._file.exists() else 0

    def resumable(self):
        """A part of what the server did not name cannot be known again."""
        return self.size() > 0 and self.etag != ""

    def begin(self, answer):
        """Goes on where the server does, else anew."""
        if answer.status != 206 or not (answer.headers.get("Content-Range") or "").startswith(f"bytes {self.size()}-"):
            self.drop()
            self._file.write_bytes(b"")
        etag = answer.headers.get("ETag") or ""
        if etag and not etag.startswith("W/"):
            self._etag.write_text(etag)
        length = answer.headers.get("Content-Length") or ""
        self.expected = self.size() + int(length) if re.fullmatch(r"\d{1,15}", length) else None
        self._digests = _digests_of(answer.headers)

    def add(self, block):
        with open(self._file, "ab") as file:
            file.write(block)

    def wrong(self, size):
        """What the whole file fails of what the server said of it; empty if nothing."""
        if size and self.size() != size:
            return f"{self.size()} bytes came, {size} were announced"
        for name, wanted in self._digests.items():
            if _sum_of(self._file, name) != wanted:
                return f"the {name} sum of what came is not the one announced"
        return ""

    def drop(self):
        for path in (self._file, self._etag):
            path.unlink(missing_ok=True)

    def finish(self):
        os.replace(self._file, self._target)
        self._etag.unlink(missing_ok=True)


def _sum_of(path, name):
    digest = hashlib.new(name)
    with open(path, "rb") as file:
        while block := file.read(BLOCK_BYTES):
            digest.update(block)
    return digest.digest()


def _digests_of(headers):
    """hashlib's name -> sum, of the headers that carry one of the whole file."""
    found = {}
    texts = [("md5", headers.get("Content-MD5")), ("sha256", headers.get("x-amz-checksum-sha256"))]
    for name in ("Digest", "Repr-Digest"):
        sums = re.findall(r"sha-256=:?([A-Za-z0-9+/]+=*)", headers.get(name) or "", re.IGNORECASE)
        texts += [("sha256", text) for text in sums]
    for name, text in texts:
        try:
            if text:
                found[name] = base64.b64decode(text, validate=True)
        except ValueError:
            continue
    return found
