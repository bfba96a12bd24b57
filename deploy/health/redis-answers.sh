#!/bin/bash
# Health check: does Redis answer commands? redis-answers HOST PORT; needs nothing but bash, and no password: that Redis
# asks for one is an answer of its one loop, which is what can hang.
set -eu

exec 3<>"/dev/tcp/$1/$2"
printf 'PING\r\n' >&3
IFS= read -r -t 2 reply <&3 || { echo "Redis does not answer"; exit 1; }
case "${reply%$'\r'}" in
    +PONG | "-NOAUTH Authentication required.") ;;
    *) echo "$reply"; exit 1 ;;
esac
