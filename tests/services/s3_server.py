"""A server that speaks as much of S3 as our object store says: one bucket, objects in memory.

Put, get, head, delete and list, by Amazon S3's API reference. A digest that comes with an object is checked,
and calls that nobody signed are refused. Signatures themselves are not checked: the library that makes them
is not ours to test.
"""

import base64
import hashlib
import threading
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, unquote, urlsplit
from xml.sax.saxutils import escape


class S3Server:
    """Runs from construction to `stop`; `objects` has the bucket's content by key."""

    def __init__(self, bucket: str, key_id: str) -> None:
        self.objects: dict[str, bytes] = {}
        self.bucket = bucket
        self.key_id = key_id
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self.url = f"http://127.0.0.1:{self._server.server_port}"
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.01})
        self._thread.start()

    def stop(self) -> None:
        """Nobody listens there any more."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(_Handler):
            s3 = server

        return Handler


class _Handler(BaseHTTPRequestHandler):
    # One call to a connection, so that a server that has stopped is away for everybody.
    protocol_version = "HTTP/1.0"
    s3: S3Server

    def log_message(self, *_: Any) -> None:
        pass

    def do_PUT(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        if (key := self._key()) is None:
            return
        digest = base64.b64encode(hashlib.sha256(body).digest()).decode()
        if self.headers.get("x-amz-checksum-sha256") != digest:
            self._error(400, "BadDigest")
            return
        self.s3.objects[key] = body
        self._answer(200, b"", {"ETag": f'"{digest}"'})

    def do_GET(self) -> None:
        if (key := self._key()) is None:
            return
        if not key:
            self._list()
        elif key in self.s3.objects:
            self._object(self.s3.objects[key])
        else:
            self._error(404, "NoSuchKey")

    do_HEAD = do_GET  # noqa: N815

    def do_DELETE(self) -> None:
        if (key := self._key()) is not None:
            # Also where there is none: S3 says the same.
            self.s3.objects.pop(key, None)
            self._answer(204, b"")

    def _key(self) -> str | None:
        """What of the bucket is asked for, empty for all; None where the caller has got an error."""
        if f"Credential={self.s3.key_id}/" not in self.headers.get("Authorization", ""):
            self._error(403, "AccessDenied")
            return None
        bucket, _, key = unquote(urlsplit(self.path).path).removeprefix("/").partition("/")
        if bucket != self.s3.bucket:
            self._error(404, "NoSuchBucket")
            return None
        return key

    def _object(self, body: bytes) -> None:
        headers = {"ETag": f'"{hashlib.md5(body).hexdigest()}"', "Last-Modified": formatdate(usegmt=True)}  # noqa: S324
        span = self.headers.get("Range", "").removeprefix("bytes=")
        if not span:
            self._answer(200, body, headers)
            return
        first, _, last = span.partition("-")
        part = body[int(first) : int(last) + 1 if last else None]
        if not part:
            self._error(416, "InvalidRange")
            return
        end = int(first) + len(part) - 1
        self._answer(206, part, headers | {"Content-Range": f"bytes {first}-{end}/{len(body)}"})

    def _list(self) -> None:
        query = parse_qs(urlsplit(self.path).query)
        assert query["list-type"] == ["2"]
        (prefix,) = query.get("prefix", [""])
        found = "".join(
            f"<Contents><Key>{escape(key)}</Key><Size>{len(body)}</Size>"
            '<LastModified>2026-01-01T00:00:00Z</LastModified><ETag>"x"</ETag></Contents>'
            for key, body in sorted(self.s3.objects.items())
            if key.startswith(prefix)
        )
        self._answer(
            200, f"<ListBucketResult><IsTruncated>false</IsTruncated>{found}</ListBucketResult>".encode()
        )

    def _error(self, status: int, code: str) -> None:
        self._answer(status, f"<Error><Code>{code}</Code></Error>".encode())

    def _answer(self, status: int, body: bytes, headers: dict[str, str] | None = None) -> None:
        self.send_response(status)
        for name, value in {**(headers or {}), "Content-Length": str(len(body))}.items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)
