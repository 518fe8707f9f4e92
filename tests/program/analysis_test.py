"""The pictures and reports of analysis/, from archives and tables that the program writes.

Needs TREBSWEEP (the program, in its build directory) in the environment.
"""

import contextlib
import io
import json
import os
import random
import runpy
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import numpy as np

from archives import h5py, tiles
from support import JOBS, PROGRAM, REPOSITORY, DirectoryTest

ANALYSIS = os.path.join(REPOSITORY, "analysis")
SIGNATURES = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml", "eps": b"%!PS", "jpg": b"\xff\xd8"}
SCRIPTS = ("assess.py", "compare.py", "heatmap.py", "loads.py", "optimum.py", "rules.py", "sobol.py", "study.py",
           "trajectory.py")
EVERY_SCRIPT = (*SCRIPTS, "machine.py", "neighbourhood.py")
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

sys.dont_write_bytecode = True
sys.path.insert(0, ANALYSIS)
import assess  # noqa: E402  (found by the path)
import compare  # noqa: E402
import heatmap  # noqa: E402
import loads  # noqa: E402
import machine  # noqa: E402
import maps  # noqa: E402
import neighbourhood  # noqa: E402
import sobol  # noqa: E402
import study  # noqa: E402
import trajectory  # noqa: E402
from archive import AXES, OPTIMUM, Archive, parse_job  # noqa: E402
from box import cells, largest_full_box  # noqa: E402
from picture import plt  # noqa: E402


def run_forked(directory, script, *arguments):
    """Runs a script in a copy of this process, in which its packages are imported; that would take a second each time.
    Returns what subprocess.run() would."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        child = os.fork()
        if child == 0:
            code = 1
            try:
                for file, stream in ((out, 1), (err, 2)):
                    os.dup2(file.fileno(), stream)
                sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", closefd=False)
                os.chdir(directory)
                sys.argv = [script, *arguments]
                for name, module in list(sys.modules.items()):  # the scripts' own take their names from sys.argv
                    if os.path.dirname(getattr(module, "__file__", None) or "") == ANALYSIS:
                        del sys.modules[name]
                runpy.run_path(script, run_name="__main__")
                code = 0
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
        return subprocess.CompletedProcess([script, *arguments], code, out.read(), err.read())


class ScriptTest(DirectoryTest):
    """Tests that run the scripts."""

    @classmethod
    def sweep(cls, job, *options, name=None, increment="0.05"):
        """Writes the archive of a job on a coarse lattice; returns its path."""
        archive = cls.path(f"{name or job}.h5")
        subprocess.run([PROGRAM, "sweep", os.path.join(JOBS, f"{job}.cfg"), "--lattice.increment",
                        increment, "--output.file", archive, *options],
                       check=True, capture_output=True, timeout=120)
        return archive

    def run_script(self, script, *arguments, code=0, says=""):
        """Runs a script, which prints nothing on stderr, or one line that contains `says`."""
        done = run_forked(self.directory, f"{ANALYSIS}/{script}", *arguments)
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
                pixels = plt.imread(file, format="png")[..., :3]
            self.assertGreater(np.mean(np.ptp(pixels, axis=-1) > 0.2), 2e-4, f"{name}: no data are drawn")

    def assert_nothing_is_cut(self, name):
        """The edges of a picture are white, as they are unless something extends beyond them."""
        pixels = plt.imread(self.path(name))[..., :3]
        for edge in (pixels[:4], pixels[-4:], pixels[:, :4], pixels[:, -4:]):
            self.assertTrue((edge == 1).all(), name)

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
        """The figure that heatmap.py draws."""
        figure = heatmap.picture(Archive(self.path(archive)), field, chosen)
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


class Heatmaps(PictureTest):
    def test_heatmaps_are_drawn_of_every_field_and_in_every_format(self):
        for archive, field in (*(("loads", field) for field in FIELDS.split(", ")),
                               *(("laboratory", field) for field in LABORATORY_FIELDS.split(", "))):
            command = ["heatmap.py", self.path(f"{archive}.h5"), "--field", field]
            with unittest.mock.patch("sys.argv", command), \
                    contextlib.redirect_stdout(io.StringIO()), \
                    contextlib.redirect_stderr(io.StringIO()) as errors:
                heatmap.main()
            self.assertEqual(errors.getvalue(), "")
            self.assert_picture(f"{archive}-{field}.png")
            self.assert_nothing_is_cut(f"{archive}-{field}.png")
        for suffix in SIGNATURES:
            self.run_script("heatmap.py", "paper.h5", "--r1", "0.7", "-o", f"map.{suffix}")
            self.assert_picture(f"map.{suffix}")

    def test_an_output_name_without_suffix_is_kept_and_holds_a_png(self):
        self.trace()
        for script, source in (("heatmap.py", ["paper.h5"]), ("trajectory.py", ["table.txt"]),
                               ("compare.py", ["paper.h5", "accurate.h5"]),
                               ("loads.py", ["paper.h5", "--count", "1", "--program", PROGRAM])):
            with self.subTest(script=script):
                name = f"picture of {script}".removesuffix(".py")
                self.run_script(script, *source, "-o", name)
                self.assert_picture(name, "png")

    def test_input_files_are_not_overwritten(self):
        shutil.copy(self.path("paper.h5"), self.path("archive"))
        before = self.read("archive")
        for script, option in (("heatmap.py", "-o"), ("loads.py", "-o"), ("optimum.py", "--job")):
            self.run_script(script, "archive", option, "archive", code=2, says="archive")
        self.run_script("compare.py", "paper.h5", "archive", "-o", "archive", code=2, says="archive")
        self.assertEqual(self.read("archive"), before)

    def test_labels_stay_inside_the_picture_for_long_names(self):
        name = "a_long_name_of_an_archive_" * 8
        self.sweep("accurate", "--lattice.r1", "0.7", name="flat")
        self.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r3", "0.5", name="thin")
        for source in ("loads", "accurate", "flat", "thin"):
            shutil.copy(self.path(f"{source}.h5"), self.path(f"{source}_{name}.h5"))
        for script, *arguments in (
                ("heatmap.py", f"loads_{name}.h5", "--field", "energy-drift"),
                ("heatmap.py", f"flat_{name}.h5"), ("heatmap.py", f"thin_{name}.h5"),
                ("heatmap.py", f"thin_{name}.h5", "--field", "status"),
                ("compare.py", f"loads_{name}.h5", f"accurate_{name}.h5"),
                ("loads.py", f"loads_{name}.h5", "--count", "1", "--program", PROGRAM)):
            with self.subTest(script=script, arguments=arguments):
                self.run_script(script, *arguments, "-o", "long.png")
                self.assert_nothing_is_cut("long.png")

    def test_names_with_markup_or_without_glyphs_are_drawn(self):
        shutil.copy(self.path("paper.h5"), self.path("$r_1$^ \u5f29.h5"))
        self.run_script("heatmap.py", "$r_1$^ \u5f29.h5", "-o", "markup.png")

    def test_three_free_axes_give_planes_two_a_plane_and_one_a_line(self):
        self.sweep("accurate", "--lattice.r3", "0.58", name="plane")
        self.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r3", "0.5", name="line")
        for archive, panels in (("accurate.h5", 3), ("plane.h5", 1), ("line.h5", 0)):
            meshes = [axes for axes in self.figure(archive, "speed").axes if axes.collections
                      and axes.get_xlabel()]
            self.assertEqual(len(meshes), panels, archive)
        with h5py.File(self.path("line.h5")) as file:
            line = self.figure("line.h5", "speed").axes[0].get_lines()[0]
            np.testing.assert_array_equal(line.get_xdata(), file["r2"])
            np.testing.assert_array_equal(line.get_ydata(), np.ravel(file["speed"]))
        self.run_script("compare.py", "plane.h5", "plane.h5", "-o", "plane.png")
        self.run_script("compare.py", "line.h5", "line.h5", "-o", "line.png")

    def test_tick_labels_with_many_digits_do_not_overlap(self):
        self.sweep("accurate", "--lattice.r1", "0.510001:0.510003:0.000001", "--lattice.r3",
                   "0.58:0.5801:0.00001", "--lattice.r2", "0.91:0.9101:0.00001", name="fine")
        figure = self.figure("fine.h5", "speed")
        figure.canvas.draw()
        for axes in figure.axes[:3]:
            boxes = [label.get_window_extent() for label in axes.get_xticklabels()
                     if axes.get_xlim()[0] <= label.get_position()[0] <= axes.get_xlim()[1]]
            for left, right in zip(boxes, boxes[1:]):
                self.assertLess(left.x1 + 5, right.x0)
            self.assertEqual(axes.xaxis.get_offset_text().get_text(), "")

    def test_a_single_design_is_printed_as_a_table(self):
        single = self.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r3", "0.5",
                            "--lattice.r2", "0.9", name="single")
        with h5py.File(single) as file:
            speed = file.attrs["best_speed"]
        done = self.run_script("heatmap.py", "single.h5", "-o", "single.png",
                               says="single.h5: holds a single design")
        self.assertRegex(done.stdout, r"(?m)^r2 +0\.9 m$")
        self.assertRegex(done.stdout, rf"(?m)^speed +{speed:.10g} m/s$")
        self.assertRegex(done.stdout, r"(?m)^status +released$")
        self.run_script("compare.py", "single.h5", "single.h5", says="no picture")
        self.assertFalse(os.path.exists(self.path("single.png")))

    def test_contours_have_the_same_levels_in_all_panels_and_labels_that_differ_from_their_ground(self):
        contour, drawn = plt.matplotlib.axes.Axes.contour, []

        def record(*arguments, **options):
            drawn.append(contour(*arguments, **options))
            return drawn[-1]

        for archive, field in (("accurate.h5", "speed"), ("loads.h5", "peak_axle_load")):
            drawn.clear()
            with unittest.mock.patch.object(plt.matplotlib.axes.Axes, "contour", record):
                self.figure(archive, field)
            self.assertEqual(len(drawn), 3)
            for lines in drawn:
                np.testing.assert_array_equal(lines.levels, drawn[0].levels)
                self.assertGreater(len(lines.labelTexts), 0)
                mesh = lines.axes.collections[0]
                for text in lines.labelTexts:
                    self.assertGreaterEqual(text.get_fontsize(), 8)
                    ground = np.mean(mesh.to_rgba(float(text.get_text()))[:3])
                    colour = np.mean(plt.matplotlib.colors.to_rgb(text.get_color()))
                    self.assertGreater(abs(ground - colour), 0.3)

    def test_levels_that_no_panel_reaches_are_left_out(self):
        flat, steep = np.full((3, 3), 2.0), np.arange(9.0).reshape(3, 3)
        self.assertEqual(maps.contour_levels([flat, flat]), [])
        self.assertEqual(maps.contour_levels([np.full((2, 2), np.nan)]), [])
        self.assertIn(4, maps.contour_levels([flat, steep]))

    def test_every_status_has_a_colour_of_its_own(self):
        meanings = Archive(self.path("paper.h5")).meanings("status")
        style = maps.flag_colours(meanings)
        colours = {style["cmap"](style["norm"](flag)) for flag in range(len(meanings))}
        self.assertEqual(len(colours), len(meanings))

    def test_the_fields_with_a_best_value_are_fields_of_the_program(self):
        usage = self.run_program("sweep", "--help").stdout
        for field in heatmap.LARGEST + heatmap.SMALLEST:
            self.assertRegex(usage, rf"[ ,]{field.replace('_', '-')}[\s,]")

    def test_the_star_and_the_title_show_the_best_design_of_the_field(self):
        with h5py.File(self.path("laboratory.h5")) as file:
            for field, best, word in (("impact_speed", np.nanargmax, "largest"),
                                      ("apex", np.nanargmax, "largest"),
                                      ("peak_hanger_tension", np.nanargmin, "smallest")):
                figure = self.figure("laboratory.h5", field)
                index = np.unravel_index(best(file[field]), file[field].shape)
                self.assertEqual(self.star(figure),
                                 {name: file[name][i] for name, i in zip(AXES, index)})
                self.assertIn(f"\u2605 {word}: ", figure._suptitle.get_text())
        with h5py.File(self.path("loads.h5")) as file:
            for field, best, words in (
                    ("speed", np.nanargmax(file["speed"]), "\u2605 fastest: "),
                    ("range", np.nanargmax(file["range"]), "\u2605 largest: "),
                    ("peak_axle_load", np.nanargmin(file["peak_axle_load"]), "\u2605 smallest: "),
                    ("release_time", np.nanargmin(file["release_time"]), "\u2605 smallest: "),
                    ("status", np.nanargmax(file["speed"]), "\u2605 fastest: ")):
                with self.subTest(field=field):
                    figure = self.figure("loads.h5", field)
                    design = {name: file[name][i] for name, i in
                              zip(AXES, np.unravel_index(best, file["speed"].shape))}
                    self.assertEqual(self.star(figure), design)
                    self.assertIn(words, figure._suptitle.get_text())

    def test_the_star_of_the_objective_is_the_sweeps_optimum(self):
        self.sweep("accurate", "--output.fields", "speed, range, status, peak-axle-load", "--optimum.objective",
                   "range", "--optimum.subject-to", "peak-axle-load <= 180000", name="within")
        with h5py.File(self.path("within.h5")) as file:
            optimum = {axis: file.attrs[f"best_{axis}"] for axis in AXES}
            shape = file["speed"].shape
            fastest, farthest = ({axis: file[axis][i] for axis, i in zip(
                AXES, np.unravel_index(np.nanargmax(file[name]), shape))} for name in ("speed", "range"))
            value = file.attrs["best_value"]
        self.assertNotEqual(optimum, farthest)
        text = f"\u2605 optimum within the constraints: range {value:.10g} m at "
        for field, design, words in (("range", optimum, text), ("status", optimum, text),
                                     ("speed", fastest, "\u2605 largest: ")):
            with self.subTest(field=field):
                figure = self.figure("within.h5", field)
                self.assertEqual(self.star(figure), design)
                self.assertIn(words, figure._suptitle.get_text())
        done = self.run_script("compare.py", "accurate.h5", "within.h5", "-o", "within.png")
        self.assertIn(f"B         within.h5: range {value:.10g} m at ", done.stdout)
        self.assertRegex(done.stdout, r"A         accurate.h5: [\d.]+ m/s at ")
        self.assertEqual(self.run_script("optimum.py", "within.h5").stdout,
                         " ".join(f"--{axis} {float(optimum[axis])!r}" for axis in AXES) + "\n")
        self.sweep("accurate", "--optimum.subject-to", "speed >= 100", name="none")
        self.assertIn("none.h5: has no optimum: no released design qualifies\n",
                      self.run_command(sys.executable, f"{ANALYSIS}/optimum.py", "none.h5").stderr)

    def test_units_have_prefixes_that_suit_the_values(self):
        self.sweep("accurate", "--output.fields", "speed, peak-axle-load, peak-beam-stress",
                   "--scene.counterweight-mass", "5", "--scene.projectile-mass", "0.1",
                   "--scene.beam-density", "1", name="toy")
        for archive, field, unit in (("loads.h5", "peak_axle_load", "(kN)"),
                                     ("loads.h5", "peak_beam_stress", "(MPa)"),
                                     ("loads.h5", "speed", "(m/s)"), ("loads.h5", "range", "(m)"),
                                     ("toy.h5", "peak_axle_load", "(N)"),
                                     ("toy.h5", "peak_beam_stress", "(kPa)")):
            label = self.figure(archive, field).axes[-1].get_ylabel().replace("\n", " ")
            self.assertTrue(label.endswith(" " + unit), f"{archive} {field}: {label}")
            values = self.figure(archive, field).axes[0].collections[0].get_array()
            self.assertLess(np.nanmax(values), 1000)


class Reports(PictureTest):
    def test_loads_of_the_best_designs_are_drawn(self):
        self.run_script("loads.py", "accurate.h5", "--count", "1", "--program", PROGRAM)
        self.assert_picture("accurate-loads.png")
        self.run_script("loads.py", "accurate.h5", "--count", "100", "--program", PROGRAM,
                        says="of 100 designs drawn")

    def test_loads_of_a_built_machine_are_those_that_it_has(self):
        self.run_script("loads.py", "laboratory.h5", "--count", "1", "--program", PROGRAM)
        self.assert_nothing_is_cut("laboratory-loads.png")
        for archive, missing, shown in (("laboratory", "bending stress", "hanger"),
                                        ("accurate", "hanger", "bending stress")):
            archive = Archive(self.path(f"{archive}.h5"))
            figure = loads.draw(archive, [archive.optimum()[0]], PROGRAM)
            self.addCleanup(plt.close, figure)
            labels = " ".join(axes.get_ylabel() for axes in figure.axes)
            self.assertIn(shown, labels)
            self.assertNotIn(missing, labels)

    def test_a_plateau_is_one_local_maximum_and_a_ledge_is_not(self):
        speed = np.zeros((9, 9, 9))
        speed[1, 1:4, 1:4] = 5
        speed[2, 3, 3] = 5  # touches a corner of the plateau
        speed[6, 6, 2:7] = 4
        speed[6, 6, 7] = 4.5  # the ledge below it is not a maximum
        speed[8, 0, 0] = np.nan
        self.assertEqual(loads.local_maxima(speed, 5), [(1, 1, 1), (6, 6, 7)])
        self.assertEqual(loads.local_maxima(np.full((3, 3, 3), 7.0), 5), [(0, 0, 0)])
        self.assertEqual(loads.local_maxima(np.full((3, 3, 3), np.nan), 5), [])

    def test_maps_without_values_and_constant_maps_are_drawn(self):
        self.sweep("accurate", "--solver.max-time", "0.01", name="nothing")
        self.run_script("heatmap.py", "nothing.h5")
        self.assert_picture("nothing-speed.png")
        shutil.copy(self.path("accurate.h5"), self.path("constant.h5"))
        with h5py.File(self.path("constant.h5"), "r+") as file:
            file["speed"][...] = 7
        self.run_script("heatmap.py", "constant.h5")
        self.run_script("compare.py", "constant.h5", "nothing.h5")

    def test_heatmap_draws_the_first_map_of_an_archive_without_speed(self):
        self.sweep("accurate", "--output.fields", "status", name="flags")
        self.run_script("heatmap.py", "flags.h5")
        self.assert_picture("flags-status.png")

    def test_compare_prints_numbers_and_draws_a_map(self):
        done = self.run_script("compare.py", "paper.h5", "accurate.h5")
        self.assertIn("largest", done.stdout)
        self.assert_picture("paper-accurate.png")
        done = self.run_script("compare.py", "accurate.h5", "accurate.h5", "-o", "same.svg")
        self.assertIn("median 0, 95 % below 0, largest 0 m/s", done.stdout)

    def test_an_assessment_is_drawn_with_maps(self):
        maps = self.sweep("paper", "--output.fields", "speed, status, speed-error, stiffness",
                          name="maps")
        subprocess.run([PROGRAM, "assess", f"{JOBS}/paper.cfg",
                        "--assess.scenes", f"{JOBS}/extreme/long_steps.cfg",
                        "--assess.steppers", "euler, dopri5", "--assess.time-steps", "0.01, 0.005",
                        "--assess.tolerances", "1e-5, 1e-7", "--assess.repeats", "1",
                        "--output.file", self.path("assess.h5")],
                       check=True, capture_output=True, timeout=120)
        self.run_script("assess.py", "assess.h5", "--maps", maps)
        for picture in ("precision", "order", "stability", "speed_error", "stiffness"):
            self.assert_picture(f"assess-{picture}.png")
            self.assert_nothing_is_cut(f"assess-{picture}.png")
        self.run_script("assess.py", "assess.h5", "--format", "svg", "-o", "other")
        self.assert_picture("other-precision.svg")
        self.run_script("assess.py", "paper.h5", code=1, says="paper.h5: is not an assessment")
        self.run_script("heatmap.py", "assess.h5", code=1,
                        says="assess.h5: is not an archive of trebsweep")

    def test_errors_beyond_the_axis_are_marked(self):
        inf, nan = np.inf, np.nan
        made = assess.Assessment.__new__(assess.Assessment)
        columns = {"scene": ["calm"] * 2 + ["wild"] * 5, "stepper": ["euler", "rk4", *["euler"] * 5],
                   "seconds": [1e-6, 2e-6, 1e-6, 2e-6, 4e-6, 8e-6, 1e-5], "error_largest": [1, 0.1, inf, nan, 50, 0.3, 0.2],
                   "different": [0, 0, 0, 1, 0, 0, 1]}
        made.tables = {"accuracy": {name: np.array(values) for name, values in columns.items()},
                       "reference": {"scene": np.array(["calm", "wild"]), "speed_bound": np.array([1e-12, 1e-12])}}
        figure = assess.draw_errors(made, "seconds", "run time (s)", "Error")
        self.addCleanup(plt.close, figure)
        calm, wild = figure.axes
        marks = [line for line in wild.get_lines() if line.get_marker() == assess.BEYOND]
        np.testing.assert_array_equal(np.concatenate([line.get_xdata() for line in marks]), [1e-6, 2e-6, 4e-6, 1e-5])
        curve = next(line for line in wild.get_lines() if line.get_label() == "euler")
        np.testing.assert_array_equal(curve.get_ydata(), [nan, nan, nan, 0.3, nan])
        for line in marks:
            self.assertEqual(line.get_color(), curve.get_color())
            shown = line.get_transform().transform(np.column_stack(line.get_data()))
            box = wild.get_window_extent()
            self.assertTrue((shown[:, 1] > box.y0 + 0.9 * box.height).all() and (shown[:, 1] < box.y1).all())
        self.assertNotIn(assess.BEYOND, [line.get_marker() for line in calm.get_lines()])
        explained = "\u2191 an error above 10 m/s, or an outcome that is not the true one"
        self.assertIn(explained, figure._suptitle.get_text())
        made.tables["accuracy"] = {name: values[:2] for name, values in made.tables["accuracy"].items()}
        figure = assess.draw_errors(made, "seconds", "run time (s)", "Error")
        self.addCleanup(plt.close, figure)
        self.assertNotIn("\u2191", figure._suptitle.get_text())

    def test_of_different_lattices_the_common_designs_are_compared(self):
        self.sweep("accurate", "--lattice.r1", "0.6:1.1:0.1", "--lattice.r3", "0.3:1.3:0.1", name="narrow")
        with h5py.File(self.path("narrow.h5")) as narrow, h5py.File(self.path("accurate.h5")) as wide:
            places = [np.flatnonzero(np.isin(wide[name][...].round(9), narrow[name][...].round(9))) for name in AXES]
            common = (wide["status"][...][np.ix_(*places)] > 0).sum()
            counts = [(file["status"][...] > 0).sum() for file in (narrow, wide)]
        self.assertTrue(0 < common == counts[0] < counts[1])
        for a, b, sizes in (("narrow", "accurate", counts), ("accurate", "narrow", counts[::-1])):
            done = self.run_script("compare.py", f"{a}.h5", f"{b}.h5")
            self.assertEqual(done.stdout.splitlines()[2:5], [
                f"lattices  {common} designs in common, of {sizes[0]} of A and {sizes[1]} of B",
                f"designs   {common} with a speed in both, 0 in one of them only",
                "|A - B|   median 0, 95 % below 0, largest 0 m/s"])
            self.assert_picture(f"{a}-{b}.png")
        self.sweep("accurate", "--lattice.r1", "0.61:0.71:0.1", name="between")
        self.run_script("compare.py", "between.h5", "accurate.h5", code=1,
                        says="between.h5 and accurate.h5 have no design in common")

    def test_optimum_prints_options_of_trace(self):
        done = self.run_script("optimum.py", "accurate.h5", "--job", "accurate-job.cfg")
        self.assertRegex(done.stdout, r"^--r1 [\d.]+ --r3 [\d.]+ --r2 [\d.]+\n$")
        self.assertIn(b"stepper = vern8\n", self.read("accurate-job.cfg"))

    def test_the_continuous_optimum_of_an_archive_is_that_of_its_job(self):
        self.sweep("paper", "--solver.time-step", "0.002", "--optimum.objective", "efficiency", name="fine")
        done = self.run_script("optimum.py", "fine.h5", "--continuous", "--job", "fine.cfg", "--program",
                               PROGRAM)
        found = json.loads(self.run_program("optimum", f"{JOBS}/accurate.cfg", "--json",
                                            "--optimum.objective", "efficiency").stdout)
        words = done.stdout.split()
        self.assertEqual(words[::2], ["--r1", "--r3", "--r2"])
        np.testing.assert_allclose(np.array(words[1::2], float), [found[name] for name in AXES], atol=1e-9)
        self.sweep(self.path("fine"), *(word.replace("--", "--lattice.") for word in words),
                   "--output.fields", "efficiency", name="efficiency")
        with h5py.File(self.path("efficiency.h5")) as file:
            self.assertAlmostEqual(file["efficiency"][0, 0, 0], found["value"], places=7)

    def test_without_a_continuous_optimum_no_options_are_printed(self):
        self.sweep("accurate", "--optimum.subject-to", "peak-axle-load <= 1", name="overloaded")
        done = self.run_script("optimum.py", "overloaded.h5", "--continuous", "--program", PROGRAM,
                               says="the constraints exclude every design")
        self.assertEqual(done.stdout, "")
        for program in ("no/such/program", "false", "true"):
            self.run_script("optimum.py", "accurate.h5", "--continuous", "--program", program, code=1,
                            says=program)

    def test_invalid_options_are_refused_with_what_is_allowed(self):
        for script, arguments, words in (
                ("heatmap.py", ["accurate.h5", "--field", "mass"],
                 "field = mass: accurate.h5 has no map mass; must be one of release_time, speed"),
                ("heatmap.py", ["accurate.h5", "-o", "picture.xyz"], "output = picture.xyz: must end"),
                ("heatmap.py", ["accurate.h5", "--r1", "5"],
                 "r1 = 5: must be a value of the axis in accurate.h5, such as 1.45 or 1.4 m, from 0.55 to 1.45 m"),
                ("heatmap.py", ["accurate.h5", "--r1", "0.64"],
                 "r1 = 0.64: must be a value of the axis in accurate.h5, such as 0.65 or 0.6 m"),
                ("heatmap.py", ["accurate.h5", "--r2", "0.123"], "r2 = 0.123: must be a value of the axis"),
                ("heatmap.py", ["accurate.h5", "--r3", "0.50001"], "such as 0.5 or 0.55 m"),
                ("heatmap.py", ["accurate.h5", "--r1", "nan"], "r1 = nan: must be"),
                ("heatmap.py", ["accurate.h5", "--r1", "x"], "--r1: invalid float value: 'x'"),
                ("heatmap.py", ["accurate.h5", "--colour", "x"], "--colour"),
                ("heatmap.py", [], "ARCHIVE"),
                ("loads.py", ["accurate.h5", "--count", "0"], "count = 0: must be at least 1"),
                ("trajectory.py", ["table.txt", "--count", "-1"], "count = -1: must be at least 2"),
                ("assess.py", ["assess.h5", "--format", "xyz"], "format = xyz: must be one of png"),
                ("compare.py", ["paper.h5", "accurate.h5", "--field", "status"],
                 "field = status: holds flags; must be a map of numbers: release_time, speed")):
            with self.subTest(script=script, arguments=arguments):
                self.run_script(script, *arguments, code=2, says=words)


class Swings(ScriptTest):
    def figure(self, table, flight=None):
        """The figure that trajectory.py draws from tables."""
        swing = trajectory.read_table(self.path(table))
        figure = trajectory.draw(swing, 16, flight and trajectory.read_flight(flight, swing))
        self.addCleanup(plt.close, figure)
        return figure

    def labels(self, *tables):
        """The labels in the legends of the figure."""
        return {label for axes in self.figure(*tables).axes
                for label in axes.get_legend_handles_labels()[1]}

    def test_swings_are_drawn_with_and_without_comments_and_flight(self):
        for trace in (self.trace, self.trace_laboratory):
            trace("--flight", name="flight.txt")
            for comments in (False, True):
                for flight in ((), ("--flight", "flight.txt")):
                    trace(comments=comments)
                    self.run_script("trajectory.py", "table.txt", *flight, "-o", "swing.png")
                    self.assert_picture("swing.png")
                    self.assert_nothing_is_cut("swing.png")

    def test_ground_trough_and_lift_off_are_drawn_if_the_comments_define_them(self):
        self.assertEqual(self.labels(self.trace()) & {"ground", "trough", "lift-off"}, {"ground"})
        self.assertTrue(self.labels(self.trace_laboratory()) >= {"ground", "trough", "lift-off"})
        self.assertFalse(self.labels(self.trace_laboratory(comments=False)) &
                         {"ground", "trough", "lift-off"})

    def test_the_trough_ends_at_the_lift_off(self):
        table = self.trace_laboratory()
        swing = trajectory.read_table(table)
        time, x, y = trajectory.lift_off(swing)
        self.assertAlmostEqual(time, 0.2532914651, places=9)
        self.assertAlmostEqual(y, -0.831, places=3)
        for line in self.figure(table).axes[1].get_lines():
            if line.get_label() == "trough":
                np.testing.assert_allclose(line.get_xdata(), (x, swing.rows["x3"][0]))
                np.testing.assert_allclose(line.get_ydata(), -0.831)

    def test_the_counterweight_hangs_from_the_end_of_its_arm(self):
        table = self.trace_laboratory()
        rows = trajectory.read_table(table).rows
        lines = [np.round(np.transpose(line.get_data()), 9).tolist()
                 for line in self.figure(table).axes[1].get_lines()]
        first = {name: [round(rows[axis + name][0], 9) for axis in "xy"] for name in "h1t3"}
        for ends in (("h", "1"), ("h", "t"), ("t", "3")):
            self.assertIn([first[name] for name in ends], lines)

    def test_without_a_release_there_is_no_flight(self):
        options = ("--solver.max-time", "0.2", "--solver.release", "crossing")
        table = self.trace_laboratory(*options)
        flight = self.trace_laboratory(*options, "--flight", name="flight.txt")
        self.assertFalse(self.labels(table, flight) & {"flight", "impact"})
        table = self.trace()
        flight = self.trace("--flight", name="flight.txt")
        self.assertTrue(self.labels(table, flight) >= {"flight", "impact"})

    def test_the_flight_after_another_swing_is_refused(self):
        self.trace()
        self.trace_laboratory("--flight", name="flight.txt")
        self.run_script("trajectory.py", "table.txt", "--flight", "flight.txt", code=1,
                        says="flight.txt: is the flight after another swing")
        self.run_script("trajectory.py", "table.txt", "--flight", "table.txt", code=1,
                        says="table.txt: is the flight after another swing")
        self.run_script("trajectory.py", "flight.txt", code=1, says="flight.txt: has no column phi1")
        self.run_script("trajectory.py", "table.txt", "--flight", "flight.txt", "-o", "flight.txt",
                        code=2, says="must")

    def test_the_flight_has_the_range_of_the_sweep(self):
        laboratory = self.write("laboratory.cfg", LABORATORY)
        air = ("--scene.projectile-diameter", "0.07", "--scene.wind", "-3")
        for job, design, *options in (
                ("jobs/scenes/paper.cfg", DESIGN, "--solver.stepper", "dopri5"),
                ("jobs/scenes/elastic_sling.cfg", DESIGN, "--solver.stepper", "dopri5"),
                (laboratory, LABORATORY_DESIGN), (laboratory, LABORATORY_DESIGN, *air)):
            with self.subTest(job=job, options=options):
                path = self.trace("--flight", *options, job=job, design=design)
                rows = trajectory.read_rows(path, trajectory.FLIGHT_COLUMNS).rows
                lattice = [word.replace("--", "--lattice.") for word in design]
                subprocess.run([PROGRAM, "sweep", os.path.join(REPOSITORY, job), *options, *lattice,
                                "--output.fields", "range, apex", "--output.file", self.path("r.h5"),
                                "--overwrite"], check=True, capture_output=True, timeout=120)
                with h5py.File(self.path("r.h5")) as file:
                    self.assertAlmostEqual(rows["x3"][-1], file["range"][0, 0, 0], places=6)
                    self.assertAlmostEqual(np.ptp(rows["y3"]), file["apex"][0, 0, 0], places=3)


class Neighbourhoods(ScriptTest):
    """The picture of the paper's machine with a weaker beam and a longest counterweight's arm, and others."""

    JOB = f"{JOBS}/accurate.cfg"
    WEAK = ("--optimum.subject-to", "peak-beam-stress <= 6e7, least-sling-tension >= 0",
            "--optimum.deviation", "0.01", "--lattice.r1", "0.52:1:0.01")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.optimum = cls.find(cls.JOB, *cls.WEAK)
        cls.archives = neighbourhood.sweep_panels(PROGRAM, cls.optimum)

    @staticmethod
    def find(job, *options):
        done = subprocess.run([PROGRAM, "optimum", job, "--json", *options], check=True,
                              capture_output=True, text=True, timeout=120)
        return neighbourhood.read_optimum(json.loads(done.stdout))

    def figure(self, optimum=None, archives=None):
        """The figure of an optimum, by default that of the weaker beam."""
        optimum = optimum or self.optimum
        figure = neighbourhood.draw("job", optimum, archives or neighbourhood.sweep_panels(PROGRAM, optimum))
        self.addCleanup(plt.close, figure)
        return figure

    def panels(self):
        """(name, {label: artist}) of each panel of the weaker beam."""
        for name, axes in zip(neighbourhood.PANELS, self.figure(archives=self.archives).axes):
            handles, labels = axes.get_legend_handles_labels()
            yield name, dict(zip(labels, handles))

    def swing(self, name, value):
        """The rows of the swing of the optimum with another value of a length."""
        lengths = {axis: length.value for axis, length in self.optimum.lengths.items()} | {name: value}
        design = [word for axis in AXES for word in (f"--{axis}", repr(float(lengths[axis])))]
        return trajectory.read_table(self.trace("--solver.tolerance", "1e-12", "--interval", "0.0005",
                                                design=design)).rows

    def box(self, count):
        """The speeds of `count` values per length within the deviation of the optimum."""
        d = self.optimum.deviation
        axes = [word for name, length in self.optimum.lengths.items()
                for word in (f"--lattice.{name}", f"{length.value - d!r}:{length.value + d!r}:"
                                                  f"{2 * d / (count - 1)!r}")]
        with h5py.File(self.sweep("accurate", *axes, name=f"box{count}")) as file:
            self.assertEqual(file["speed"].shape, (count,) * 3)
            return file["speed"][...]

    def test_the_curves_pass_through_traced_designs_and_the_optimum(self):
        for name, drawn in self.panels():
            x, speed = drawn["speed of the designs"].get_data()
            for i in (20, 100, 180):
                self.assertAlmostEqual(speed[i], self.swing(name, x[i])["speed"][-1], places=6)
            star = next(line for label, line in drawn.items() if label.startswith("optimum: "))
            self.assertEqual(float(star.get_xdata()), self.optimum.lengths[name].value)
            speed = self.swing(name, float(star.get_xdata()))["speed"][-1]
            self.assertAlmostEqual(float(star.get_ydata()), speed, places=8)

    def test_the_marks_are_where_1_percent_is_lost_within_the_limits(self):
        marks = {}
        for name, drawn in self.panels():
            least = drawn["1 % less than the optimum"].get_ydata()[0]
            self.assertAlmostEqual(least, 0.99 * self.optimum.value, places=12)
            marks[name] = drawn["where 1 % is lost"].get_xdata() if "where 1 % is lost" in drawn else []
            for x in marks[name]:
                swing = self.swing(name, x)
                self.assertAlmostEqual(swing["speed"][-1], least, places=5)
                self.assertLess(swing["stress"].max(), 6e7 * (1 + 1e-6))
        # Shorter, only the bound of r1 comes before the loss; longer, the stress does.
        self.assertEqual({name: len(x) for name, x in marks.items()}, {"r1": 0, "r2": 1, "r3": 1})

    def test_a_mark_beyond_a_bound_is_not_drawn(self):
        for name, least, most in (("r1", 0.501, 0.515), ("r2", 0.511, 0.913)):
            optimum = self.find(self.JOB, f"--lattice.{name}", f"{least}:{most}:0.002")
            length = optimum.lengths[name]
            self.assertEqual(length.longer_limit, f"{name} <= {most}")
            self.assertAlmostEqual(length.longer, most - length.value, places=9)
            self.assertIsNone(length.shorter_limit)
            axes = self.figure(optimum).axes[neighbourhood.PANELS.index(name)]
            mark = next(line for line in axes.get_lines() if line.get_label() == "where 1 % is lost")
            np.testing.assert_allclose(mark.get_xdata(), [length.value - length.shorter])
            self.assertIn(f" mm shorter\nor {round(1000 * length.longer, 4):.3g} mm longer ({name} <= {most} m)",
                          axes.get_title())

    def test_the_region_in_which_the_beam_is_overloaded_is_shaded(self):
        shaded = {}
        for name, drawn in self.panels():
            for label, artist in drawn.items():
                if ">" in label or "<" in label:
                    shaded.setdefault(label, {})[name] = artist.get_paths()
        self.assertEqual(set(shaded), {"peak-beam-stress > 60 MPa"})
        regions = shaded["peak-beam-stress > 60 MPa"]
        self.assertEqual(set(regions), set(AXES))
        for name, (path,) in regions.items():
            axis, ends = self.archives[name].axes[name], path.vertices[:, 0]
            self.assertAlmostEqual(ends.min(), self.optimum.lengths[name].value, places=5)  # it is active
            self.assertGreater(self.swing(name, ends.mean())["stress"].max(), 6e7)
            for end in {ends.min(), ends.max()} - {axis[-1]}:
                self.assertAlmostEqual(self.swing(name, end)["stress"].max() / 6e7, 1, places=4)

    def test_a_region_ends_where_its_field_crosses_the_limit(self):
        x, y = neighbourhood.with_zeros(np.arange(6.0), np.array([-1, 3, np.nan, 2, -2, 0]))
        np.testing.assert_array_equal(x, [0, 0.25, 1, 2, 3, 3.5, 4, 5])
        np.testing.assert_array_equal(y, [-1, 0, 3, np.nan, 2, 0, -2, 0])

    def test_the_worst_and_the_expected_value_are_those_of_a_box_of_designs(self):
        weights = np.array([1, 4, 2, 4, 2, 4, 2, 4, 1]) / 24  # Simpson's rule
        speeds = self.box(9)
        expected = np.einsum("ijk,i,j,k", speeds, weights, weights, weights)
        for name, drawn in self.panels():
            lines = {label.split()[0]: line for label, line in drawn.items() if "off by up to" in label}
            self.assertAlmostEqual(lines["worst"].get_ydata()[0], speeds.min(), places=6)
            self.assertAlmostEqual(lines["expected"].get_ydata()[0], expected, places=4)
            band = drawn["deviation of up to 10 mm"].get_xy()[:, 0]
            centre = self.optimum.lengths[name].value
            np.testing.assert_allclose([band.min(), band.max()], [centre - 0.01, centre + 0.01])

    def test_a_deviation_with_designs_without_a_release_has_no_worst_value(self):
        optimum = self.find(self.JOB, "--optimum.deviation", "0.02")
        self.assertGreater(optimum.lengths["r1"].value, 0.52)  # so that all these designs have a release
        optimum = optimum._replace(worst=None, expected=None)
        labels = self.figure(optimum).axes[0].get_legend_handles_labels()[1]
        self.assertIn("deviation of up to 20 mm, with designs that have no release", labels)
        self.assertFalse([label for label in labels if "worst" in label or "expected" in label])

    def test_designs_without_a_release_are_a_gap(self):
        axes = self.figure(self.find(self.JOB)).axes[0]
        line = next(line for line in axes.get_lines() if line.get_label() == "speed of the designs")
        np.testing.assert_array_equal(np.isnan(line.get_ydata()), line.get_xdata() <= 0.5)  # h - h0
        self.assertTrue(np.isnan(line.get_ydata()).any())

    def test_the_panels_hold_the_deviation_and_little_beyond_the_bounds(self):
        for name, archive in self.archives.items():
            length, (first, last) = self.optimum.lengths[name], archive.axes[name][[0, -1]]
            self.assertLess(first, length.value - 0.01)
            self.assertGreater(last, length.value + 0.01)
            self.assertLess(last, length.bounds[1] + 0.1 * (last - first))
            self.assertAlmostEqual(len(archive.axes[name]), 200, delta=10)

    def test_the_bounds_are_those_of_the_lattice(self):
        bounds = {name: length.bounds for name, length in self.optimum.lengths.items()}
        r2, r3 = (self.optimum.lengths[name].value for name in ("r2", "r3"))
        for name, low, high in (("r1", 0.52, 1), ("r2", 0, 1.5 - r3), ("r3", 0.3, 1.5 - r2)):
            np.testing.assert_allclose(bounds[name], (low, high), atol=1e-9)
        lines = {name: drawn.get("bound of the lattice") for name, drawn in self.panels()}
        self.assertEqual(lines["r1"].get_xdata()[0], 1)

    def test_titles_and_labels_name_the_values_with_their_units(self):
        figure = self.figure(archives=self.archives)
        self.assertEqual(figure._suptitle.get_text().replace("\n", " "),
                         f"job: neighbourhood of the optimum, speed {self.optimum.value:.6g} m/s, "
                         "subject to peak-beam-stress <= 60 MPa, least-sling-tension >= 0 N")
        for name, axes in zip(neighbourhood.PANELS, figure.axes):
            length = self.optimum.lengths[name]
            bound = " (r1 >= 0.52 m)" if name == "r1" else ""
            self.assertEqual(axes.get_title().split("\n"), [
                f"{name} = {length.value:.7f} m", f"within 1 %: {round(1000 * length.shorter, 4):.3g} mm shorter{bound}",
                "or 0 mm longer (peak-beam-stress <= 60 MPa)"])
            self.assertTrue(axes.get_xlabel().endswith(f" {name} (m)"))
        self.assertEqual(figure.axes[0].get_ylabel(), "speed of the projectile at release (m/s)")

    def test_a_fixed_length_is_drawn_around_its_value_and_without_bounds(self):
        optimum = self.find(self.JOB, "--lattice.r2", "0.9", "--optimum.objective", "kinetic-energy",
                            "--output.optimum", "taut")
        axes = self.figure(optimum).axes[1]
        self.assertTrue(axes.get_title().startswith("r2 = 0.9000000 m (fixed)\n"))
        self.assertLess(axes.get_xlim()[0], 0.89)
        self.assertGreater(axes.get_xlim()[1], 0.91)
        self.assertNotIn("bound of the lattice", axes.get_legend_handles_labels()[1])
        self.assertIn(f"kinetic-energy {optimum.value / 1000:.6g} kJ, subject to least-sling-tension >= 0 N",
                      axes.figure._suptitle.get_text().replace("\n", " "))

    def test_designs_are_integrated_accurately_whatever_the_jobs_stepper(self):
        job = self.write("euler.cfg", "[solver]\nstepper = euler\ntime-step = 0.02\nrelease = window\n"
                                      "release-window = 0.1\n")
        archives = neighbourhood.sweep_panels(PROGRAM, self.find(job))
        accurate = neighbourhood.sweep_panels(PROGRAM, self.find(self.JOB))
        for name in neighbourhood.PANELS:
            np.testing.assert_allclose(archives[name].read("speed"), accurate[name].read("speed"), rtol=1e-8)

    def test_neighbourhoods_are_drawn_in_every_format_and_nothing_is_cut(self):
        laboratory = self.write("laboratory.cfg", LABORATORY)
        long = self.write("a_long_name_of_a_job_" * 8 + ".cfg", "")
        for job, *options in ((laboratory, "--optimum.objective", "range"),
                              (long, *self.WEAK), (self.JOB, "--lattice.r1", "0.55")):
            self.run_script("neighbourhood.py", job, "-o", "n.png", "--program", PROGRAM, "--", *options)
            self.assert_nothing_is_cut("n.png")
        self.run_script("neighbourhood.py", laboratory, "--program", PROGRAM)
        self.assert_picture("laboratory-neighbourhood.png")
        for suffix in SIGNATURES:
            self.run_script("neighbourhood.py", self.JOB, "-o", f"n.{suffix}", "--program", PROGRAM)
            self.assert_picture(f"n.{suffix}")

    def test_failures_are_reported_on_one_line(self):
        self.write("job", "[scene]\n")
        for arguments, code, words in (
                ([], 2, "the following arguments are required: JOB"),
                (["missing.cfg"], 2, "missing.cfg: No such file"),
                (["job", "-o", "job"], 2, "output = job: must not be an input file"),
                (["job", "-o", "n.xyz"], 2, "output = n.xyz: must end"),
                (["job", "--lattice.r1", "1"], 2, "--lattice.r1"),
                (["job", "--", "--optimum.objective", "mass"], 2, "optimum.objective = mass: must be"),
                (["job", "--", "--fast"], 2, "--fast: unknown option"),
                (["job", "--", "--optimum.subject-to", "peak-axle-load <= 1"], 1, "exclude every design"),
                (["job", "--program", "no/such/program"], 1, "no/such/program: cannot be started"),
                (["job", "--program", "false"], 1, "false: optimum failed with exit code 1"),
                (["job", "--program", "true"], 1, "true: printed no optimum")):
            with self.subTest(arguments=arguments):
                program = [] if "--program" in arguments else ["--program", PROGRAM]
                self.run_script("neighbourhood.py", *program, *arguments, code=code, says=words)
        self.assertEqual(self.read("job"), b"[scene]\n")


class Machine(ScriptTest):
    def assert_traced(self, sketch, *options, design):
        """The three moments are those of a traced swing."""
        rows = trajectory.read_table(self.trace("--interval", "0.02", *options, design=design)).rows
        last = len(rows["t"]) - 1
        middle = int(np.argmin(np.abs(rows["phi1"] - sketch.middle[0])))
        hinge = "h" if sketch.r4 else "1"
        for angles, i in ((sketch.start, 0), (sketch.middle, middle), (sketch.release, last)):
            for angle, name in zip(angles, ("phi1", "phi2", "phi3") if sketch.r4 else ("phi1", "phi2")):
                self.assertAlmostEqual(angle, rows[name][i], places=6)
            for point, body in zip(machine.positions(sketch, angles), ("1", hinge, "t", "3")):
                np.testing.assert_allclose(point, (rows[f"x{body}"][i], rows[f"y{body}"][i]), atol=1e-6)

    def test_the_sketches_show_three_moments_of_a_traced_swing(self):
        design = [word for name in ("r1", "r2", "r3")
                  for word in (f"--{name}", str(getattr(machine.PAPER, name)))]
        self.assert_traced(machine.PAPER, design=design)
        self.assert_traced(machine.BUILT, design=machine.BUILT_OPTIONS.split())

    def test_labels_of_the_sketches_overlap_neither_lines_nor_each_other(self):
        for built in (False, True):
            with self.subTest(built=built):
                self.assert_labels_are_free(machine.draw(built))

    def assert_labels_are_free(self, figure):
        """The labels of a sketch, except for turned ones, overlap neither lines nor each other."""
        self.addCleanup(plt.close, figure)
        figure.canvas.draw()
        axes = figure.axes[0]
        boxes = [text.get_window_extent() for text in axes.texts
                 if text.get_text() and not text.get_rotation() % 90]
        self.assertGreater(len(boxes), 10)
        for i, box in enumerate(boxes):
            self.assertEqual([other for other in boxes[i + 1:] if box.overlaps(other)], [])
            for line in axes.lines:
                path = line.get_transform().transform_path(line.get_path())
                self.assertFalse(path.intersects_bbox(box, filled=False), (box, line))

    def test_the_sketch_is_drawn_in_every_format(self):
        for name, options in (("machine.svg", ()), ("built.svg", ("--built",))):
            self.run_script("machine.py", *options)
            self.assert_picture(name)
        for suffix in SIGNATURES:
            self.run_script("machine.py", "-o", f"sketch.{suffix}")
            self.assert_picture(f"sketch.{suffix}")
        self.assert_nothing_is_cut("sketch.png")
        self.run_script("machine.py", "-o", "sketch.xyz", code=2, says="output = sketch.xyz: must end")


def best_of(speed, file):
    """{column: value} of the fastest design of a map; NaN without one."""
    if np.isnan(speed).all():
        return {f"best_{name}": np.nan for name in OPTIMUM}
    index = np.unravel_index(np.nanargmax(speed), speed.shape)
    return {"best_value": speed[index], **{f"best_{name}": file[name][i] for name, i in zip(AXES, index)}}


class PartialArchives(ScriptTest):
    """Snapshots of unfinished sweeps, with any values in the cells of the tiles that are not done, and unfinished
    sweeps themselves, the folders FILE.partial."""

    FIELDS = ("--output.fields", "speed, status, speed-error")
    OPTIONS = {"complete.h5": FIELDS, "by_hand.h5": (*FIELDS, "--lattice.r2", "0.1:1.2:0.02")}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name, options in cls.OPTIONS.items():
            cls.sweep("paper", *options, name=name.removesuffix(".h5"), increment="0.02")

    def stop_after(self, source, folder, done):
        """Makes the folder of an unfinished sweep with the first `done` tiles."""
        shutil.rmtree(self.path(folder), ignore_errors=True)
        for _ in range(done):  # each run computes at least one tile
            self.run_program("sweep", f"{JOBS}/paper.cfg", "--lattice.increment", "0.02", *self.OPTIONS[source],
                             "--output.file", folder.removesuffix(".partial"), "--time-limit", "1e-9", code=75)

    def make_partial(self, source, name, done, junk):
        """Makes a snapshot, or an unfinished sweep, in which the first `done` tiles are done; returns the others and the
        message."""
        snapshot = name
        if name.endswith(".partial"):
            self.stop_after(source, name, done)
            snapshot = "snapshot.h5"
        shutil.copy(self.path(source), self.path(snapshot))
        with h5py.File(self.path(snapshot), "r+") as file:
            all_tiles = list(tiles(file))
            for tile in all_tiles[done:]:
                file["speed"][tile] = junk
                file["speed_error"][tile] = junk
                file["status"][tile] = 0
            file["tile_designs"][done:] = 0
            speed = np.full(file["speed"].shape, np.nan)
            for tile in all_tiles[:done]:
                speed[tile] = file["speed"][tile]
            for column, value in best_of(speed, file).items():
                file.attrs[column] = value
        return all_tiles[done:], f"{name}: unfinished: {done} of {len(all_tiles)} tiles done; " \
                             "the rest is left blank\n"

    def test_tiles_that_are_not_done_read_as_blank(self):
        for source in ("complete.h5", "by_hand.h5"):
            for name, numbers in (("q.h5", (0, 5)), ("r.h5.partial", (2,))):
                for done in numbers:
                    undone, message = self.make_partial(source, name, done, junk=99)
                    with h5py.File(self.path(source)) as file:
                        speed, status = file["speed"][...], file["status"][...]
                    for tile in undone:
                        speed[tile], status[tile] = np.nan, 0
                    with open(self.path("stderr"), "w+", encoding="utf-8") as stderr, \
                            contextlib.redirect_stderr(stderr):
                        archive = Archive(self.path(name))
                        stderr.seek(0)
                        self.assertTrue(stderr.read().endswith(message))
                    # Without the last values of r3, at which there is no design.
                    where = (slice(None), slice(archive.shape[1]), slice(None))
                    np.testing.assert_array_equal(archive.read("speed"), speed[where])
                    np.testing.assert_array_equal(archive.read("status"), status[where])
                    where = (3, *where[1:])
                    np.testing.assert_array_equal(archive.read("speed", where), speed[where])
                    archive.file.close()

    def test_the_optimum_is_the_fastest_design_in_the_tiles_done(self):
        for junk in (99,):
            undone, message = self.make_partial("complete.h5", "r.h5.partial", 3, junk)
            with h5py.File(self.path("complete.h5")) as file:
                speed = file["speed"][...]
                for tile in undone:
                    speed[tile] = np.nan
                best = {name: file[name][i] for name, i in
                        zip(AXES, np.unravel_index(np.nanargmax(speed), speed.shape))}
            done = self.run_script("optimum.py", "r.h5.partial", says=message)
            self.assertEqual(done.stdout.split(),
                             [word for name in AXES for word in (f"--{name}", repr(float(best[name])))])
        _, message = self.make_partial("complete.h5", "q.h5", 0, 0)
        done = self.run_command(sys.executable, f"{ANALYSIS}/optimum.py", "q.h5")
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr, message + "q.h5: has no optimum: nothing released yet\n")

    def test_the_name_of_the_complete_archive_finds_the_partial_one(self):
        _, message = self.make_partial("complete.h5", "soon.h5.partial", 5, junk=0)
        self.make_partial("complete.h5", "elsewhere.h5.partial", 5, junk=0)
        os.symlink("elsewhere.h5", self.path("link.h5"))
        self.run_script("heatmap.py", "soon.h5", says=message)
        self.assert_picture("soon-speed.png")
        self.run_script("compare.py", "soon.h5", "complete.h5", says=message)
        self.assert_picture("soon-complete.png")
        self.assertEqual(self.run_script("optimum.py", "soon.h5", says=message).stdout,
                         self.run_script("optimum.py", "link.h5", says="elsewhere.h5.partial: unfinished").stdout)
        before = sorted(os.listdir(self.path("soon.h5.partial")))
        for name in ("soon.h5", "soon.h5.partial"):
            self.run_script("optimum.py", "soon.h5", "--job", name, code=2,
                            says=f"job = {name}: must not be an input file")
        self.assertFalse(os.path.exists(self.path("soon.h5")))
        self.assertEqual(sorted(os.listdir(self.path("soon.h5.partial"))), before)
        self.run_script("heatmap.py", "never.h5", code=1, says="never.h5: no such file")

    def test_every_script_reports_an_unfinished_sweep_once(self):
        subprocess.run([PROGRAM, "assess", f"{JOBS}/paper.cfg", "--assess.scenes",
                        f"{JOBS}/scenes/paper.cfg", "--assess.steppers", "euler",
                        "--assess.time-steps", "0.01", "--assess.repeats", "1",
                        "--assess.designs", "1", "--output.file", self.path("assess.h5")],
                       check=True, capture_output=True, timeout=120)
        for name in ("q.h5", "r.h5.partial"):
            undone, message = self.make_partial("complete.h5", name, 5, junk=0)
            for script, *arguments in (("heatmap.py", name), ("heatmap.py", name, "--field", "status"),
                                       ("compare.py", name, "complete.h5"),
                                       ("loads.py", name, "--count", "1", "--program", PROGRAM)):
                with self.subTest(script=script):
                    done = self.run_script(script, *arguments, "-o", "q.png", says=message)
                    self.assert_picture("q.png")
                    if script == "compare.py":
                        with h5py.File(self.path("complete.h5")) as file:
                            missing = sum(np.isfinite(file["speed"][tile]).sum() for tile in undone)
                            designs = np.isfinite(file["speed"][...]).sum()
                        self.assertIn(f"{designs - missing} with a speed in both, {missing} in one",
                                      done.stdout)
            self.run_script("assess.py", "assess.h5", "--maps", name, says=message)


class StudyTest(ScriptTest):
    """Tests with the archives study.h5, of scenes whose lattices differ, and alone<i>.h5, of each of these
    scenes; of many masses, refined and without maps, masses.h5; and one of three outer axes, three.h5."""

    MASSES = (50.0, 100.0)
    HEIGHTS = (1.5, 1.92, 2.5)  # with r1 = 1.12, ... m, r1 = 0.7, ... m and r1 = 0.12, ... m
    RELEASE = ("--scene.release-height", "2.57")
    MANY_MASSES = (20, 50, 100, 200, 500, 1000)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", *cls.RELEASE, "--scene.projectile-mass", "50:100:50",
                  "--scene.fulcrum-height", "1.92, 1.5, 2.5", name="study")
        for i, (mass, height) in enumerate(cls.scenes()):
            cls.sweep("accurate", *cls.RELEASE, "--scene.projectile-mass", str(mass), "--scene.fulcrum-height",
                      str(height), name=f"alone{i}")
        cls.sweep("accurate", "--scene.projectile-mass", ", ".join(map(str, cls.MANY_MASSES)),
                  "--output.maps", "none", "--optimum.refine", "yes", name="masses")
        cls.sweep("accurate", "--scene.projectile-mass", "50, 100", "--scene.counterweight-mass", "2000, 4000",
                  "--scene.fulcrum-height", "1.5, 1.6", "--output.maps", "none", name="three", increment="0.1")

    @classmethod
    def scenes(cls):
        return [(mass, height) for mass in cls.MASSES for height in cls.HEIGHTS]

    @staticmethod
    def at(mass, height):
        """A scene of study.h5, as Archive.scene() takes it."""
        return [("projectile-mass", mass), ("fulcrum-height", height)]

    @staticmethod
    def words(at):
        """The same as options."""
        return [word for key, value in at for word in ("--at", f"{key}={value:g}")]

    def figure(self, archive, names=study.DEFAULT):
        """The figure that study.py draws."""
        figure = study.picture(archive, list(names))
        self.addCleanup(plt.close, figure)
        return figure

    def tiles(self):
        """(scene, slices) of each tile of study.h5."""
        with h5py.File(self.path("study.h5")) as file:
            yield from zip(file["tile_block"][:, 0].astype(int).tolist(), tiles(file))

    def make_partial(self, done, junk=99):
        """Copies study.h5 as partial.h5 with only the first `done` tiles done, and `junk` in the others."""
        shutil.copy(self.path("study.h5"), self.path("partial.h5"))
        all_tiles = list(self.tiles())
        with h5py.File(self.path("partial.h5"), "r+") as file:
            for i, tile in all_tiles[done:]:
                file["speed"][tile], file["status"][tile] = junk, 1
            file["tile_designs"][done:] = 0
            for scene in {i for i, _ in all_tiles[done:]}:
                speed = np.full(file["speed"].shape[2:], np.nan)
                for _, tile in (one for one in all_tiles[:done] if one[0] == scene):
                    speed[tile[2:]] = file["speed"][tile]
                for column, value in best_of(speed, file).items():
                    file[column][np.unravel_index(scene, (2, 3))] = value
        return all_tiles

    def open_quietly(self, name):
        with contextlib.redirect_stderr(io.StringIO()):
            return Archive(self.path(name)).select([])


class ScenesOfStudies(StudyTest):
    def test_a_scene_reads_as_its_own_archive(self):
        with h5py.File(self.path("study.h5")) as file:  # else this test shows little
            self.assertTrue(set(np.diff(file["r1"][...]).round(3)) >= {0.02, 0.03})
        for i, scene in enumerate(self.scenes()):
            with self.subTest(scene=scene):
                one = Archive(self.path("study.h5")).scene(self.at(*scene))
                alone = Archive(self.path(f"alone{i}.h5"))
                for name in AXES:
                    np.testing.assert_array_equal(one.axes[name], alone.axes[name])
                self.assertEqual(one.fields, alone.fields)
                for field in one.fields:
                    for where in ((slice(None),) * 3, (3, slice(None), 5), (slice(2, 4), 1, slice(None)),
                                  (0, 0, 0)):
                        np.testing.assert_array_equal(one.read(field, where), alone.read(field, where))
                self.assertEqual(one.optimum(), alone.optimum())
                self.assertEqual(one.best_text(), alone.best_text())
                self.assertEqual(one.extreme("release_time", False), alone.extreme("release_time", False))
                self.assertEqual({**one.job, ("output", "file"): ""}, {**alone.job, ("output", "file"): ""})
                self.assertEqual(parse_job(one.attributes["job"]), one.job)

    def test_scenes_with_explicit_axes_read_as_their_own_archives(self):
        for i, (axis, values) in enumerate((("r2", "0.1:0.8:0.1"), ("r1", "0.6:1.2:0.1"), ("r3", "0.3:1.3:0.1"))):
            lattice = (f"--lattice.{axis}", values, *self.RELEASE, "--scene.fulcrum-height")
            path = self.sweep("accurate", *lattice, "1.5, 2.13", name=f"explicit{i}", increment="0.1")
            for height in (1.5, 2.13):
                one = Archive(path).scene([("fulcrum-height", height)])
                alone = Archive(self.sweep("accurate", *lattice, str(height), name=f"explicit{i}_{height}",
                                           increment="0.1"))
                for name in AXES:
                    np.testing.assert_array_equal(one.axes[name], alone.axes[name])
                np.testing.assert_array_equal(one.read("speed"), alone.read("speed"))

    def test_a_heatmap_of_a_scene_is_that_of_its_own_archive(self):
        for i, scene in enumerate(self.scenes()):
            figures = [heatmap.picture(archive, "speed", {}) for archive in (
                Archive(self.path("study.h5")).scene(self.at(*scene)), Archive(self.path(f"alone{i}.h5")))]
            drawn = [[(np.asarray(mesh.get_array()).ravel(), mesh.get_coordinates().ravel(), mesh.get_clim())
                      for axes in figure.axes[:3] for mesh in axes.collections[:1]] for figure in figures]
            self.assertEqual(len(drawn[0]), 3)
            for one, alone in zip(*drawn):
                for a, b in zip(one, alone):
                    np.testing.assert_array_equal(a, b)
            titles = [figure._suptitle.get_text().split(": ", 1) for figure in figures]
            self.assertEqual(titles[0][0], f"study, projectile-mass = {scene[0]:g} kg, fulcrum-height = "
                                           f"{scene[1]:g} m")
            self.assertEqual(titles[0][1], titles[1][1])
            for figure in figures:
                plt.close(figure)

    def test_every_script_takes_a_scene(self):
        at = self.words(self.at(100, 1.92))
        self.run_script("heatmap.py", "study.h5", *at)
        self.assert_nothing_is_cut("study-projectile-mass=100-fulcrum-height=1.92-speed.png")
        self.run_script("loads.py", "study.h5", *at, "--count", "1", "--program", PROGRAM)
        self.assert_picture("study-projectile-mass=100-fulcrum-height=1.92-loads.png")
        done = self.run_script("compare.py", "study.h5", "alone4.h5", *at, "-o", "c.png")
        self.assertIn("largest 0 m/s", done.stdout)
        done = self.run_script("compare.py", "alone4.h5", "study.h5", *at, "-o", "c.png")
        self.assertIn("largest 0 m/s", done.stdout)
        other = [word.replace("--at", "--at-b") for word in self.words(self.at(50, 1.92))]
        done = self.run_script("compare.py", "study.h5", "study.h5", *at, *other, "-o", "c.png")
        same = self.run_script("compare.py", "alone4.h5", "alone1.h5", "-o", "c.png")
        self.assertEqual(done.stdout.splitlines()[2:], same.stdout.splitlines()[2:])
        short = self.run_script("compare.py", "study.h5", "study.h5", *at, "--at-b", "projectile-mass=50",
                                "-o", "c.png")
        self.assertEqual(short.stdout, done.stdout)
        names = [line.split(": ")[0] for line in done.stdout.splitlines()[:2]]
        self.assertEqual(names, [f"{letter}         study.h5, projectile-mass = {mass} kg, fulcrum-height = 1.92 m"
                                 for letter, mass in (("A", 100), ("B", 50))])
        for options in ((), ("--continuous", "--program", PROGRAM)):
            one = self.run_script("optimum.py", "study.h5", *at, "--job", "one.cfg", "--overwrite", *options).stdout
            self.assertEqual(one, self.run_script("optimum.py", "alone4.h5", *options).stdout)
        self.run_script("optimum.py", "study.h5", *at, "--job", "one.cfg", "--overwrite")
        self.run_program("sweep", "one.cfg", "--output.file", "again.h5", "--overwrite")
        with h5py.File(self.path("again.h5")) as again, h5py.File(self.path("alone4.h5")) as alone:
            np.testing.assert_array_equal(again["speed"], alone["speed"])

    def test_scenes_of_different_lattices_are_compared_where_both_have_designs(self):
        path = self.sweep("accurate", "--scene.counterweight-hanger", "0, 0.1, 0.42", name="hangers")
        with h5py.File(path) as file:
            speed, hold = file["speed"][...], file["status"][...] > 0
        both = hold[0] & hold[1]
        self.assertTrue(both.sum() < max(hold[0].sum(), hold[1].sum()))
        difference = np.abs(speed[0] - speed[1])[both & np.isfinite(speed[0]) & np.isfinite(speed[1])]
        at = [word for i in (0, 1) for word in (("--at", "--at-b")[i], f"counterweight-hanger={(0, 0.1)[i]}")]
        done = self.run_script("compare.py", "hangers.h5", "hangers.h5", *at, "-o", "c.png")
        lines = done.stdout.splitlines()
        self.assertEqual(lines[2], f"lattices  {both.sum()} designs in common, of {hold[0].sum()} of A and "
                                   f"{hold[1].sum()} of B")
        only = (both & (np.isfinite(speed[0]) != np.isfinite(speed[1]))).sum()
        self.assertEqual(lines[3], f"designs   {difference.size} with a speed in both, {only} in one of them only")
        self.assertIn(f"median {np.median(difference):.6g}, ", lines[4])
        self.assertIn(f"largest {difference.max():.6g} m/s", lines[4])
        self.assert_nothing_is_cut("c.png")
        none = ("study.h5", "study.h5", *self.words(self.at(50, 1.5)), "--at-b", "fulcrum-height=1.92")
        self.run_script("compare.py", *none, code=1,
                        says="study.h5, projectile-mass = 50 kg, fulcrum-height = 1.5 m and study.h5, "
                             "projectile-mass = 50 kg, fulcrum-height = 1.92 m have no design in common")

    def test_the_star_of_a_comparison_is_an_optimum_that_both_scenes_could_have(self):
        a, b = (Archive(self.path(f"alone{i}.h5")) for i in (0, 1))
        self.assertEqual(compare.optimum_within(b), b.optimum()[0])
        far = [np.arange(2), np.arange(2), np.arange(2)]
        self.assertIsNone(compare.optimum_within(b.restricted(far)))
        self.assertEqual(compare.optimum_within(a.restricted([slice(None)] * 3)), a.optimum()[0])

    def test_a_refined_optimum_of_a_scene_is_that_of_the_continuous_search(self):
        done = self.run_script("optimum.py", "masses.h5", "--at", "projectile-mass=200")
        found = json.loads(self.run_program("optimum", f"{JOBS}/accurate.cfg", "--json", "--lattice.increment",
                                            "0.05", "--scene.projectile-mass", "200").stdout)
        np.testing.assert_allclose([float(word) for word in done.stdout.split()[1::2]],
                                   [found[name] for name in AXES], atol=1e-7)

    def test_a_missing_or_wrong_choice_of_a_scene_is_refused(self):
        both = "study.h5: is a study over projectile-mass (50, 100 kg) and fulcrum-height (1.5, 1.92, 2.5 m); " \
               "choose a scene, such as --at projectile-mass=50 --at fulcrum-height=1.5\n"
        for script in ("heatmap.py", "loads.py", "optimum.py"):
            self.run_script(script, "study.h5", code=2, says=both)
        self.run_script("compare.py", "study.h5", "study.h5", code=2, says=both)
        self.sweep("accurate", "--scene.projectile-mass", "10:100:10", name="ten", increment="0.2")
        for archive, at, words in (
                ("study.h5", ["projectile-mass=50"], "is a study over fulcrum-height (1.5, 1.92, 2.5 m); choose"),
                ("study.h5", ["projectile-mass=60"], "at = projectile-mass=60: must be one of 50, 100 kg\n"),
                ("ten.h5", ["projectile-mass=5"], "must be one of 10, 20, 30, ..., 100 kg\n"),
                ("study.h5", ["mass=60"], "at = mass=60: must name an outer axis of study.h5, each once: "
                                          "projectile-mass, fulcrum-height\n"),
                ("study.h5", ["projectile-mass=50"] * 2, "at = projectile-mass=50: must name an outer axis"),
                ("study.h5", ["projectile-mass"], "--at: projectile-mass: must be KEY=VALUE, VALUE a number"),
                ("study.h5", ["fulcrum-height=x"], "--at: fulcrum-height=x: must be KEY=VALUE, VALUE a number"),
                ("alone0.h5", ["fulcrum-height=1.5"], "at = fulcrum-height=1.5: must be left out: alone0.h5 is "
                                                      "not a study\n")):
            with self.subTest(archive=archive, at=at):
                self.run_script("heatmap.py", archive, *(w for text in at for w in ("--at", text)), code=2,
                                says=words)

    def test_a_missing_or_wrong_choice_of_b_is_refused_with_the_option_of_b(self):
        self.sweep("accurate", "--scene.projectile-mass", "50, 100", name="plain")
        mass, height = ("--at", "projectile-mass=50"), ("--at", "fulcrum-height=1.5")
        for a, b, options, words in (
                ("plain.h5", "study.h5", mass, "study.h5: is a study over fulcrum-height (1.5, 1.92, 2.5 m); choose "
                                               "a scene, such as --at-b fulcrum-height=1.5\n"),
                ("study.h5", "study.h5", (*mass, *height, "--at-b", "fulcrum-height=3"),
                 "at-b = fulcrum-height=3: must be one of 1.5, 1.92, 2.5 m"),
                ("study.h5", "study.h5", (*mass, *height, "--at-b", "mass=3"),
                 "at-b = mass=3: must name an outer axis of study.h5"),
                ("study.h5", "study.h5", (*mass, *height, "--at", "mass=3"),
                 "at = mass=3: must name an outer axis of study.h5"),
                ("alone0.h5", "study.h5", (*mass, *height, "--at", "mass=3"),
                 "at-b = mass=3: must name an outer axis of study.h5"),
                ("study.h5", "alone0.h5", (*mass, *height, "--at-b", "projectile-mass=50"),
                 "at-b = projectile-mass=50: must be left out: alone0.h5 is not a study")):
            with self.subTest(a=a, b=b, options=options):
                self.run_script("compare.py", a, b, *options, code=2, says=words)
        done = self.run_script("compare.py", "study.h5", "plain.h5", *mass, "--at", "fulcrum-height=1.92",
                               "-o", "c.png")  # fulcrum-height is A's alone
        self.assertIn("B         plain.h5, projectile-mass = 50 kg: ", done.stdout)

    def test_an_axis_of_one_value_needs_no_choice(self):
        self.sweep("accurate", "--scene.projectile-mass", "50:50:1", name="one", increment="0.1")
        self.run_script("heatmap.py", "one.h5")

    def test_archives_without_maps_have_an_optimum_and_no_heatmap(self):
        for at in ((), ("--at", "projectile-mass=100")):
            for script, *more in (("heatmap.py",), ("sobol.py",), ("compare.py", "masses.h5")):
                self.run_script(script, "masses.h5", *more, *at, code=1,
                                says="masses.h5: has no maps (output.maps = none)")
            self.run_script("loads.py", "masses.h5", *at, code=1, says="masses.h5: has no map of the speed")

    def test_tiles_that_are_not_done_read_as_blank(self):
        tiles = self.make_partial(0)
        for done in (0, 1, 5, len(tiles) // 2, len(tiles) - 1):
            self.make_partial(done)
            partial = self.open_quietly("partial.h5")
            for number, one in enumerate(partial.each_scene()):
                alone = Archive(self.path(f"alone{number}.h5"))
                with h5py.File(self.path("study.h5")) as file:
                    box, speed = file["speed"].shape[2:], file["speed"][np.unravel_index(number, (2, 3))]
                    places = [np.searchsorted(file[name][...], alone.axes[name]) for name in AXES]
                is_done = np.zeros(box, bool)
                for i, tile in tiles[:done]:
                    if i == number:
                        is_done[tile[2:]] = True
                want = np.where(is_done, speed, np.nan)[np.ix_(*places)]
                np.testing.assert_array_equal(one.read("speed"), want)
                self.assertEqual(one.complete, all(i != number for i, _ in tiles[done:]))
                optimum = one.optimum()
                self.assertEqual(optimum is None, np.isnan(want).all())
                if optimum:
                    index = np.unravel_index(np.nanargmax(want), want.shape)
                    self.assertEqual(optimum, (alone.design(index), np.nanmax(want)))
            partial.file.close()

    def test_a_partial_study_is_reported_once(self):
        tiles = self.make_partial(5)
        numbers = [i for i, _ in tiles]
        at = self.words(self.at(50, 1.5))
        first = numbers.count(0)
        self.assertGreater(first, 0)
        self.make_partial(first)
        text = f"partial.h5: unfinished: {first} of {len(tiles)} tiles done; the rest is left blank\n"
        self.run_script("study.py", "partial.h5", says=text)
        self.run_script("heatmap.py", "partial.h5", *at)
        self.run_script("heatmap.py", "partial.h5", *self.words(self.at(50, 1.92)),
                        says=f"partial.h5: unfinished: 0 of {numbers.count(1)} tiles done")
        self.run_script("sobol.py", "partial.h5", *at)


class Studies(StudyTest):
    def lines(self, figure):
        """{label: (x, y)} of the curves of a figure."""
        return {line.get_label(): line.get_data() for axes in figure.axes for line in axes.get_lines()
                if line.get_marker() != "*"}

    def test_curves_show_the_optimum_of_each_scene(self):
        figure = self.figure(Archive(self.path("masses.h5")))
        lines = self.lines(figure)
        with h5py.File(self.path("masses.h5")) as file:
            best = {name: file[f"best_{name}"][...] for name in ("value", *AXES)}
        want = {**best, "r3/r2": best["r3"] / best["r2"], "r2/r1": best["r2"] / best["r1"],
                "(r2+r3)/h0": (best["r2"] + best["r3"]) / 1.5}
        self.assertEqual(set(lines), set(want))
        for name, (x, y) in lines.items():
            np.testing.assert_array_equal(x, self.MANY_MASSES)
            np.testing.assert_allclose(y, want[name], rtol=1e-14)
        self.assertEqual(len(figure.axes), 5)
        for axes in figure.axes:
            self.assertEqual(axes.get_xscale(), "log")
        self.assertEqual([axes.get_xlabel() for axes in figure.axes],  # in two rows, of three and two
                         ["", "", *["mass m3 of the projectile (kg)"] * 3])
        self.assertEqual([axes.get_ylabel().replace("\n", " ") for axes in figure.axes],
                         ["speed of the optimum (m/s)", "lengths of the optimum (m)", "r3/r2", "r2/r1",
                          "(r2+r3)/h0"])

    def broken(self, **lengths):
        """The intervals in which the curves of masses.h5 with other optimal lengths break, and the title."""
        shutil.copy(self.path("masses.h5"), self.path("jump.h5"))
        with h5py.File(self.path("jump.h5"), "r+") as file:
            for name in AXES:
                file[f"best_{name}"][...] = lengths.get(name, np.full(6, 0.6))
            value = file["best_value"][...]
        archive = Archive(self.path("jump.h5"))
        figure = self.figure(archive)
        archive.file.close()
        gaps = set()
        for x, y in self.lines(figure).values():
            gap = np.flatnonzero(np.isnan(x))
            self.assertTrue(np.isnan(y[gap]).all())
            np.testing.assert_array_equal(np.delete(x, gap), self.MANY_MASSES)  # no scene is lost
            gaps.add(tuple(gap - np.arange(1, len(gap) + 1)))
        np.testing.assert_array_equal(np.delete(self.lines(figure)["value"][1], gap), value)
        self.assertEqual(len(gaps), 1)  # all curves break alike
        return gaps.pop(), figure._suptitle.get_text()

    def test_curves_break_where_the_optimum_jumps(self):
        words = "\ncurves break where the optimum jumps to another local maximum\n"
        for jump, lengths in ((2, {"r1": (0.5, 0.51, 0.52, 0.9, 0.92, 0.93)}),
                              (2, {"r2": (0.74, 0.71, 0.6, 1.05, 1.08, 1.14), "r1": (0.1, 0.1, 0.1, 0.27, 0.4, 0.67)}),
                              (1, {"r3": (0.9, 0.9, 0.3, 0.3, 0.3, 0.3)})):
            gaps, title = self.broken(**lengths)
            self.assertEqual(gaps, (jump,))
            self.assertIn(words, title)
        for lengths in ({"r1": (0.5, 0.5, 0.5, 0.7, 0.9, 1.0)},        # leaves a bound
                        {"r1": (0.5, 0.5, 0.51, 0.53, 0.58, 0.9)},     # ever faster: no interval follows the last
                        {"r1": (0.9, 0.5, 0.5, 0.5, 0.5, 0.5)},        # nor precedes the first
                        {"r1": (0.5, 0.5, 0.5, 0.6, 0.6, 0.6)},        # by two steps of the lattice
                        {"r1": (0.5, 0.5, np.nan, 0.9, 0.9, 0.9)}):    # where a scene has no optimum
            gaps, title = self.broken(**lengths)
            self.assertEqual(gaps, ())
            self.assertNotIn("break", title)

    def test_a_jump_between_local_maxima_of_a_study_is_found(self):
        # Up to 50 kg a short arm is best, from 100 kg on the longest one.
        path = self.sweep("accurate", "--scene.projectile-mass", "10, 20, 50, 100, 200, 500", "--scene.beam-side", "0.2",
                          "--scene.release-height", "1.6", "--optimum.subject-to", "least-sling-tension >= -1",
                          "--optimum.refine", "yes", "--output.maps", "none", name="heavy")
        archive = Archive(path)
        np.testing.assert_array_equal(study.jumps(archive, study.read_quantities(archive)), np.arange(5) == 2)

    def test_the_title_tells_how_the_optimum_was_chosen(self):
        best = "\n\u2605 best of all: speed "
        for options, want in (((), ""), (("--optimum.refine", "yes"), " (continuous)"),
                              (("--optimum.subject-to", "speed >= 1"), ", within the constraints"),
                              (("--optimum.refine", "yes", "--optimum.subject-to", "speed >= 1"),
                               " (continuous), within the constraints"),
                              (("--output.optimum", "taut"), ", with a taut sling")):
            self.sweep("accurate", "--scene.projectile-mass", "50, 100", *options, "--overwrite", name="few",
                       increment="0.2")
            archive = Archive(self.path("few.h5"))
            self.assertIn(f"few: optimum of each scene{want}{best}",
                          self.figure(archive)._suptitle.get_text())
            archive.file.close()

    def test_the_stars_have_the_colours_of_their_curves(self):
        for axes in self.figure(Archive(self.path("masses.h5"))).axes:
            curves, stars = ([line for line in axes.get_lines() if (line.get_marker() == "*") == is_star]
                             for is_star in (False, True))
            self.assertEqual([line.get_color() for line in stars], [line.get_color() for line in curves])
            self.assertEqual(len({line.get_color() for line in stars}), len(curves))
            for curve, star in zip(curves, stars):
                self.assertIn((star.get_xdata(), star.get_ydata()), list(zip(*curve.get_data())))

    def test_few_values_are_the_only_ticks(self):
        panel = self.figure(Archive(self.path("study.h5")), ["value"]).axes[0]
        for axis, values in ((panel.xaxis, self.MASSES), (panel.yaxis, self.HEIGHTS)):
            np.testing.assert_array_equal(axis.get_ticklocs(), values)
            self.assertEqual([text.get_text() for text in axis.get_ticklabels()],
                             [f"{value:g}" for value in values])
            self.assertEqual(len(axis.get_ticklocs(minor=True)), 0)

    def test_labels_have_no_remarks(self):
        for key, values in (("release-height", "1.9, 2"), ("counterweight-hanger", "0, 0.1")):
            self.sweep("accurate", f"--scene.{key}", values, name=key, increment="0.2")
            archive = Archive(self.path(f"{key}.h5"))
            label = study.axis_label(archive, key.replace("-", "_")).replace("\n", " ")
            self.assertRegex(label, r"^(height h|length r4) [^,()]* \(m\)$")

    def test_an_optimum_can_be_found_again_in_the_picture(self):
        lines = self.lines(self.figure(Archive(self.path("masses.h5"))))
        found = json.loads(self.run_program("optimum", f"{JOBS}/accurate.cfg", "--json", "--scene.projectile-mass",
                                            "500").stdout)
        for name in ("value", *AXES):
            self.assertAlmostEqual(lines[name][1][4], found[name], delta=1e-6)

    def test_maps_show_the_optimum_of_each_scene(self):
        archive = Archive(self.path("study.h5"))
        figure = self.figure(archive)
        meshes = figure.axes[:7]  # in rows of four and three; the colour bars follow
        with h5py.File(self.path("study.h5")) as file:
            value, r2, r3 = (file[f"best_{name}"][...] for name in ("value", "r2", "r3"))
        self.assertEqual([bool(axes.get_xlabel()) for axes in meshes], [False] * 3 + [True] * 4)
        self.assertEqual([bool(axes.get_ylabel()) for axes in meshes], [i in (0, 4) for i in range(7)])
        for axes in meshes:
            for ticks, label in ((axes.get_xticklabels(), axes.get_xlabel()),
                                 (axes.get_yticklabels(), axes.get_ylabel())):
                self.assertEqual(len(ticks) > 0, bool(label))
        for panel, want in ((0, value), (4, r3 / r2), (6, (r2 + r3) / np.array(self.HEIGHTS))):
            np.testing.assert_allclose(meshes[panel].collections[0].get_array().reshape(3, 2), want.T)
            star = next(line for line in meshes[panel].get_lines() if line.get_marker() == "*")
            index = np.unravel_index(np.argmax(value), value.shape)
            self.assertEqual((float(np.squeeze(star.get_xdata())), float(np.squeeze(star.get_ydata()))),
                             (self.MASSES[index[0]], self.HEIGHTS[index[1]]))
        turned = study.order(archive, "fulcrum-height", None)
        panel = self.figure(turned, ["value"]).axes[0]
        np.testing.assert_array_equal(panel.collections[0].get_array().reshape(2, 3), value)
        self.assertTrue(panel.get_xlabel().startswith("height h0"))

    def test_the_table_holds_what_is_drawn(self):
        done = self.run_script("study.py", "study.h5", "--csv")
        rows = [line.split(",") for line in done.stdout.splitlines()]
        self.assertEqual(rows[0], ["projectile-mass", "fulcrum-height", "value", "r1", "r2", "r3", "r3/r2",
                                   "r2/r1", "(r2+r3)/h0"])
        self.assertFalse(os.path.exists(self.path("study-study.png")))
        for row, scene, i in zip(rows[1:], self.scenes(), range(6)):
            values = dict(zip(rows[0], map(float, row)))
            design, speed = Archive(self.path(f"alone{i}.h5")).optimum()
            self.assertEqual((values["projectile-mass"], values["fulcrum-height"]), scene)
            self.assertEqual({name: values[name] for name in AXES}, design)
            self.assertEqual(values["value"], speed)
            self.assertEqual(values["(r2+r3)/h0"], (design["r2"] + design["r3"]) / scene[1])
        done = self.run_script("study.py", "study.h5")
        self.assertEqual(done.stdout.splitlines()[1].split(), ["kg", "m", "m/s", "m", "m", "m"])
        self.assertEqual(len(done.stdout.splitlines()), 2 + 6 + 1)
        np.testing.assert_allclose([list(map(float, line.split())) for line in done.stdout.splitlines()[2:8]],
                                   [list(map(float, row)) for row in rows[1:]], rtol=1e-6)
        self.assert_nothing_is_cut("study-study.png")

    def test_scenes_that_are_not_done_are_blank(self):
        tiles = self.make_partial(0)
        done = [i for i, _ in tiles].index(4)  # the first four scenes
        self.make_partial(done)
        archive = self.open_quietly("partial.h5")
        value = self.figure(archive).axes[0].collections[0].get_array().reshape(3, 2)
        with h5py.File(self.path("study.h5")) as file:
            want = file["best_value"][...].ravel()
        want[4:] = np.nan
        np.testing.assert_array_equal(np.ma.filled(value, np.nan), want.reshape(2, 3).T)
        archive.file.close()
        rows = self.run_script("study.py", "partial.h5", says="unfinished").stdout.splitlines()[2:-1]
        self.assertEqual([row.split()[2] == "-" for row in rows], [False] * 4 + [True] * 2)
        self.make_partial(0)
        self.run_command(sys.executable, "-B", f"{ANALYSIS}/study.py", "partial.h5", "-o", "none.png")
        self.assertFalse(os.path.exists(self.path("none.png")))

    def test_scenes_without_an_optimum_are_blank(self):
        self.sweep("accurate", "--scene.projectile-mass", "100, 2000", "--optimum.subject-to", "speed >= 10",
                   name="weak", increment="0.1")
        _, y = self.lines(self.figure(Archive(self.path("weak.h5"))))["value"]
        np.testing.assert_array_equal(np.isnan(y), [False, True])
        self.sweep("accurate", "--scene.projectile-mass", "1000, 2000", "--optimum.subject-to", "speed >= 100",
                   name="weaker", increment="0.1")
        self.run_script("study.py", "weaker.h5", says="weaker.h5: no scene has an optimum; no picture is drawn")

    def test_of_more_axes_at_most_two_are_drawn(self):
        with h5py.File(self.path("three.h5")) as file:
            best = np.unravel_index(file["best_value"][...].argmax(), file["best_value"].shape)
            height = file["fulcrum_height"][best[2]]
        done = self.run_script("study.py", "three.h5",
                               says=f"three.h5: drawn at fulcrum-height = {height:g}, where the best scene is")
        self.assertEqual(done.stdout.split()[:2], ["counterweight-mass", "projectile-mass"])
        self.run_script("study.py", "three.h5", "--at", "counterweight-mass=4000", "--quantity", "value",
                        "--quantity", "r3/r2", "-o", "map.svg")
        self.assert_picture("map.svg")
        done = self.run_script("study.py", "three.h5", "--at", "counterweight-mass=4000", "--at",
                               "fulcrum-height=1.6", "--quantity", "value", "--csv")
        with h5py.File(self.path("three.h5")) as file:
            values = file["best_value"][1, :, 1]
        self.assertEqual(done.stdout.splitlines()[1:], [f"{mass:.1f},{float(value)!r}"
                                                        for mass, value in zip((50, 100), values)])
        self.run_script("study.py", "three.h5", "--at", "counterweight-mass=4000", "--at", "fulcrum-height=1.6",
                        "--at", "projectile-mass=50", says="a single scene, printed as a table")

    def test_axes_are_logarithmic_where_their_values_are(self):
        for values, log in (((1, 2, 4, 8), True), ((1, 2, 5, 10), True), ((1, 2, 3, 4), False), ((1, 10), False),
                            ((0, 1, 10), False), ((-4, -2, -1), False), ((1.5, 1.6, 1.7), False)):
            self.assertEqual(study.is_geometric(np.array(values, float)), log, values)

    def test_invalid_options_are_refused(self):
        for arguments, code, words in (
                (["alone0.h5"], 1, "alone0.h5: is not a study: it has one scene"),
                (["study.h5", "--csv", "-o", "study.csv"], 2,
                 "output = study.csv: must be left out with --csv, which writes to stdout"),
                (["study.h5", "--x", "mass"], 2, "x = mass: must be one of the outer axes that --at leaves: "
                                                 "projectile-mass, fulcrum-height"),
                (["study.h5", "--y", "fulcrum-height", "--at", "fulcrum-height=1.5"], 2,
                 "y = fulcrum-height: must be one of the outer axes that --at leaves: projectile-mass"),
                (["study.h5", "--x", "fulcrum-height", "--y", "fulcrum-height"], 2, "must differ from x"),
                (["study.h5", "--quantity", "mass"], 2, "--quantity: invalid choice: 'mass'"),
                (["study.h5", "-o", "study.h5"], 2, "output = study.h5: must"),
                (["study.h5", "--at", "fulcrum-height=3"], 2, "must be one of 1.5, 1.92, 2.5 m")):
            with self.subTest(arguments=arguments):
                self.run_script("study.py", *arguments, code=code, says=words)


class VarianceShares(StudyTest):
    def boxed(self, archive, field="speed", **ranges):
        """The box of a map that sobol.py finds."""
        return sobol.read_box(archive, field, ranges)

    def test_shares_of_the_ishigami_function_have_their_closed_form(self):
        a, b, n = 7, 0.1, 64
        x = -np.pi + 2 * np.pi * (np.arange(n) + 0.5) / n  # sums of sines over it are exact
        f = np.sin(x)[:, None, None] * (1 + b * x ** 4) + a * np.sin(x)[None, :, None] ** 2
        fourth, eighth = (x ** 4).mean(), (x ** 8).mean()
        one, two, both = (1 + b * fourth) ** 2 / 2, a ** 2 / 8, b ** 2 * (eighth - fourth ** 2) / 2
        all_ = one + two + both
        np.testing.assert_allclose(sobol.first_order(f), [one / all_, two / all_, 0], atol=1e-14)
        np.testing.assert_allclose(sobol.totals(f), [(one + both) / all_, two / all_, both / all_], atol=1e-14)
        pairs = sobol.second_order(f)
        np.testing.assert_allclose([pairs[0, 1], pairs[0, 2], pairs[1, 2]], [0, both / all_, 0], atol=1e-14)
        # On a fine grid these are those of the continuous function.
        self.assertAlmostEqual(all_, a ** 2 / 8 + b * np.pi ** 4 / 5 + b ** 2 * np.pi ** 8 / 18 + 0.5, delta=0.02)

    def test_shares_of_a_map_over_scenes_and_lengths_have_their_closed_form(self):
        shutil.copy(self.path("study.h5"), self.path("formula.h5"))
        with h5py.File(self.path("formula.h5"), "r+") as file:
            m, _, r1, r3, r2 = np.meshgrid(*(file[name][...] for name in (
                "projectile_mass", "fulcrum_height", *AXES)), indexing="ij")
            file["speed"][...] = np.where(file["status"][...] == 1, 0.01 * m + r1 ** 2 + 3 * r3 * r2, np.nan)
        done = self.run_script("sobol.py", "formula.h5", "--at", "fulcrum-height=1.92", "--pairs")
        self.assert_nothing_is_cut("formula-fulcrum-height=1.92-sobol.png")
        axes = self.boxed(Archive(self.path("formula.h5")).select([("fulcrum-height", 1.92)])).axes
        r3, r2 = axes["r3"], axes["r2"]
        v3, v2 = r3.var(), r2.var()
        parts = {"projectile-mass": (0.01 * axes["projectile_mass"]).var(), "r1": (axes["r1"] ** 2).var(),
                 "r3": 9 * v3 * r2.mean() ** 2, "r2": 9 * v2 * r3.mean() ** 2, "r3, r2": 9 * v3 * v2}
        whole, pair = sum(parts.values()), parts["r3, r2"]
        for name, share in parts.items():
            total = f" {(share + pair * (name in ('r3', 'r2'))) / whole:8.6f}" if name != "r3, r2" else ""
            self.assertRegex(done.stdout, rf"(?m)^{name} +{share / whole:.6f}{total}$")
        self.assertRegex(done.stdout, rf"(?m)^sum +{1 - pair / whole:.6f} {1 + pair / whole:.6f}$")

    def test_the_box_is_full_and_the_largest(self):
        chance = np.random.default_rng(5)
        for _ in range(60):
            shape = chance.integers(1, 6, 3)
            rows = np.sort(chance.integers(0, shape[2] + 1, shape[1]))[::-1]
            finite = chance.random(shape) < chance.choice([0.3, 0.6, 0.9, 1])
            finite &= rows[:, np.newaxis] > np.arange(shape[2])
            ranges = [[(a, b) for b in range(1, n + 1) for a in range(b)] for n in shape]
            largest = max((b - a) * (d - c) * (f - e) * finite[a:b, c:d, e:f].all()
                          for a, b in ranges[0] for c, d in ranges[1] for e, f in ranges[2])
            for steps in (20000, 0):
                with unittest.mock.patch("box.MOST_STEPS", steps):
                    box = largest_full_box(finite, rows)
                if largest == 0:
                    self.assertIsNone(box)
                    continue
                self.assertTrue(finite[tuple(map(slice, box.lower, box.upper))].all())
                self.assertGreaterEqual(box.most, largest)
                if steps:
                    self.assertEqual(cells(box.lower, box.upper), largest)
                    self.assertEqual(box.most, largest)

    def test_the_largest_box_is_found_among_many_designs(self):
        finite = np.ones((100, 120, 120), bool)
        self.assertEqual(largest_full_box(finite, np.arange(120, 0, -1))[:2], ((0, 0, 0), (100, 60, 61)))
        finite[np.random.default_rng(3).random(finite.shape) < 1e-4] = False
        box = largest_full_box(finite, np.arange(120, 0, -1))
        self.assertEqual(box.most, cells(box.lower, box.upper))

    def test_designs_without_a_value_are_not_in_the_box(self):
        shutil.copy(self.path("study.h5"), self.path("holes.h5"))
        archive = Archive(self.path("holes.h5")).select([("fulcrum-height", 1.92)])
        before = self.boxed(archive)
        r3 = before.axes["r3"][1]
        archive.file.close()
        with h5py.File(self.path("holes.h5"), "r+") as file:
            i = int(np.flatnonzero(file["r3"][...] == r3)[0])
            file["speed"][0, 1, :, i, :] = np.nan  # of the lighter projectile
        after = self.boxed(Archive(self.path("holes.h5")).select([("fulcrum-height", 1.92)]))
        self.assertNotIn(r3, after.axes["r3"])
        self.assertLess(after.values.size, before.values.size)
        self.assertTrue(np.isfinite(after.values).all())
        heavier = Archive(self.path("holes.h5")).scene(self.at(100, 1.92))
        np.testing.assert_array_equal(self.boxed(heavier).axes["r3"], before.axes["r3"])

    def test_a_given_box_holds_all_values_of_its_range(self):
        done = self.run_script("sobol.py", "study.h5", "--at", "fulcrum-height=1.92", "--box", "r1=0.9:1.3",
                               "--box", "r3=0.5:0.6", "--box", "projectile-mass=60:100")
        for text in ("r1 = 0.9 to 1.3 m (9 values)", "r3 = 0.5 to 0.6 m (3 values)", "projectile-mass = 100 kg\n",
                     "r2 = 0.05 to 1.3 m (26 values)", "the full box with the most designs for the given r1 and r3",
                     f"designs  {9 * 3 * 26}, "):
            self.assertIn(text, done.stdout)
        archive = Archive(self.path("alone4.h5"))
        where = tuple(np.flatnonzero((archive.axes[name] > low - 1e-9) & (archive.axes[name] < high + 1e-9))
                      for name, low, high in (("r1", 0.9, 1.3), ("r3", 0.5, 0.6), ("r2", 0, 1.3)))
        values = archive.read("speed")[np.ix_(*where)]
        self.assertIn(f"values   mean {values.mean():.6g}, standard deviation {values.std():.6g} m/s", done.stdout)
        for name, share, total in zip(AXES, sobol.first_order(values), sobol.totals(values)):
            self.assertRegex(done.stdout, rf"(?m)^{name} +{share:.6f} {total:.6f}$")

    def test_archives_of_one_scene_have_shares_too(self):
        done = self.run_script("sobol.py", "alone0.h5", "--field", "release-time")
        self.assertIn("% of the lattice\n", done.stdout)
        self.assertRegex(done.stdout, r"(?m)^r2 +0\.\d+ 0\.\d+$")

    def test_where_there_is_no_box_the_reason_is_given(self):
        shutil.copy(self.path("alone0.h5"), self.path("constant.h5"))
        with h5py.File(self.path("constant.h5"), "r+") as file:
            file["speed"][...] = 7
        for arguments, code, words in (
                (["study.h5"], 1, "study.h5: no design is in the lattices of all scenes"),
                (["alone0.h5", "--box", "r1=1:1.3", "--box", "r2=0.5:0.9", "--box", "r3=0.5:1"], 1,
                 "alone0.h5: no box has a speed in every design"),
                (["alone0.h5", "--box", "r1=5:6"], 2, "box = r1=5:6: must hold a value of the axis, from 1.12 to"),
                (["alone0.h5", "--box", "r4=1"], 2, "box = r4=1:1: must name an axis, each once: r1, r3, r2"),
                (["alone0.h5", "--box", "r1=2:1"], 2, "--box: r1=2:1: must be KEY=FIRST:LAST with FIRST <= LAST"),
                (["alone0.h5", "--field", "status"], 2, "field = status: holds flags; must be a map of numbers"),
                (["constant.h5"], 1, "constant.h5: speed is constant in the box")):
            with self.subTest(arguments=arguments):
                done = self.run_command(sys.executable, "-B", f"{ANALYSIS}/sobol.py", *arguments, code=code)
                self.assertIn(words, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1)


class Failures(ScriptTest):
    """A missing or damaged file is reported as one line on stderr, with exit code 1."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.archive = cls.sweep("accurate", "--output.compression", "1", name="archive")

    def sources(self, script, name):
        """The arguments that make a script read the file `name`."""
        return [name, "archive.h5"] if script == "compare.py" else [name]

    def test_missing_empty_damaged_and_foreign_files_are_refused(self):
        whole = self.read("archive.h5")
        with h5py.File(self.path("other.h5"), "w") as file:
            file["numbers"] = np.arange(5)
        with h5py.File(self.path("axes.h5"), "w") as file:
            for name in (*AXES, "tile_block"):
                file[name] = "text"
        os.makedirs(self.path("folder.h5"), exist_ok=True)
        self.write("empty.h5", b"")
        self.write("cut.h5", whole[: len(whole) // 2])
        self.write("text.h5", b"t phi1\n1 2 3\n")
        self.write("noise.h5", random.Random(1).randbytes(5000))
        for script in SCRIPTS:
            for name in ("missing.h5", "empty.h5", "cut.h5", "text.h5", "noise.h5", "folder.h5",
                         "other.h5", "axes.h5"):
                with self.subTest(script=script, name=name):
                    done = self.run_script(script, *self.sources(script, name), code=1, says=name)
                    self.assertNotIn("Traceback", done.stderr)

    def test_truncated_and_empty_swings_are_refused(self):
        table = self.read(self.trace(comments=False))
        for content in (table[: table.rindex(b" ")], table.splitlines()[0], table.replace(b"\n0.05 ", b"\nx "),
                        b"# gravity = 9.8\n"):
            self.write("cut.txt", content)
            self.run_script("trajectory.py", "cut.txt", code=1, says="cut.txt: ")

    def test_a_crash_of_hdf5_is_reported(self):
        whole = self.read("archive.h5")
        chance = random.Random(7)
        for _ in range(25):
            damaged = bytearray(whole)
            for offset in chance.sample(range(8, 12000), 40):
                damaged[offset] = chance.randrange(256)
            self.write("damaged.h5", damaged)
            done = self.run_command(sys.executable, "-B", f"{ANALYSIS}/optimum.py", "damaged.h5",
                                    code=None, timeout=60)
            self.assertIn(done.returncode, (0, 1))
            if done.returncode:
                self.assertRegex(done.stderr, r"^damaged\.h5: .*\n$")

    def test_missing_modules_are_reported(self):
        for script in EVERY_SCRIPT:
            with self.subTest(script=script):  # -S: without installed packages
                done = self.run_command(sys.executable, "-B", "-S", f"{ANALYSIS}/{script}", "archive.h5", code=1)
                self.assertRegex(done.stderr, r"\A.*cannot import.*h5py.*\n\Z")

    def test_loads_reports_an_unusable_program(self):
        for program in ("no/such/program", "false", "/etc/passwd"):
            self.run_script("loads.py", "archive.h5", "--program", program, code=1, says=program)

    def test_files_that_cannot_be_written_are_reported(self):
        self.run_script("heatmap.py", "archive.h5", "-o", "no/such/folder.png", code=1,
                        says="no/such/folder.png")
        self.run_script("optimum.py", "archive.h5", "--job", "no/such/folder.cfg", code=1,
                        says="no/such/folder.cfg")
        job = self.write("kept.cfg", "kept")
        before = set(os.listdir(self.directory))
        for limit, *command in ((1, "heatmap.py", "archive.h5", "-o", "large.png"),
                                (0, "optimum.py", "archive.h5", "--job", job, "--overwrite")):
            done = self.run_command("bash", "-c", f'ulimit -f {limit} && exec "$@"', "bash", sys.executable, "-B",
                                    f"{ANALYSIS}/{command[0]}", *command[1:], code=1)
            self.assertRegex(done.stderr, r"^\S+: cannot be written: File too large\n$")
        self.assertEqual(self.read("kept.cfg"), b"kept")
        self.assertEqual(set(os.listdir(self.directory)) - {"large.png"}, before)


class Streams(ScriptTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", "--scene.projectile-mass", "50, 100, 200", name="study", increment="0.1")
        cls.sweep("accurate", name="archive", increment="0.1")
        cls.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r2", "0.8", "--lattice.r3", "0.5", name="single")

    def test_a_script_whose_reader_leaves_ends_silently(self):
        for command in (("study.py", "study.h5", "--csv"), ("study.py", "study.h5"), ("sobol.py", "study.h5"),
                        ("rules.py", "study.h5", "--rule", "r1 < r2"), ("optimum.py", "archive.h5"),
                        ("compare.py", "archive.h5", "single.h5"), ("heatmap.py", "single.h5"),
                        ("heatmap.py", "archive.h5"), ("machine.py",)):
            with self.subTest(command=command):
                reader, writer = os.pipe()
                os.close(reader)
                done = subprocess.run([sys.executable, "-B", f"{ANALYSIS}/{command[0]}", *command[1:]], stdout=writer,
                                      stderr=subprocess.PIPE, text=True, cwd=self.directory, timeout=60, check=False)
                os.close(writer)
                self.assertEqual(done.returncode, 128 + signal.SIGPIPE, done.stderr)
                self.assertNotIn("pipe", done.stderr.lower())

    def test_no_exit_code_depends_on_stderr(self):
        self.sweep("accurate", "--solver.max-time", "0.1", name="none", increment="0.1")  # has no optimum: a message
        for redirection in ("2>&-", "2>/dev/full"):
            for name in ("none.h5", "archive.h5"):
                done = self.run_command("bash", "-c", f'exec "$@" {redirection}', "bash", sys.executable, "-B",
                                        f"{ANALYSIS}/optimum.py", name)
                self.assertEqual(done.stdout == "", name == "none.h5")


class Outputs(ScriptTest):
    """No script replaces a file by surprise, or waits for the other end of a FIFO."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", name="archive", increment="0.1")
        cls.write("module.wasm", b"a module")
        cls.write("table.txt", cls.read("archive.h5"))
        os.symlink("table.txt", cls.path("link"))
        os.symlink("nowhere", cls.path("dangling"))
        os.mkfifo(cls.path("fifo"))
        os.mkdir(cls.path("folder"))
        # A command for each output that is not a picture, before the name of the output.
        cls.texts = {"job": ("optimum.py", "archive.h5", "--job"), "output": ("explorer/bundle.py", "module.wasm")}

    def assert_refused(self, option, command, name, words, *options):
        with self.subTest(command=command, name=name):
            before = self.read("table.txt")
            done = self.run_script(*command, name, *options, code=2, says=f"{option} = {name}: {words}")
            self.assertEqual(done.stdout, "")
            self.assertEqual(self.read("table.txt"), before)

    def test_an_existing_file_is_not_replaced_by_a_text(self):
        for option, command in self.texts.items():
            for name in ("table.txt", "link", "dangling"):
                self.assert_refused(option, command, name, "exists; name another file, or give --overwrite")
            for name in ("fifo", "folder", "/dev/full"):
                for options in ((), ("--overwrite",)):
                    self.assert_refused(option, command, name, "is not a regular file", *options)
            self.assert_refused(option, command, command[1], "must not be an input file", "--overwrite")
        self.assertFalse(os.path.lexists(self.path("nowhere")))

    def test_overwrite_replaces_a_file_and_keeps_a_link_to_it(self):
        for command in self.texts.values():
            self.run_script(*command, "text")
            expected = self.read("text")
            for name in ("old", "link to old"):
                self.write("old", "old")
                if not os.path.lexists(self.path("link to old")):
                    os.symlink("old", self.path("link to old"))
                self.run_script(*command, name, "--overwrite")
                self.assertEqual(self.read("old"), expected)
                self.assertTrue(os.path.islink(self.path("link to old")))
            os.remove(self.path("text"))

    def test_a_picture_replaces_only_a_picture_of_its_format(self):
        self.write("text.png", "a text")
        for script in ("heatmap.py", "study.py"):
            for name, words in (("table.txt", "must end in"), ("link", "exists and is no PNG"),
                                ("text.png", "exists and is no PNG"), ("fifo", "is not a regular file"),
                                ("folder", "is not a regular file")):
                self.assert_refused("output", (script, "archive.h5", "-o"), name, words)
        for suffix in SIGNATURES:
            self.write(f"map.{suffix}", b"")
            for _ in range(2):
                self.run_script("heatmap.py", "archive.h5", "--r1", "0.7", "-o", f"map.{suffix}")
                self.assert_picture(f"map.{suffix}")

    def test_an_assessment_does_not_replace_other_files(self):
        self.run_program("assess", f"{JOBS}/scenes/paper.cfg", "--lattice.increment", "0.25", "--assess.designs", "1",
                         "--assess.steppers", "euler, rk4", "--assess.repeats", "1", "--output.file", "assess.h5")
        for name in ("x-precision.png", "x-order.png", "x-stability.png"):
            self.write(name, "a text")
            self.run_script("assess.py", "assess.h5", "-o", "x", code=2, says=f"output = {name}: exists and is no PNG")
            self.assertEqual(self.read(name), b"a text")
            os.remove(self.path(name))


class Installed(ScriptTest):
    def test_every_script_runs_by_its_name(self):
        os.symlink(sys.executable, self.path("python3"))
        for script in EVERY_SCRIPT:
            done = subprocess.run([f"{ANALYSIS}/{script}", "--help"], text=True, capture_output=True,
                                  check=True, timeout=60,
                                  env={"PATH": self.directory, "PYTHONDONTWRITEBYTECODE": "1"})
            self.assertTrue(done.stdout.startswith(f"usage: {script} "))
            output = {"optimum.py": "trebsweep trace", "machine.py": "machine.svg"}.get(script, ".png")
            self.assertIn(output, done.stdout)

    def test_the_installed_scripts_find_the_installed_program(self):
        subprocess.run(["cmake", "--install", os.path.dirname(PROGRAM), "--prefix", self.directory],
                       check=True, capture_output=True, timeout=120)
        share = self.path("share/trebsweep")
        for script in EVERY_SCRIPT:
            self.assertTrue(os.access(f"{share}/analysis/{script}", os.X_OK), script)
        for name in ("jobs/paper.cfg", "jobs/scenes/wood.cfg", "jobs/slurm.sh", "jobs/pbs.sh"):
            source, copy = f"{REPOSITORY}/{name}", f"{share}/{name}"
            self.assertEqual(os.stat(source).st_mode & 0o777, os.stat(copy).st_mode & 0o777, name)
        job = ["sweep", f"{share}/jobs/accurate.cfg", "--lattice.increment", "0.1", "--output.file",
               "small.h5"]
        self.run_command(self.path("bin/trebsweep"), *job)
        done = self.run_command(sys.executable, "-B", f"{share}/analysis/loads.py", "small.h5",
                                "--count", "1", PATH="/nowhere")
        self.assertEqual(done.stderr, "")
        self.assert_picture("small-loads.png")
        self.run_command(sys.executable, "-B", f"{share}/analysis/neighbourhood.py",
                         f"{share}/jobs/accurate.cfg", PATH="/nowhere")
        self.assert_picture("accurate-neighbourhood.png")


if __name__ == "__main__":
    unittest.main()
