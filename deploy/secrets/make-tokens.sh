#!/bin/bash
# Makes an API token of a data folder in each of these files, unless the data folder knows the one that is there:
# make-tokens DATA SCOPE=FILE... Files are readable to their owner; that of scope `read` to all, for Prometheus.
set -eu
umask 077
data=$1
shift

for pair in "$@"; do
    scope=${pair%%=*} file=${pair#*=}
    # Each data folder's tokens have names of their own: a volume that outlived its data folder holds a stranger's.
    if [ -s "$file" ] && nocturne token list --data "$data" | grep -qF "$(<"$file.name")  $scope "; then
        continue
    fi
    name=compose-$scope-$(head -c 4 /dev/urandom | od -An -tx1 | tr -d ' \n')
    nocturne token create "$name" --scope "$scope" --data "$data" >"$file.new"
    printf %s "$name" >"$file.name"
    [ "$scope" != read ] || chmod 0444 "$file.new"
    mv "$file.new" "$file"
    echo "made $file"
done
