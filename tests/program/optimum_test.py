"""`trebsweep optimum`."""

import json
import os
import unittest

import h5py
import numpy as np

from commands import CommandTest, read_trace
from support import JOBS


class Optimum(CommandTest):
    KEYS = {"objective", "value", "error", "r1", "r3", "r2", "release_time", "active", "gradient", "hessian",
            "one_percent_loss", "one_percent_limit", "constraints", "build_constraints", "sensitivity",
            "sensitivity_of_optimum", "worst", "expected", "maxima", "starts", "starts_at_best", "coarse_increment",
            "designs", "seconds", "converged", "bounds", "job", "unsafe", "values", "units", "version", "pin_angle_loss",
            "pin_angle_limit", "range_with_wind", "variables", "warnings",
            "constraint_units", "sought"}

    def optimum(self, *options, job=None, ranks=None):
        """The JSON object that the command prints, without the run time."""
        found = json.loads(self.run_program("optimum", job or self.job, "--json", *options, ranks=ranks).stdout)
        self.assertGreater(found.pop("seconds"), 0)
        return found

    def assert_no_optimum(self, *options, words, ranks=None):
        """Exit code 3, nothing on stdout, and a message of one line with the words."""
        done = self.run_program("optimum", self.job, *options, code=3 if ranks is None else None, ranks=ranks)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(done.stdout, "")
        self.assert_one_message(done.stderr, words)

    def test_tolerances_end_at_bounds_and_constraints_and_say_which(self):
        weak = ("--optimum.subject-to", "peak-beam-stress <= 6e7", "--lattice.r1", "0.52:1:0.01")
        found = self.optimum(*weak)
        (r1_shorter, r1_longer), (r3_shorter, r3_longer), (r2_shorter, r2_longer) = found["one_percent_loss"]
        for forbidden in (r1_shorter, r1_longer, r3_longer, r2_longer):
            self.assertLess(forbidden, 1e-6)
        for allowed in (r3_shorter, r2_shorter):
            self.assertGreater(allowed, 0.009)
        stress = "peak-beam-stress <= 60000000"
        self.assertEqual(found["one_percent_limit"], [["r1 >= 0.52", stress], [None, stress], [None, stress]])
        text = self.run_program("optimum", self.job, *weak).stdout
        self.assertIn(f"r1: 0.0000 m shorter (r1 >= 0.52) or 0.0000 m longer ({stress}); gradient", text)
        text = self.run_program("optimum", self.job).stdout
        self.assertIn(" m shorter or 0.0000 m longer (r2 + r3 <= 1.5); gradient", text)

    def test_json_has_the_documented_keys_and_the_papers_optimum(self):
        found = self.optimum("--optimum.deviation", "0.005")
        self.assertEqual(set(found) | {"seconds"}, self.KEYS)
        self.assertEqual(found["objective"], "speed")
        # The maximum between the designs of the millimetre lattice, where it is 16.94320899 m/s at most.
        self.assertAlmostEqual(found["value"], 16.952925755, places=8)
        for name, length in {"r1": 0.511423, "r3": 0.583397, "r2": 0.916603}.items():
            self.assertAlmostEqual(found[name], length, places=6)
        self.assertLess(found["error"], 1e-9)
        self.assertEqual([limit["constraint"] for limit in found["active"]], ["r2 + r3 <= 1.5"])
        self.assertEqual({key for maximum in found["maxima"] for key in maximum}, {"r1", "r3", "r2", "value"})
        self.assertEqual(np.shape(found["hessian"]), (3, 3))
        self.assertLess(found["worst"], found["expected"])
        self.assertLess(found["expected"], found["value"])
        # By dimensional analysis, the speed is proportional to the square root of gravity.
        self.assertAlmostEqual(found["sensitivity"]["gravity"], found["value"] / (2 * 9.8), places=8)
        self.assertIsNone(self.optimum()["worst"])

    def test_without_an_optimum_the_message_says_why(self):
        for ranks in (None, 2):
            self.assert_no_optimum("--optimum.subject-to", "peak-axle-load <= 1e4, speed >= 16",
                                   words="the constraints exclude every design", ranks=ranks)

    def test_a_given_increment_is_that_of_the_coarse_sweep(self):
        own = self.optimum()
        given = self.optimum("--lattice.increment", "0.03")
        self.assertEqual(given["coarse_increment"], 0.03)
        self.assertNotEqual(own["coarse_increment"], 0.03)
        self.assertAlmostEqual(given["value"], own["value"], places=10)
        self.assertIn("0.03 m", self.run_program("optimum", self.job, "--lattice.increment", "0.03").stdout)

    def test_the_optimum_does_not_depend_on_the_jobs_stepper(self):
        paper, accurate = (self.optimum(job=os.path.join(JOBS, f"{name}.cfg")) for name in ("paper", "accurate"))
        self.assertNotEqual(paper.pop("job"), accurate.pop("job"))
        self.assertEqual(paper, accurate)

    def test_variables_have_the_values_of_the_optimum_in_the_job_that_is_printed(self):
        bounds = {"start-angle": (0.3, 1.2), "counterweight-mass": (2000, 5000)}
        variables = ", ".join(f"{name} {low}:{high}" for name, (low, high) in bounds.items())
        options = ("--optimum.objective", "range", "--optimum.variables", variables, "--optimum.subject-to",
                   "peak-axle-load / counterweight-mass <= 25")
        found = self.optimum(*options)
        self.assertEqual(set(found["variables"]), set(bounds))
        for name, (low, high) in bounds.items():
            self.assertLessEqual(low, found["variables"][name])
            self.assertLessEqual(found["variables"][name], high)
        self.assertEqual(found["units"]["start-angle"], "rad")
        self.assertEqual([np.shape(found[key]) for key in ("gradient", "hessian", "bounds", "one_percent_loss")],
                         [(5,), (5, 5), (5, 2), (5, 2)])
        job = self.write("found.cfg", found["job"])
        lengths = [f"--{name}={found[name]!r}" for name in ("r1", "r2", "r3")]
        trace = self.run_program("trace", job, *lengths, "--solver.tolerance", "1e-12").stdout
        _, rows = read_trace(trace)
        self.assertAlmostEqual(rows["speed"][-1], found["values"]["speed"], places=8)
        self.assertEqual(self.optimum(*options, ranks=2), found)
        text = self.run_program("optimum", self.job, *options).stdout
        self.assertIn(f"start-angle = {found['variables']['start-angle']:.7g} rad", text)

    def test_a_variable_that_is_best_at_a_bound_gives_the_optimum_with_that_value(self):
        # Objectives that are convex in the key, with and without values beyond the bound.
        for key, bounds, best in (("projectile-mass", "5:50", "5"), ("beam-density", "0:2000", "0"),
                                  ("pivot-friction", "0:500", "0")):
            found = self.optimum("--optimum.variables", f"{key} {bounds}")
            fixed = self.optimum(f"--scene.{key}", best)
            self.assertTrue(found["converged"])
            self.assertEqual(found["variables"][key], float(best))
            self.assertAlmostEqual(found["value"], fixed["value"], places=9)
            self.assertAlmostEqual(found["gradient"][3], fixed["sensitivity"][key],
                                   delta=1e-5 * abs(fixed["sensitivity"][key]))

    def test_a_robust_search_has_room_above_the_bound_of_r1_in_each_scene(self):
        options = ("--optimum.robust", "worst", "--optimum.deviation", "0.01", "--optimum.objective", "speed")
        found = self.optimum(*options, "--optimum.variables", "release-height 1.6:2.4")
        fixed = self.optimum(*options, "--scene.release-height", repr(found["variables"]["release-height"]))
        self.assertGreater(found["worst"], self.optimum(*options)["worst"] + 0.5)  # at the height of the job
        self.assertLess(found["worst"], fixed["worst"])  # that height is exact
        self.assertGreater(found["worst"], 0.95 * fixed["worst"])

    def test_a_target_is_met_or_a_warning_names_what_comes_closest(self):
        near = self.optimum("--optimum.minimize", "abs(range - 15)")
        self.assertAlmostEqual(near["values"]["range"], 15, places=7)
        self.assertEqual((near["warnings"], near["converged"], near["gradient"]), ([], False, [None] * 3))
        self.assertIsNotNone(near["pin_angle_loss"])
        farthest = self.optimum("--optimum.objective", "range")
        far = self.optimum("--optimum.minimize", "abs(range - 500)")
        self.assertAlmostEqual(far["value"], farthest["value"] - 500, places=8)
        self.assertIn("the target is not met: abs(range - 500) is 4", far["warnings"][0])

    def test_the_least_load_for_a_range_is_that_of_the_largest_range_for_the_load(self):
        least = self.optimum("--optimum.objective", "-peak-axle-load", "--optimum.subject-to", "range >= 15")
        load = -least["value"]
        most = self.optimum("--optimum.objective", "range", "--optimum.subject-to", f"peak-axle-load <= {load!r}")
        self.assertAlmostEqual(most["value"], 15, places=6)
        price, gain = ({limit["constraint"].split()[0]: limit["multiplier"] for limit in found["active"]}
                       for found in (least, most))
        self.assertAlmostEqual(price["range"] * gain["peak-axle-load"], -1, places=4)

    def test_no_design_of_the_lattice_dominates_a_pareto_front(self):
        constraint = ("--optimum.subject-to", "least-sling-tension >= 0")
        front = json.loads(self.run_program("optimum", self.job, *constraint, "--json", "--pareto",
                                            "range, -peak-axle-load", "7").stdout)
        points = np.array([point["values"] for point in front["points"]])
        self.assertEqual(points.shape, (7, 2))
        self.assertTrue((np.diff(points[:, 0]) < 0).all() and (np.diff(points[:, 1]) > 0).all())
        fields = ("range", "peak-axle-load", "least-sling-tension", "tip-clearance", "counterweight-clearance",
                  "projectile-clearance")
        self.run_program("sweep", self.job, "--lattice.increment", "0.02", "--output.file", "lattice.h5",
                         "--output.fields", ", ".join(fields))
        with h5py.File(self.path("lattice.h5")) as archive:
            distance, load, *least = (archive[field.replace("-", "_")][:] for field in fields)
        possible = np.all([values >= 0 for values in least], axis=0)
        self.assertGreater(possible.sum(), 1000)
        for value, negative_load in points:
            self.assertFalse((possible & (distance > value + 1e-6) & (load < -negative_load - 1e-3)).any())
        # The slope of the front is its multiplier.
        slopes = np.gradient(points[:, 0], points[:, 1])
        for slope, point in list(zip(slopes, front["points"]))[1:-1]:
            if point["multiplier"] is not None:
                self.assertAlmostEqual(point["multiplier"] / slope, 1, delta=0.2)
        text = self.run_program("optimum", self.job, *constraint, "--pareto", "range, -peak-axle-load", "3").stdout
        self.assertEqual(text.splitlines()[0].split(), ["range", "-peak-axle-load", "multiplier", "r1", "r2", "r3"])
        for words in (("range",), ("range, speed, apex",), ("range, range",), ("range, speed", "2"),
                      ("range, speed", "x")):
            self.run_program("optimum", self.job, "--pareto", *words, code=2)


if __name__ == "__main__":
    unittest.main()
