#!/bin/sh
# The tests of the Python module, with an interpreter that can load it.
#
#   run.sh NAME SOURCE BUILD SCRATCH [WHY]    WHY: why there is nothing to test; "" when there is
#
# NAME is that of test_NAME.py; `docs` runs the blocks of docs/python.md and docs/environments.md;
# `notebook` those of the notebook there; `reference` makes docs/python-reference.md again and
# compares; `pip` installs a copy of the checkout into an empty virtual environment, without network,
# and tests what is there then; `asan` builds the module once more with the sanitizers for addresses
# and undefined behaviour, on the same library. (CMake leaves an empty WHY out of what it hands on.)
set -eu
name=$1 source=$2 build=$3 scratch=$4 why=${5-}
here=$source/tests/python
[ -z "$why" ] || { echo "skipped: $why"; exit 77; }

# Debian's own knows its packages (numpy); another one on the PATH does as well.
python=
for candidate in /usr/bin/python3 python3; do
    "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || continue
    python=$candidate
    break
done
[ -n "$python" ] || { echo "skipped: no python3 of version 3.11 or later"; exit 77; }
rm -rf "$scratch"
mkdir -p "$scratch"
cd "$scratch"
export LARIAT_COMMAND="$build/lariat" PYTHONDONTWRITEBYTECODE=1

case $name in
docs)
    for page in python environments; do
        mkdir "$page"
        (cd "$page" && PYTHONPATH="$build/python" "$python" -X faulthandler "$here/docs.py" \
            "$source/docs/$page.md") || exit 1
    done
    ;;
notebook)
    PYTHONPATH="$build/python" "$python" -X faulthandler "$here/notebook.py" \
        "$source/docs/notebooks/organ.ipynb" || exit
    ;;
reference)
    PYTHONPATH="$build/python" "$python" "$here/reference.py" >"$scratch/page" || exit 1
    diff "$source/docs/python-reference.md" "$scratch/page" || {
        echo "docs/python-reference.md is not what the docstrings say; make it anew (tests/python/reference.py)"
        exit 1
    }
    ;;
pip)
    "$python" -c 'import venv, ensurepip' 2>/dev/null || { echo "skipped: no venv (apt-get install python3-venv)"; exit 77; }
    "$python" -m venv "$scratch/venv"
    # A stranger's copy: what is tracked, in another folder.
    git -C "$source" ls-files -z --cached --others --exclude-standard 2>/dev/null |
        (cd "$source" && xargs -0 tar cf -) | (mkdir "$scratch/copy" && tar xf - -C "$scratch/copy") || {
        echo "skipped: this is no git checkout"
        exit 77
    }
    # And the page, where it is built: wheels bring it along.
    page=$source/web/dist
    [ ! -e "$page/index.html" ] || { mkdir -p "$scratch/copy/web/dist" && cp -r "$page/." "$scratch/copy/web/dist/"; }
    # Compiled without optimisation, in half the time: the code is that of the release build. Of meshing
    # what reads images, unless in full.
    meshing=Images
    [ -z "${LARIAT_TEST_FULL:-}" ] || meshing=
    LARIAT_CMAKE_ARGS="-DCMAKE_C_FLAGS_RELEASE=-O0" \
        "$scratch/venv/bin/python" -m pip install --no-index --disable-pip-version-check \
        "$scratch/copy" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
    rm -rf "$scratch/copy"
    PYTHONPATH="$here" "$scratch/venv/bin/python" -X faulthandler "$here/test_meshing.py" $meshing || exit 1
    for test in model misuse envs study; do
        PYTHONPATH="$here" "$scratch/venv/bin/python" -X faulthandler "$here/test_$test.py" || exit 1
    done
    found=$("$scratch/venv/bin/python" -c 'from lariat._command import program; print(program())')
    [ "$found" = "$scratch/venv/bin/lariat" ] || { echo "not the wheel's command: $found"; exit 1; }
    if [ -e "$page/index.html" ]; then
        "$scratch/venv/bin/python" - "$page/index.html" "$source/examples/beam.yaml" <<'END' || exit 1
import subprocess, sys, urllib.request
import lariat
from lariat._command import program
with lariat.Simulation(lariat.Model(sys.argv[2])) as sim, lariat.Session(sim) as session:
    try:
        view = session.view(open=False)
    except lariat.UnsupportedError:
        sys.exit(0)  # built without libwebsockets
    assert lariat._viewer_folder and "site-packages" in lariat._viewer_folder, lariat._viewer_folder
    with urllib.request.urlopen(view.url) as answer, open(sys.argv[1], "rb") as page:
        assert answer.read() == page.read(), "another page than the wheel's"
# The command's too: the folder that it was built in is gone.
command = [program(), "view", "--port", "0", "--seconds", "20", sys.argv[2]]
with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
    url = child.stdout.readline().strip()
    with urllib.request.urlopen(url) as answer, open(sys.argv[1], "rb") as page:
        assert answer.read() == page.read(), "the command has another page"
    child.terminate()
END
    fi
    "$scratch/venv/bin/python" -m pip uninstall -y lariat >>"$scratch/log" 2>&1
    left=$(find "$scratch/venv" -name '*lariat*')
    [ -z "$left" ] || { echo "left behind: $left"; exit 1; }
    ;;
asan)
    runtime=$(gcc -print-file-name=libasan.so 2>/dev/null) undefined=$(gcc -print-file-name=libubsan.so)
    [ -e "$runtime" ] && [ -e "$undefined" ] || { echo "skipped: no gcc with sanitizers"; exit 77; }
    include=$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')
    [ -e "$include/Python.h" ] || { echo "skipped: no headers of $python"; exit 77; }
    cp -r "$build/python" "$scratch/python"
    ln -s "$build/lariat" "$scratch/lariat"
    gcc -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -shared \
        -fPIC -D_GNU_SOURCE -DPy_LIMITED_API=0x030b0000 -I"$include" -I"$source/include" \
        "$source"/python/*.c -o "$scratch/python/lariat/_lariat.abi3.so" -L"$build" -llariat \
        -Wl,-rpath,"$build"
    for test in model meshing simulation look batch envs session misuse study; do
        env LD_PRELOAD="$runtime $undefined" ASAN_OPTIONS=detect_leaks=0 PYTHONMALLOC=malloc \
            LARIAT_TEST_SANITIZED=1 PYTHONPATH="$scratch/python:$here" \
            "$python" "$here/test_$test.py" || exit 1
    done
    ;;
*) PYTHONPATH="$build/python:$here" "$python" -X faulthandler "$here/test_$name.py" ;;
esac
cd /
rm -rf "$scratch"
