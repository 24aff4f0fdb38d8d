"""A way to a server that can be cut and mended: a proxy, which a client takes for the server."""

import socket
import threading
from contextlib import suppress


class Way:
    """Passes on bytes between 127.0.0.1:`port` and the server at 127.0.0.1:`target` until it is cut."""

    def __init__(self, target: int) -> None:
        self._target, self.port = target, 0
        self.mend()

    def mend(self) -> None:
        """Accept connections, at the same port as before."""
        self._listener = socket.create_server(("127.0.0.1", self.port))
        self.port = self._listener.getsockname()[1]
        self._ends: list[socket.socket] = []
        threading.Thread(target=self._accept, args=(self._listener,), daemon=True).start()

    def cut(self) -> None:
        """End all connections and refuse new ones."""
        for end in (self._listener, *self._ends):
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _accept(self, listener: socket.socket) -> None:
        with suppress(OSError):  # it was cut
            while True:
                client, _ = listener.accept()
                server = socket.create_connection(("127.0.0.1", self._target))
                self._ends += [client, server]
                for pair in ((client, server), (server, client)):
                    threading.Thread(target=_pass_on, args=pair, daemon=True).start()


def _pass_on(source: socket.socket, target: socket.socket) -> None:
    with source, target:
        with suppress(OSError):
            while data := source.recv(1 << 16):
                target.sendall(data)
        for end in (source, target):  # a socket at which another thread waits would outlast being closed
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
