#!/bin/sh
# Prints the Debian packages that have any of the given roles, one a line: debian-packages.sh ROLE...
set -eu
[ $# -gt 0 ] || { echo "usage: $0 ROLE..." >&2; exit 2; }

exec awk -v roles="$*" '
    BEGIN { count = split(roles, wanted, " "); for (i = 1; i <= count; i++) want[wanted[i]] = 1 }
    { sub(/#.*/, "") }
    NF == 0 { next }
    NF != 2 { printf "%s:%d: expected: package role[,role]\n", FILENAME, FNR >"/dev/stderr"; failed = 1; exit }
    {
        has = split($2, role, ",")
        hit = 0
        for (i = 1; i <= has; i++) { seen[role[i]] = 1; if (role[i] in want) hit = 1 }
        if (hit) print $1
    }
    END {
        if (failed) exit 1
        for (name in want) if (!(name in seen)) {
            printf "%s: no package has the role \"%s\"\n", FILENAME, name >"/dev/stderr"; failed = 1
        }
        exit failed
    }
' "$(dirname "$0")/debian-packages.txt"
