"""What a sweep and `trebsweep info` say at the end: warnings, the best design, the measured error."""

import json
import os
import re
import unittest

import h5py
import numpy as np

from commands import COARSE, CommandTest, read_trace
from support import JOBS


class Warnings(CommandTest):
    """Each reason to doubt a result is reported once, on stderr."""

    def warnings(self, *arguments, job=None):
        done = self.run_program("sweep", job or self.job, *arguments, "--overwrite", "--progress", "none", ranks=2)
        return [line for line in done.stderr.splitlines() if line.startswith("warning: ")]

    def test_steps_that_create_energy_are_reported(self):
        euler = self.write("euler.cfg", "[solver]\nstepper = euler\nrelease = window\ntime-step = 0.1\n")
        # Of the best designs of this scene, whose efficiency is high: not of single ones with chaotic swings.
        warnings = self.warnings("--lattice.increment", "0.05", "--scene.counterweight-mass", "400",
                                 "--solver.release", "crossing", job=euler)
        self.assertEqual(sum("an energy efficiency above 1" in line for line in warnings), 1)

    def test_slack_slings_among_the_best_designs_are_reported(self):
        warnings = self.warnings("--scene.sling-angle", "1.5", "--lattice.increment", "0.05")
        self.assertEqual(sum("slack" in line for line in warnings), 1)
        warnings = self.warnings("--scene.sling-angle", "1.5", "--lattice.increment", "0.05", "--output.optimum", "taut")
        self.assertEqual(sum("the sling goes slack" in line for line in warnings), 0)

    def test_a_refined_optimum_at_the_end_of_a_given_axis_is_reported(self):
        axes = ("--lattice.r3", "0.5", "--lattice.r2", "0.9", "--optimum.refine", "yes")
        [warning] = self.warnings("--lattice.r1", "0.6:0.9:0.1", *axes)
        self.assertIn("on the edge of the lattice: r1 = 0.6 m, the smallest allowed by lattice.r1", warning)
        self.assertEqual(self.warnings("--lattice.r1", "0.505:0.905:0.1", *axes), [])
        warnings = self.warnings("--lattice.r1", "0.6:0.9:0.1", *axes, "--scene.release-height", "1.7, 1.9, 2")
        self.assertEqual(sum("lies on the edge of the lattice: the smallest r1 in" in line for line in warnings), 1)


class Buildable(CommandTest):
    """In what a best design cannot be built: by how much the rows of its trace say."""

    SCENE = ("[scene]\ncounterweight-mass = 60\nprojectile-mass = 0.5\nfulcrum-height = 1.1\nbeam-side = 0.05\n"
             "beam-density = 700\nstart-angle = 0.5\ncounterweight-hanger = 0.6\ntrough = yes\n"
             "[lattice]\nr1 = 0.7:0.9:0.1\nr3 = 1\nr2 = 2\n[solver]\nrelease = fastest\n")
    BODIES = {"the arm's tip": "yt", "the counterweight": "y1", "the projectile": "y3"}

    def setUp(self):
        super().setUp()
        self.job = self.write("job.cfg", self.SCENE)

    def swept(self, *arguments):
        """The warnings of a sweep, and its optimum as options of trace."""
        done = self.run_program("sweep", self.job, *arguments, "--overwrite", "--progress", "none", ranks=2)
        with h5py.File(self.path("job.h5")) as file:
            design = [f"--{name}={float(file.attrs['best_' + name])!r}" for name in ("r1", "r2", "r3")]
        return [line for line in done.stderr.splitlines() if line.startswith("warning: ")], design

    def assert_described(self, line, design, *scene):
        """The line names the bodies and tensions that the rows of the design's trace have below zero."""
        done = self.run_program("trace", self.job, *scene, *design, "--interval", "1e-4")
        comments, rows = read_trace(done.stdout)
        rows["y3"][rows["t"] < float(comments["lift-off-time"])] = 0
        heights = {body: rows[column].min() + 1.1 for body, column in self.BODIES.items()}
        below = re.findall(r"(the [a-z' ]+) reaches (\S+) m below the ground", line)
        self.assertEqual([body for body, _ in below], [body for body, height in heights.items() if height < -1e-6])
        for body, depth in below:
            self.assertAlmostEqual(float(depth) / -heights[body], 1, delta=0.05)
        for column, words in (("tension", "push with"), ("hanger_tension", "under a compression of")):
            least = rows[column].min()
            found = re.search(rf"{words} (\S+) N", line)
            self.assertEqual(found is not None, least < 0)
            if found:
                self.assertAlmostEqual(float(found.group(1)) / -least, 1, delta=0.01)
        # A trace says the same, and where and when it is worst.
        problems = line[line.index("the arm's tip reaches"):]
        self.assertIn(f"warning: the design cannot be built: {problems}\n", done.stderr)
        self.assertAlmostEqual(float(comments["ground-clearance"]), min(heights.values()), places=6)
        self.assertEqual(comments["ground-clearance-of"], "tip")
        for column, key in (("yt", "ground-clearance"), ("tension", "least-sling-tension"),
                            ("hanger_tension", "least-hanger-tension")):
            self.assertAlmostEqual(float(comments[key + "-time"]), rows["t"][rows[column].argmin()], delta=1.01e-4)

    def test_the_best_design_of_a_lattice_is_described_as_by_its_trace(self):
        for arguments in ((), ("--solver.check", "no"), ("--solver.release", "crossing")):
            with self.subTest(arguments=arguments):
                warnings, design = self.swept(*arguments)
                self.assertTrue(warnings[0].startswith("warning: the optimum cannot be built: the arm's tip"))
                self.assertEqual(sum("slack" in line for line in warnings), 1)
                self.assert_described(warnings[0], design, *arguments)

    def test_a_refined_optimum_is_described_instead_of_that_of_the_lattice(self):
        options = ("--solver.release", "crossing", "--lattice.r1", "0.3:0.9:0.1")
        _, lattice = self.swept(*options)
        warnings, design = self.swept(*options, "--optimum.refine", "yes")
        self.assertNotEqual(design, lattice)
        self.assert_described(warnings[0], design, "--solver.release", "crossing")

    def test_a_machine_above_the_ground_and_under_tension_has_no_warning(self):
        raised = ("--scene.fulcrum-height", "2.1", "--solver.release", "farthest")
        warnings, design = self.swept(*raised, "--lattice.r1", "0.5", "--lattice.r3", "1.5")
        self.assertEqual(warnings, [])
        self.assertEqual(self.run_program("trace", self.job, *design, *raised).stderr, "")

    def test_a_study_has_one_line_that_counts_its_scenes(self):
        warnings, _ = self.swept("--scene.fulcrum-height", "1.1, 1.2, 2.1", "--lattice.r1", "0.5", "--lattice.r3",
                                 "1.5", "--solver.release", "farthest")
        [line] = [line for line in warnings if "built" in line]
        self.assertRegex(line, "^warning: the optimum of 2 of 3 scenes cannot be built: below the ground in 2")


class MeasuredError(CommandTest):
    NAMES = ("error_median", "error_largest", "error_at_optimum", "error_designs")

    def line(self, text):
        return next(line for line in text.splitlines() if line.startswith("error "))

    def test_summary_info_and_attributes_give_the_same_error(self):
        line = self.line(self.run_program("sweep", self.job, *COARSE).stdout)
        self.assertEqual(line, self.line(self.run_program("info", "job.h5").stdout))
        with h5py.File(self.path("job.h5")) as file:
            median, largest, at_optimum, designs = (file.attrs[name] for name in self.NAMES)
        self.assertEqual(line, f"error     {median:.2g} median, {largest:.2g} largest of {designs} designs; "
                               f"{at_optimum:.2g} at the optimum")
        self.assertTrue(0 < median < largest < 1e-7)

    def test_check_no_leaves_out_the_error_and_the_warnings_that_need_it(self):
        euler = self.write("euler.cfg", "[solver]\nstepper = euler\nrelease = window\ntime-step = 0.1\n")
        done = self.run_program("sweep", euler, *COARSE, "--solver.check", "no")
        self.assertEqual(self.line(done.stdout), "error     not measured")
        self.assertEqual(done.stderr.count("warning: "), done.stderr.count("on the edge of the lattice"))
        with h5py.File(self.path("euler.h5")) as file:
            values = [file.attrs[name] for name in self.NAMES]
        self.assertTrue(np.isnan(values[:3]).all())
        self.assertEqual(values[3], 0)


class BuiltMachines(CommandTest):
    """The laboratory machine of jobs/lab.cfg: a hanger, a trough and the rules of release of builders."""

    LAB = os.path.join(JOBS, "lab.cfg")
    COARSE = ("--lattice.r1", "0.17:0.29:0.06", "--lattice.r3", "0.67:1.07:0.1", "--lattice.r2", "0.875:1.275:0.1")

    def test_maps_and_error_are_the_same_on_any_number_of_ranks_for_rules_of_builders(self):
        for rule, most in (("farthest", 3), ("fastest", 2), ("pin --solver.pin-angle 0.6", 2)):
            results = []
            for ranks in range(1, most + 1):
                self.run_program("sweep", self.LAB, *self.COARSE, "--solver.release", *rule.split(), "--overwrite",
                                 ranks=ranks)
                with h5py.File(self.path("lab.h5")) as file:
                    maps = {name: item[...].tobytes() for name, item in file.items() if item.shape == (3, 5, 5)}
                    results.append((maps, [file.attrs[name] for name in MeasuredError.NAMES]))
            self.assertEqual(len(maps), 12)
            for other in results[1:]:
                self.assertEqual(results[0], other, rule)
            median, largest, _, designs = results[0][1]
            self.assertEqual(designs, 75)
            self.assertTrue(1e-10 < median < 1e-7 and largest < 1e-6, (rule, median, largest))

    def test_designs_that_do_not_lift_off_or_reach_the_trough_are_counted(self):
        done = self.run_program("sweep", self.LAB, "--solver.max-time", "0.1", "--lattice.r1", "0.25",
                                "--lattice.r3", "0.07:1.07:0.25", "--lattice.r2", "1.075:1.275:0.1")
        info = self.run_program("info", "lab.h5").stdout
        with h5py.File(self.path("lab.h5")) as file:
            row = dict(zip(file["tile_designs"].attrs["columns"].split(), file["tile_designs"][0]))
            meanings = file["status"].attrs["flag_meanings"].split()
            self.assertEqual(meanings[file["status"][0, 0, 0]], "sling_too_short")
            self.assertEqual(meanings[file["status"][0, 4, 0]], "never_lifted")
        self.assertEqual((row["sling_too_short"], row["never_lifted"]), (3, 12))
        for words in ("3 sling_too_short", "12 never_lifted", "optimum   none: nothing was released"):
            self.assertIn(words, done.stdout)
            self.assertIn(words, info)

    def test_the_axes_that_a_trough_has_by_default_are_printed_and_continue_the_archive(self):
        scene = ("--scene.file", os.path.join(JOBS, "scenes", "laboratory.cfg"), "--lattice.increment", "0.1")
        summary = self.run_program("sweep", self.job, *scene, ranks=2).stdout
        self.assertIn("\naxes      r3 = 0.3:1.8:0.1, r2 = 0.3:1.8:0.1 m (default with a trough)\n", summary)
        with h5py.File(self.path("job.h5")) as file:
            for axis in ("r3", "r2"):
                np.testing.assert_array_equal(file[axis], np.arange(3, 19) / 10)
        for given in ((), ("--lattice.r2", "0.3:1.8:0.1")):
            again = self.run_program("sweep", self.job, *scene, *given)
            self.assertIn("holds the complete archive of this job", again.stderr)
        self.assertNotIn("axes ", self.run_program("sweep", self.job, *COARSE, "--overwrite").stdout)

    def test_the_optimum_is_sought_among_the_axes_that_a_trough_has_by_default(self):
        found = self.run_program("optimum", self.job, "--scene.file", os.path.join(JOBS, "scenes", "laboratory.cfg"),
                                 "--lattice.r1", "0.25", "--lattice.increment", "0.1", "--json", ranks=2).stdout
        _, r3, r2 = json.loads(found)["bounds"]
        self.assertEqual((r3, r2), ([0.3, 1.8], [0.3, 1.8]))

    def test_the_best_machine_for_the_backyard_is_within_its_limits(self):
        done = self.run_program("sweep", os.path.join(JOBS, "backyard.cfg"), ranks=2)
        refined = float(re.search(r"\nrefined   range (.+) m at ", done.stdout)[1])
        with h5py.File(self.path("backyard.h5")) as file:
            at = {name: data[...] for name, data in file.items() if data.ndim == 3}
        within = (at["peak_axle_load"] <= 5000) & (at["peak_beam_stress"] <= 2e7)
        for name in ("ground_clearance", "least_sling_tension", "least_hanger_tension"):
            within &= at[name] >= 0
        best = at["range"][within].max()
        self.assertGreater(best, 65)
        self.assertLess(best, refined)
        self.assertLess(refined, np.nanmax(at["range"]))


if __name__ == "__main__":
    unittest.main()
