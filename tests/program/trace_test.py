"""`trebsweep trace`."""

import math
import os
import unittest

import h5py

from commands import COARSE, DESIGN, CommandTest, table_of
from support import JOBS


class Trace(CommandTest):
    def test_comments_stand_only_above_the_header(self):
        done = self.run_program("trace", os.path.join(JOBS, "paper.cfg"), *DESIGN)
        lines = done.stdout.splitlines()
        header = next(i for i, line in enumerate(lines) if line.startswith("t phi1 phi2 "))
        self.assertTrue(all(line.startswith("# ") for line in lines[:header]))
        self.assertNotIn("#", "".join(lines[header:]))
        self.assertIn("# fulcrum-height = 1.5", lines)
        table = table_of(done.stdout)
        self.assertEqual(len(table), 93)
        self.assertAlmostEqual(table["speed"][-1], 17.47606519, places=7)

    def test_a_traced_swing_is_that_of_the_sweep(self):
        self.run_program("sweep", self.job, *COARSE)
        with h5py.File(self.path("job.h5")) as file:
            best = {name: file.attrs[f"best_{name}"] for name in ("r1", "r2", "r3", "speed")}
        options = [word for name in ("r1", "r2", "r3") for word in (f"--{name}", repr(float(best[name])))]
        table = table_of(self.run_program("trace", self.job, *options).stdout)
        self.assertAlmostEqual(table["speed"][-1], best["speed"], places=7)

    def test_the_hobby_machine_in_feet_and_pounds_throws_as_far_as_independent_codes_say(self):
        # ra226.net, Trebuchet Construction, with the arm as a uniform beam; 41.1 m with a pin of 42 degrees.
        job = self.write("hobby.cfg", "[scene]\ncounterweight-mass = 60 lb\nprojectile-mass = 1 lb\n"
                         "fulcrum-height = 2.5 ft\ncounterweight-hanger = 0.7 ft\nstart-tip-height = 0\n"
                         "trough = yes\nbeam-mass = 7 lb\nbeam-centre = 0.95 ft\nbeam-moment = 15.19 lb ft^2\n[solver]\nrelease = farthest\n")
        trace = ("trace", job, "--r1", "1 ft", "--r2", "2.9 ft", "--r3", "3 ft")
        swing, flight = (table_of(self.run_program(*trace, *options).stdout) for options in ((), ("--flight",)))
        self.assertAlmostEqual(flight["x3"][-1], 41.1, delta=0.05)
        self.assertAlmostEqual(math.degrees(swing["phi1"][-1] - swing["phi2"][-1]), 42, delta=0.5)

    def test_a_swing_without_release_is_reported(self):
        done = self.run_program("trace", self.job, *DESIGN, "--solver.max-time", "0.3")
        self.assertEqual(done.stderr, "the swing ends without a release: not_released: "
                                      "no release before solver.max-time, or none above the ground\n")

    def test_invalid_designs_are_refused(self):
        self.assert_refused(["trace", self.job, "--r1", "1", "--r2", "1"], "--r3: missing")
        self.assert_refused(["trace", self.job, "--r1", "x", "--r2", "1", "--r3", "1"], "r1 = x")
        self.assert_refused(["trace", self.job, "--r1", "0.3", "--r2", "1", "--r3", "1"],
                            "r1 = 0.3", "0.5")


if __name__ == "__main__":
    unittest.main()
