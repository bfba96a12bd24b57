#!/bin/bash
# Health check: does a GET answer 200? http-ok HOST PORT PATH; needs nothing but bash.
set -eu

exec 3<>"/dev/tcp/$1/$2"
printf 'GET %s HTTP/1.1\r\nHost: %s:%s\r\nConnection: close\r\n\r\n' "$3" "$1" "$2" >&3
read -r -t 4 status <&3
[[ $status == "HTTP/1.1 200 "* ]] || { echo "$3: ${status:-no answer}"; exit 1; }
