#!/usr/bin/env bash
# The viewer in Debian's Chromium, without a screen: first its parts, then the page against a stand-in
# for the server, then against `lariat view` itself.
#
#     run.sh LARIAT WEB OUT          screenshots and what the engines wrote are left in OUT
#
# Skipped, with a sentence, where something of it is not there.
set -uo pipefail
lariat=$(realpath "$1")
web=$(realpath "$2")
out=$3

skip() {
    echo "skipped: $1"
    exit 77
}
chromium=${CHROMIUM:-/usr/bin/chromium}
command -v node >/dev/null || skip "node is not there (apt-get install nodejs)"
[ -x "$chromium" ] || skip "$chromium is not there (apt-get install chromium)"
[ -e "$web/dist/index.html" ] || skip "web/dist is not built (apt-get install nodejs npm, then make)"
[ -e "$web/node_modules/playwright-core" ] || skip "playwright-core is not there (cd web && npm ci)"

rm -rf "$out"
mkdir -p "$out"
"$lariat" demo-model "$out/probe" >/dev/null || exit 1
if "$lariat" view "$out/probe/uterus_live.yaml" --port 0 --seconds 0.1 2>&1 |
    grep -q 'no server for viewers'; then
    skip "this build has no server for viewers (apt-get install libwebsockets-dev)"
fi
export LARIAT=$lariat CHROMIUM=$chromium LARIAT_TEST_OUT
LARIAT_TEST_OUT=$(realpath "$out")
cd "$web" || exit 1
for part in ${PARTS:-units mock engine}; do
    timeout 240 node --test --test-concurrency=1 "test/$part.test.mjs" >"$out/$part.txt" 2>&1
    status=$?
    grep -E '^(not )?ok |^# (pass|fail) ' "$out/$part.txt"
    if [ $status -ne 0 ]; then
        cat "$out/$part.txt"
        exit 1
    fi
done
