#!/usr/bin/env python3
"""Finds names in comments that exist nowhere in the code.

Checked are names of source files (foo.cpp, dir/foo.h) and identifiers with (), with :: or in
backquotes. An identifier exists where it occurs outside comments, also within a string.
Usage: tools/check_comments.py, in the root of the repository.
"""
import pathlib
import re
import sys

ROOMS = ("src", "include", "tests", "bench", "examples")
CODE = re.compile(r'R"(\w*)\(.*?\)\1"|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)\'|//[^\n]*|/\*.*?\*/', re.S)
FILE = re.compile(r'(?<![\w./-])(?:[\w-]+/)*[\w-]+\.(?:cpp|h|py|cmake)\b')
NAME = re.compile(r'(?<![\w.:/<])((?!NOLINT)(?:\w+::)*~?\w+)\((?!\d)|(?<![\w.:/<])((?:\w+::)+\w+)|`(\w[\w:]*)`')
FOREIGN = re.compile(r'std::|hwy::|hn::|CLI::|testing::|fmt::|ImGui|tbb::')


def split(text):
    """The comments as (line, text), and the rest of the file."""
    comments, code, last = [], [], 0
    for match in CODE.finditer(text):
        if match[0].startswith(('//', '/*')):
            code.append(text[last:match.start()])
            comments.append((text.count('\n', 0, match.start()) + 1, match[0]))
            last = match.end()
    return comments, ''.join(code) + text[last:]


def main():
    paths = [p for room in ROOMS for p in sorted(pathlib.Path(room).rglob('*'))
             if p.suffix in ('.cpp', '.h')]
    files = {str(p) for p in pathlib.Path('.').rglob('*')
             if p.suffix in ('.cpp', '.h', '.py', '.cmake') and p.parts[0] != 'build'}
    split_files = {p: split(p.read_text(errors='replace')) for p in paths}
    words = []  # by file: all words of A::b must occur in one file
    for _, code in split_files.values():
        words.append(set(re.findall(r'\w+', code)))
        files.update(re.findall(r'#include ["<]([^">]+)', code))
    found = 0
    for path, (comments, _) in split_files.items():
        for line, text in comments:
            missing = [name for name in FILE.findall(text)
                       if not name.startswith('hwy/') and not any(f == name or f.endswith('/' + name) for f in files)]
            for match in NAME.finditer(text):
                name = next(n for n in match.groups() if n)
                parts = set(re.findall(r'\w+', name))
                if not FOREIGN.match(name) and not any(parts <= known for known in words):
                    missing.append(name)
            for name in missing:
                found += 1
                print(f'{path}:{line}: no such name: {name}')
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
