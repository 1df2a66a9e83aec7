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
# Either may be there without the other, and npm is a script of node's: it has to run. Sentences name
# what to do; what vite needs, package.json says under "engines".
for tool in node npm; do
    "$tool" --version >/dev/null 2>&1 ||
        give_up "not built, $tool is not there or does not run (optional: apt-get install nodejs npm)"
done
node -e 'process.exit(process.versions.node.split(".")[0] >= 18 ? 0 : 1)' ||
    give_up "not built, node $(node --version) is too old (optional: install Node.js 18 or newer)"
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
# Its licence wants to go along with three.js, which is inside the page.
! cp node_modules/three/LICENSE dist/three-licence.txt 2>/dev/null || chmod 644 dist/three-licence.txt
# Also when nothing in it has changed.
touch dist/index.html
