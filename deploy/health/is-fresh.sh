#!/bin/bash
# Health check: was a file written within the last seconds? is-fresh FILE SECONDS. Coordinator and worker
# set the time of the file that --alive names every second or two; one that hangs does it no more.
set -eu

[ -e "$1" ] || { echo "$1: not there yet"; exit 1; }
age=$(($(date +%s) - $(stat -c %Y "$1")))
[ "$age" -le "$2" ] || { echo "$1: $age s old"; exit 1; }
