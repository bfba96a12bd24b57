#!/bin/bash
# Starts the service if it is not running (data folder: ./data), renders the Cornell box through it, and says where things
# are. The service goes on afterwards, so that the page can be looked at. NOCTURNE_PORT chooses another port.
set -euo pipefail
cd "$(dirname "$0")/.."

port=${NOCTURNE_PORT:-7070}
export NOCTURNE_URL=http://127.0.0.1:$port

ready() { python3 -c "import sys, urllib.request as u; u.urlopen('$NOCTURNE_URL/readyz?exclude=merging', timeout=2)" 2>/dev/null; }

if ! ready; then
    mkdir -p data
    setsid nocturne up --data data --port "$port" >data/service.log 2>&1 </dev/null &
    service=$!
    for _ in $(seq 600); do
        ready && break
        kill -0 "$service" 2>/dev/null || { echo "The service stopped:" >&2; tail -n 20 data/service.log >&2; exit 1; }
        sleep 0.2
    done
    ready || { echo "The service does not answer; see data/service.log" >&2; exit 1; }
fi

id=$(nocturne submit examples/cornell/scene.json --width 512 --height 512 --samples 64 --json |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["id"])')
nocturne watch "$id"
mkdir -p build/demo
nocturne get "$id" --exr build/demo/cornell.exr --png build/demo/cornell.png --json >build/demo/cornell.json

python3 deploy/demo_report.py build/demo/cornell.json "$NOCTURNE_URL"
