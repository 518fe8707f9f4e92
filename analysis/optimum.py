#!/usr/bin/env python3
"""Prints the optimum of an archive as options of `trebsweep trace`.

The optimum is the design with the largest optimum.objective, by default the fastest, among those
that satisfy the job's constraints; in a partial archive, that of the designs done so far. If there
is none, nothing is printed on stdout, and the exit code is 0.

  trebsweep trace as-run.cfg $(optimum.py accurate.h5 --job as-run.cfg) > swing.txt
"""

from program import Parser, fail, note, refuse_overwriting, run  # before missing modules

from archive import Archive


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a sweep, complete or partial")
    parser.add_argument("--job", metavar="FILE", help="also write the job as it was run to FILE")
    arguments = parser.parse_args()

    archive = Archive(arguments.archive)
    if arguments.job:
        refuse_overwriting("job", arguments.job, arguments.archive)
        try:
            with open(arguments.job, "w", encoding="utf-8") as file:
                file.write(archive.attributes["job"])
        except OSError as error:
            fail(f"{arguments.job}: cannot be written: {error.strerror}")
    optimum = archive.optimum()
    if optimum is None:
        note(f"{arguments.archive}: has no optimum: {archive.best_text()}")
        return
    print(" ".join(f"--{name} {value!r}" for name, value in optimum[0].items()))


if __name__ == "__main__":
    run(main)
