# SPDX-License-Identifier: BSD-3-Clause
"""Catalogues of Sweet Home 3D (.sh3f, zip files), such as those of Debian's sweethome3d-furniture."""
import collections
import pathlib
import re
import zipfile
import zlib

from voxid.acquire import source
from voxid.acquire.archive import Archive
from voxid.failure import Failure

FURNITURE = pathlib.Path("/usr/share/sweethome3d/furniture")
MOST_PROPERTIES_BYTES = 16 << 20
PACKAGE = "Debian package sweethome3d-furniture"
# The catalogues' licence texts begin with these words; /usr/share/doc/sweethome3d-furniture/copyright says the same.
LICENCES = {
    "Public domain": ("CC0-1.0", "https://creativecommons.org/publicdomain/zero/1.0/"),
    "Creative Commons Attribution 3.0 United States":
        ("CC-BY-3.0-US", "https://creativecommons.org/licenses/by/3.0/us/"),
    "Creative Commons Attribution 3.0": ("CC-BY-3.0", "https://creativecommons.org/licenses/by/3.0/"),
}

Model = collections.namedtuple("Model", "id name member width_cm rotation author licence licence_url catalogue")
UPRIGHT = (1, 0, 0, 0, 1, 0, 0, 0, 1)


def read_properties(text):
    """Java's properties: Latin-1, \\uXXXX for the rest; keys are unique."""
    pairs = (line.split("=", 1) for line in text.splitlines() if "=" in line and not line.startswith("#"))
    unescape = lambda value: re.sub(r"\\u([0-9a-fA-F]{4})", lambda m: chr(int(m[1], 16)), value)
    return {key.strip(): unescape(value.strip()) for key, value in pairs}


def licence_of(catalogue):
    text = catalogue.get("license", "")
    return next((found for words, found in LICENCES.items() if text.startswith(words)), ("", ""))


def model_id(member):
    """katorlegaz/coffee-mug/coffee-mug.obj becomes katorlegaz_coffee_mug."""
    folder, *_, file = pathlib.PurePosixPath(member).parts
    return re.sub(r"[^a-z0-9]+", "_", f"{folder}_{pathlib.PurePosixPath(file).stem}".lower()).strip("_")


def models_of(archive):
    listed = archive.getinfo("PluginFurnitureCatalog.properties")
    if listed.file_size > MOST_PROPERTIES_BYTES:
        raise ValueError(f"its list has more than {MOST_PROPERTIES_BYTES} bytes")
    catalogue = read_properties(archive.read(listed).decode("latin-1"))
    licence, url = licence_of(catalogue)
    for key in catalogue:
        if not key.startswith("model#"):
            continue
        number = key[len("model#"):]
        of = lambda field, otherwise="": catalogue.get(f"{field}#{number}", otherwise)
        rotation = tuple(float(x) for x in of("modelRotation").split()) or UPRIGHT
        member = of("model").lstrip("/")
        yield Model(model_id(member), of("name"), member, float(of("width", "0")), rotation, of("creator"), licence,
                    url,
                    catalogue.get("name", ""))


class Catalogues(source.Source):
    """All .sh3f files of a folder."""

    name = "sh3d"

    def __init__(self, folder=FURNITURE):
        self._files = sorted(pathlib.Path(folder).glob("*.sh3f"))
        if not self._files:
            raise Failure(f"{folder} holds no .sh3f catalogue; scripts/install_deps installs sweethome3d-furniture")

    def search(self, queries, synsets):
        for path in self._files:
            yield from self._search(path, [query for query in queries if query.origin != "translation"])

    def _search(self, path, queries):
        try:
            with zipfile.ZipFile(path) as archive:
                for model in models_of(archive):
                    query = source.query_for(model.name, queries)
                    format_ = pathlib.PurePosixPath(model.member).suffix[1:].lower()
                    if query is None or format_ not in source.FORMATS:
                        continue
                    yield source.Candidate(f"{PACKAGE}, catalogue {model.catalogue}", model.id, model.name, format_,
                                           archive.getinfo(model.member).file_size, model.licence, model.author,
                                           model.licence_url, query, (path, model.member))
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, KeyError, ValueError) as error:
            raise Failure(f"{path} is no Sweet Home 3D catalogue: {error}") from None

    def fetch(self, candidate, target, limit_bytes):
        path, member = candidate.place
        with Archive(path, limit_bytes) as archive:
            target.write_bytes(archive.read(member))
