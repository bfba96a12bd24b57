#!/bin/bash
# Starts one end of the tunnel for Redis between machines: start.sh server|client. Addresses and files come from the
# environment: NOCTURNE_TUNNEL_ACCEPT, _CONNECT, _CERTIFICATE, _KEY, _AUTHORITY, and for a client _NAME.
set -eu

[ "${1:-}" = server ] || [ "${1:-}" = client ] || { echo "usage: $0 server|client" >&2; exit 2; }

umask 077
settings=$(mktemp)
# What stands in the file as ${NAME} is taken from the environment, and missing ones are named.
while IFS= read -r line; do
    while [[ $line =~ \$\{([A-Z_]+)\} ]]; do
        name=${BASH_REMATCH[1]}
        line=${line//"\${$name}"/${!name:?is not set}}
    done
    printf '%s\n' "$line"
done <"$(dirname "$0")/$1.conf" >"$settings"
exec stunnel "$settings"
