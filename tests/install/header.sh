#!/bin/sh
# The public headers on their own, as the compilers of embedding programs see them, and that the one
# for C++ has every function of the one for C.
set -eu
header=$1 cpp=$2
strict="-Wall -Wextra -pedantic-errors -Werror -fsyntax-only"
# shellcheck disable=SC2086
for standard in c99 c17; do
    "${CC:-cc}" -std=$standard $strict -x c "$header"
done
# shellcheck disable=SC2086
for standard in c++11 c++17; do
    "${CXX:-c++}" -std=$standard $strict -x c++ "$header"
done
include=$(dirname "$header")
for compiler in "${CXX:-c++}" clang++; do
    command -v "$compiler" >/dev/null || continue
    for standard in c++17 c++20; do
        # shellcheck disable=SC2086
        "$compiler" -std=$standard $strict -Wshadow -Wconversion -I "$include" -x c++ "$cpp"
    done
done
missing=$("${CC:-cc}" -E -P "$header" | tr '\n' ' ' | tr ';{}' '\n\n\n' |
    sed -n 's/.*visibility("default").*[^a-z_0-9]\(lar_[a-z_0-9]*\)(.*/\1/p' |
    sed 's/_sized$//' | while read -r name; do grep -q "$name[^a-z_0-9]" "$cpp" || printf '%s ' "$name"; done)
[ -z "$missing" ] || { echo "header: lariat.hpp lacks $missing" >&2; exit 1; }
echo "header: C++17 and C++20 accept lariat.hpp"
echo "header: C99, C17, C++11 and C++17 accept lariat.h alone"
