#!/bin/sh
# The layer rule once more, on what is linked: a room calls only functions of rooms that it may
# include from (check.sh looks at the includes; a declaration of one's own would go around it).
#
#   links.sh ROOT BUILD    checks the object files of a build
#   links.sh --self-test   plants a call upwards and expects it found
set -eu
here=$(cd "$(dirname "$0")" && pwd)

# check SHORT HEADER...: what nm says, from standard input.
check() {
    short=$1
    shift
    awk -v short="$short" -f "$here/rooms.awk" -f "$here/links.awk" "$@" -
}

self_test() {
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    echo 'LAR_API void lar_public(void);' >"$scratch/lariat.h"
    sound='a.dir/base/x.c.o:0 T lar_low
a.dir/session/y.c.o:0 T lar_public
a.dir/session/y.c.o: U lar_low
a.dir/session/y.c.o:0 T lar_inside
a.dir/server/v.c.o: U lar_low
a.dir/server/v.c.o: U lar_public
b.dir/cli/z.c.o: U lar_low
b.dir/cli/z.c.o: U lar_public'
    printf '%s\n' "$sound" | check 1 "$scratch/lariat.h" >/dev/null ||
        { echo "links: sound calls are refused"; exit 1; }
    for planted in 'a.dir/base/x.c.o: U lar_public' 'b.dir/cli/z.c.o: U lar_inside' \
        'a.dir/server/v.c.o: U lar_inside'; do
        if printf '%s\n%s\n' "$sound" "$planted" | check 1 "$scratch/lariat.h" >/dev/null; then
            echo "links: not found: $planted"
            exit 1
        fi
    done
    echo "links: every planted call was found"
}

case ${1:-} in
--self-test) self_test ;;
'') echo "usage: links.sh ROOT BUILD | --self-test" >&2; exit 2 ;;
*)
    # An old build folder has objects of sources that are no more.
    find "$2/src/CMakeFiles" -name '*.o' | while read -r object; do
        source=${object#*.dir/}
        [ ! -e "$1/src/${source%.o}" ] || echo "$object"
    done | xargs -d '\n' nm -A | check "" "$1/include/lariat.h" "$1/include/lariat_sizes.h" "$1/include/lariat_fit.h"
    ;;
esac
