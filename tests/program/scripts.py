"""Shared by the tests of treb-plot and of the package trebsweep, which can be imported after this one."""

import os
import runpy
import signal
import subprocess
import sys
import tempfile

import numpy as np

from support import JOBS, PROGRAM, REPOSITORY, DirectoryTest

ANALYSIS = os.path.join(REPOSITORY, "analysis")
sys.dont_write_bytecode = True
sys.path.insert(0, ANALYSIS)
from archives import h5py, tiles
from trebsweep import cli, heatmap
from trebsweep.backend import AXES, OPTIMUM
from trebsweep.picture import plt
from trebsweep.scenes import load, only

plt.figure  # imports matplotlib, before the first fork
TREB_PLOT = os.path.join(ANALYSIS, "treb-plot")

SIGNATURES = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml", "eps": b"%!PS", "jpg": b"\xff\xd8"}
SUBCOMMANDS = ("assess", "compare", "heatmap", "importance", "loads", "optimum", "rules", "study", "trajectory")
EVERY_SUBCOMMAND = tuple(cli.COMMANDS)
FIELDS = "speed, status, slack, release-time, peak-axle-load, peak-beam-stress, range, energy-drift"
DESIGN = ("--r1", "0.51", "--r2", "0.91", "--r3", "0.58")
# The laboratory machine of arXiv:2502.19442.
LABORATORY = """[scene]
gravity = 9.81
counterweight-mass = 53.9
projectile-mass = 0.717
beam-mass = 4.86
beam-centre = 0.465
beam-moment = 1.85
fulcrum-height = 0.831
start-angle = 0.55
trough = yes
counterweight-hanger = 0.515
[lattice]
r1 = 0.15:0.35:0.05
r3 = 0.47:1.07:0.2
r2 = 0.675:1.175:0.1
[solver]
release = farthest
"""
LABORATORY_DESIGN = ("--r1", "0.25", "--r2", "0.975", "--r3", "0.87")
LABORATORY_FIELDS = "speed, status, range, flight-time, impact-speed, apex, lift-off-time, arm-angle, " \
                    "pin-angle, peak-hanger-tension"


def run_forked(directory, *words):
    """Runs treb-plot, or a script, in a copy of this process, in which its packages are imported; that would take a
    second each time. Returns what subprocess.run() would."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        child = os.fork()
        if child == 0:
            code = 1
            signal.alarm(60)  # s: ends a script that hangs
            try:
                for file, stream in ((out, 1), (err, 2)):
                    os.dup2(file.fileno(), stream)
                sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", closefd=False)
                os.chdir(directory)
                if words[0].endswith(".py"):
                    sys.argv = [*words]
                    runpy.run_path(words[0], run_name="__main__")
                sys.argv = [TREB_PLOT, *words]
                cli.main()
            except SystemExit as end:
                code = end.code if isinstance(end.code, int) else int(end.code is not None)
            except BaseException:
                sys.excepthook(*sys.exc_info())
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        out.seek(0)
        err.seek(0)
        return subprocess.CompletedProcess(["treb-plot", *words], code, out.read(), err.read())


class ScriptTest(DirectoryTest):
    """Tests that run treb-plot."""

    @classmethod
    def sweep(cls, job, *options, name=None, increment="0.05"):
        """Writes the archive of a job on a coarse lattice; returns its path."""
        archive = cls.path(f"{name or job}.h5")
        subprocess.run([PROGRAM, "sweep", os.path.join(JOBS, f"{job}.cfg"), "--lattice.increment",
                        increment, "--output.file", archive, *options],
                       check=True, capture_output=True, timeout=120)
        return archive

    def run_script(self, *words, code=0, says=""):
        """Runs treb-plot, which prints nothing on stderr, or one line that contains `says`."""
        done = run_forked(self.directory, *words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertIn(says, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1 if says else 0, done.stderr)
        return done

    def assert_picture(self, name, suffix=None):
        """A file of this format; a PNG shows data: axes and text are black, grey and white."""
        suffix = suffix or name.rsplit(".", 1)[1]
        self.assertTrue(self.read(name).startswith(SIGNATURES[suffix]))
        if suffix == "png":
            with open(self.path(name), "rb") as file:
                red, green, blue = np.moveaxis(plt.imread(file, format="png")[..., :3], -1, 0)
            largest = np.maximum(np.maximum(red, green), blue)
            smallest = np.minimum(np.minimum(red, green), blue)
            self.assertGreater(np.mean(largest - smallest > 0.2), 2e-4, f"{name}: no data are drawn")

    def trace(self, *options, comments=True, job="jobs/accurate.cfg", name="table.txt", design=DESIGN):
        """Writes the table of a swing, by default the optimum's, with or without its comments; returns its
        path."""
        done = subprocess.run([PROGRAM, "trace", os.path.join(REPOSITORY, job), *design, *options],
                              check=True, capture_output=True, text=True, timeout=120)
        lines = [line for line in done.stdout.splitlines() if comments or not line.startswith("#")]
        return self.write(name, "\n".join([*lines, ""]))

    def trace_laboratory(self, *options, **arguments):
        """The same for the laboratory machine."""
        job = self.write("laboratory.cfg", LABORATORY)
        return self.trace(*options, job=job, design=LABORATORY_DESIGN, **arguments)


class PictureTest(ScriptTest):
    """Tests with the archives paper.h5, accurate.h5, loads.h5 with the maps of FIELDS, and
    laboratory.h5, of a machine with hanger and trough, with those of LABORATORY_FIELDS."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("paper")
        cls.sweep("accurate")
        cls.sweep("accurate", "--output.fields", FIELDS, name="loads")
        cls.write("laboratory.cfg", LABORATORY)
        cls.sweep(cls.path("laboratory"), "--output.fields", LABORATORY_FIELDS, name="laboratory")

    def figure(self, archive, field, **chosen):
        """The figure that treb-plot heatmap draws."""
        figure = heatmap.picture(only(load(self.path(archive))), field, chosen)
        self.addCleanup(plt.close, figure)
        return figure

    def star(self, figure):
        """{axis: m} of the star, read from the first two panels."""
        design = {}
        for axes in figure.axes[:2]:
            for line in axes.get_lines():
                if line.get_marker() == "*":
                    for label, value in ((axes.get_xlabel(), line.get_xdata()),
                                         (axes.get_ylabel(), line.get_ydata())):
                        design[label.split()[-2]] = float(np.squeeze(value))
        return design


def best_of(speed, file):
    """{column: value} of the fastest design of a map; NaN without one."""
    if np.isnan(speed).all():
        return {f"best_{name}": np.nan for name in OPTIMUM}
    index = np.unravel_index(np.nanargmax(speed), speed.shape)
    return {"best_value": speed[index], **{f"best_{name}": file[name][i] for name, i in zip(AXES, index)}}


def leave_out(path, done, junk):
    """Makes an archive that of an unfinished sweep with the first `done` tiles done, and `junk` in the maps of the
    others, whose slices are returned."""
    with h5py.File(path, "r+") as file:
        speed = np.full(file["speed"].shape, np.nan)
        for tile in list(tiles(file))[:done]:
            speed[tile] = file["speed"][tile]
        undone = list(tiles(file))[done:]
        for name in {"speed", "speed_error"} & file.keys():
            for tile in undone:
                file[name][tile] = junk
        for tile in undone:
            file["status"][tile] = 1
        file["tile_designs"][done:] = 0
        outer = file["scene_lattice"].shape
        for number in set(file["tile_block"][done:, 0].astype(int).tolist()):
            scene = np.unravel_index(number, outer)
            for column, value in best_of(speed[scene], file).items():
                if outer:
                    file[column][scene] = value
                else:
                    file.attrs[column] = value
    return undone
