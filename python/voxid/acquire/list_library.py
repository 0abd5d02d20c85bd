# SPDX-License-Identifier: BSD-3-Clause
"""voxid library list|licences: what a library holds, and what a product that uses it must attribute."""
import collections
import json

from voxid.acquire.library import Library
from voxid.acquire.parser import Parser
from voxid.acquire.source import counted
from voxid.failure import CANNOT_DO, Failure


def list_models(library, as_json):
    for key, note in library.models():
        if as_json:
            print(json.dumps({"model": key, **note}, ensure_ascii=False, sort_keys=True))
        else:
            print(f"{key}  {note.get('verdict', 'kept')}  {note.get('licence') or 'licence not stated'}  "
                  f"{note.get('author', '')}")


def list_licences(library, as_json):
    groups = collections.defaultdict(list)
    for key, note in library.kept():
        groups[note.get("licence") or ""].append({"model": key, "title": note.get("title", ""),
                                                  "author": note.get("author", ""),
                                                  "source": note.get("source", ""), "url": note.get("url", "")})
    for licence, models in sorted(groups.items()):
        if as_json:
            print(json.dumps({"licence": licence, "models": models}, ensure_ascii=False))
            continue
        print(f"{licence or 'licence not stated: ask before you ship'}: {counted(len(models), 'model')}")
        for model in models:
            print("  " + "; ".join(filter(None, (f"{model['model']}: \"{model['title']}\"",
                                                 model["author"] and f"by {model['author']}",
                                                 model["source"], model["url"]))))


def run(arguments):
    parser = Parser(prog="voxid library", description="What a library holds, and what must be attributed.")
    parser.add_argument("what", choices=["list", "licences"],
                        help="every model with its verdict, or licences with those who made the models")
    parser.add_argument("library", help="folder that `voxid acquire --out` wrote")
    parser.add_argument("--json", action="store_true", help="one JSON object a line")
    options = parser.parse_args(arguments)
    library = Library(options.library)
    if not (library.root / "library.json").exists():
        raise Failure(f"{library.root}/library.json is not there; `voxid acquire --out {library.root}` makes one",
                      CANNOT_DO)
    {"list": list_models, "licences": list_licences}[options.what](library, options.json)
    return 0
