#!/usr/bin/env python3
"""Changes one operator, constant, branch or call of src and include at a time, and lists the changes that no test sees.

The sources are changed in place and restored: use a clone with a configured build, such as build/debug.
A change that does not compile is left out. The same seed chooses the same changes.
"""

import argparse
import pathlib
import random
import re
import subprocess
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
SWAPS = {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ", " != ": " == ", " && ": " || ",
         " || ": " && ", " + ": " - ", " - ": " + ", " * ": " / ", " / ": " * ", " += ": " -= ", "true": "false",
         "false": "true", "std::min(": "std::max(", "std::max(": "std::min(", "break;": ";", "continue;": ";"}
SITE = re.compile("|".join(
    [rf"\b{word}\b" if word in ("true", "false") else re.escape(word) for word in SWAPS]
    + [r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])",          # a number
       r"\bif \((?!constexpr)(?=.*\) ?\{?$)",                   # a condition that ends with its line
       r"^ +[a-z_.:]+(?:->)?[a-z_.:]*\(.*\);$"]))               # a call on a line of its own
NO_CODE = re.compile(r"\s*(//|#|template|static_assert|using |namespace |requires )")
TEXT = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'|//.*')


def sites(folders):
    """The places that can be changed, as (path, number of the line, match)."""
    for folder in folders:
        for path in sorted(pathlib.Path(REPOSITORY, folder).rglob("*.[ch]pp")):
            for number, line in enumerate(path.read_text(encoding="utf-8").split("\n")):
                if not NO_CODE.match(line):
                    without_text = TEXT.sub(lambda text: "\0" * len(text[0]), line)
                    yield from ((path, number, match) for match in SITE.finditer(without_text))


def mutated(line, match):
    """The line with another operator, constant or condition, or without its call."""
    old, before, after = match[0], line[:match.start()], line[match.end():]
    if old in SWAPS:
        return before + SWAPS[old] + after
    if old[0].isdigit():
        return before + {"0": "1", "1": "0"}.get(old, f"({old} + 1)") + after
    if old == "if (":
        end = line.rindex(")")
        return f"{before}if (!({line[match.end():end]})){line[end + 1:]}"
    return re.match(" *", line)[0] + ";"


def outcome(args):
    """What the tests said of the sources as they are; None if these do not compile."""
    if subprocess.run(["cmake", "--build", args.build], capture_output=True, check=False).returncode != 0:
        return None
    tests = ["ctest", "--test-dir", args.build, "--no-tests=error", "--stop-on-failure", "--timeout", "120",
             *args.tests.split()]
    done = subprocess.run(tests, capture_output=True, text=True, check=False)
    failed = re.search(r"^\s*\d+ - (.*) \(", done.stdout, re.MULTILINE)
    return f"killed by {failed[1]}" if failed else "survived" if done.returncode == 0 else "killed"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="directory of the build")
    parser.add_argument("--number", type=int, default=200, help="of changes (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of their choice (%(default)s)")
    parser.add_argument("--under", nargs="+", default=["src", "include"], metavar="FOLDER", help="with the sources")
    parser.add_argument("--tests", default="-L fast -j 2", metavar="OPTIONS", help="for ctest (%(default)s)")
    args = parser.parse_args()
    if (unchanged := outcome(args)) != "survived":
        sys.exit(f"{args.build}: the unchanged sources must compile and pass the tests: {unchanged}")
    candidates = list(sites(args.under))
    random.Random(args.seed).shuffle(candidates)
    print(f"{len(candidates)} places", flush=True)
    done = killed = 0
    for path, number, match in candidates:
        text = path.read_text(encoding="utf-8")
        lines = text.split("\n")
        old, lines[number] = lines[number], mutated(lines[number], match)
        try:
            path.write_text("\n".join(lines), encoding="utf-8")
            result = outcome(args)
        finally:
            path.write_text(text, encoding="utf-8")
        if result is None:
            continue
        done += 1
        killed += result != "survived"
        print(f"{path.relative_to(REPOSITORY)}:{number + 1}: {result}\n  - {old.strip()}\n  + {lines[number].strip()}",
              flush=True)
        if done == args.number:
            break
    print(f"{killed} of {done} killed")


if __name__ == "__main__":
    sys.exit(main())
