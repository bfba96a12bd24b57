#!/bin/bash
# Health check: is there such a key in Redis? redis-has KEY HOST PORT; needs nothing but bash.
set -eu

exec 3<>"/dev/tcp/$2/$3"
printf 'EXISTS %s\r\n' "$1" >&3
read -r -t 2 reply <&3
[ "${reply%$'\r'}" = ":1" ] || { echo "$1: ${reply:-no answer}"; exit 1; }
