# SPDX-License-Identifier: BSD-3-Clause
"""From sources to judged candidates: what is not settled in the library is fetched, judged and compared."""
import collections
import datetime
import errno
import sys

from voxid.acquire import judge, source
from voxid.acquire.library import checksum
from voxid.acquire.web import Unreached
from voxid.failure import Failure

NO_ROOM = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EROFS)  # nobody's fault but ours: everything ends
FAILURES_IN_A_ROW = 3  # of one source, after which it is left alone

# A candidate that has been fetched: `key` its place in the library, `mesh` the file, `digest` its SHA-256. What is not
# `settled` (its source could not be reached) is tried again by the next run.
Found = collections.namedtuple("Found", "key candidate mesh digest verdict settled")


def say(sentence):
    print(f"voxid: {' '.join(str(sentence).split())}", file=sys.stderr, flush=True)


class Gatherer:
    """Meshes are put into `folder`."""

    def __init__(self, library, category, folder, limit_bytes):
        self._library, self._category = library, category
        self._folder, self._limit_bytes = folder, limit_bytes
        self.broken = []  # sentences of sources that ended early

    def gather(self, sources, queries, synsets, most):
        """At most so many candidates, of all sources in turn, each judged."""
        seen = {key.rsplit(".", 1)[0]: (key.rsplit(".", 1)[1], note.get("sha256", ""))
                for key, note in self._library.models(self._category) if "." in key}
        found = []
        for where in sources:
            try:
                for one in self._of(where, queries, synsets, seen):
                    if len(found) == most:
                        return found
                    found.append(one)
            except judge.NoReader:
                raise
            except (Failure, OSError) as failure:
                self._unless_no_room(failure)
                self.broken.append(f"{where.name}: {failure}")
                say(self.broken[-1])
        return found

    def _of(self, where, queries, synsets, seen):
        in_a_row = 0
        for candidate in map(source.printable, where.search(queries, synsets)):
            key = self._key_of(where, candidate, seen)
            if key is None:
                continue
            one = self._fetch_and_judge(where, candidate, f"{key}.{candidate.format}")
            seen[key] = candidate.format, one.digest
            yield one
            in_a_row = 0 if one.settled else in_a_row + 1
            if in_a_row == FAILURES_IN_A_ROW:
                raise Failure(f"given up after {in_a_row} failures in a row; the last: {one.verdict.reason}")

    def _key_of(self, where, candidate, seen):
        """Its place in the library, without the ending; None if it is among `seen` (key -> format, SHA-256). Where
        another file has its name, of another folder perhaps, it gets a sum too."""
        key = f"{self._category}/{where.name}_{candidate.id}"
        if key not in seen:
            return key
        format_, digest = seen[key]
        if format_ != candidate.format or not digest:
            return None
        own = where.digest(candidate)
        return f"{key}_{own[:8]}" if own and (format_, own) not in seen.values() else None

    def _fetch_and_judge(self, where, candidate, key):
        mesh = self._folder / f"{len(list(self._folder.iterdir()))}.{candidate.format}"
        try:
            where.fetch(candidate, mesh, self._limit_bytes)
        except (Failure, OSError) as failure:
            self._unless_no_room(failure)
            verdict = judge.Verdict(source.one_line(str(failure)), 0, None, None)
            return Found(key, candidate, None, "", verdict, not isinstance(failure, (Unreached, OSError)))
        return Found(key, candidate, mesh, checksum(mesh), judge.judge(mesh), True)

    def _unless_no_room(self, failure):
        if isinstance(failure, OSError) and failure.errno in NO_ROOM:
            raise OSError(failure.errno, failure.strerror, str(self._folder)) from None

    def _known(self):
        """(key, shape) of the library's models; each is described once, for good."""
        described = self._library.described(self._category)
        known = []
        for key, note in self._library.kept(self._category):
            digest = note.get("sha256") or checksum(self._library.root / key)
            if digest not in described:
                described[digest] = judge.judge(self._library.root / key).shape
            if described[digest] is not None:
                known.append((key, described[digest]))
        return known, described

    def without_duplicates(self, found):
        """Drops what has the shape or the bytes of an earlier one, or of one that the library has already. Also the
        shapes of what is in the library, and of all by SHA-256."""
        known, described = self._known() if found else ([], {})
        old = [shape for _, shape in known]
        known = [(key, shape.bins) for key, shape in known]
        digests = {note.get("sha256"): key for key, note in self._library.kept(self._category)}
        result = []
        for one in found:
            if not one.verdict.reason:
                twin = digests.get(one.digest) or judge.duplicate_of(one.verdict.shape.bins, known)
                if twin:
                    one = one._replace(verdict=one.verdict._replace(reason=f"the same shape as {twin}"))
                else:
                    known.append((one.key, one.verdict.shape.bins))
                    digests[one.digest] = one.key
                    described[one.digest] = one.verdict.shape
            result.append(one)
        return result, old, described


def ranked(found, old):
    """(strangeness, found) of those that pass, the most usual first; then those dropped."""
    passed = [one for one in found if not one.verdict.reason]
    strange = judge.strangeness([shape.views for shape in old + [one.verdict.shape for one in passed]])[len(old):]
    by_strangeness = sorted(zip(strange, passed), key=lambda pair: (pair[0], pair[1].key))
    return by_strangeness, [one for one in found if one.verdict.reason]


def note_of(one, verdict):
    """What library.json keeps of a candidate."""
    candidate = one.candidate
    note = {"title": candidate.title, "source": candidate.source, "url": candidate.url, "licence": candidate.licence,
            "author": candidate.author, "word": candidate.word.word, "sha256": one.digest, "verdict": verdict,
            "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")}
    return {field: value for field, value in note.items() if value}
