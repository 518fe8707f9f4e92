"""The pictures and reports of analysis/, from archives and tables that the program writes.

Needs TREBSWEEP (the program, in its build directory) in the environment.
"""

import contextlib
import io
import json
import os
import random
import shutil
import subprocess
import sys
import unittest
import unittest.mock

import h5py
import numpy as np

from support import JOBS, PROGRAM, REPOSITORY, DirectoryTest

ANALYSIS = os.path.join(REPOSITORY, "analysis")
SIGNATURES = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml", "eps": b"%!PS", "jpg": b"\xff\xd8"}
SCRIPTS = ("assess.py", "compare.py", "heatmap.py", "loads.py", "optimum.py", "trajectory.py")
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
import heatmap  # noqa: E402  (found by the path)
import loads  # noqa: E402
import machine  # noqa: E402
import maps  # noqa: E402
import neighbourhood  # noqa: E402
import trajectory  # noqa: E402
from archive import AXES, Archive  # noqa: E402
from picture import plt  # noqa: E402


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

    def run_script(self, script, *arguments, code=0, says="", python=()):
        """Runs a script, which prints nothing on stderr, or one line that contains `says`."""
        done = self.run_command(sys.executable, "-B", *python, f"{ANALYSIS}/{script}", *arguments,
                                code=code)
        self.assertIn(says, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1 if says else 0, done.stderr)
        return done

    def assert_picture(self, name, suffix=None):
        self.assertTrue(self.read(name).startswith(SIGNATURES[suffix or name.rsplit(".", 1)[1]]))

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

    def test_archives_of_different_lattices_are_not_compared(self):
        self.sweep("accurate", "--lattice.r1", "0.6:0.7:0.1", name="narrow")
        self.run_script("compare.py", "narrow.h5", "accurate.h5", code=1,
                        says="different lattices: r1")

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
                ("heatmap.py", ["accurate.h5", "--r1", "5"], "r1 = 5: must be from 0.55 to 1.45 m"),
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

    def test_the_marks_are_where_1_percent_is_lost(self):
        for name, drawn in self.panels():
            least = drawn["1 % less than the optimum"].get_ydata()[0]
            self.assertAlmostEqual(least, 0.99 * self.optimum.value, places=12)
            for x in drawn["where 1 % is lost"].get_xdata():
                self.assertAlmostEqual(self.swing(name, x)["speed"][-1], least, places=5)

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
        self.assertIsNone(optimum.worst)
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
            self.assertEqual(axes.get_title(), f"{name} = {length.value:.7f} m\n1 % less: {1000 * length.shorter:.3g}"
                                               f" mm shorter or {1000 * length.longer:.3g} mm longer")
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


class PartialArchives(ScriptTest):
    """Partial archives, with any values in the cells of the tiles that are not done."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        fields = "speed, status, speed-error"
        cls.sweep("paper", "--output.fields", fields, name="complete", increment="0.02")
        cls.sweep("paper", "--output.fields", fields, "--lattice.r2", "0.1:1.2:0.02", name="by_hand",
                  increment="0.02")

    @classmethod
    def tiles(cls, file):
        """The slices of the tiles with designs, in the order of tile_done."""
        status = file["status"][...]
        edge = [int(file["tile_done"].attrs[f"edge_{name}"]) for name in AXES]
        for corner in np.ndindex(*(-(-n // e) for n, e in zip(status.shape, edge))):
            tile = tuple(slice(i * e, (i + 1) * e) for i, e in zip(corner, edge))
            if status[tile].any():
                yield tile

    def test_the_optimum_of_a_sweep_killed_before_its_summary_is_found(self):
        shutil.copy(self.path("complete.h5"), self.path("killed.h5.partial"))
        with h5py.File(self.path("killed.h5.partial"), "r+") as file:
            for name in file.attrs:
                if name.startswith("best_"):
                    file.attrs[name] = np.nan
        self.assertEqual(self.run_script("optimum.py", "killed.h5.partial").stdout,
                         self.run_script("optimum.py", "complete.h5").stdout)

    def make_partial(self, source, name, done, junk):
        """Copies a complete archive with only the first `done` tiles done; returns the others and the message."""
        shutil.copy(self.path(source), self.path(name))
        with h5py.File(self.path(name), "r+") as file:
            tiles = list(self.tiles(file))
            self.assertEqual(len(tiles), len(file["tile_done"]))
            for tile in tiles[done:]:
                file["speed"][tile] = junk
                file["speed_error"][tile] = junk
                file["status"][tile] = 0
            file["tile_done"][done:] = 0
            for axis in (*AXES, "speed", "release_time"):
                file.attrs[f"best_{axis}"] = np.nan
        return tiles[done:], f"{name}: unfinished: {done} of {len(tiles)} tiles done; " \
                             "the rest is left blank\n"

    def test_tiles_that_are_not_done_read_as_blank(self):
        for source in ("complete.h5", "by_hand.h5"):
            for name in ("q.h5", "q.h5.partial"):
                for done in (0, 5):
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
                    np.testing.assert_array_equal(archive.read("speed"), speed)
                    np.testing.assert_array_equal(archive.read("status"), status)
                    where = (3, slice(None), slice(None))
                    np.testing.assert_array_equal(archive.read("speed", where), speed[where])
                    archive.file.close()

    def test_the_optimum_is_the_fastest_design_in_the_tiles_done(self):
        for junk in (99, 0, np.nan):
            undone, message = self.make_partial("complete.h5", "q.h5", 5, junk)
            with h5py.File(self.path("complete.h5")) as file:
                speed = file["speed"][...]
                for tile in undone:
                    speed[tile] = np.nan
                best = {name: file[name][i] for name, i in
                        zip(AXES, np.unravel_index(np.nanargmax(speed), speed.shape))}
            done = self.run_script("optimum.py", "q.h5", says=message)
            self.assertEqual(done.stdout.split(),
                             [word for name in AXES for word in (f"--{name}", repr(float(best[name])))])
        _, message = self.make_partial("complete.h5", "q.h5", 0, 0)
        done = self.run_command(sys.executable, f"{ANALYSIS}/optimum.py", "q.h5")
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr, message + "q.h5: has no optimum: nothing released yet\n")

    def test_every_script_reports_a_partial_archive_once(self):
        subprocess.run([PROGRAM, "assess", f"{JOBS}/paper.cfg", "--assess.scenes",
                        f"{JOBS}/scenes/paper.cfg", "--assess.steppers", "euler",
                        "--assess.time-steps", "0.01", "--assess.repeats", "1",
                        "--assess.designs", "1", "--output.file", self.path("assess.h5")],
                       check=True, capture_output=True, timeout=120)
        for name in ("q.h5", "q.h5.partial"):
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
            for name in (*AXES, "tile_done"):
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
                done = self.run_script(script, "archive.h5", code=1, says="cannot import",
                                       python=["-S"])
                self.assertIn("h5py", done.stderr)

    def test_loads_reports_an_unusable_program(self):
        for program in ("no/such/program", "false", "/etc/passwd"):
            self.run_script("loads.py", "archive.h5", "--program", program, code=1, says=program)

    def test_files_that_cannot_be_written_are_reported(self):
        self.run_script("heatmap.py", "archive.h5", "-o", "no/such/folder.png", code=1,
                        says="no/such/folder.png")
        self.run_script("heatmap.py", "archive.h5", "-o", "/dev/full", code=1, says="/dev/full")
        self.run_script("optimum.py", "archive.h5", "--job", "no/such/folder.cfg", code=1,
                        says="no/such/folder.cfg")


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
