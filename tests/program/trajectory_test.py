"""treb-plot trajectory: a traced swing."""

import os
import unittest

import numpy as np
import PIL.Image

from scripts import DESIGN, LABORATORY, LABORATORY_DESIGN, ScriptTest
from archives import h5py
from support import REPOSITORY
from trebsweep import swing, trajectory
from trebsweep.picture import plt


class Swings(ScriptTest):
    def figure(self, table, flight=None):
        """The figure that treb-plot trajectory draws from tables."""
        rows = swing.read_swing(self.path(table))
        figure = trajectory.draw(rows, "swing", 16, swing.read_flight(flight, rows) if flight else None)
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
                    self.run_script("trajectory", "table.txt", *flight, "-o", "swing.png")
                    self.assert_picture("swing.png")

    def test_a_swing_moves_in_as_many_pictures_as_asked(self):
        self.trace_laboratory()
        self.run_script("animation", "table.txt", "--count", "5", "--width", "8")
        with PIL.Image.open(self.path("table.gif")) as picture:
            self.assertEqual(picture.n_frames, 5)
        self.run_script("animation", "table.txt", "--count", "2", "-o", "swing.html")
        self.assertIn(b"<img", self.read("swing.html"))
        for options, words in ((("-o", "x.png"), "output = x.png: must end in .gif or .html"),
                               ((), "exists; name another"),
                               (("-o", "x.gif", "--count", "1"), "count = 1: must be from 2 to 1000"),
                               (("-o", "x.gif", "--slower", "0"), "slower = 0: must be from 0.01 to 1000")):
            self.run_script("animation", "table.txt", *options, code=2, says=words)

    def test_ground_trough_and_lift_off_are_drawn_if_the_comments_define_them(self):
        self.assertEqual(self.labels(self.trace()) & {"ground", "trough", "lift-off"}, {"ground"})
        self.assertTrue(self.labels(self.trace_laboratory()) >= {"ground", "trough", "lift-off"})
        self.assertFalse(self.labels(self.trace_laboratory(comments=False)) &
                         {"ground", "trough", "lift-off"})

    def test_the_phase_portrait_has_every_angle_with_its_velocity(self):
        rows = swing.read_swing(self.trace_laboratory())
        figure = trajectory.draw(rows, "swing", 16, phase=True)
        self.addCleanup(plt.close, figure)
        for line, i in zip([line for line in figure.axes[0].get_lines() if line.get_marker() != "o"], "123"):
            np.testing.assert_array_equal(line.get_data(), (rows[f"phi{i}"], rows[f"w{i}"]))

    def test_the_trough_ends_at_the_lift_off(self):
        table = self.trace_laboratory()
        rows = swing.read_swing(table)
        time, x, y = swing.lift_off(rows)
        self.assertAlmostEqual(time, 0.2532914651, places=9)
        self.assertAlmostEqual(y, -0.831, places=3)
        for line in self.figure(table).axes[1].get_lines():
            if line.get_label() == "trough":
                np.testing.assert_allclose(line.get_xdata(), (x, rows["x3"][0]))
                np.testing.assert_allclose(line.get_ydata(), -0.831)

    def test_the_counterweight_hangs_from_the_end_of_its_arm(self):
        table = self.trace_laboratory()
        rows = swing.read_swing(table)
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
        self.run_script("trajectory", "table.txt", "--flight", "flight.txt", code=1,
                        says="flight.txt: is the flight after another swing")
        self.run_script("trajectory", "table.txt", "--flight", "table.txt", code=1,
                        says="table.txt: is the flight after another swing")
        self.run_script("trajectory", "flight.txt", code=1, says="flight.txt: has no column phi1")
        self.run_script("trajectory", "table.txt", "--flight", "flight.txt", "-o", "flight.txt",
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
                rows = swing.read_file(path, swing.FLIGHT)
                lattice = [word.replace("--", "--lattice.") for word in design]
                self.run_program("sweep", os.path.join(REPOSITORY, job), *options, *lattice, "--output.fields",
                                 "range, apex", "--output.file", "r.h5", "--overwrite")
                with h5py.File(self.path("r.h5")) as file:
                    self.assertAlmostEqual(rows["x3"].iloc[-1], file["range"][0, 0, 0], places=6)
                    self.assertAlmostEqual(np.ptp(rows["y3"]), file["apex"][0, 0, 0], places=3)


if __name__ == "__main__":
    unittest.main()
