#!/bin/sh
# The public header on its own, as the compilers of embedding programs see it.
set -eu
header=$1
strict="-Wall -Wextra -pedantic-errors -Werror -fsyntax-only"
# shellcheck disable=SC2086
for standard in c99 c17; do
    "${CC:-cc}" -std=$standard $strict -x c "$header"
done
# shellcheck disable=SC2086
for standard in c++11 c++17; do
    "${CXX:-c++}" -std=$standard $strict -x c++ "$header"
done
echo "header: C99, C17, C++11 and C++17 accept lariat.h alone"
