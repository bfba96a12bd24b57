#!/bin/bash
# Starts redis-server as the service needs it: no files, no eviction, a user for each role (users.acl beside this file).
# Coordinators may read and write our keys; workers may take jobs, add results, say how they are, and see whether they are
# in quarantine. Nobody has scripts or administration.
# The user `default` is off, so a connection without a password can do nothing; that is also what Redis's protected mode
# asks for before it answers other machines at all.
# Passwords come from the environment. Further arguments are redis-server's.
set -eu

: "${NOCTURNE_REDIS_COORDINATOR_PASSWORD:?is not set: the password of the coordinator}"
: "${NOCTURNE_REDIS_WORKER_PASSWORD:?is not set: the password of the workers}"

hash() { printf %s "$1" | sha256sum | cut -d ' ' -f 1; }

umask 077
users=$(mktemp)
sed -e "s/@COORDINATOR@/$(hash "$NOCTURNE_REDIS_COORDINATOR_PASSWORD")/" \
    -e "s/@WORKER@/$(hash "$NOCTURNE_REDIS_WORKER_PASSWORD")/" "$(dirname "$0")/users.acl" >"$users"
unset NOCTURNE_REDIS_COORDINATOR_PASSWORD NOCTURNE_REDIS_WORKER_PASSWORD

exec redis-server --aclfile "$users" --save "" --appendonly no \
    --maxmemory "${NOCTURNE_REDIS_MEMORY:-512mb}" --maxmemory-policy noeviction "$@"
