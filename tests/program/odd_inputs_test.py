"""Odd inputs: for each, the program ends within 10 s of processor time with the expected exit code. Where that is 2,
it prints one line on stderr and nothing on stdout, and the directory is unchanged; `info` prints one line wherever it
fails.

Needs TREBSWEEP (the program) in the environment.
"""

import concurrent.futures
import os
import re
import stat
import subprocess
import tempfile
import unittest

from support import PROGRAM

LONG = "9" * 5000
DESIGN = ["--r1", "0.6", "--r2", "0.9", "--r3", "0.5"]
TINY = ["--lattice.increment", "0.3", "--progress", "none"]
# Processor time does not depend on what else runs; the time of the clock only tells a program that waits for ever.
LIMITED = ["prlimit", "--cpu=10", PROGRAM]

def values():
    """Values in the file and on the command line; those that are refused in the process are in ../job/refused.json."""
    def trace(code, *options):
        return ["trace", "job.cfg", *DESIGN, *options], code

    for value in ["", "1e999", "-1", "½", LONG, "1,,2"]:
        yield trace(2, f"--scene.gravity={value}")
    yield trace(2, "--scene.gravity=1, 2")
    yield trace(2, "--solver.target-error=1e-30")
    yield trace(2, "--solver.release", "pin")
    for key in ["gravity", "counterweight-mass", "fulcrum-height"]:
        yield trace(0, f"--scene.{key}", " +1.6 ")
    for value in ["1e12", "1e-12"]:
        yield trace(0, "--scene.projectile-mass", value)
    yield trace(0, "--solver.max-steps", "1")
    yield trace(0, "--solver.max-steps", "1", "--flight")
    yield trace(2, "--flight", "--interval", "1e-9")
    yield trace(1, "--flight", "--scene.projectile-diameter", "1e5")
    yield trace(0, "--solver.max-time", "1e-300")
    for command in ["optimum", "assess"]:
        yield [command, "job.cfg", "--scene.gravity=9:10:0.5"], 2


def sweeps():
    """Lattices and studies that are empty, too large or odd."""
    def sweep(code, *options):
        return ["sweep", "job.cfg", "--progress", "none", *options], code

    yield sweep(2, "--lattice.increment=1e-12")
    yield sweep(2, "--lattice.increment=2")
    yield sweep(2, "--lattice.r3", "2")
    yield sweep(2, "--lattice.increment=1e-3", "--scene.gravity=1:1000000:1")
    yield sweep(0, "--lattice.r1", "0.6", "--lattice.r3", "1e12", "--lattice.r2", "1e-12")
    yield sweep(0, "--lattice.r1", "0.1", "--lattice.r3", "0.5", "--lattice.r2", "1")  # unreachable_start
    yield sweep(0, "--lattice.increment", "0.3", "--scene.gravity=10 ,9", "--output.maps=none")
    yield sweep(0, "--lattice.increment", "0.3", "--scene.gravity=9:9:1")


def outputs():
    """Output paths that cannot be files, and odd ones that can."""
    def sweep(code, *options):
        return ["sweep", "job.cfg", *TINY, *options], code

    for name in ["", ".", "..", "/", "folder", "folder/", "no/such.h5", "job.cfg/x.h5", "a#b.h5", "a\nb.h5", " a.h5", "a.h5 ", '"a.h5"', "x" * 248,
                 "x" * 255, "x" * 300, "job.cfg", "text.txt", "empty", "fifo", "/dev/null", "/dev/zero", "loop",
                 "link_to_fifo", "link_to_folder", "socket"]:
        yield sweep(2, f"--output.file={name}")
    for name in ["partial_fifo.h5", "partial_text.h5", "partial_folder.h5", "partial_job.h5", "partial_link.h5"]:
        for more in [[], ["--overwrite"]]:
            yield sweep(2, "--output.file", name, *more)
    yield sweep(0, "--output.file", "a name with blanks.h5")
    yield sweep(0, "--output.file", "-.h5")
    yield sweep(0, "--output.file", "ünïcödé.h5")
    yield sweep(0, "--output.file", "no_suffix")
    yield sweep(0, "--output.file", "dangling")


def optima():
    """Searches that are refused, find nothing, or are odd."""
    def sweep(code, *options):
        return ["sweep", "job.cfg", *TINY, *options], code

    yield ["sweep", "strict.cfg", *TINY], 2
    yield ["trace", "job.cfg", *DESIGN, "--optimum.objective", "range"], 2
    yield ["assess", "job.cfg", "--optimum.objective", "range"], 2
    fixed = ["--lattice.r1=0.6", "--lattice.r3=0.6", "--lattice.r2=0.8"]
    for code, *options in [(2, "--optimum.objective=status"), (2, "--optimum.subject-to=speed < 3"),
                           (2, "--optimum.deviation=-1"), (2, "--optimum.robust=worst"), (2, "--json=yes"),
                           (2, "--lattice.increment=1e-4"), (2, "--lattice.r1=0.1:0.2"), (2, "--r1=0.6"),
                           (0, "--scene.trough=yes"), (2, "--overwrite"), (2, "--time-limit=1"),
                           (3, "--lattice.shortest-sling=2"), (3, "--scene.release-height=1e3"),
                           (3, "--optimum.subject-to=speed >= 1e6"), (3, "--scene.projectile-mass=1e9", "--lattice.increment=0.1"),
                           (3, "--optimum.deviation=1e9", "--optimum.robust=worst"), (0, *fixed),
                           (3, "--optimum.deviation=1e9"), (0, "--optimum.subject-to", ""),
                           (0, "--lattice.increment=0.3"), (0, "--optimum.refine=yes")]:
        yield ["optimum", "job.cfg", *options], code
    yield ["trace", "job.cfg", *DESIGN, "--json"], 2
    yield ["trace", "job.cfg", *DESIGN, "--dry-run"], 2
    yield ["sweep", "job.cfg", *TINY, "--lattice.r3=2", "--dry-run"], 2
    yield ["assess", "job.cfg", "--output.file=folder", "--dry-run"], 2
    yield sweep(0, "--optimum.subject-to", "")
    yield sweep(0, "--optimum.subject-to", " speed<=+1e3 , least-sling-tension >= -0 ")


def command_lines():
    """Command lines with too few, too many or meaningless words."""
    for arguments in [[], ["swep"], [""], [LONG], ["--halp"], ["sweep"], ["optimum"], ["trace"], ["assess"], ["info"], ["sweep", "a", "b"],
                      ["info", "a", "b"], ["sweep", "job.cfg", "--overwrit"], ["sweep", "job.cfg", "--scene.gravity"],
                      ["sweep", "job.cfg", "--scene.gravity", "9", "--scene.gravity", "9"],
                      ["sweep", "job.cfg", "--r1", "1"], ["sweep", "job.cfg", "--gravity", "9"],
                      ["sweep", "job.cfg", "--scene.gravitiy", "9"], ["sweep", "job.cfg", f"--{LONG}", "9"],
                      ["sweep", "--", "--help"], ["assess", "--", "-h"], ["sweep", "job.cfg", "--interval", "1"], ["sweep", "job.cfg", "--assess.designs", "3"],
                      ["sweep", "job.cfg", "--progress", "loud"], ["sweep", "job.cfg", "--progress", ""],
                      ["trace", "job.cfg"], ["trace", "job.cfg", "--r1", "1", "--r2", "1"],
                      ["trace", "job.cfg", "--r1", "x", "--r2", "1", "--r3", "1"],
                      ["trace", "job.cfg", "--r1", "-1", "--r2", "1", "--r3", "1"],
                      ["trace", "job.cfg", "--r1", "1e13", "--r2", "1", "--r3", "1"],
                      ["trace", "job.cfg", "--r1", "0.3", "--r2", "1", "--r3", "1"],
                      ["trace", "job.cfg", *DESIGN, "--interval", "0"],
                      ["trace", "job.cfg", *DESIGN, "--interval", "1e-300"],
                      ["trace", "job.cfg", *DESIGN, "--output.file", "a.txt"],
                      ["trace", "job.cfg", *DESIGN, "--overwrite"],
                      ["trace", "job.cfg", *DESIGN, "--lattice.increment", "0.1"],
                      ["assess", "job.cfg", "--assess.scenes", "missing.cfg"], ["assess", "job.cfg", "--assess.scenes", "a#b.cfg"],
                      ["assess", "job.cfg", "--assess.scenes", "fifo"], ["assess", "job.cfg", "--assess.steppers", ""],
                      ["assess", "job.cfg", "--assess.steppers", "rk4,rk4"],
                      ["assess", "job.cfg", "--assess.time-steps", "0"],
                      ["assess", "job.cfg", "--assess.tolerances", "1e-9,1"],
                      ["assess", "job.cfg", "--assess.designs", "0"], ["assess", "job.cfg", "--time-limit", "1"],
                      ["info", "missing.h5"], ["info", "folder"], ["info", "fifo"], ["info", "/dev/null"],
                      ["info", "/dev/zero"], ["info", "loop"],
                      ["info", "x" * 300], ["info", "job.cfg", "--overwrite"]]:
        yield arguments, 2
    for name in ["text.txt", "empty", "foreign.h5"]:
        yield ["info", name], 1
    for limit in ["", "0", "-5", "nan", "1:", ":30", "1-12", "1:2:3:4", "soon", "1e999"]:
        yield ["sweep", "job.cfg", f"--time-limit={limit}"], 2
    yield ["trace", "job.cfg", *DESIGN, "--unset", "solver.tolerance"], 2
    for arguments in [["help", "swep"], ["help", "sweep", "x"], ["completion", "x"]]:
        yield arguments, 2
    for arguments in [["--help"], ["-h"], ["--version"], ["sweep", "--help"], ["sweep", "missing.cfg", "-h"],
                      ["info", "--help"]]:
        yield arguments, 0


JOB_FILES = {
    "words": ("This is a letter.\n", 2), "long_line": ("[scene]\n" + "x" * 100000 + "\n", 2),
    "long_value": (f"[scene]\ngravity = {LONG}\n", 2), "long_key": (f"[scene]\n{LONG} = 1\n", 2),
    "unknown_key": ("[scene]\ngravitiy = 9.8\n", 2), "key_as_section": ("[scene.gravity]\nx = 1\n", 2),
    "huge": ("#" * (2 << 20), 2), "binary": ("[scene]\n\0\1\2", 2), "no_key": ("[scene]\n= 9\n", 2), "duplicate": ("[scene]\ngravity = 9\ngravity = 9\n", 2),
    "escape": ("[scene]\ngravity = \x1b[31m9\n", 2),
    "strict": ("[optimum]\nsubject-to = speed < 3\n", 2), "constraint": ("[optimum]\nsubject-to = speed<=3\n", 0),
    "nested": ("[scene]\nfile = nesting.cfg\n", 2), "missing_scene": ("[scene]\nfile = missing.cfg\n", 2),
    "fifo_scene": ("[scene]\nfile = fifo\n", 2), "folder_scene": ("[scene]\nfile = folder\n", 2),
    "itself": ("[scene]\nfile = itself.cfg\n", 2), "scene_is_a_job": ("[scene]\nfile = a_job.cfg\n", 2),
    "empty": ("", 0), "comment": ("# nothing\n", 0), "crlf": ("[scene]\r\ngravity = 9\r\n", 0),
    "no_newline": ("[scene]\ngravity = 9", 0), "blanks": ("  [scene]  \n\t gravity\t=\t9  # g\n\n", 0),
    "byte_order_mark": ("\ufeff[scene]\ngravity = 9\n", 0), "plus": ("[scene]\ngravity = +9\n", 0),
    "empty_sections": ("[scene]\n[solver]\n[scene]\n", 0), "scene_file": ("[scene]\nfile = scene.cfg\n", 0),
}


def job_files():
    """Malformed job files, and valid ones that look odd."""
    for name, (_, code) in JOB_FILES.items():
        yield ["trace", f"{name}.cfg", *DESIGN], code
    for name in ["missing.cfg", "folder", "fifo", "/dev/null", "/dev/zero", "", "x" * 300, "loop", "utf16.cfg", "link_to_fifo",
                 "socket"]:
        yield ["trace", name, *DESIGN], 2
        yield ["trace", "job.cfg", *DESIGN, f"--scene.file={name}"], 2
    yield ["sweep", "fifo"], 2
    yield ["sweep", "duplicate.cfg"], 2


KINDS = (values, sweeps, outputs, optima, command_lines, job_files)


def fill(directory):
    """Writes the files that the cases name."""
    def write(name, text):
        with open(os.path.join(directory, name), "w", encoding="utf-8", newline="") as file:
            file.write(text)

    write("job.cfg", "")
    write("text.txt", "precious\n")
    write("empty", "")
    write("foreign.h5", "\x89HDF\r\n\x1a\nrest")
    write("scene.cfg", "[scene]\ngravity = 9\n")
    write("nesting.cfg", "[scene]\nfile = scene.cfg\n")
    write("a_job.cfg", "[solver]\nstepper = rk4\n")
    for name, (text, _) in JOB_FILES.items():
        write(f"{name}.cfg", text)
    with open(os.path.join(directory, "utf16.cfg"), "w", encoding="utf-16") as file:
        file.write("[scene]\ngravity = 9\n")
    os.mkdir(os.path.join(directory, "folder"))
    for name in ["fifo", "partial_fifo.h5.partial"]:
        os.mkfifo(os.path.join(directory, name))
    os.mknod(os.path.join(directory, "socket"), 0o600 | stat.S_IFSOCK)
    os.mkdir(os.path.join(directory, "partial_folder.h5.partial"))
    write("partial_folder.h5.partial/notes", "precious\n")
    write("partial_text.h5.partial", "precious\n")
    for name, target in [("loop", "loop"), ("link_to_fifo", "fifo"), ("link_to_folder", "folder"),
                         ("dangling", "target.h5"), ("partial_job.h5.partial", "job.cfg"),
                         ("partial_link.h5.partial", "folder")]:
        os.symlink(target, os.path.join(directory, name))


def snapshot(directory):
    """{path: (kind, contents or the target of a link)} of everything in a directory."""
    found = {}
    for root, directories, files in os.walk(directory):
        for name in directories + files:
            path = os.path.join(root, name)
            kind = stat.S_IFMT(os.lstat(path).st_mode)
            content = os.readlink(path) if kind == stat.S_IFLNK else None
            if kind == stat.S_IFREG:
                with open(path, "rb") as file:
                    content = file.read()
            found[os.path.relpath(path, directory)] = (kind, content)
    return found


def fault(case, directory, before, sessions):
    """Runs a case in a directory with the contents `before`. Returns what is wrong with the answer, or None.
    `sessions` is a directory for the files of MPI."""
    arguments, code = case
    shown = " ".join(repr(a if len(a) < 60 else a[:60] + "...") for a in arguments)
    try:
        done = subprocess.run([*LIMITED, *arguments], cwd=directory, capture_output=True, timeout=60, check=False,
                              stdin=subprocess.DEVNULL, errors="replace", env={**os.environ, "TMPDIR": sessions})
    except subprocess.TimeoutExpired:
        return f"{shown}: does not end"
    wrong = []
    if done.returncode != code:
        wrong.append(f"exit code {done.returncode} instead of {code}")
    is_refused = code == 2 or (code == 1 and arguments[0] == "info")  # a search may report its progress
    if is_refused and (not re.fullmatch(r"trebsweep: [^\n]+\n", done.stderr) or len(done.stderr) > 3000):
        wrong.append("not one short line on stderr")
    if code == 2:
        if done.stdout:
            wrong.append(f"on stdout: {done.stdout[:200]!r}")
        if snapshot(directory) != before:
            wrong.append("the directory has changed")
    return f"{shown}: {'; '.join(wrong)}; stderr: {done.stderr[:300]!r}" if wrong else None


def faults(cases):
    """Runs the cases one after the other; those that may write files get a directory of their own."""
    found = []
    with tempfile.TemporaryDirectory() as shared, tempfile.TemporaryDirectory() as sessions:
        fill(shared)
        before = snapshot(shared)
        for case in cases:
            if case[1] == 2:
                found.append(fault(case, shared, before, sessions))
            else:
                with tempfile.TemporaryDirectory() as own:
                    fill(own)
                    found.append(fault(case, own, before, sessions))
    return [text for text in found if text]


class OddInputs(unittest.TestCase):
    def test_each_ends_within_seconds_with_its_exit_code_and_without_harm(self):
        kinds = [list(kind()) for kind in KINDS]
        count = sum(map(len, kinds))
        self.assertGreaterEqual(count, 150)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            found = sum(pool.map(faults, kinds), [])
        self.assertEqual(found, [], f"{len(found)} of {count}:\n" + "\n".join(found))


if __name__ == "__main__":
    unittest.main()
