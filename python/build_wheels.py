"""What pip calls (PEP 517): builds the extension with CMake and packs it as a wheel.

    pip install .                 in the checkout; nothing is fetched
    pip wheel . -w out            a wheel for CPython 3.11 and later on this kind of machine

It needs what the library needs to be built (tools/setup.sh), python3-dev's headers, and of Python
its standard library only, so that it works in an empty virtual environment without network. The
library is inside the extension, and the command goes along; libxml2, libyaml and the like are the
system's. LARIAT_CMAKE_ARGS: further arguments for CMake.
"""

import base64
import hashlib
import os
import platform
import re
import shlex
import shutil
import subprocess
import sysconfig
import tarfile
import tempfile
import zipfile

SOURCE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# For several processes, which the module does not have, and for one study of the command.
WITHOUT = "mpi;petsc;ucx"


def _version():
    with open(os.path.join(SOURCE, "CMakeLists.txt"), encoding="utf-8") as file:
        return re.search(r"project\(lariat VERSION ([0-9.]+)", file.read()).group(1)


def _metadata():
    with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as file:
        readme = file.read()
    return ("Metadata-Version: 2.1\nName: lariat\n" f"Version: {_version()}\n"
            "Summary: Real-time finite elements for soft tissue\nLicense: Apache-2.0\n"
            "Requires-Python: >=3.11\nDescription-Content-Type: text/markdown\n\n" + readme)


def _run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    if done.returncode:
        raise RuntimeError(f"{shlex.join(command)} failed:\n{done.stdout}")
    return done.stdout


def _build(folder):
    """Configures and builds; returns the folder of the package and the command."""
    if not shutil.which("cmake"):
        raise RuntimeError("cmake is missing; tools/setup.sh installs what Lariat is built with")
    ninja = ["-G", "Ninja"] if shutil.which("ninja") else []
    said = _run("cmake", "-S", SOURCE, "-B", folder, *ninja, "-DCMAKE_BUILD_TYPE=Release",
                "-DBUILD_TESTING=OFF", "-DLARIAT_PYTHON_WHOLE=ON", f"-DLARIAT_WITHOUT={WITHOUT}",
                "-DPYTHON_INCLUDE_FIRST=" + sysconfig.get_path("include"),
                *shlex.split(os.environ.get("LARIAT_CMAKE_ARGS", "")))
    if not os.path.exists(os.path.join(folder, "python", "lariat")):
        raise RuntimeError("the Python module cannot be built here; CMake says:\n" + said)
    _run("cmake", "--build", folder, "--target", "lariat_python", "lariat", "-j", str(os.cpu_count() or 2))
    return os.path.join(folder, "python", "lariat"), os.path.join(folder, "lariat")


def _files(package):
    """(path in the wheel, path on disk) of everything that is installed."""
    for at, _, names in sorted(os.walk(package)):
        for name in sorted(names):
            if name.endswith((".py", ".pyi", ".so", ".typed")):
                path = os.path.join(at, name)
                yield "lariat/" + os.path.relpath(path, package), path
    for name, path in _page():
        yield "lariat/viewer/" + name, path


def _page():
    """The viewer's page, where `make` or tools/web.sh has built it: npm would fetch from the network."""
    page = os.path.join(SOURCE, "web", "dist")
    if not os.path.exists(os.path.join(page, "index.html")):
        return
    for at, _, names in sorted(os.walk(page)):
        for name in sorted(names):
            path = os.path.join(at, name)
            yield os.path.relpath(path, page), path


def _tag():
    machine = re.sub(r"[-.]", "_", f"{platform.system()}_{platform.machine()}".lower())
    return "cp311-abi3-" + machine


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    del config_settings, metadata_directory
    name = f"lariat-{_version()}-{_tag()}.whl"
    info = f"lariat-{_version()}.dist-info"
    record = []

    def add(wheel, path, data, mode=0o644):
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record.append(f"{path},sha256={digest},{len(data)}")
        entry = zipfile.ZipInfo(path)
        entry.external_attr, entry.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
        wheel.writestr(entry, data)

    with tempfile.TemporaryDirectory(prefix="lariat-wheel-") as folder:
        package, command = _build(folder)
        if shutil.which("strip"):
            _run("strip", os.path.join(package, "_lariat.abi3.so"), command)
        with zipfile.ZipFile(os.path.join(wheel_directory, name), "w",
                             zipfile.ZIP_DEFLATED) as wheel:
            for path, source in _files(package):
                with open(source, "rb") as file:
                    add(wheel, path, file.read())
            with open(command, "rb") as file:  # what lariat.fit and its like run; pip knows where to
                add(wheel, f"lariat-{_version()}.data/scripts/lariat", file.read(), 0o755)
            with open(os.path.join(SOURCE, "LICENSE"), "rb") as file:
                add(wheel, f"{info}/LICENSE", file.read())
            add(wheel, f"{info}/METADATA", _metadata().encode())
            add(wheel, f"{info}/WHEEL", (f"Wheel-Version: 1.0\nGenerator: lariat {_version()}\n"
                                         f"Root-Is-Purelib: false\nTag: {_tag()}\n").encode())
            record.append(f"{info}/RECORD,,")
            wheel.writestr(f"{info}/RECORD", "\n".join(record) + "\n")
    return name


def build_sdist(sdist_directory, config_settings=None):
    del config_settings
    name = f"lariat-{_version()}"
    listed = subprocess.run(["git", "-C", SOURCE, "ls-files", "-z"], check=True,
                            stdout=subprocess.PIPE).stdout.decode().split("\0")
    with tarfile.open(os.path.join(sdist_directory, name + ".tar.gz"), "w:gz") as archive:
        for path in filter(None, listed):
            archive.add(os.path.join(SOURCE, path), f"{name}/{path}", recursive=False)
        for path, source in _page():
            archive.add(source, f"{name}/web/dist/{path}", recursive=False)
        with tempfile.NamedTemporaryFile("w", encoding="utf-8") as file:
            file.write(_metadata())
            file.flush()
            archive.add(file.name, f"{name}/PKG-INFO")
    return name + ".tar.gz"
