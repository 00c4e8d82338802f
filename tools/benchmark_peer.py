"""What all peers of tools/benchmark.py share: a process of its own that says its name and then answers each line of its standard input with a line."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence


class Peer:
    """A process that serves. ``name`` is the peer's, with its version: the first line that it wrote."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str] | None = None) -> None:
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
        self.command = " ".join(command)
        self.name = self._line()

    def _line(self) -> str:
        line = self.process.stdout.readline().strip()
        if not line:
            raise RuntimeError(f"the peer `{self.command}` ended with status {self.process.wait()}; what it said stands above")
        return line

    def ask(self, request: str) -> list[str]:
        """The words of the answer to the line ``request``. Raises RuntimeError where the peer is gone."""
        self.process.stdin.write(f"{request}\n")
        self.process.stdin.flush()
        return self._line().split()

    def close(self) -> None:
        """Ends the process."""
        self.process.stdin.close()
        self.process.wait()
