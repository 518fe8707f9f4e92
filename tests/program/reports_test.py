"""treb-plot assess, compare.py, loads.py and optimum.py."""

import json
import shutil
import unittest

import numpy as np

from scripts import PictureTest
from archives import h5py
from support import JOBS, PROGRAM
from trebsweep import assess, loads
from trebsweep.backend import AXES
from trebsweep.picture import plt
from trebsweep.scenes import load, only


class Reports(PictureTest):
    def test_loads_of_the_best_designs_are_drawn(self):
        self.run_script("loads", "accurate.h5", "--count", "1", "--program", PROGRAM)
        self.assert_picture("accurate-loads.png")
        self.run_script("loads", "accurate.h5", "--count", "100", "--program", PROGRAM,
                        says="of 100 designs drawn")

    def test_loads_of_a_built_machine_are_those_that_it_has(self):
        self.run_script("loads", "laboratory.h5", "--count", "1", "--program", PROGRAM)
        self.assert_picture("laboratory-loads.png")
        for archive, missing, shown in (("laboratory", "bending stress", "hanger"),
                                        ("accurate", "hanger", "bending stress")):
            archive = only(load(self.path(f"{archive}.h5")))
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
        self.run_script("heatmap", "nothing.h5")
        self.assert_picture("nothing-speed.png")
        shutil.copy(self.path("accurate.h5"), self.path("constant.h5"))
        with h5py.File(self.path("constant.h5"), "r+") as file:
            file["speed"][...] = 7
        self.run_script("heatmap", "constant.h5")
        self.run_script("compare", "constant.h5", "nothing.h5")

    def test_heatmap_draws_the_first_map_of_an_archive_without_speed(self):
        self.sweep("accurate", "--output.fields", "status", name="flags")
        self.run_script("heatmap", "flags.h5")
        self.assert_picture("flags-status.png")

    def test_compare_prints_numbers_and_draws_a_map(self):
        done = self.run_script("compare", "paper.h5", "accurate.h5")
        self.assertIn("largest", done.stdout)
        self.assert_picture("paper-accurate.png")
        done = self.run_script("compare", "accurate.h5", "accurate.h5", "-o", "same.svg")
        self.assertIn("median 0, 95 % below 0, largest 0 m/s", done.stdout)

    def test_an_assessment_is_drawn_with_maps(self):
        maps = self.sweep("paper", "--output.fields", "speed, status, speed-error, stiffness",
                          name="maps")
        self.run_program("assess", f"{JOBS}/paper.cfg", "--assess.scenes", f"{JOBS}/extreme/long_steps.cfg",
                         "--assess.steppers", "euler, dopri5", "--assess.time-steps", "0.01, 0.005",
                         "--assess.tolerances", "1e-5, 1e-7", "--assess.repeats", "1", "--output.file", "assess.h5")
        self.run_script("assess", "assess.h5", "--maps", maps)
        for picture in ("precision", "order", "stability", "speed_error", "stiffness"):
            self.assert_picture(f"assess-{picture}.png")
        self.run_script("assess", "assess.h5", "--format", "svg", "-o", "other")
        self.assert_picture("other-precision.svg")
        self.run_script("assess", "paper.h5", code=1, says="paper.h5: is not an assessment")
        self.run_script("heatmap", "assess.h5", code=1,
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
            done = self.run_script("compare", f"{a}.h5", f"{b}.h5")
            self.assertEqual(done.stdout.splitlines()[2:5], [
                f"lattices  {common} designs in common, of {sizes[0]} of A and {sizes[1]} of B",
                f"designs   {common} with a speed in both, 0 in one of them only",
                "|A - B|   median 0, 95 % below 0, largest 0 m/s"])
            self.assert_picture(f"{a}-{b}.png")
        self.sweep("accurate", "--lattice.r1", "0.61:0.71:0.1", name="between")
        self.run_script("compare", "between.h5", "accurate.h5", code=1,
                        says="between.h5 and accurate.h5 have no design in common")

    def test_the_continuous_optimum_of_an_archive_is_that_of_its_job(self):
        self.sweep("paper", "--solver.time-step", "0.002", "--optimum.objective", "efficiency", name="fine")
        done = self.run_script("optimum", "fine.h5", "--continuous", "--job", "fine.cfg", "--program",
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
        done = self.run_script("optimum", "overloaded.h5", "--continuous", "--program", PROGRAM,
                               says="the constraints exclude every design")
        self.assertEqual(done.stdout, "")
        for program in ("no/such/program", "false", "true"):
            self.run_script("optimum", "accurate.h5", "--continuous", "--program", program, code=1,
                            says=program)

    def test_invalid_options_are_refused_with_what_is_allowed(self):
        for script, arguments, words in (
                ("heatmap", ["accurate.h5", "--field", "mass"],
                 "field = mass: accurate.h5 has no map mass; must be one of release_time, speed"),
                ("heatmap", ["accurate.h5", "-o", "picture.xyz"], "output = picture.xyz: must end"),
                ("heatmap", ["accurate.h5", "--r1", "5"],
                 "r1 = 5: must be a value of the axis in accurate.h5, such as 1.45 or 1.4 m, from 0.55 to 1.45 m"),
                ("heatmap", ["accurate.h5", "--r1", "0.64"],
                 "r1 = 0.64: must be a value of the axis in accurate.h5, such as 0.65 or 0.6 m"),
                ("heatmap", ["accurate.h5", "--r2", "0.123"], "r2 = 0.123: must be a value of the axis"),
                ("heatmap", ["accurate.h5", "--r3", "0.50001"], "such as 0.5 or 0.55 m"),
                ("heatmap", ["accurate.h5", "--r1", "nan"], "r1 = nan: must be"),
                ("heatmap", ["accurate.h5", "--r1", "x"], "--r1: invalid float value: 'x'"),
                ("heatmap", ["accurate.h5", "--colour", "x"], "--colour"),
                ("heatmap", [], "ARCHIVE"),
                ("loads", ["accurate.h5", "--count", "0"], "count = 0: must be at least 1"),
                ("trajectory", ["table.txt", "--count", "-1"], "count = -1: must be at least 2"),
                ("assess", ["assess.h5", "--format", "xyz"], "format = xyz: must be one of png"),
                ("compare", ["paper.h5", "accurate.h5", "--field", "status"],
                 "field = status: holds flags; must be a map of numbers: release_time, speed")):
            with self.subTest(script=script, arguments=arguments):
                self.run_script(script, *arguments, code=2, says=words)


if __name__ == "__main__":
    unittest.main()
