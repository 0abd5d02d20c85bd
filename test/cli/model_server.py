# SPDX-License-Identifier: BSD-3-Clause
"""A server on loopback that speaks the JSON of Sketchfab's data API, and misbehaves as it is told."""
import base64
import hashlib
import http.server
import io
import json
import struct
import threading
import time
import urllib.parse
import zipfile

TOKEN = "0123456789abcdef"


def scene_of(mesh):
    """(glTF as an object, its buffer)."""
    vertices, triangles = mesh
    points = b"".join(struct.pack("<3f", *v) for v in vertices)
    numbers = b"".join(struct.pack("<3I", *t) for t in triangles)
    low, high = ([side(v[i] for v in vertices) for i in range(3)] for side in (min, max))
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3", "min": low,
                           "max": high},
                          {"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
                            {"buffer": 0, "byteOffset": len(points), "byteLength": len(numbers)}],
            "buffers": [{"byteLength": len(points) + len(numbers)}]}, points + numbers


def glb_of(scene, buffer=b""):
    """Without a chunk for the buffer if there is none."""
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(buffer), b"BIN\0") + buffer if buffer else b""
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def glb(mesh):
    return glb_of(*scene_of(mesh))


def packed(members):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return file.getvalue()


def gltf_zip(mesh, folder="", **more):
    scene, buffer = scene_of(mesh)
    scene["buffers"][0]["uri"] = "scene.bin"
    scene["images"] = [{"uri": "textures/none.png"}]
    return packed({folder + "scene.gltf": json.dumps(scene), folder + "scene.bin": buffer, **more})


class Model:
    """`habits`: what goes wrong with its download; see Handler.send_file."""

    def __init__(self, uid, title, data, format_="glb", **habits):
        self.uid, self.title, self.data, self.format, self.habits = uid, title, data, format_, habits


class Handler(http.server.BaseHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def do_GET(self):
        self.server.asked.append((self.path, dict(self.headers)))
        try:
            path = urllib.parse.urlsplit(self.path)
            if path.path.startswith("/files/"):
                return self.send_file(self.server.models[path.path.split("/")[2]])
            if self.headers.get("Authorization") != f"Token {TOKEN}":
                return self.send_json({"detail": "Invalid token."}, 401)
            if path.path == "/v3/search":
                return self.send_page(urllib.parse.parse_qs(path.query))
            uid = path.path.split("/")[3]
            self.send_download(self.server.models[uid])
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True

    def send_json(self, value, code=200, headers=()):
        self.send_bytes(json.dumps(value).encode(), code, headers)

    def send_bytes(self, data, code=200, headers=()):
        self.send_response(code)
        for name, text in (("Content-Length", str(len(data))), *headers):
            self.send_header(name, text)
        self.end_headers()
        self.wfile.write(data)

    def send_page(self, options):
        """The models are what every word finds; `refusals` answers come before the first page."""
        if self.server.refusals:
            code, headers = self.server.refusals.pop(0)
            return self.send_json({"detail": "no"}, code, headers)
        if self.server.text is not None:
            return self.send_bytes(self.server.text)
        first = int(options.get("cursor", ["0"])[0])
        models = list(self.server.models.values())
        page = models[first:first + self.server.page]
        following = f"{self.server.base}/search?cursor={first + len(page)}" if first + len(page) < len(models) else None
        self.send_json({"results": [self.about(model) for model in page], "next": following, "previous": None})

    @staticmethod
    def about(model):
        return {"uid": model.uid, "name": model.title, "isDownloadable": True,
                "viewerUrl": f"https://example.org/{model.uid}",
                "user": {"username": "ann", "displayName": "Ann"}, "license": {"label": "CC Attribution", "slug": "by"},
                "archives": {model.format: {"size": len(model.data)}}}

    def send_download(self, model):
        if "answer" in model.habits:
            return self.send_bytes(model.habits["answer"])
        url = model.habits.get("url", f"{self.server.files}/{model.uid}")
        self.send_json({model.format: {"url": url, "size": model.habits.get("size", len(model.data)), "expires": 300}})

    def send_file(self, model):
        habits, data = model.habits, model.data
        time.sleep(habits.get("sleep_s", 0))
        if habits.get("code"):
            return self.send_json({}, habits["code"], habits.get("headers", ()))
        if "redirect" in habits:
            return self.send_bytes(b"", 302, [("Location", habits["redirect"])])
        first = 0
        code, headers = 200, [("ETag", '"1"')] if habits.get("etag", True) else []
        if self.headers.get("If-Range") == '"1"':
            first = int(self.headers["Range"][len("bytes="):-1])
            if first >= len(data):
                return self.send_json({}, 416, [("Content-Range", f"bytes */{len(data)}")])
            code, headers = 206, headers + [("Content-Range", f"bytes {first}-{len(data) - 1}/{len(data)}")]
        wanted = habits.get("sum", hashlib.sha256(data).digest())
        headers.append(("Digest", "sha-256=" + base64.b64encode(wanted).decode()))
        self.send_response(code)
        for name, text in (("Content-Length", str(len(data) - first)), *headers):
            self.send_header(name, text)
        self.end_headers()
        stop = len(data) // 2 if habits.get("breaks", 0) > 0 else len(data)
        habits["breaks"] = habits.get("breaks", 0) - 1
        self.wfile.write(data[first:max(stop, first)])


class Server:
    """Runs while the block lasts. `asked`: (path, headers) of every request."""

    def __init__(self, models, page=2, refusals=(), text=None):
        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        port = self._server.server_address[1]
        self._server.base, self._server.files = f"http://127.0.0.1:{port}/v3", f"http://localhost:{port}/files"
        self._server.models = {model.uid: model for model in models}
        self._server.page, self._server.refusals, self._server.text, self._server.asked = page, list(refusals), text, []
        self._server.daemon_threads = True
        self.base, self.asked = self._server.base, self._server.asked

    def __enter__(self):
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.05})
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()
