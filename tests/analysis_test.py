"""The pictures and reports of analysis/, from archives and tables made here.

Needs TREBSWEEP (the program) in the environment.
"""

import os
import subprocess
import sys
import tempfile
import unittest

SOURCE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SIGNATURES = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}


class AnalysisTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="trebsweep_")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.sweep("paper")
        cls.sweep("accurate")

    @classmethod
    def sweep(cls, job, *options, name=None):
        archive = os.path.join(cls.folder, f"{name or job}.h5")
        subprocess.run([os.environ["TREBSWEEP"], "sweep", f"{SOURCE}/jobs/{job}.cfg",
                        "--lattice.increment", "0.05", "--output.file", archive, *options],
                       check=True, capture_output=True, timeout=120)
        return archive

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_script(self, script, *arguments, code=0):
        done = subprocess.run([sys.executable, "-B", f"{SOURCE}/analysis/{script}", *arguments],
                              cwd=self.folder, text=True, capture_output=True, timeout=120, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def assert_picture(self, name):
        with open(self.path(name), "rb") as file:
            self.assertTrue(file.read().startswith(SIGNATURES[name.rsplit(".", 1)[1]]))

    def trace(self, *options):
        table = self.path("table.txt")
        with open(table, "w", encoding="utf-8") as file:
            subprocess.run([os.environ["TREBSWEEP"], "trace", f"{SOURCE}/jobs/accurate.cfg", "--r1",
                            "0.51", "--r2", "0.91", "--r3", "0.58", *options], check=True, stdout=file,
                           stderr=subprocess.DEVNULL, timeout=120)
        return table

    def test_an_assessment_with_maps(self):
        maps = self.sweep("paper", "--output.fields", "speed, status, speed-error, stiffness",
                          name="maps")
        subprocess.run([os.environ["TREBSWEEP"], "assess", f"{SOURCE}/jobs/paper.cfg",
                        "--assess.scenes", f"{SOURCE}/jobs/extreme/long_steps.cfg",
                        "--assess.steppers", "euler, dopri5", "--assess.time-steps", "0.01, 0.005",
                        "--assess.tolerances", "1e-5, 1e-7", "--assess.repeats", "1",
                        "--output.file", self.path("assess.h5")],
                       check=True, capture_output=True, timeout=120)
        self.run_script("assess.py", "assess.h5", "--maps", maps)
        for picture in ("precision", "order", "stability", "speed_error", "stiffness"):
            self.assert_picture(f"assess-{picture}.png")
        self.run_script("assess.py", "assess.h5", "--format", "svg", "-o", "other")
        self.assert_picture("other-precision.svg")
        self.run_script("assess.py", "paper.h5", code=1)

    def test_heatmaps_of_every_field_in_every_format(self):
        for field in ("speed", "release-time", "status"):
            self.run_script("heatmap.py", "accurate.h5", "--field", field)
            self.assert_picture(f"accurate-{field}.png")
        archive = self.sweep("accurate", "--output.fields", "speed, slack, peak-beam-stress, range",
                             name="loads")
        for field in ("slack", "peak-beam-stress", "range"):
            self.run_script("heatmap.py", archive, "--field", field)
            self.assert_picture(f"loads-{field}.png")
        for suffix in SIGNATURES:
            self.run_script("heatmap.py", "paper.h5", "--r1", "0.7", "-o", f"map.{suffix}")
            self.assert_picture(f"map.{suffix}")

    def test_loads_of_the_best_designs(self):
        self.run_script("loads.py", "accurate.h5", "--program", os.environ["TREBSWEEP"])
        self.assert_picture("accurate-loads.png")
        self.run_script("loads.py", "accurate.h5", "--count", "0", code=1)

    def test_heatmap_without_an_optimum_and_of_a_single_design(self):
        self.sweep("accurate", "--solver.max-time", "0.01", name="nothing")
        self.run_script("heatmap.py", "nothing.h5")
        self.assert_picture("nothing-speed.png")
        self.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r3", "0.5", "--lattice.r2", "0.9",
                   name="single")
        self.run_script("heatmap.py", "single.h5")
        self.assert_picture("single-speed.png")

    def test_heatmap_draws_the_first_map_where_there_is_no_speed(self):
        self.sweep("accurate", "--output.fields", "status", name="flags")
        self.run_script("heatmap.py", "flags.h5")
        self.assert_picture("flags-status.png")

    def test_comparison_in_numbers_and_as_a_map(self):
        done = self.run_script("compare.py", "paper.h5", "accurate.h5")
        self.assertIn("largest", done.stdout)
        self.assert_picture("paper-accurate.png")
        done = self.run_script("compare.py", "accurate.h5", "accurate.h5", "-o", "same.svg")
        self.assertIn("median 0, 95 % below 0, largest 0 m/s", done.stdout)

    def test_comparison_of_different_lattices_is_refused(self):
        self.sweep("accurate", "--lattice.r1", "0.6:0.7:0.1", name="narrow")
        done = self.run_script("compare.py", "narrow.h5", "accurate.h5", code=1)
        self.assertIn("different lattices: r1", done.stderr)

    def test_trajectory(self):
        self.trace()
        self.run_script("trajectory.py", "table.txt", "-o", "swing.png")
        self.assert_picture("swing.png")

    def test_optimum_as_options_of_trace(self):
        done = self.run_script("optimum.py", "accurate.h5", "--job", "accurate-job.cfg")
        self.assertRegex(done.stdout, r"^--r1 [\d.]+ --r3 [\d.]+ --r2 [\d.]+\n$")
        with open(self.path("accurate-job.cfg"), encoding="utf-8") as file:
            self.assertIn("stepper = fehlberg78\n", file.read())

    def test_what_cannot_be_drawn_is_refused_in_one_line(self):
        for script, arguments, words in (
                ("heatmap.py", ["missing.h5"], "missing.h5"),
                ("heatmap.py", ["accurate.h5", "--field", "mass"], "has no map mass"),
                ("heatmap.py", ["accurate.h5", "-o", "picture.xyz"], "picture.xyz"),
                ("heatmap.py", ["accurate.h5", "--r1", "5"], "r1 = 5: must be from 0.55 to 1.45 m"),
                ("heatmap.py", ["accurate.h5", "--r1", "nan"], "r1 = nan"),
                ("optimum.py", ["accurate.h5", "--job", "no/such/folder.cfg"], "no/such/folder.cfg"),
                ("trajectory.py", ["table.txt", "--count", "-1"], "count = -1"),
                ("compare.py", ["paper.h5", "accurate.h5", "--field", "status"], "flags"),
                ("trajectory.py", ["accurate.h5"], "accurate.h5")):
            with self.subTest(script=script, arguments=arguments):
                done = self.run_script(script, *arguments, code=1)
                self.assertIn(words, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


if __name__ == "__main__":
    unittest.main()
