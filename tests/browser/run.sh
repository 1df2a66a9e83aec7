#!/usr/bin/env bash
# The viewer in Debian's Chromium, without a screen: first its parts, then the page against a stand-in
# for the server, then against `lariat view` itself.
#
#     run.sh LARIAT WEB OUT [PART...]    screenshots and what the engines wrote are left in OUT
#
# PART is units, mock, look, engine or jaws; without one all of them.
#
# Skipped, with a sentence, where something of it is not there.
set -uo pipefail
lariat=$(realpath "$1")
web=$(realpath "$2")
out=$3
shift 3

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
# A browser that draws in software on two busy cores misses a moment now and then: tests that fail are
# tried once more, by themselves, and it is said. What fails twice has failed.
try_part() {
    local name=$1 said=$2
    shift 2
    timeout 400 node --test --test-concurrency=1 "$@" "test/$name.test.mjs" >"$said" 2>&1
    local status=$?
    grep -E '^(not )?ok |^# (pass|fail) ' "$said" | grep -v '# SKIP'
    return $status
}
# The tests that failed, one pattern each, into `again`; all of them when none was named.
failed_of() {
    again=()
    while IFS= read -r name; do
        again+=(--test-name-pattern "^$(printf '%s' "$name" | sed 's/[][\\.*^$+?(){}|/]/\\&/g')\$")
    done < <(sed -n 's/^not ok [0-9]* - //p' "$1")
}
[ $# -gt 0 ] || set -- units mock look engine jaws
for part; do
    try_part "$part" "$out/$part.txt" && continue
    failed_of "$out/$part.txt"
    echo "$part failed, see $out/$part.txt; once more:"
    try_part "$part" "$out/$part-again.txt" "${again[@]}" && continue
    cat "$out/$part.txt" "$out/$part-again.txt"
    exit 1
done
