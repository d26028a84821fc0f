#!/bin/sh
# Gradescope runs this as root for each submission; it needs no network.
set -eu
# The compiler runs as another user: assignment, hidden seeds and earlier results are closed to it.
chmod go-rwx /autograder
trap 'chmod go+rx /autograder' EXIT
mkdir -p /autograder/results
export RUMBO_CACHE=/var/cache/rumbo
/autograder/source/rumbo grade /autograder/source/assignment/assignment.toml --autograder /autograder --language @LANGUAGE@
