"""The command `lariat` as a child: what measures, plans and fits is in it and not in the library.

    program()                      where it is, and of this module's version
    ask("info", arguments)         runs it with --json; its answer as a dict

The child has a process group of its own, so that Ctrl-C reaches this process alone, which hands it
on and waits: `fit` then gives the best so far. Threads read both pipes; the calling thread sleeps
in a queue, without the interpreter's lock, and there alone callbacks run and exceptions arise.
"""

import json
import os
import queue
import re
import shutil
import signal
import subprocess
import sysconfig
import threading
import warnings

from ._lariat import (
    ArgumentError, Error, FileError, FormatError, ModelError, OutOfMemoryError, PeerError,
    UnstableError, UnsupportedError, __version__)

from ._scene_text import check_text

_FAILED, _USAGE, _UNSTABLE, _INTERRUPTED = 1, 2, 3, 130
_ERRORS = {kind.status: kind for kind in (
    ArgumentError, FileError, FormatError, ModelError, UnsupportedError, OutOfMemoryError,
    UnstableError, PeerError)}
_versions = {}  # (path, time, inode): what it says it is


def _is_no(answer):
    """False, or numpy's: what a comparison of arrays gives."""
    return answer is False or (type(answer).__name__ in ("bool_", "bool") and not answer)


def _candidates():
    """Where the program of this package is: of a build folder, of a prefix or a virtual
    environment, of `pip install --target`; then wherever the PATH has one."""
    package = os.path.dirname(os.path.abspath(__file__))
    up = os.path.dirname
    root = up(up(up(up(package))))
    scripts = sysconfig.get_path("scripts")
    for folder in (up(up(package)), os.path.join(root, "bin"), scripts,
                   os.path.join(up(package), "bin")):
        path = os.path.join(folder, "lariat") if folder else ""
        if os.path.isfile(path) and os.access(path, os.X_OK):
            yield path
    found = shutil.which("lariat")
    if found:
        yield os.path.abspath(found)


def _version_of(path):
    about = os.stat(path)
    key = (path, about.st_mtime_ns, about.st_ino)
    if key not in _versions:
        try:
            said = subprocess.run([path, "--version"], stdin=subprocess.DEVNULL, timeout=60,
                                  capture_output=True, check=False).stdout
        except (OSError, subprocess.TimeoutExpired):
            said = b""
        words = said.decode("utf-8", "replace").split()
        _versions[key] = words[1] if len(words) == 2 and words[0] == "lariat" else ""
    return _versions[key]


def program():
    """The path of the command that belongs to this module."""
    others = []
    for path in _candidates():
        version = _version_of(path)
        if version == __version__:
            return path
        others.append(f"{path} is of version {version}" if version else f"{path} is another program")
    if others:
        raise UnsupportedError(f"{others[0]}, and this module of version {__version__}: install "
                               "both of one version")
    raise UnsupportedError("this call runs the command lariat, which is neither beside the module "
                           "nor on the PATH; install it (with Debian's packages: apt-get install "
                           "lariat)")


def argument(value, name):
    """What stands behind an option."""
    text = os.fspath(value) if isinstance(value, (str, bytes, os.PathLike)) else repr(value)
    if (b"\0" if isinstance(text, bytes) else "\0") in text:
        raise ArgumentError(f"{name}: there is a character 0 in the text")
    if isinstance(text, str):
        check_text(text, name)
    return text


def options(**given):
    """Keywords as options: None and False are left out, True has no value, _ becomes -."""
    words = []
    for name, value in given.items():
        if value is None or value is False:
            continue
        words.append("--" + name.replace("_", "-"))
        if value is not True:
            words.append(argument(value, name))
    return words


class _Child:
    """A child, its lines on standard error and its answer."""

    def __init__(self, arguments, folder):
        self.lines = queue.SimpleQueue()  # of standard error; None: that was all
        self.answer = b""
        self.process = subprocess.Popen(  # pylint: disable=consider-using-with
            arguments, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            cwd=folder, process_group=0)
        self.readers = [threading.Thread(target=read, daemon=True)
                        for read in (self._read_answer, self._read_lines)]
        for reader in self.readers:
            reader.start()

    def _read_answer(self):
        self.answer = self.process.stdout.read()

    def _read_lines(self):
        for line in self.process.stderr:
            self.lines.put(line.decode("utf-8", "replace").rstrip("\n"))
        self.lines.put(None)

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)

    def end(self):
        """Whatever happened: no child and no open pipe is left behind."""
        if self.process.poll() is None:
            self.process.kill()
        status = self.process.wait()
        for reader in self.readers:
            reader.join()
        self.process.stdout.close()
        self.process.stderr.close()
        return status


def _follow(child, progress):
    """Until it has nothing more to say: its messages, whether somebody wanted it to stop, and the
    kind of its failure where it tells. A second Ctrl-C does not wait for it."""
    messages, stopped, failed = [], None, None
    while True:
        try:
            line = child.lines.get()
            if line is None:
                child.process.wait()
                return messages, stopped, failed
            if not line.startswith("{"):
                messages.append(line)
            elif line.startswith('{"failed"'):
                failed = json.loads(line)["failed"]
            elif progress and not stopped and _is_no(progress(json.loads(line))):
                stopped = "progress"
                child.stop()
        except KeyboardInterrupt:
            if stopped == "Ctrl-C":
                raise
            stopped = "Ctrl-C"
            child.stop()


def _in_words_of_python(text):
    """A message of the command's: options are keywords here."""
    text = text.replace("lariat predict --list-machines tells", "predict(list_machines=True) tells")
    text = text.replace("SCENE is missing", "model is missing")
    return re.sub(r"(?<![\w/-])--([a-z]+(?:-[a-z]+)*)(?![\w/.])",
                  lambda found: found[1].replace("-", "_"), text)


def _refuse(status, text, failed):
    if status < 0:
        raise PeerError(f"the command was ended by signal {-status}" + (f": {text}" if text else ""))
    kind = {_USAGE: ArgumentError, _UNSTABLE: UnstableError}.get(status, Error)
    raise _ERRORS.get(failed, kind)(
        text or f"the command ended with status {status} and no message")


def _told(value, folder, said=False):
    """An answer, whose sentences name no files of the Folder's."""
    if isinstance(value, dict):
        return {key: _told(one, folder, key in ("notices", "notes", "why_not"))
                for key, one in value.items()}
    if isinstance(value, list):
        return [_told(one, folder, said) for one in value]
    return folder.told(value) if said and isinstance(value, str) else value


def ask(command, arguments, *, folder, progress=None, keeps=False, level=3):
    """Runs `lariat COMMAND ARGUMENTS --json` in the Folder. `progress` gets its lines of progress as
    dicts; False stops it. `keeps`: what is stopped has an answer all the same, where there is one.
    `level`: of the caller that warnings are for.
    """
    path = program()
    try:
        child = _Child([path, command, "--json", *arguments], folder.path)
    except OSError as error:
        raise FileError(f"{path} cannot be run: {error.strerror}") from None
    try:
        messages, stopped, failed = _follow(child, progress)
    finally:
        status = child.end()
    prefix = f"lariat {command}: "
    said = [line.removeprefix(prefix) for line in messages]
    notes = [line.removeprefix("note: ") for line in said if line.startswith("note: ")]
    rest = "\n".join(line for line in said if not line.startswith("note: "))
    rest = folder.told(_in_words_of_python(rest))
    if stopped and not (keeps and child.answer.strip()):
        if stopped == "Ctrl-C":
            raise KeyboardInterrupt
        raise Error(rest or "stopped before there was an answer")
    if status != 0 and not (stopped and status == _INTERRUPTED):
        _refuse(status, rest, failed)
    answer = json.loads(child.answer.decode("utf-8", "replace"))
    for note in notes:
        if note not in answer.get("notices", ()):
            note = folder.told(note)
            warnings.warn(note, UserWarning, stacklevel=level)
    return _told(answer, folder)
