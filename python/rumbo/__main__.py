"""`python -m rumbo`: says where the command is."""

from __future__ import annotations

import sys

WORDS = """\
The Python package has no command of its own: its functions are in `import rumbo`, and help(rumbo) lists them.
rumbo.read_log("LOG.mcap") reads a log. To look at one on the dashboard, or for anything else of the command line,
install the program: `cargo install --path crates/cli` in a checkout of Rumbo, then `rumbo replay LOG.mcap`."""

if __name__ == "__main__":
    print(WORDS, file=sys.stderr)
    sys.exit(2)
