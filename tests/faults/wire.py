"""A network that a test can spoil: a TCP port that leads to Redis' socket, by threads and nothing else."""

import random
import socket
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

_PIECE_BYTES = 65536
_LOOK_S = 0.05


@dataclass(frozen=True)
class Weather:
    """What happens to what passes.

    A packet that is lost comes again after `retransmission_s`: that is all that TCP lets its users see of it.
    """

    delay_s: float = 0.0
    loss: float = 0.0
    """Of pieces, 0 to 1."""
    retransmission_s: float = 1.0
    lost_answers: float = 0.0
    """Of what the server answers, 0 to 1: never delivered, and the connection ends. The call has happened."""


FAIR = Weather()


class Wire:
    """Carries bytes in both directions until a fault is set. Use it as a context manager."""

    def __init__(self, upstream: Path, seed: int = 1) -> None:
        self.weather = FAIR
        self.lost = 0
        """Answers that were not delivered."""
        self._upstream = upstream
        self._random = random.Random(seed)
        self._open = True
        self._silent: set[socket.socket] = set()
        self._asked: set[socket.socket] = set()
        """Servers that have not begun their answer, which is lost as a whole or not at all."""
        self._all: set[socket.socket] = set()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listener.getsockname()[1])
        self._is_silent = False
        threading.Thread(target=self._listen, daemon=True).start()

    def __enter__(self) -> "Wire":
        return self

    def __exit__(self, *_: object) -> None:
        self._open = False
        # A thread that waits for callers does not see that its socket is closed.
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self.cut()

    @property
    def connections(self) -> int:
        """How many were made and not ended."""
        return len(self._all) // 2

    def cut(self) -> None:
        """Ends all connections at once, and refuses others until `mend`."""
        self._open = False
        self._end_all()

    def fall_silent(self) -> None:
        """Drops all bytes silently until `mend`: connections stay half open, new ones too. Connections that
        were silent stay so for good, as behind a router that forgot them."""
        self._is_silent = True
        self._silent |= set(self._all)

    def mend(self) -> None:
        """Fair weather for new connections."""
        self.weather = FAIR
        self._is_silent = False
        self._open = True

    # Inside

    def _listen(self) -> None:
        while True:
            try:
                caller, _ = self._listener.accept()
            except OSError:
                return
            if not self._open:
                caller.close()
                continue
            server = socket.socket(socket.AF_UNIX)
            try:
                server.connect(str(self._upstream))
            except OSError:
                caller.close()
                continue
            for end in (caller, server):
                end.settimeout(_LOOK_S)
                self._all.add(end)
                if self._is_silent:
                    self._silent.add(end)
            for source, sink, answers in ((caller, server, False), (server, caller, True)):
                threading.Thread(target=self._carry, args=(source, sink, answers), daemon=True).start()

    def _carry(self, source: socket.socket, sink: socket.socket, answers: bool) -> None:
        try:
            while True:
                try:
                    piece = source.recv(_PIECE_BYTES)
                except TimeoutError:
                    continue
                if not piece:
                    return
                weather = self.weather
                if weather.delay_s:
                    late = weather.retransmission_s if self._random.random() < weather.loss else 0.0
                    time.sleep(weather.delay_s + late)
                if answers and self._is_lost(source, weather):
                    self.lost += 1
                    return
                if source in self._silent:
                    continue
                if not answers:
                    self._asked.add(sink)
                sink.settimeout(None)
                sink.sendall(piece)
                sink.settimeout(_LOOK_S)
        except OSError:
            return
        finally:
            self._end(source, sink)

    def _is_lost(self, server: socket.socket, weather: Weather) -> bool:
        if server not in self._asked:
            return False
        self._asked.discard(server)
        return self._random.random() < weather.lost_answers

    def _end_all(self) -> None:
        self._end(*self._all)

    def _end(self, *ends: socket.socket) -> None:
        for end in ends:
            self._all.discard(end)
            self._silent.discard(end)
            self._asked.discard(end)
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()
