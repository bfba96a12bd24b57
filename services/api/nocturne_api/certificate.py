"""The certificate of both endpoints, read again when its files are renewed; connections keep the one they
began with."""

import asyncio
import logging
import ssl
from pathlib import Path

import grpc

from nocturne_api import limits
from nocturne_api.addresses import AddressError
from nocturne_api.background.task import Background

_log = logging.getLogger(__name__)


class Certificate(Background):
    """The files' content, as it was last when key and certificate belonged together."""

    def __init__(self, certificate: Path, key: Path) -> None:
        """Raises AddressError where the files can't be used."""
        self._files = certificate, key
        self._contexts: list[ssl.SSLContext] = []
        try:
            self._stamp = self._stamp_now()
            self._read()
        except OSError as error:
            raise AddressError(f"{certificate} and {key} can't be used for TLS: {error}") from error

    @property
    def expires(self) -> float:
        """Unix time."""
        return self._expires

    def serve(self, context: ssl.SSLContext) -> None:
        """New connections of this context get the certificate of then."""
        context.load_cert_chain(*self._files)
        self._contexts.append(context)

    def grpc_credentials(self) -> grpc.ServerCredentials:
        """gRPC asks before each handshake which certificate to show."""
        seen = self._pair

        def changed() -> grpc.ServerCertificateConfiguration | None:
            nonlocal seen
            if self._pair is seen:
                return None
            seen = self._pair
            return grpc.ssl_server_certificate_configuration([seen])

        first = grpc.ssl_server_certificate_configuration([seen])
        # The types say that there is always something new; gRPC itself says None for nothing.
        return grpc.dynamic_ssl_server_credentials(
            first,
            changed,  # type: ignore[arg-type]
            require_client_authentication=False,
        )

    def reload(self) -> None:
        """Reads the files again; where they can't be used, the certificate before stays in use."""
        try:
            self._read()
            for context in self._contexts:
                context.load_cert_chain(*self._files)
        except OSError as error:
            _log.error("the certificate was not renewed: %s: %s", self._files[0], error)
        else:
            _log.info("the certificate was read again; it is good until %s", self._until)

    def _read(self) -> None:
        certificate, key = self._files
        # Raises ssl.SSLError, an OSError, for a key of another certificate: one file is renewed first.
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(certificate, key)
        # Private in Python 3.11, and all that the standard library has; a library would be for one date.
        self._until = str(ssl._ssl._test_decode_cert(str(certificate))["notAfter"])  # type: ignore[attr-defined]
        self._expires = float(ssl.cert_time_to_seconds(self._until))
        self._pair = key.read_bytes(), certificate.read_bytes()

    def _stamp_now(self) -> list[tuple[int, int]]:
        """Another one for another content: Kubernetes changes a link, others the file."""
        found = [path.stat() for path in self._files]
        return [(each.st_mtime_ns, each.st_ino) for each in found]

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(limits.CERTIFICATE_LOOK_S)
            try:
                stamp = self._stamp_now()
            except OSError:
                continue
            if stamp != self._stamp:
                self._stamp = stamp
                self.reload()
