"""A network between a browser and a server that can be cut, or fall silent, and be mended."""

from __future__ import annotations

import socket
from contextlib import suppress
from threading import Event, Thread

from processes import PATIENCE

TEXT = 0x81
"""Begins a frame of a WebSocket that is a text."""
LONGER = 126
"""Stands for the length of a frame whose length follows, in two bytes."""
MASKED = 128
"""From here on, the frame is one of a browser."""


class Proxy:
    """Passes on what comes to a port of its own.

    Attributes
    ----------
    port
        Its own.
    target
        That of the server, once there is one.
    """

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self.target = 0
        self._is_cut = self._is_to_tear = False
        self._flows = Event()
        self._flows.set()
        self._opens = Event()
        self._opens.set()
        self._torn = Event()
        self._sockets: list[socket.socket] = []
        self._silent: list[socket.socket] = []
        Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        """Close all connections, and refuse others."""
        self._is_cut = True
        self.drop()
        self._silent, self._sockets = self._sockets, []
        self.drop()

    def tear(self) -> None:
        """Cut it in the midst of the server's next message: only its first frame passes.

        Come back once it is cut: else a message that comes late would cut what was mended before.
        """
        self._torn.clear()
        self._is_to_tear = True
        assert self._torn.wait(PATIENCE), "no message came that could be torn"

    def hush(self) -> None:
        """Keep all connections, and pass nothing on."""
        self._flows.clear()

    def renew(self) -> None:
        """Pass on what comes by new connections; the old ones stay silent."""
        self._silent, self._sockets = self._sockets, []
        self._flows = Event()
        self._flows.set()

    def drop(self) -> None:
        """Close the connections that are silent for good."""
        for one in self._silent:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
        self._silent.clear()

    def mend_slowly(self) -> None:
        """Mend it, but have those wait who ask for a WebSocket."""
        self._opens.clear()
        self._is_cut = False

    def mend(self) -> None:
        self._is_cut = False
        self._flows.set()
        self._opens.set()

    def close(self) -> None:
        self.cut()
        self._flows.set()
        self._opens.set()
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                near, _ = self._listener.accept()
                if self._is_cut:
                    near.close()
                    continue
                try:
                    far = socket.create_connection(("127.0.0.1", self.target))
                except ConnectionRefusedError:
                    near.close()
                    continue
                self._sockets += [near, far]
                for ends in ((near, far), (far, near)):
                    Thread(target=self._pass_on, args=(*ends, self._flows), daemon=True).start()

    def _pass_on(self, source: socket.socket, sink: socket.socket, flows: Event) -> None:
        with suppress(OSError):
            while data := source.recv(1 << 16):
                flows.wait()
                if b"Upgrade: websocket" in data:
                    self._opens.wait()
                if self._is_to_tear and data[0] == TEXT and data[1] < MASKED:
                    self._is_to_tear = False
                    sink.sendall(_first_frame(data))
                    self.cut()
                    self._torn.set()
                    break
                sink.sendall(data)
        for one in (source, sink):
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()


def _first_frame(data: bytes) -> bytes:
    """Give a server's frame that is shorter than 64 KB: the header of a message is one."""
    start, length = (4, int.from_bytes(data[2:4])) if data[1] == LONGER else (2, data[1])
    return data[: start + length]
