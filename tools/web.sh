#!/usr/bin/env bash
# Builds the viewer: web/ into web/dist, when something there is newer. The engine works without it
# and then serves a page that says how to get it, so nothing here fails but by `--required`.
#
#   tools/web.sh [--required]
set -uo pipefail
cd "$(dirname "$0")/../web" || exit 1

required=no
[ "${1:-}" != --required ] || required=yes

# give_up SENTENCE
give_up() {
    echo "viewer: $1" >&2
    [ $required = no ]
    exit
}

# One at a time: several build folders share web/.
exec 9<package.json
! command -v flock >/dev/null || flock 9

newer() {
    [ ! -e "$1" ] || [ -n "$(find src public index.html package-lock.json vite.config.ts \
        tsconfig.json -newer "$1" -print -quit 2>/dev/null)" ]
}
newer dist/index.html || exit 0
command -v npm >/dev/null ||
    give_up "not built, npm is not there (optional: apt-get install nodejs npm)"
if [ ! -e node_modules/.package-lock.json ] ||
    [ package-lock.json -nt node_modules/.package-lock.json ]; then
    echo "viewer: npm fetches what it is built from" >&2
    npm ci --no-audit --no-fund --loglevel=error >&2 || {
        rm -rf node_modules
        give_up "not built, npm could not fetch what it needs; check the network and try again"
    }
    touch node_modules/.package-lock.json
fi
npx --no-install vite build --logLevel warn >&2 ||
    give_up "not built, vite failed, see above"
# Also when nothing in it has changed.
touch dist/index.html
