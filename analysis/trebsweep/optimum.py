"""Prints the optimum of an archive as options of `trebsweep trace`.

The optimum is the design with the largest optimum.objective, by default the fastest, among those
that satisfy the job's constraints; in an unfinished sweep, that of the designs done so far. With
--continuous it is the one that `trebsweep optimum` finds between the designs of the lattice.
Without an optimum, nothing is printed on stdout, and the exit code is 0.

  trebsweep trace as-run.cfg $(treb-plot optimum accurate.h5 --job as-run.cfg) > swing.txt
"""

from .backend import AXES
from .job import accurate_job, job_text
from .launch import PROGRAM_HELP, command, find_program, parse_optimum
from .program import Parser, check_new, note, write_text
from .scenes import load, only

NO_OPTIMUM = 3  # exit code of `trebsweep optimum`


def lattice_optimum(archive):
    """{axis: value in m} of the optimum of an archive, or None."""
    optimum = archive.optimum()
    if optimum is None:
        note(f"{archive.path}: has no optimum: {archive.best_text()}")
    return optimum and optimum[0]


def continuous_optimum(program, text):
    """{axis: value in m} of the optimum that a search with the job `text` finds, or None."""
    done = command("optimum", text, "--json", program=program)
    if done.returncode == NO_OPTIMUM and done.stderr:
        note(done.stderr)
        return None
    found = parse_optimum(done)
    return {name: found[name] for name in AXES}


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a sweep, or FILE.partial, an unfinished one")
    parser.add_scene()
    parser.add_argument("--continuous", action="store_true",
                        help="search between the designs of the lattice")
    parser.add_argument("--job", metavar="FILE", help="also write the job to FILE: as it was run, "
                        "or with --continuous with an accurate solver, as the search has it")
    parser.add_overwrite()
    parser.add_argument("--program", help=PROGRAM_HELP)
    arguments = parser.parse_args()

    if arguments.job:
        check_new("job", arguments.job, arguments.overwrite, arguments.archive)
    archive = only(load(arguments.archive), arguments.at)
    # The search is in the archive's scene, also if the job has variables.
    lengths_only = {**archive.keys, ("optimum", "variables"): ""}
    job = job_text(accurate_job(lengths_only)) if arguments.continuous else archive.job
    if arguments.job:
        write_text(arguments.job, job)
    if arguments.continuous:
        design = continuous_optimum(find_program(arguments.program), job)
    else:
        design = lattice_optimum(archive)
    if design is not None:
        print(" ".join(f"--{name} {value!r}" for name, value in design.items()))
