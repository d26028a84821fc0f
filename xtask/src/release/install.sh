#!/bin/sh
# Installs the command rumbo for this user, or below PREFIX.
set -eu
files="${RUMBO_FILES:-@FILES@}"
prefix="${PREFIX:-$HOME/.local}"
if [ -z "$files" ]; then
  echo "install.sh: set RUMBO_FILES to the address of a release's files" >&2
  exit 2
fi
case "$(uname -s)" in
  Linux) system=linux ;;
  Darwin) system=macos ;;
  *) echo "install.sh: no archive for $(uname -s); build it with cargo" >&2; exit 2 ;;
esac
case "$(uname -m)" in
  x86_64 | amd64) machine=x86_64 ;;
  aarch64 | arm64) machine=aarch64 ;;
  *) echo "install.sh: no archive for $(uname -m); build it with cargo" >&2; exit 2 ;;
esac
name="rumbo-@VERSION@-$machine-$system.tar.gz"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
curl -fsSLO "$files/$name"
curl -fsSLO "$files/SHA256SUMS"
if command -v sha256sum >/dev/null; then sum="sha256sum"; else sum="shasum -a 256"; fi
if ! grep " $name\$" SHA256SUMS | $sum -c - >/dev/null 2>&1; then
  echo "install.sh: $name is not the file that the release names; nothing is installed" >&2
  exit 1
fi
mkdir -p "$prefix"
tar -xzf "$name" --strip-components=1 -C "$prefix"
echo "installed $prefix/bin/rumbo"
case ":$PATH:" in
  *":$prefix/bin:"*) ;;
  *) echo "add $prefix/bin to your PATH" ;;
esac
