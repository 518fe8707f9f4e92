#!/usr/bin/env python3
"""Prints the fastest design of an archive as options for `trebsweep trace`; nothing if there is none."""

import argparse
import sys

from archive import Archive


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("archive", help="archive of a sweep")
    parser.add_argument("--job", metavar="FILE", help="also write the job, as it was run, to FILE")
    arguments = parser.parse_args()

    archive = Archive(arguments.archive)
    if arguments.job:
        try:
            with open(arguments.job, "w", encoding="utf-8") as file:
                file.write(archive.attribute("job"))
        except OSError as error:
            sys.exit(f"{arguments.job}: cannot be written: {error.strerror}")
    optimum = archive.optimum()
    if optimum is None:
        print(f"{arguments.archive}: has no optimum: nothing was released, or the sweep is unfinished",
              file=sys.stderr)
        return
    print(" ".join(f"--{name} {float(value)!r}" for name, value in optimum.items()))


if __name__ == "__main__":
    main()
