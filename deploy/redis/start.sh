#!/bin/bash
# Starts redis-server as the service needs it: no files, no eviction, and one user, the coordinator (users.acl beside this
# file). It may read and write our keys, and makes a user of each machine that enrols (nocturne_coordinator/queue/guard.py),
# which may take jobs, add results, say how its workers are, and see what it is told. Nobody has scripts.
# The user `default` is off, so a connection without a password can do nothing; that is also what Redis's protected mode
# asks for before it answers other machines at all.
# The password comes from the environment. Further arguments are redis-server's.
set -eu

: "${NOCTURNE_REDIS_COORDINATOR_PASSWORD:?is not set: the password of the coordinator}"

hash() { printf %s "$1" | sha256sum | cut -d ' ' -f 1; }

coordinator=$(hash "$NOCTURNE_REDIS_COORDINATOR_PASSWORD")
unset NOCTURNE_REDIS_COORDINATOR_PASSWORD

# The users come by standard input, so that no file of theirs stays behind.
exec redis-server --save "" --appendonly no \
    --maxmemory "${NOCTURNE_REDIS_MEMORY:-512mb}" --maxmemory-policy noeviction "$@" - \
    < <(sed -e "s/@COORDINATOR@/$coordinator/" "$(dirname "$0")/users.acl")
