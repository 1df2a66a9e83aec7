#!/usr/bin/env bash
# What `make demo` shows: the demonstration organ in the browser, or, where this build has no viewer,
# the same organ pulled by a force, as files for ParaView.
#
#   tools/demo.sh [SECONDS]        ends by itself after so many; without it Ctrl-C does
set -euo pipefail
cd "$(dirname "$0")/.."
lariat=build/lariat folder=out/demo

$lariat demo-model $folder >/dev/null
# What the browser shows needs both: a server, and the page that npm makes.
doctor=$($lariat doctor --no-speed --json)
there() {
    grep -A 2 "\"name\": \"$1\"" <<<"$doctor" | grep -q '"there": true'
}
if there viewer && there page; then
    echo "Take hold of the organ with the mouse and pull. Ctrl-C ends. What else there is:"
    echo "    build/lariat --help; your own scan or mesh: README.md."
    open=
    [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] || open=--open
    exec $lariat view $folder/uterus_live.yaml --save-folder $folder/saved $open \
        ${1:+--seconds "$1"}
else
    what='the page that the viewer shows' how='apt-get install nodejs npm, then make demo; npm needs the network'
    there viewer || what=libwebsockets how='apt-get install libwebsockets-dev, then make demo'
    echo "This build has not $what, so there is nothing to see in a browser"
    echo "($how). The organ, pulled by a force:"
    $lariat run $folder/uterus.yaml --out $folder/results
    echo "Open $folder/results/uterus.pvd in ParaView to see it move."
fi
