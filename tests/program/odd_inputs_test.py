"""Odd inputs: for each, the program ends within 10 s of processor time with the expected exit code. Where that is 2,
it prints one line on stderr and nothing on stdout, and the directory is unchanged.

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
EULER = ["--solver.stepper", "euler"]
# Processor time does not depend on what else runs; the time of the clock only tells a program that waits for ever.
LIMITED = ["prlimit", "--cpu=10", PROGRAM]

NO_NUMBERS = ["", " ", "nonsense", "nan", "-nan", "inf", "1e999", "1,5", "0x10", "1 kg", "--1", "1e", "½", LONG]
MAGNITUDES = ["1e300", "1.1e12", "9e-13", "1e-300", "-1"]


def scene_keys():
    """Values that are physically impossible, for each key."""
    masses = ["gravity", "counterweight-mass", "projectile-mass", "release-height", "fulcrum-height"]
    others = ["beam-density", "beam-side", "pivot-viscosity", "pivot-friction", "sling-mass", "sling-stiffness",
              "sling-damping", "beam-mass", "beam-moment", "counterweight-hanger", "trough-height",
              "projectile-diameter", "drag-coefficient", "air-density"]
    for key in masses + others:
        for value in NO_NUMBERS[:8] + MAGNITUDES + (["0"] if key in masses else []):
            yield ["trace", "job.cfg", *DESIGN, f"--scene.{key}={value}"], 2
    for value in [*NO_NUMBERS, "4", "-3.2"]:
        yield ["trace", "job.cfg", *DESIGN, f"--scene.sling-angle={value}"], 2
    for key in ["beam-centre", "start-angle", "wind"]:
        for value in [*NO_NUMBERS, "1.1e12", "-1.1e12"]:
            yield ["trace", "job.cfg", *DESIGN, f"--scene.{key}={value}"], 2
    for value in ["", "true", "Yes", "yes,no", "1"]:
        yield ["trace", "job.cfg", *DESIGN, f"--scene.trough={value}"], 2
    for value in ["", "Prism", "rod", "slender,prism"]:
        yield ["trace", "job.cfg", *DESIGN, f"--scene.beam-inertia={value}"], 2
    yield ["trace", "job.cfg", *DESIGN, "--scene.sling-damping", "5"], 2
    yield from contradicting_scene_keys()
    for key in masses:
        yield ["trace", "job.cfg", *DESIGN, f"--scene.{key}", " +1.6 "], 0
    for value in ["1e12", "1e-12"]:
        yield ["trace", "job.cfg", *DESIGN, "--scene.projectile-mass", value], 0


def contradicting_scene_keys():
    """Scenes whose keys exclude or require each other."""
    beam = {"beam-mass": "5", "beam-centre": "0.4", "beam-moment": "2"}
    trough = {"trough": "yes"}
    for scene in [*({key: beam[key] for key in beam if key != missing} for missing in beam),
                  {**beam, "beam-density": "700"}, {**beam, "beam-side": "0.1"}, {**beam, "beam-inertia": "prism"},
                  {**beam, "beam-moment": "0.79"},
                  {"start-angle": "0.9", "release-height": "2"},
                  {"trough-height": "0.1"}, {**trough, "sling-angle": "-1"}, {**trough, "trough-height": "1.5"},
                  {"wind": "3"}, {"drag-coefficient": "0.5"}, {"projectile-diameter": "0", "air-density": "1.2"},
                  {**trough, "sling-stiffness": "3e5"}, {"counterweight-hanger": "0.3", "sling-stiffness": "3e5"}]:
        yield ["sweep", "job.cfg", *TINY, *(f"--scene.{key}={value}" for key, value in scene.items())], 2
    yield ["sweep", "job.cfg", *TINY, "--output.fields=peak-beam-stress",
           *(f"--scene.{key}={value}" for key, value in beam.items())], 2


def outer_axes():
    """Several values of a key that are malformed, and of commands and keys that take one."""
    texts = [",", "1,", "1,,2", "1, 1", "1 2", "1:2", "1:2:3:4", "2:1:1", "1:2:0", "1:2:-1", "1:2:0.7", "1:2:nan", "1::1", "1:2:1,3",
             "nan, 1", "1, 1e999", "-1e13, 1", "1:1e12:1e-6", "1:2:1e-300", f"{LONG}, 1", ", ".join(["1"] * 5000)]
    for key in ["gravity", "sling-angle", "beam-mass", "wind"]:
        for text in texts:
            yield ["trace", "job.cfg", *DESIGN, f"--scene.{key}={text}"], 2
        yield ["trace", "job.cfg", *DESIGN, f"--scene.{key}=1, 2"], 2
    for command in ["optimum", "assess"]:
        yield [command, "job.cfg", "--scene.gravity=9:10:0.5"], 2
    yield ["sweep", "job.cfg", "--lattice.increment=1e-3", "--scene.gravity=1:1000000:1"], 2
    yield ["sweep", "job.cfg", *TINY, "--scene.gravity=1:1e6:1", "--scene.projectile-mass=1:2:1"], 2
    yield ["sweep", "job.cfg", *TINY, "--scene.gravity=9, 10", "--output.maps=some"], 2
    yield ["sweep", "job.cfg", *TINY, "--scene.gravity=10 ,9", "--output.maps=none"], 0
    yield ["sweep", "job.cfg", *TINY, "--scene.gravity=9:9:1"], 0


def solver_keys():
    """Unknown solvers, and settings that exclude each other."""
    def refused(*options):
        return ["trace", "job.cfg", *DESIGN, *options], 2

    for value in ["", "Euler", "rk45", "dopri5 ", "euler,rk4"]:
        yield refused(f"--solver.stepper={value}")
    for value in [*NO_NUMBERS, "0", "-0.01"]:
        yield refused(*EULER, f"--solver.time-step={value}")
    for value in [*NO_NUMBERS, "0", "1", "1e-16", "-1e-9"]:
        yield refused(f"--solver.tolerance={value}")
    for value in ["", "nan", "0", "-1", "1e-30"]:
        yield refused(f"--solver.target-error={value}")
    for value in ["", "Window", "crossing,window"]:
        yield refused(*EULER, f"--solver.release={value}")
    for value in ["", "nan", "0", "-0.05", "1.5708", "10"]:
        yield refused(*EULER, "--solver.release", "window", f"--solver.release-window={value}")
    for value in [*NO_NUMBERS, "0", "-3.1", "6.3"]:
        yield refused(f"--solver.release-angle={value}")
    for value in [*NO_NUMBERS, "3.2", "-3.2"]:
        yield refused("--solver.release", "pin", f"--solver.pin-angle={value}")
    for value in ["", "nan", "inf", "0", "-1"]:
        yield refused(f"--solver.max-time={value}")
    for value in ["", "0", "-1", "1.5", "1e6", "99999999999999999999", "1000000000001"]:
        yield refused(f"--solver.max-steps={value}")
    yield refused("--solver.release", "window")
    yield refused("--solver.release-window", "0.05")
    yield refused("--solver.release", "pin")
    yield refused("--solver.pin-angle", "0.6")
    for release in ["pin", "farthest", "fastest"]:
        yield refused("--solver.release", release, "--solver.release-angle", "3")
    yield refused("--solver.time-step", "0.01")
    yield refused(*EULER, "--solver.tolerance", "1e-9")
    yield refused(*EULER, "--solver.target-error", "1e-6")
    yield refused("--solver.tolerance", "1e-9", "--solver.target-error", "1e-6")
    yield ["trace", "job.cfg", *DESIGN, "--solver.max-steps", "1"], 0
    yield ["trace", "job.cfg", *DESIGN, "--solver.max-steps", "1", "--flight"], 0
    yield ["trace", "job.cfg", *DESIGN, "--flight", "--interval", "1e-9"], 2
    yield ["trace", "job.cfg", *DESIGN, "--flight", "--scene.projectile-diameter", "1e5"], 1
    yield ["trace", "job.cfg", *DESIGN, "--solver.max-time", "1e-300"], 0


def lattices():
    """Lattices that are empty, too large or malformed."""
    def sweep(code, *options):
        return ["sweep", "job.cfg", "--progress", "none", *options], code

    for value in ["", "nan", "0", "-0.01", "1e-300", "1e-13", "1e-12", "1e-9", "2", "1e13"]:
        yield sweep(2, f"--lattice.increment={value}")
    for value in ["", "nan", "0", "1.5", "1e13"]:
        yield sweep(2, f"--lattice.shortest-sling={value}")
    for value in ["", ":", "::", "1:2", "1:2:3:4", "0:1:0.1", "1:0.5:0.1", "0.5:1:0", "0.5:1:-0.1", "a:b:c", "nan",
                  "0.5:inf:1", "1e13", "0.5:1.0:0.3", "0.1:0.3000001:0.1", "0.5:1:1e-13", "1e-12:1:1e-12"]:
        yield sweep(2, f"--lattice.r1={value}")
    yield sweep(2, "--lattice.r3", "2")
    yield sweep(2, "--scene.release-height", "3.5")
    yield sweep(0, "--lattice.r1", "0.6", "--lattice.r3", "1e12", "--lattice.r2", "1e-12")
    yield sweep(0, "--lattice.r1", "0.1", "--lattice.r3", "0.5", "--lattice.r2", "1")  # unreachable_start


def outputs():
    """Output paths that cannot be files, and malformed lists."""
    def sweep(code, *options):
        return ["sweep", "job.cfg", *TINY, *options], code

    for value in ["", ",", "speed,mass", "speed,speed", "speed;status", "Speed", LONG]:
        yield sweep(2, f"--output.fields={value}")
    for value in ["", "float16", "Float64"]:
        yield sweep(2, f"--output.storage={value}")
    for value in ["", "10", "-1", "1.5", "nine"]:
        yield sweep(2, f"--output.compression={value}")
    yield sweep(2, "--output.optimum", "slack")
    yield sweep(2, "--scene.beam-side", "0", "--output.fields", "peak-beam-stress")
    for name in ["", ".", "..", "/", "folder", "folder/", "no/such.h5", "job.cfg/x.h5", "a#b.h5", "a\nb.h5", " a.h5", "a.h5 ", '"a.h5"', "x" * 248,
                 "x" * 255, "x" * 300, "job.cfg", "text.txt", "empty", "fifo", "/dev/null", "loop", "link_to_fifo",
                 "link_to_folder", "socket"]:
        yield sweep(2, f"--output.file={name}")
    for name in ["partial_fifo.h5", "partial_text.h5", "partial_folder.h5", "partial_job.h5"]:
        for more in [[], ["--overwrite"]]:
            yield sweep(2, "--output.file", name, *more)
    yield sweep(0, "--output.file", "a name with blanks.h5")
    yield sweep(0, "--output.file", "-.h5")
    yield sweep(0, "--output.file", "ünïcödé.h5")
    yield sweep(0, "--output.file", "no_suffix")
    yield sweep(0, "--output.file", "dangling")


def optima():
    """Objectives and constraints that are malformed, contradict each other or do not suit the scene."""
    def sweep(code, *options):
        return ["sweep", "job.cfg", *TINY, *options], code

    limits = ["<", ">", "==", "=", "=>", "=<", "< =", "", "<= >="]
    fields = ["", "sped", "Speed", "peak_axle_load", "status", "slack", "steps", "speed-error", "energy-drift", LONG]
    lists = [",", "speed <= 3,", ",speed <= 3", "speed <= 3;apex <= 3", "speed <= 3 apex <= 3", "0 <= speed <= 3",
             "3 >= speed", "speed >= 3, speed <= 3", "speed >= 4, speed <= 3", "speed <= 3, speed <= 4",
             "apex >= 3,apex>=3", "lift-off-time >= 0", "peak-hanger-tension <= 1"]
    for value in [*(f"speed {sign} 3" for sign in limits), *(f"{field} <= 3" for field in fields),
                  *(f"speed <= {number}" for number in NO_NUMBERS), *lists]:
        yield sweep(2, f"--optimum.subject-to={value}")
    for value in [*fields, "speed,range", "lift-off-time", "peak-hanger-tension"]:
        yield sweep(2, f"--optimum.objective={value}")
    for value in [*NO_NUMBERS, "-0.01", "1e-13", "1.1e12"]:
        yield sweep(2, f"--optimum.deviation={value}")
    for value in ["", "yes", "Worst", "worst,expected", "worst", "expected"]:
        yield sweep(2, f"--optimum.robust={value}")
    for value in ["", "true", "1"]:
        yield sweep(2, f"--optimum.refine={value}")
    yield sweep(2, "--optimum.objective=peak-beam-stress", "--scene.beam-side=0")
    yield sweep(2, "--optimum.subject-to=peak-beam-stress <= 1e8", "--scene.beam-side=0")
    yield ["sweep", "strict.cfg", *TINY], 2
    yield ["trace", "job.cfg", *DESIGN, "--optimum.objective", "range"], 2
    yield ["assess", "job.cfg", "--optimum.objective", "range"], 2
    fixed = ["--lattice.r1=0.6", "--lattice.r3=0.6", "--lattice.r2=0.8"]
    for code, *options in [(2, "--optimum.objective=status"), (2, "--optimum.subject-to=speed < 3"),
                           (2, "--optimum.deviation=-1"), (2, "--optimum.robust=worst"), (2, "--json=yes"),
                           (2, "--lattice.increment=1e-4"), (2, "--lattice.r1=0.1:0.2"), (2, "--r1=0.6"),
                           (0, "--scene.trough=yes"), (2, "--overwrite"), (2, "--time-limit=1"),
                           (1, "--lattice.shortest-sling=2"), (1, "--scene.release-height=1e3"),
                           (1, "--optimum.subject-to=speed >= 1e6"), (1, "--scene.projectile-mass=1e9", "--lattice.increment=0.1"),
                           (1, "--optimum.deviation=1e9", "--optimum.robust=worst"), (0, *fixed),
                           (1, "--optimum.deviation=1e9"), (0, "--optimum.subject-to", ""),
                           (0, "--lattice.increment=0.3"), (0, "--optimum.refine=yes")]:
        yield ["optimum", "job.cfg", *options], code
    yield ["sweep", "job.cfg", *TINY, "--json"], 2
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
                      ["info", "missing.h5"], ["info", "folder"], ["info", "fifo"], ["info", "/dev/null"], ["info", "loop"],
                      ["info", "x" * 300], ["info", "job.cfg", "--overwrite"]]:
        yield arguments, 2
    for name in ["text.txt", "empty", "foreign.h5"]:
        yield ["info", name], 1
    for limit in ["", "0", "-5", "nan", "1:", ":30", "1-12", "1:2:3:4", "soon", "1e999"]:
        yield ["sweep", "job.cfg", f"--time-limit={limit}"], 2
    for arguments in [["--help"], ["-h"], ["--version"], ["sweep", "--help"], ["sweep", "missing.cfg", "-h"],
                      ["info", "--help"]]:
        yield arguments, 0


JOB_FILES = {
    "no_section": ("gravity = 9.8\n", 2), "unknown_section": ("[sceen]\ngravity = 9.8\n", 2),
    "unknown_key": ("[scene]\ngravitiy = 9.8\n", 2), "key_as_section": ("[scene.gravity]\nx = 1\n", 2),
    "dotted": ("scene.gravity = 5\n[scene]\ngravity = 9\n", 2), "dotted_section": ("[scene]\ngravity = 9\n[scene.]\ngravity = 8\n", 2),
    "duplicate": ("[scene]\ngravity = 9\ngravity = 9\n", 2), "twice": ("[scene]\ngravity = 9\n[scene]\ngravity = 9\n", 2),
    "hash": ("[output]\nfile = run#2.h5\n", 2), "words": ("This is a letter.\n", 2), "bracket": ("[scene\n", 2),
    "empty_section": ("[]\ngravity = 9\n", 2), "no_key": ("[scene]\n= 9\n", 2), "no_value": ("[scene]\ngravity =\n", 2),
    "placeholder": ("%invalid_line%\n", 2), "two_equals": ("[scene]\ngravity = 9 = 8\n", 2),
    "long_line": ("[scene]\n" + "x" * 100000 + "\n", 2), "long_value": (f"[scene]\ngravity = {LONG}\n", 2),
    "long_key": (f"[scene]\n{LONG} = 1\n", 2), "huge": ("#" * (2 << 20), 2), "binary": ("[scene]\n\0\1\2", 2),
    "escape": ("[scene]\ngravity = \x1b[31m9\n", 2), "json": ('{"scene": {"gravity": 9.8}}\n', 2),
    "strict": ("[optimum]\nsubject-to = speed < 3\n", 2), "constraint": ("[optimum]\nsubject-to = speed<=3\n", 0),
    "yaml": ("scene:\n  gravity: 9.8\n", 2), "semicolon": ("; a comment\n[scene]\n", 2),
    "quoted": ('[scene]\ngravity = "9.8"\n', 2), "unit": ("[scene]\nfulcrum-height = 1.5 m\n", 2),
    "nested": ("[scene]\nfile = nesting.cfg\n", 2), "missing_scene": ("[scene]\nfile = missing.cfg\n", 2),
    "fifo_scene": ("[scene]\nfile = fifo\n", 2), "folder_scene": ("[scene]\nfile = folder\n", 2),
    "itself": ("[scene]\nfile = itself.cfg\n", 2), "scene_is_a_job": ("[scene]\nfile = a_job.cfg\n", 2),
    "nonsense_under_option": ("[solver]\ntime-step = 0.1\n", 2), "unused_tolerance": ("[solver]\nstepper = rk4\ntolerance = 1e-9\n", 2),
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


KINDS = (scene_keys, outer_axes, solver_keys, lattices, outputs, optima, command_lines, job_files)


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
                         ("dangling", "target.h5"), ("partial_job.h5.partial", "job.cfg")]:
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
    if code == 2:
        if done.stdout:
            wrong.append(f"on stdout: {done.stdout[:200]!r}")
        if not re.fullmatch(r"trebsweep: [^\n]+\n", done.stderr) or len(done.stderr) > 3000:
            wrong.append("not one short line on stderr")
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
        self.assertGreaterEqual(count, 300)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            found = sum(pool.map(faults, kinds), [])
        self.assertEqual(found, [], f"{len(found)} of {count}:\n" + "\n".join(found))


if __name__ == "__main__":
    unittest.main()
