#!/bin/sh
# Gradescope runs this as root, with a network, when the archive is uploaded.
set -eu
if ! command -v avr-gcc >/dev/null || [ ! -d /usr/share/arduino/hardware/arduino/avr ]; then
    apt-get update
    DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends gcc-avr avr-libc arduino-core-avr
fi
chmod 755 /autograder/source/rumbo
if ! /autograder/source/rumbo --version; then
    echo "The rumbo in the archive does not run here: choose a newer system in the autograder's settings (Ubuntu 24.04)," \
        "or give the archive one that was built for this system with --linux." >&2
    exit 1
fi
