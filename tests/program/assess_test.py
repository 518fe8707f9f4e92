"""`trebsweep assess`."""

import json
import os
import unittest

import h5py
import numpy as np

from commands import COARSE, SMALL_ASSESSMENT, CommandTest
from support import JOBS


class Assess(CommandTest):
    def test_tables_are_printed_and_open_in_xarray(self):
        import xarray as xr  # slow to import, and used by two tests only
        job = self.write("job.cfg", f"[assess]\nscenes = {JOBS}/extreme/long_steps.cfg\n"
                                    f"extremes = {JOBS}/extreme/upright.cfg\n")
        done = self.run_program("assess", job, *SMALL_ASSESSMENT, ranks=2)
        for title in ("References", "Errors of each solver", "Extreme scenes", "Order of convergence",
                      "largest step", "A small oscillation", "whole lattice", "The cheapest solver"):
            self.assertIn(title, done.stdout)
        self.assertIn("not_released", done.stdout)
        for engine in ("netcdf4", "h5netcdf"):
            with xr.open_dataset(self.path("job-assess.h5"), group="accuracy", engine=engine) as data:
                frame = data.to_dataframe()
        self.assertEqual(list(frame.scene.unique()), ["long_steps"])
        dopri5 = frame[frame.stepper == "dopri5"]
        self.assertLess(dopri5.error_largest.iloc[1], 1e-2 * dopri5.error_largest.iloc[0])
        self.assertTrue((frame.seconds > 0).all())
        self.assertEqual(data.error_median.attrs["units"], "m s-1")
        with h5py.File(self.path("job-assess.h5")) as file:
            self.assertIn("time-steps = 0.01, 0.005", file.attrs["job"])
        self.assert_refused(["assess", job, *SMALL_ASSESSMENT], "output.file", "already exists")
        done = self.run_program("assess", job, *SMALL_ASSESSMENT, "--overwrite", "--progress", "none", "--json")
        tables = json.loads(done.stdout)["tables"]
        self.assertEqual(tables["accuracy"]["stepper"], list(frame.stepper))

    def test_scene_options_apply_to_all_scenes(self):
        job = self.write("two.cfg", f"[assess]\nscenes = {JOBS}/extreme/no_beam.cfg\n")
        tables = [self.run_program("assess", job, *SMALL_ASSESSMENT, "--overwrite", *options).stdout
                  for options in ([], ["--scene.gravity", "20"], ["--scene.file", f"{JOBS}/scenes/friction.cfg"])]
        speeds = [table.split("Errors of each")[0] for table in tables]  # the reference speeds
        self.assertEqual(len(set(speeds)), 3)

    def test_sweeps_and_assessments_do_not_replace_each_other(self):
        file, lattice = ("--output.file", "job.h5"), SMALL_ASSESSMENT[-2:]
        self.run_program("assess", self.job, *SMALL_ASSESSMENT, *file)
        self.assert_refused(["sweep", self.job, *lattice], "job.h5", "holds an assessment")
        self.run_program("sweep", self.job, *lattice, "--overwrite")
        done = self.run_program("sweep", self.job, *lattice, ranks=2)
        self.assertIn("complete archive of this job", done.stderr)
        self.assert_refused(["assess", self.job, *SMALL_ASSESSMENT, *file], "job.h5", "already exists")

    def test_the_jobs_own_scene_is_assessed_into_an_archive_of_its_own(self):
        os.symlink("far.h5", self.path("job-assess.h5"))
        done = self.run_program("assess", self.job, *SMALL_ASSESSMENT)
        self.assertIn("scene job", done.stdout)
        self.assertIn("archive   job-assess.h5", done.stdout)
        self.assertEqual(os.readlink(self.path("job-assess.h5")), "far.h5")
        text = self.run_program("info", "job-assess.h5").stdout
        for words in ("job-assess.h5, an assessment", "accuracy", "reference", "source    trebsweep", "[assess]", "assess "):
            self.assertIn(words, text)
        self.run_program("sweep", self.job, *SMALL_ASSESSMENT[-2:])
        self.assertEqual(sorted(os.listdir(self.directory)), ["far.h5", "job-assess.h5", "job.cfg", "job.h5"])

    def test_a_sweep_meets_its_target_error(self):
        job = self.write("target.cfg", "[solver]\nstepper = dopri5\ntarget-error = 1e-5\n")
        done = self.run_program("sweep", job, *COARSE, "--output.fields", "speed, speed-error", ranks=2)
        self.assertIn("tolerance ", done.stderr)
        with h5py.File(self.path("target.h5")) as file:
            self.assertLess(np.nanmax(np.abs(file["speed_error"])), 1e-5)
        self.run_program("sweep", job, *COARSE, "--output.fields", "speed, speed-error")  # already complete


if __name__ == "__main__":
    unittest.main()
