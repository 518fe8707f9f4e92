"""treb-plot neighbourhood: the designs around an optimum."""

import functools
import json
import subprocess
import unittest

import numpy as np

from scripts import LABORATORY, ScriptTest
from archives import h5py
from support import JOBS, PROGRAM
from trebsweep import neighbourhood, swing
from trebsweep.backend import AXES
from trebsweep.picture import plt


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

    @classmethod
    @functools.cache
    def fastest(cls):
        """The optimum of the job without options, and the archives of its panels."""
        optimum = cls.find(cls.JOB)
        return optimum, neighbourhood.sweep_panels(PROGRAM, optimum)

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
        return swing.read_swing(self.trace("--solver.tolerance", "1e-12", "--interval", "0.0005",
                                                design=design))

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
                self.assertAlmostEqual(speed[i], self.swing(name, x[i])["speed"].iloc[-1], places=6)
            star = next(line for label, line in drawn.items() if label.startswith("optimum: "))
            self.assertEqual(float(np.squeeze(star.get_xdata())), self.optimum.lengths[name].value)
            speed = self.swing(name, float(np.squeeze(star.get_xdata())))["speed"].iloc[-1]
            self.assertAlmostEqual(float(np.squeeze(star.get_ydata())), speed, places=8)

    def test_the_marks_are_where_1_percent_is_lost_within_the_limits(self):
        marks = {}
        for name, drawn in self.panels():
            least = drawn["1 % less than the optimum"].get_ydata()[0]
            self.assertAlmostEqual(least, 0.99 * self.optimum.value, places=12)
            marks[name] = drawn["where 1 % is lost"].get_xdata() if "where 1 % is lost" in drawn else []
            for x in marks[name]:
                swing = self.swing(name, x)
                self.assertAlmostEqual(swing["speed"].iloc[-1], least, places=5)
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
            self.assertIn(f" mm shorter or {round(1000 * length.longer, 4):.3g} mm longer ({name} <= {most} m)",
                          axes.get_title().replace("\n", " "))

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
            patch = drawn["deviation of up to 10 mm"]  # a polygon or, since Matplotlib 3.9, a rectangle
            band = patch.get_patch_transform().transform(patch.get_path().vertices)[:, 0]
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
        axes = self.figure(*self.fastest()).axes[0]
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
            self.assertEqual(" ".join(axes.get_title().split()), " ".join([
                f"{name} = {length.value:.7f} m", f"within 1 %: {round(1000 * length.shorter, 4):.3g} mm shorter{bound}",
                "or 0 mm longer (peak-beam-stress <= 60 MPa)"]))
            self.assertTrue(axes.get_xlabel().replace("\n", " ").endswith(f" {name} (m)"))
        self.assertEqual(figure.axes[0].get_ylabel().replace("\n", " "), "speed of the projectile at release (m/s)")

    def test_a_constraint_on_a_formula_is_named_but_not_drawn(self):
        texts = ["r1 + r2 <= 1.3", "peak-axle-load / counterweight-mass <= 40"]
        formulas = [neighbourhood.read_constraint(text, ["peak-axle-load"]) for text in texts]
        self.assertEqual([constraint.field for constraint in formulas], [None, None])
        optimum = self.optimum._replace(given_constraints=formulas)
        title = self.figure(optimum, self.archives)._suptitle.get_text().replace("\n", " ")
        self.assertTrue(title.endswith(f", subject to {texts[0]} m, {texts[1]}"), title)

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
        _, accurate = self.fastest()
        for name in neighbourhood.PANELS:
            np.testing.assert_allclose(archives[name].data["speed"], accurate[name].data["speed"], rtol=1e-8)

    def test_neighbourhoods_are_drawn(self):
        laboratory = self.write("laboratory.cfg", LABORATORY)
        long = self.write("a_long_name_of_a_job_" * 8 + ".cfg", "")
        for job, *options in ((laboratory, "--optimum.objective", "range"),
                              (long, *self.WEAK), (self.JOB, "--lattice.r1", "0.55")):
            self.run_script("neighbourhood", job, "-o", "n.png", "--program", PROGRAM, "--", *options)
            self.assert_picture("n.png")
        self.run_script("neighbourhood", laboratory, "--program", PROGRAM)
        self.assert_picture("laboratory-neighbourhood.png")

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
                self.run_script("neighbourhood", *program, *arguments, code=code, says=words)
        self.assertEqual(self.read("job"), b"[scene]\n")


if __name__ == "__main__":
    unittest.main()
