"""A scene, or an experiment, in a dict, as the YAML that the library reads."""

import json
import math
import os
import re

from ._lariat import ArgumentError


def check_text(text, name):
    """Refuses half of a pair of surrogates that is not from a path either."""
    try:
        text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError as error:
        raise ArgumentError(
            f"{name}: character {error.start} of the text, counted from 0, is "
            f"{text[error.start]!r}, half of a pair of surrogates and no character; leave it out"
        ) from None


def _check_name(text, where):
    """Files may have such names, which are shown with ? then; two that differ there are one."""
    if re.search("[\0-\x1f\x7f-\x9f]", text):
        raise ArgumentError(f"{where}: {text!r} has a tab, a new line or another control character; "
                            "leave it out of the name")


def _tidy(value, where, above=()):
    """The value with numpy's scalars, arrays and paths as json knows them. What a file could not
    say is refused, with the key at which it stands. `above`: ids of what it is in."""
    if id(value) in above:
        raise ArgumentError(f"{where}: it contains itself, which no scene can; put a copy of what is "
                            "meant there, without itself")
    if value is None:
        raise ArgumentError(f"{where}: None is no value; leave the key out")
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ArgumentError(f"{where}: {value} is not a finite number")
        return value
    if isinstance(value, str):
        check_text(value, where)
        if where.endswith(".name"):
            _check_name(value, where)
        return value
    if isinstance(value, (bool, int)):
        return value
    if isinstance(value, (dict, list, tuple)):
        above = (*above, id(value))
    if isinstance(value, dict):
        for key in value:
            if isinstance(key, str):
                check_text(key, f"{where}: the key {key!r}")
        return {key: _tidy(one, f"{where}.{key}", above) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_tidy(one, f"{where}[{i}]", above) for i, one in enumerate(value)]
    if hasattr(value, "tolist"):
        return _tidy(value.tolist(), where)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    remedy = "; write a list" if isinstance(value, (set, frozenset)) else ""
    raise TypeError(f"{where}: a value of {type(value)!r} is nothing that scenes have{remedy}")


class DictText(str):
    """The text of a dict, whose lines nobody has seen."""

    __slots__ = ()


def text_of(value, name):
    """A dict as YAML. In files `all` is a word and "all" in quotes the name of a set; who writes a
    dict means the word."""
    try:  # libyaml knows no pairs of surrogates, so characters stay themselves
        text = json.dumps(_tidy(value, name), ensure_ascii=False, indent=1)
    except (ValueError, RecursionError) as error:
        if isinstance(error, ArgumentError):
            raise
        raise ArgumentError(f"{name}: {error}") from None
    return DictText(re.sub(r'(?<!\\)"all"(?!:)', "all", text))


def _keys_of(text, line):
    """The keys that lead to a line of a text of text_of, from 1 on: ".tools[0].radius"."""
    keys = []  # one for each level: a name, or how many items of a list there were
    for number, row in enumerate(text.split("\n"), 1):
        depth = len(row) - len(row.lstrip(" "))
        if depth and row[depth] not in "]}":  # what closes is no entry
            named = re.match(r'("(?:[^"\\]|\\.)*"): ', row[depth:])
            del keys[depth:]
            if len(keys) < depth:
                keys.append(None)
            keys[-1] = json.loads(named[1]) if named else (
                keys[-1] + 1 if isinstance(keys[-1], int) else 0)
        if number == line:
            break
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in keys)


def with_keys(message, name, text, *files):
    """A message about a text of text_of, with the keys of the dict in place of lines and columns.
    `files`: what messages call the text besides its name."""
    called = "|".join(re.escape(file) for file in (*files, name))
    place = re.compile(rf"(?<![\w/.])(?:{called}):(\d+)(?::\d+)?\b(?:: (\w+): )?")

    def keys(found):
        path = name + _keys_of(text, int(found[1]))
        if found[2] is None:
            return path
        again = path.endswith("." + found[2])  # the sentence names it, too
        return f"{path}: " if again else f"{path}: {found[2]}: "

    def in_line(found):
        return f" in {name}{_keys_of(text, int(found[1]))}"

    told = []
    for sentence in message.split("\n"):
        if place.match(sentence):  # then it means lines of this text
            sentence = re.sub(r" here \(line \d+\)", "", sentence)
            sentence = re.sub(r" in line (\d+)\b", in_line, sentence)
        told.append(place.sub(keys, sentence))
    return "\n".join(told)


def keyed(message, scene):
    """What the library says about a model of arrays with this scene: a str, or a DictText."""
    if not isinstance(scene, DictText):
        return message
    message = with_keys(message, "scene", scene, "model")
    whole = re.match(r"(?:scene|model): (\w+): ", message)  # it names a key, and no line
    if whole and f'\n "{whole[1]}": ' in scene:
        message = f"scene.{whole[1]}: {message[whole.end():]}"
    return message
