#!/bin/bash
# Makes a random password in each of these files that is not there yet: make-passwords FILE...
set -eu
umask 077

for file in "$@"; do
    [ -s "$file" ] && continue
    head -c 32 /dev/urandom | base64 -w 0 | tr '+/' '-_' | tr -d '=' >"$file.new"
    mv "$file.new" "$file"
    echo "made $file"
done
