#!/usr/bin/env python3
"""Assembles the explorer: one HTML file with its style, scripts, WebAssembly module and presets.

The scripts in page/ are modules. Here they become two scripts, the page's and its worker's, because a page opened from
disk must not import files: each module is a function that returns its exports, after those that it imports.
"""

import base64
import gzip
import json
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(1, os.path.dirname(HERE))

from trebsweep.program import Parser, check_new, refuse, run, write_text  # noqa: E402  # in analysis/

JOBS = os.path.join(HERE, "..", "..", "jobs")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def name_of(path):
    """The constant that holds the exports of a module."""
    return path.replace(".", "_")


def joined(path, done):
    """The script of a module after those that it imports, without those in `done`, which grows."""
    if path in done:
        return ""
    done.add(path)
    text = read(os.path.join(HERE, "page", path))
    imports = re.compile(r'^import (\{[^}]*\}) from "\./(.+?)";$', re.M)
    before = "".join(joined(other, done) for _, other in imports.findall(text))
    exports = ", ".join(re.findall(r"^export (?:async )?(?:function|class|const) (\w+)", text, re.M))
    body = imports.sub(lambda match: f"const {match[1]} = {name_of(match[2])};", text)
    body = re.sub(r"^export ", "", body, flags=re.M)
    body = re.sub(r"^ *(//.*|/\*\*[\s\S]*?\*/)\n", "", body, flags=re.M)  # comments: the page is small
    return f"{before}const {name_of(path)} = (() => {{\n{body}return {{ {exports} }};\n}})();\n"


def presets():
    """The texts of the scenes and of the laboratory's job, by name."""
    scenes = os.path.join(JOBS, "scenes")
    paths = [os.path.join(scenes, name) for name in sorted(os.listdir(scenes))] + [os.path.join(JOBS, "lab.cfg")]
    return {os.path.basename(path).removesuffix(".cfg"): read(path) for path in paths}


def page(module, archive, at):
    """The text of the page with a module and, unless it is None, the planes of an archive."""
    with open(module, "rb") as file:
        packed = gzip.compress(file.read(), 9, mtime=0)
    stored = None
    if archive:
        from stored_planes import stored_planes  # needs h5py
        stored = stored_planes(archive, at)
    data = {"module": base64.b64encode(packed).decode(), "presets": presets(), "stored": stored}
    parts = {
        "style": read(os.path.join(HERE, "page", "style.css")),
        "data": json.dumps(data).replace("<", "\\u003c"),  # no text ends the script
        "worker": joined("worker.js", set()),
        "script": joined("main.js", set()),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], read(os.path.join(HERE, "page", "page.html")))


def main():
    parser = Parser(__doc__)
    parser.add_argument("module", metavar="MODULE", help="the WebAssembly module")
    parser.add_argument("output", metavar="OUTPUT", help="the HTML file to write")
    parser.add_argument("--archive", metavar="ARCHIVE", help="an archive whose planes are shown too")
    parser.add_scene()
    parser.add_overwrite()
    arguments = parser.parse_args()
    if arguments.at and not arguments.archive:
        key, value = arguments.at[0]
        refuse("at", f"{key}={value:g}", "must be given with --archive")
    inputs = filter(None, (arguments.module, arguments.archive))
    check_new("output", arguments.output, arguments.overwrite, *inputs)
    write_text(arguments.output, page(arguments.module, arguments.archive, arguments.at))


if __name__ == "__main__":
    run(main)
