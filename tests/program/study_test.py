"""Studies: sweeps over scenes. Each slice is the sweep of its scene alone, on any number of ranks, after kills, stops
and damage; bad input is refused with a clear message.

Needs TREBSWEEP (the program) and MPIEXEC in the environment. TREBSWEEP_KILLS and TREBSWEEP_SEED are as for
resume_test.py.
"""

import os
import shutil
import signal
import time
import unittest

import numpy as np

import damage_test
import resume_test
from archives import differences, h5py
from commands import CommandTest
from support import DirectoryTest

AXES = "projectile-mass = 50:200:75\nfulcrum-height = 1.7, 1.4,1.5 , 1.6\n"
MASSES, HEIGHTS = (50, 125, 200), (1.4, 1.5, 1.6, 1.7)
LATTICE = "[lattice]\nincrement = 0.03\n"
OPTIMUM = resume_test.OPTIMUM
NO_MAPS = ("--output.maps", "none", "--optimum.refine", "yes")
QUIET = ("--progress", "none")


class Slices(DirectoryTest):
    """A study of 3 x 4 scenes, study.h5, and the sweeps of each scene alone."""

    FIELDS = ("speed", "range", "slack", "status")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        settings = f"{LATTICE}[output]\nfields = {', '.join(cls.FIELDS)}\n"
        cls.write("study.cfg", f"[scene]\n{AXES}{settings}")
        cls.write("own.cfg", settings)
        cls().run_program("sweep", "study.cfg", *QUIET)

    def own(self, mass, height, *options):
        """The archive of the sweep of one scene."""
        name = f"{mass}_{height}_{len(options)}.h5"
        if not os.path.exists(self.path(name)):
            self.run_program("sweep", "own.cfg", *QUIET, "--scene.projectile-mass", str(mass), "--scene.fulcrum-height",
                             str(height), "--output.file", name, *options)
        return h5py.File(self.path(name))

    def each_scene(self, *options):
        """(index of the scene, archive of its own sweep) of all scenes."""
        for i, mass in enumerate(MASSES):
            for j, height in enumerate(HEIGHTS):
                with self.own(mass, height, *options) as own, self.subTest(mass=mass, height=height):
                    yield (i, j), own

    def assert_optimum(self, study, scene, own):
        for name in OPTIMUM:
            self.assertEqual(study[name][scene], own.attrs[name], name)

    def test_each_slice_is_the_sweep_of_its_scene(self):
        with h5py.File(self.path("study.h5")) as study:
            axes = [study[name][...] for name in ("r1", "r3", "r2")]
            for scene, own in self.each_scene():
                places = [np.searchsorted(axis, own[name]) for axis, name in zip(axes, ("r1", "r3", "r2"))]
                for axis, place, name in zip(axes, places, ("r1", "r3", "r2")):
                    self.assertEqual(axis[place].tobytes(), own[name][...].tobytes())
                inside = np.ix_(*places)
                outside = np.ones(study["status"].shape[2:], bool)
                outside[inside] = False
                self.assertTrue(outside.any())
                for name in self.FIELDS:
                    values = study[name][scene]
                    self.assertEqual(values[inside].tobytes(), own[name][...].tobytes(), name)
                    is_fill = np.isnan if values.dtype.kind == "f" else np.logical_not
                    self.assertTrue(is_fill(values[outside]).all(), name)
                self.assert_optimum(study, scene, own)

    def test_the_best_scene_and_the_counts_are_those_of_all_sweeps(self):
        with h5py.File(self.path("study.h5")) as study:
            best = np.unravel_index(np.argmax(study["best_value"]), study["best_value"].shape)
            designs = steps = 0
            for scene, own in self.each_scene():
                designs += own.attrs["designs"]
                steps += own.attrs["steps"]
                if scene == best:
                    for name in OPTIMUM[:-1]:
                        self.assertEqual(study.attrs[name], own.attrs[name])
            self.assertEqual((study.attrs["designs"], study.attrs["steps"]), (designs, steps))

    def test_it_is_bitwise_the_same_on_any_number_of_ranks_and_compressed(self):
        for ranks, options in ((2, ()), (3, ()), (1, ("--output.compression", "1")), (3, ("--output.compression", "1"))):
            self.run_program("sweep", "study.cfg", *QUIET, "--output.file", "other.h5", "--overwrite", *options, ranks=ranks)
            self.assertEqual(differences(self.path("other.h5"), self.path("study.h5")), [], (ranks, options))

    def test_its_float32_maps_are_the_rounded_ones(self):
        self.run_program("sweep", "study.cfg", *QUIET, "--output.file", "small.h5", "--output.storage", "float32", ranks=2)
        with h5py.File(self.path("small.h5")) as small, h5py.File(self.path("study.h5")) as study:
            for name in self.FIELDS:
                values = study[name][...]
                if values.dtype.kind == "f":
                    values = values.astype(np.float32)
                self.assertEqual(small[name][...].tobytes(), values.tobytes(), name)
            for name in OPTIMUM:
                self.assertEqual(small[name][...].tobytes(), study[name][...].tobytes(), name)

    def test_without_maps_it_has_the_refined_optimum_of_each_sweep_on_any_number_of_ranks(self):
        for ranks in (3, 2, 1):
            sweep = self.run_program("sweep", "study.cfg", *QUIET, *NO_MAPS, "--output.file", f"none{ranks}.h5",
                                     ranks=ranks)
            self.assertEqual(differences(self.path(f"none{ranks}.h5"), self.path("none3.h5")), [])
        with h5py.File(self.path("none1.h5")) as study:
            self.assertEqual([name for name in self.FIELDS if name in study], [])
            for scene, own in self.each_scene(*NO_MAPS[2:]):
                self.assert_optimum(study, scene, own)
        # `info` repeats the summary of the sweep.
        results = sweep.stdout[sweep.stdout.index("designs "):sweep.stdout.index("seconds ")]
        self.assertIn("refined ", results)
        self.assertIn(results, self.run_program("info", "none1.h5").stdout)

    def test_xarray_selects_scenes_by_value(self):
        import xarray as xr  # slow to import
        dimensions = ("projectile_mass", "fulcrum_height", "r1", "r3", "r2")
        with self.own(125, 1.6) as own:
            best = {name: own.attrs[f"best_{name}"] for name in ("value", "r1", "r3", "r2")}
        for engine in ("netcdf4", "h5netcdf"):
            with xr.open_dataset(self.path("study.h5"), engine=engine) as study:
                self.assertEqual(study.speed.dims, dimensions)
                self.assertEqual(study.status.dims, dimensions)
                self.assertEqual(study.best_speed.dims, dimensions[:2])
                self.assertEqual(study.projectile_mass.values.tolist(), list(MASSES))
                self.assertEqual(study.fulcrum_height.values.tolist(), list(HEIGHTS))
                self.assertEqual([study[name].units for name in dimensions], ["kg", "m", "m", "m", "m"])
                self.assertIn("projectile", study.projectile_mass.long_name)
                self.assertIn("fulcrum", study.fulcrum_height.long_name)
                scene = study.sel(projectile_mass=125, fulcrum_height=1.6)
                self.assertEqual(float(scene.best_value), best["value"])
                self.assertEqual(float(scene.speed.max()), best["value"])
                self.assertEqual(float(scene.speed.sel(r1=best["r1"], r3=best["r3"], r2=best["r2"])), best["value"])


class Kills(resume_test.ResumeTest):
    JOB_TEXT = f"[scene]\n{AXES}{LATTICE}{resume_test.JOB}"
    VERSIONS = ((), NO_MAPS)

    def test_a_study_killed_repeatedly_produces_the_same_archive(self):
        self.interrupt(resume_test.kill_all, (), lambda launcher, errors: None)

    def test_a_study_without_maps_killed_repeatedly_produces_the_same_archive(self):
        self.interrupt(resume_test.kill_all, NO_MAPS, lambda launcher, errors: None)


class BadInput(CommandTest):
    """Each is refused with exit code 2, one line that names the key, the value and what is allowed, and no file."""

    DESIGN = ("--r1", "0.6", "--r2", "0.9", "--r3", "0.5")
    TINY = ("--lattice.increment", "0.3")

    def test_more_than_a_million_scenes_are_refused_whatever_the_number_of_axes(self):
        many = "1:1000000:1"
        start = time.time()
        self.assert_refused(["sweep", self.job, "--scene.projectile-mass=1:1001:1", "--scene.fulcrum-height=1:2:0.001"],
                            "scene.fulcrum-height = 1:2:0.001: must be fewer values", "1002001 scenes",
                            "at most 1000000 are allowed")
        keys = ("gravity", "counterweight-mass", "projectile-mass", "release-height", "fulcrum-height", "beam-density", "beam-side",
                "pivot-viscosity", "pivot-friction", "sling-mass", "counterweight-hanger", "projectile-diameter", "wind")
        first_refusal = time.time() - start
        self.assert_refused(["sweep", self.job, *(f"--scene.{key}={many}" for key in keys)],
                            f"scene.counterweight-mass = {many}: must be fewer values", "1000000000000 scenes")
        self.assertLess(time.time() - start, 20 * first_refusal)

    def test_maps_that_do_not_fit_the_disk_are_refused(self):
        study = ["sweep", self.job, "--lattice.increment=0.01", "--output.fields=speed"]
        free = shutil.disk_usage(self.directory).free
        scenes = int(free / 8e6) + 2  # of 1.7 million cells, 3/5 of them in tiles
        self.assertLess(scenes, 1e6)
        self.assert_refused([*study, f"--scene.projectile-mass=1:{scenes}:1"], "output.file = job.h5: needs at least", "available",
                            "output.maps = none")

    def test_scenes_without_a_design_are_named(self):
        for options, words in ((("fulcrum-height=1.6, 1.4", "release-height=2.9"),
                                ("scene.release-height = 2.9 leaves no design", "(in the scene with fulcrum-height = 1.4 m)")),
                               (("fulcrum-height=1.4:1.6:0.1", "release-height=2, 2.9"),
                                ("choose a height below 2.8 m",
                                 "(in the scene with release-height = 2.9 m, fulcrum-height = 1.4 m)")),
                               (("counterweight-hanger=0, 0.2, 1.6",),
                                ("scene.counterweight-hanger = 1.6 leaves no design", "counterweight-hanger = 1.6 m)"))):
            self.assert_refused(["sweep", self.job, *(f"--scene.{option}" for option in options)], *words)

    def test_a_trough_that_is_too_high_is_reported_with_its_scene(self):
        lattice = ("--lattice.r1=0.4", "--lattice.r3=0.9", "--lattice.r2=1.2")
        self.assert_refused(["sweep", self.job, *lattice, "--scene.trough=yes", "--scene.trough-height=0.1, 1.4",
                             "--scene.fulcrum-height=1.3, 1.5"],
                            "scene.trough-height = 1.4: must be below scene.fulcrum-height = 1.3 (in the scene with "
                            "fulcrum-height = 1.3 m, trough-height = 1.4 m)")

    def test_commands_for_one_scene_name_the_key_and_the_remedy(self):
        axes = ("--scene.projectile-mass=50, 60", "--scene.wind=0:3:1", "--scene.projectile-diameter=0.1")
        for command, words in ((["trace", self.job, *self.DESIGN], ("trace integrates one scene",)),
                               (["assess", self.job], ("assess takes one scene",)),
                               (["optimum", self.job], ("--output.maps none", "--optimum.refine yes"))):
            self.assert_refused([*command, *axes], "scene.projectile-mass = 50, 60: must be a single number", *words)


class OddAxes(CommandTest):
    """Odd but valid values."""

    TINY = BadInput.TINY

    def axes(self, *options):
        """{name: values} of the outer axes of a study with a coarse lattice, whose maps hold numbers in each scene."""
        self.run_program("sweep", self.job, *self.TINY, *QUIET, "--overwrite", *options)
        with h5py.File(self.path("job.h5")) as study:
            speed = study["speed"]
            names = [dimension.keys()[0] for dimension in speed.dims][:-3]
            self.assertTrue(np.isfinite(speed[...]).any(axis=(-3, -2, -1)).all())
            return {name: study[name][...].tolist() for name in names}

    def test_values_may_be_negative_or_zero(self):
        self.assertEqual(self.axes("--scene.sling-angle=-0.5:0.5:0.5"), {"sling_angle": [-0.5, 0, 0.5]})
        self.assertEqual(self.axes("--scene.wind=-3, 0, 3", "--scene.projectile-diameter=0, 0.1"),
                         {"projectile_diameter": [0, 0.1], "wind": [-3, 0, 3]})

    def test_optional_keys_are_axes(self):
        self.assertEqual(self.axes("--scene.start-angle=0.5, 0.7"), {"start_angle": [0.5, 0.7]})
        self.assertEqual(self.axes("--scene.beam-mass=5, 6", "--scene.beam-centre=-0.1, 0.4", "--scene.beam-moment=2"),
                         {"beam_mass": [5, 6], "beam_centre": [-0.1, 0.4]})

    def test_effects_that_are_zero_in_some_scenes_leave_the_others_bitwise_the_same(self):
        effects = {"counterweight-hanger": (0, 0.2), "pivot-friction": (0, 10), "sling-mass": (0, 1)}
        self.axes(*(f"--scene.{key}={first}, {second}" for key, (first, second) in effects.items()))
        with h5py.File(self.path("job.h5")) as study:
            for scene in ((0, 0, 0), (1, 0, 1), (1, 1, 1)):
                # In the order of the keys.
                values = {"pivot-friction": scene[0], "sling-mass": scene[1], "counterweight-hanger": scene[2]}
                self.run_program("sweep", self.job, *self.TINY, *QUIET, "--output.file", "own.h5", "--overwrite",
                                 *(f"--scene.{key}={effects[key][i]}" for key, i in values.items()))
                with h5py.File(self.path("own.h5")) as own:
                    places = np.ix_(*(np.searchsorted(study[name], own[name]) for name in ("r1", "r3", "r2")))
                    self.assertEqual(study["speed"][scene][places].tobytes(), own["speed"][...].tobytes())

    def test_the_stored_job_of_a_study_reproduces_it(self):
        self.axes("--scene.projectile-mass=70, 50", "--scene.gravity=9:10:0.5")
        with h5py.File(self.path("job.h5")) as study:
            again = self.write("again.cfg", study.attrs["job"])
        self.run_program("sweep", again, *QUIET, "--output.file", "again.h5")
        self.assertEqual(differences(self.path("again.h5"), self.path("job.h5")), [])

    def test_an_axis_may_have_ten_thousand_values_given_one_by_one(self):
        masses = [i + 0.123456 for i in range(1, 10001)]
        job = self.write("many.cfg", f"[scene]\nprojectile-mass = {', '.join(map(str, masses))}\n")
        done = self.run_program("sweep", job, *self.TINY, *QUIET, "--output.maps=none")
        self.assertIn("scenes    10000", done.stdout)
        with h5py.File(self.path("many.h5")) as study:
            self.assertEqual(study["projectile_mass"][...].tolist(), masses)
            self.assertTrue(np.isfinite(study["best_value"][...]).all())
        self.assertIn("scenes    10000", self.run_program("info", "many.h5").stdout)


class Stops(resume_test.ResumeTest):
    JOB_TEXT = Kills.JOB_TEXT
    VERSIONS = ((), NO_MAPS)

    def continue_with_limits(self, options):
        """Stops a study by its time limit, checks its description, and continues it in slices of time to its end."""
        self.assert_one_message(self.stop_partway(*options), "the same command continues")
        self.assert_sound(options)
        text = self.run_program("info", "job.h5").stdout
        self.assertRegex(text, r"job\.h5\.partial, unfinished, \d+\.\d % of the tiles done; interrupted: run the command")
        self.assertRegex(text, r"lattice +118 x 47 x 46 \(r1 x r3 x r2\), 389028 designs in 12 scenes")
        self.assertRegex(text, r"\nscenes +12")
        self.assertRegex(text, r"\n +(50|125|200) .+ -\n")  # the best so far of a scene has no error
        for _ in range(50):
            launcher = self.launch(2, *options, "--time-limit", f"{self.sweep_seconds[()] / 2:.2f}")
            errors = self.finish(launcher, codes=(0, 75))
            if launcher.returncode == 0:
                break
            self.assert_stopped(launcher, errors)
            self.assert_sound(options)
        self.assert_complete(options)

    def test_a_study_stopped_by_its_time_limit_continues(self):
        self.continue_with_limits(())

    def test_a_study_without_maps_stopped_by_its_time_limit_continues(self):
        self.continue_with_limits(NO_MAPS)

    def test_a_study_stopped_by_sigterm_continues(self):
        def strike(_, ranks):
            for rank in ranks:
                os.kill(rank, signal.SIGTERM)

        self.interrupt(lambda launcher: self.strike_when_up(launcher, strike), (), self.assert_stopped)

    def test_a_study_with_other_values_is_another_job(self):
        self.stop_partway()
        before = self.files()
        for option, there, here in (("--scene.projectile-mass=50:200:50", "50:200:75", "50:200:50"),
                                    ("--scene.projectile-mass=50", "50:200:75", "50"),
                                    ("--scene.fulcrum-height=1.4, 1.5, 1.6, 1.8", "1.4, 1.5, 1.6, 1.7", "1.4, 1.5, 1.6, 1.8"),
                                    ("--scene.gravity=9.8, 9.9", "9.8", "9.8, 9.9"),
                                    ("--output.maps=none", "all", "none"),
                                    ("--solver.check=no", "yes", "no")):  # decides whether optima have an error
            key = option[2:].split("=")[0]
            errors = self.run_sweep(2, option, codes=(2,))
            self.assert_one_message(errors, "job.h5.partial", f"{key} = {there} there, {here} here")
            self.assertEqual(self.files(), before)


class Damage(damage_test.Flips):
    """Flipped bits in a study's maps."""

    JOB_TEXT = f"[scene]\n{AXES}{damage_test.JOB}"
    SCENE = "projectile-mass = 50 kg, fulcrum-height = 1.4 m, "


if __name__ == "__main__":
    unittest.main()
