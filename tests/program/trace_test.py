"""`trebsweep trace`."""

import math
import unittest

import h5py

from commands import COARSE, DESIGN, CommandTest, read_trace


class Trace(CommandTest):
    def test_a_traced_swing_is_that_of_the_sweep(self):
        self.run_program("sweep", self.job, *COARSE)
        with h5py.File(self.path("job.h5")) as file:
            best = {name: file.attrs[f"best_{name}"] for name in ("r1", "r2", "r3", "speed")}
        options = [word for name in ("r1", "r2", "r3") for word in (f"--{name}", repr(float(best[name])))]
        _, rows = read_trace(self.run_program("trace", self.job, *options).stdout)
        self.assertAlmostEqual(rows["speed"][-1], best["speed"], places=7)

    def test_the_hobby_machine_in_feet_and_pounds_throws_as_far_as_independent_codes_say(self):
        # ra226.net, Trebuchet Construction, with the arm as a uniform beam; 41.1 m with a pin of 42 degrees.
        job = self.write("hobby.cfg", "[scene]\ncounterweight-mass = 60 lb\nprojectile-mass = 1 lb\n"
                         "fulcrum-height = 2.5 ft\ncounterweight-hanger = 0.7 ft\nstart-tip-height = 0\n"
                         "trough = yes\nbeam-mass = 7 lb\nbeam-centre = 0.95 ft\nbeam-moment = 15.19 lb ft^2\n[solver]\nrelease = farthest\n")
        trace = ("trace", job, "--r1", "1 ft", "--r2", "2.9 ft", "--r3", "3 ft")
        swing, flight = (read_trace(self.run_program(*trace, *options).stdout)[1] for options in ((), ("--flight",)))
        self.assertAlmostEqual(flight["x3"][-1], 41.1, delta=0.05)
        self.assertAlmostEqual(math.degrees(swing["phi1"][-1] - swing["phi2"][-1]), 42, delta=0.5)

    def test_a_swing_without_release_is_reported(self):
        done = self.run_program("trace", self.job, *DESIGN, "--solver.max-time", "0.3")
        self.assertEqual(done.stderr, "the swing ends without a release: not_released: "
                                      "no release before solver.max-time, or none above the ground\n")


if __name__ == "__main__":
    unittest.main()
