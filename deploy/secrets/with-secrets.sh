#!/bin/bash
# Runs a command with secrets from files in its environment, and in nobody else's: with-secrets COMMAND... For every
# variable NOCTURNE_..._FILE that is set, NOCTURNE_... becomes what that file holds.
set -eu

for variable in ${!NOCTURNE_@}; do
    [[ $variable == *_FILE ]] || continue
    [ -r "${!variable}" ] || { echo "$variable: can't read ${!variable}" >&2; exit 2; }
    export "${variable%_FILE}=$(<"${!variable}")"
    unset "$variable"
done
exec "$@"
