"""What the checks of ROS 2 share whatever the middleware: a robot that runs."""

import atexit
import os
import subprocess
import sys
import threading
import time

# Long enough for any machine; nothing is judged by it.
PATIENCE_S = 40


def wait_for(what, condition):
    """The first true value of `condition`."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"not seen: {what}")


class Program:
    """A `rumbo` that runs until it is asked to end; what it prints."""

    def __init__(self, *arguments, ready):
        command = [os.environ["RUMBO_COMMAND"], *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        atexit.register(self.process.kill)
        self.lines = []
        threading.Thread(target=self._read, daemon=True).start()
        self.ready = wait_for(f"{ready} of {arguments}", lambda: self.said(ready) or self.process.poll() is not None)
        assert self.process.poll() is None, self.lines

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line.rstrip())

    def said(self, text):
        return next((line for line in list(self.lines) if text in line), None)

    def end(self):
        self.process.terminate()
        status = self.process.wait(PATIENCE_S)
        assert status == 0, (status, self.lines)


def lab(*arguments):
    folder = ["--out", sys.argv[1]]
    return Program("ros", "lab", "--no-browser", "--port", "0", *folder, *arguments, ready="http://")
