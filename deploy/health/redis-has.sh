#!/bin/bash
# Health check: is there such a key in Redis? redis-has KEY HOST PORT; needs nothing but bash. Comes as the user
# NOCTURNE_REDIS_USER with NOCTURNE_REDIS_PASSWORD, where they are set.
set -eu
LC_ALL=C

# A command as Redis reads it: the number of words, and each with its length in bytes, so that passwords may have any
# characters.
send() {
    printf '*%d\r\n' $# >&3
    for word in "$@"; do
        printf '$%d\r\n%s\r\n' "${#word}" "$word" >&3
    done
}

# Its answer, in one line.
answer() {
    IFS= read -r -t 2 reply <&3 || { echo "Redis does not answer"; exit 1; }
    reply=${reply%$'\r'}
}

exec 3<>"/dev/tcp/$2/$3"
if [ -n "${NOCTURNE_REDIS_USER:-}" ]; then
    send AUTH "$NOCTURNE_REDIS_USER" "${NOCTURNE_REDIS_PASSWORD:-}"
    answer
    [ "$reply" = +OK ] || { echo "$reply"; exit 1; }
fi
send EXISTS "$1"
answer
[ "$reply" = ":1" ] || { echo "$1: $reply"; exit 1; }
