"""`trebsweep sweep`: its maps, its archive in common tools, and its progress."""

import json
import os
import re
import unittest

import numpy as np

from archives import differences, h5py
from commands import COARSE, KERNELS, SMALL_ASSESSMENT, CommandTest, wide_kernels
from support import JOBS


class AccurateByDefault(CommandTest):
    TABLETOP = ("[scene]\nfulcrum-height = 0.3\nrelease-height = 0.4\ncounterweight-mass = 2\n"
                "projectile-mass = 0.02\nbeam-side = 0.01\nbeam-density = 700\n"
                "[lattice]\nincrement = 0.02\nshortest-sling = 0.06\n")

    def test_the_default_solver_is_accurate_to_1e_7(self):
        job = self.write("tabletop.cfg", self.TABLETOP)
        self.run_program("sweep", job, "--output.fields", "speed, speed-error, status")
        with h5py.File(self.path("tabletop.h5")) as file:
            self.assertLess(np.nanmax(np.abs(file["speed_error"][...])), 1e-7)

    def test_a_counterweight_that_cannot_lift_the_projectile_gives_no_release(self):
        # The paper's Euler method reports releases at up to thousands of metres per second.
        job = self.write("heavy.cfg", "[scene]\nprojectile-mass = 1e8\n[lattice]\nincrement = 0.1\n")
        self.assertIn("optimum   none: nothing was released", self.run_program("sweep", job).stdout)


class Scale(CommandTest):
    def test_an_axis_of_millions_of_values_makes_progress_within_seconds(self):
        command = ["sweep", self.job, "--lattice.r1", "0.6", "--lattice.r3", "0.58", "--lattice.r2", "0.1:0.9999999:1e-7",
                   "--solver.stepper", "fehlberg78"]
        done, limit = 0, 4
        while not os.path.exists(self.path("job.h5")):
            run = self.run_program(*command, "--time-limit", str(limit), ranks=2, code=None)
            self.assertIn(run.returncode, (0, 75), run.stderr)
            if run.returncode == 75:
                before, stopped = done, re.search(r"stopped with (\d+) designs done", run.stderr)
                done = int(stopped.group(1)) if stopped else 0
                if done == before:  # other processes share the machine
                    limit *= 2
                    self.assertLess(limit, 60)


class DryRun(CommandTest):
    """What a sweep will cost, and what it would refuse, without a file written."""

    def cost(self, *arguments, ranks=None, code=0):
        before = sorted(os.walk(self.directory))
        done = self.run_program("sweep", *arguments, "--dry-run", "--json", ranks=ranks, code=code)
        self.assertEqual(sorted(os.walk(self.directory)), before)
        return json.loads(done.stdout), done.stderr

    def test_the_predicted_core_seconds_are_those_of_a_sweep_within_a_factor_of_two(self):
        # In processor time: others use the machine as well.
        for job in (["lab.cfg"], ["paper.cfg", "--lattice.increment", "0.1", "--scene.projectile-mass", "50:200:50",
                                  "--scene.fulcrum-height", "1.3:1.6:0.1", "--solver.release", "crossing",
                                  "--solver.stepper", "rosenbrock4"]):
            arguments = (os.path.join(JOBS, job[0]), *job[1:], "-o", "cost.h5", "--solver.check", "no", "--overwrite")
            cost, _ = self.cost(*arguments)
            start = os.times()
            summary = json.loads(self.run_program("sweep", *arguments, "--json", "--progress", "none").stdout)
            end = os.times()
            spent = end.children_user + end.children_system - start.children_user - start.children_system
            predicted = cost["design_core_seconds"]
            self.assertGreater(spent, 0.5)
            self.assertLess(predicted, 2 * min(spent, summary["integration_seconds"]))
            self.assertGreater(predicted, spent / 2)
            self.assertEqual(cost["designs"], summary["designs"])
            tiles = json.loads(self.run_program("info", "cost.h5", "--json").stdout)["tiles"]
            self.assertEqual(cost["tiles"], tiles)
            size = os.path.getsize(self.path("cost.h5"))
            self.assertLess(abs(cost["archive_bytes"] - size), 0.01 * size + 200_000)

    def test_it_says_what_a_sweep_would_continue_or_refuse(self):
        coarse = (self.job, "--lattice.increment", "0.05")
        self.run_program("sweep", *coarse, "--time-limit", "1e-6", code=75)
        cost, _ = self.cost(*coarse, ranks=2)
        self.assertEqual((cost["refused"], cost["ranks"]), (None, 2))
        self.assertLess(cost["designs_done"], cost["designs"])
        other = (*coarse, "--scene.gravity", "9")
        cost, message = self.cost(*other, code=2)
        self.assertEqual(message, self.run_program("sweep", *other, code=2).stderr)
        self.assertIn("holds an unfinished sweep of another job", cost["refused"])
        self.run_program("sweep", *coarse)
        cost, _ = self.cost(*coarse)
        self.assertEqual((cost["designs_done"], cost["seconds"]), (cost["designs"], 0))
        cost, message = self.cost(*other, code=2)
        self.assertIn("holds the archive of another job", message)
        text = self.run_program("sweep", *coarse, "--dry-run").stdout
        self.assertRegex(text, r"\ndesigns   \d+ in 1 scene, all of them done\ntiles     \d+ of up to")

    def test_a_search_and_an_assessment_have_a_dry_run(self):
        before = os.listdir(self.directory)
        for command in (["optimum"], ["assess", *SMALL_ASSESSMENT]):
            cost = json.loads(self.run_program(*command[:1], self.job, *command[1:], "--dry-run", "--json").stdout)
            self.assertGreater(cost["seconds"], 0)
        self.assertEqual(os.listdir(self.directory), before)


class Json(CommandTest):
    def test_the_summary_and_info_give_the_numbers_of_the_archive(self):
        study = (self.job, *COARSE, "--scene.projectile-mass", "50, 100", "--json")
        done = self.run_program("sweep", *study, "--progress", "none", ranks=2)
        swept = json.loads(done.stdout)
        info = json.loads(self.run_program("info", "job.h5", "--json").stdout)
        with h5py.File(self.path("job.h5")) as file:
            for found in (swept, info):
                self.assertEqual([found["optimum"][name] for name in ("value", "r1", "r3", "r2")],
                                 [file.attrs[f"best_{name}"] for name in ("value", "r1", "r3", "r2")])
                self.assertEqual([scene["value"] for scene in found["scenes"]], list(file["best_value"][...]))
                self.assertEqual(found["error"]["largest"], file.attrs["error_largest"])
                self.assertEqual(found["statuses"], {"released": found["designs"]})
        self.assertEqual(swept["optimum"]["scene"], {"projectile-mass": 50})
        self.assertEqual((swept["ranks"], swept["complete"], info["tiles_done"]), (2, True, info["tiles"]))
        self.assertEqual(["warning: " + text for text in swept["warnings"]], done.stderr.splitlines())
        again = json.loads(self.run_program("sweep", *study).stdout)
        self.assertEqual(again["optimum"], swept["optimum"])


class Sweep(CommandTest):
    def test_maps_are_bitwise_the_same_on_any_number_of_ranks(self):
        for ranks in (1, 5, 16):
            self.run_program("sweep", self.job, *COARSE, "--output.file", f"{ranks}.h5", ranks=ranks)
            self.assertEqual(differences(self.path("1.h5"), self.path(f"{ranks}.h5")), [], ranks)

    def test_maps_are_bitwise_the_same_with_avx2_and_avx512(self):
        if not wide_kernels():
            self.skipTest("this machine, or this build, lacks AVX-512")
        for stepper in ("euler", "rk4", "cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"):
            maps = []
            for level, name in (("x86-64-v3", "AVX2"), ("x86-64-v4", "AVX-512")):
                environment = {"LD_LIBRARY_PATH": os.path.join(KERNELS, level)}
                self.assertIn(name, self.run_program("--version", environment=environment).stdout)
                self.run_program("sweep", self.job, *COARSE, "--solver.stepper", stepper,
                                 "--output.file", "map.h5", "--overwrite", environment=environment)
                with h5py.File(self.path("map.h5")) as archive:
                    maps.append([archive[field][...].tobytes()
                                 for field in ("speed", "release_time", "status")])
            self.assertEqual(maps[0], maps[1])

    def test_effects_and_fields_are_bitwise_the_same_with_avx2_and_avx512_and_on_ranks(self):
        levels = ["x86-64-v3", "x86-64-v4"] if wide_kernels() else [""]
        fields = ["speed", "status", "slack", "range", "energy-drift", "peak-sling-tension",
                  "peak-beam-stress", "efficiency", "steps"]
        for scene in ("friction", "heavy_sling", "elastic_sling"):
            maps = []
            for level in levels:
                for ranks in (1, 2):
                    self.run_program(
                        "sweep", self.job, *COARSE, "--solver.stepper", "fehlberg78",
                        "--scene.file", os.path.join(JOBS, "scenes", f"{scene}.cfg"),
                        "--output.fields", ", ".join(fields), "--output.file", "map.h5",
                        "--overwrite", ranks=ranks,
                        environment={"LD_LIBRARY_PATH": os.path.join(KERNELS, level)})
                    with h5py.File(self.path("map.h5")) as archive:
                        maps.append([archive[field.replace("-", "_")][...].tobytes()
                                     for field in fields])
                        drift = archive["energy_drift"][...]
                        self.assertLess(np.nanmax(abs(drift)), 1e-6)
                        self.assertTrue({0, 1} <= set(np.unique(archive["slack"])) <= {0, 1, 2})
            for other in maps[1:]:
                self.assertEqual(maps[0], other)

    def test_the_optimum_can_be_limited_to_taut_slings(self):
        arguments = (*COARSE, "--scene.sling-angle", "1.5", "--solver.stepper", "fehlberg78")
        self.run_program("sweep", self.job, *arguments, "--output.fields", "speed, slack",
                         "--output.file", "all.h5")
        self.run_program("sweep", self.job, *arguments, "--output.optimum", "taut", "--output.file", "taut.h5")
        with h5py.File(self.path("all.h5")) as archive, h5py.File(self.path("taut.h5")) as taut:
            slack, speed = archive["slack"][...], archive["speed"][...]
            self.assertTrue((slack == 2).any() and (slack == 1).any())
            self.assertEqual(taut.attrs["best_speed"], speed[slack == 1].max())

    def test_the_optimum_has_the_largest_objective_of_the_designs_that_satisfy_the_constraints(self):
        scene = ("--lattice.increment", "0.05", "--solver.stepper", "vern8", "--lattice.shortest-sling", "0.2")
        fields = ("speed", "range", "efficiency", "sling-angle", "pin-angle", "arm-rate", "peak-axle-load",
                  "least-sling-tension", "slack")
        self.run_program("sweep", self.job, *scene, "--output.fields", ", ".join(fields), "--output.file", "all.h5")
        with h5py.File(self.path("all.h5")) as archive:
            maps = {field: archive[field.replace("-", "_")][...] for field in fields}
            axes = [archive[name][...] for name in ("r1", "r3", "r2")]
        angle, load = (float(np.nanmedian(maps[field])) for field in ("sling-angle", "peak-axle-load"))
        for objective, taut, constraints in (
                ("range", False, ()), ("efficiency", False, ()), ("sling-angle", False, ()),
                ("pin-angle", False, (("pin-angle", "<=", -0.1),)),
                ("speed", False, (("peak-axle-load", "<=", load),)),
                ("range", True, (("peak-axle-load", "<=", load), ("least-sling-tension", ">=", 100))),
                ("arm-rate", True, ()), ("efficiency", False, (("sling-angle", ">=", angle), ("speed", "<=", 10)))):
            with self.subTest(objective=objective, taut=taut, constraints=constraints):
                allowed = np.isfinite(maps[objective])
                for field, sign, limit in constraints:
                    allowed &= maps[field] <= limit if sign == "<=" else maps[field] >= limit
                if taut:
                    allowed &= maps["slack"] == 1
                self.assertTrue(allowed.any() and not allowed.all())
                index = np.unravel_index(np.where(allowed, maps[objective], -np.inf).argmax(), allowed.shape)
                expected = [maps[objective][index], maps["speed"][index], *(axis[i] for axis, i in zip(axes, index))]
                for ranks in (1, 3):
                    done = self.run_program(
                        "sweep", self.job, *scene, "--output.file", "best.h5", "--overwrite", "--optimum.objective",
                        objective, "--output.optimum", "taut" if taut else "all", "--optimum.subject-to",
                        ", ".join(f"{field} {sign} {limit!r}" for field, sign, limit in constraints), ranks=ranks)
                    with h5py.File(self.path("best.h5")) as best:
                        self.assertEqual([best.attrs[f"best_{name}"] for name in ("value", "speed", "r1", "r3", "r2")],
                                         expected)
                        self.assertEqual(best.attrs["objective"], objective)
                        self.assertEqual(best["speed"][...].tobytes(), maps["speed"].tobytes())
                        self.assertEqual(sorted(name for name, item in best.items() if item.shape == allowed.shape),
                                         ["release_time", "speed", "status"])
                    line = re.search("optimum .*", done.stdout).group()
                    self.assertIn(line, self.run_program("info", "best.h5").stdout)
                    self.assertEqual("subject to" in line, bool(constraints))

    def test_constraints_that_no_design_satisfies_leave_no_optimum(self):
        done = self.run_program("sweep", self.job, *COARSE, "--optimum.subject-to", "speed >= 100")
        text = "optimum   none: no released design satisfies the constraints"
        self.assertIn(text, done.stdout)
        self.assertIn(text, self.run_program("info", "job.h5").stdout)
        with h5py.File(self.path("job.h5")) as file:
            self.assertTrue(all(np.isnan(value) for name, value in file.attrs.items() if name.startswith("best_")))
            self.assertTrue(np.isnan(file.attrs["error_at_optimum"]) and file.attrs["error_designs"] > 0)

    def test_an_archive_opens_in_xarray(self):
        import xarray as xr  # slow to import, and used by two tests only
        self.run_program("sweep", self.job, *COARSE, ranks=2)
        for engine in ("netcdf4", "h5netcdf"):
            with xr.open_dataset(self.path("job.h5"), engine=engine) as data:
                self.assertEqual(data.speed.dims, ("r1", "r3", "r2"))
                self.assertEqual([data[axis].units for axis in ("r1", "r3", "r2")], ["m"] * 3)
                self.assertEqual(data.speed.units, "m s-1")
                self.assertEqual(data.release_time.units, "s")
                self.assertEqual(data.speed.ancillary_variables, "status")
                self.assertEqual(data.status.dtype, np.uint8)
                flags = dict(zip(data.status.flag_meanings.split(), data.status.flag_values))
                released = data.status == flags["released"]
                self.assertTrue((released == data.speed.notnull()).all())
                self.assertTrue(((data.status == flags["outside_lattice"])
                                 == (data.r2 > 1.5 - data.r3 - 1e-6)).all())
                best = data.speed.sel(r1=data.best_r1, r3=data.best_r3, r2=data.best_r2)
                self.assertEqual(float(best), data.best_speed)
                self.assertEqual(float(data.speed.max()), data.best_speed)
                self.assertTrue(data.tile_designs.any("tile_designs_column").all())

    def test_an_archive_records_its_origin(self):
        self.run_program("sweep", self.job, *COARSE, "--scene.gravity", "9.81")
        with h5py.File(self.path("job.h5")) as file:
            attributes = dict(file.attrs)
        self.assertEqual(attributes["Conventions"], "CF-1.10")
        self.assertEqual(attributes["format_version"], 1)
        self.assertEqual((attributes["objective"], attributes["objective_units"]), ("speed", "m s-1"))
        self.assertRegex(attributes["source"], r"^trebsweep \d")
        self.assertIn("--scene.gravity 9.81", attributes["history"])
        self.assertIn("gravity = 9.81\n", attributes["job"])
        self.assertGreaterEqual(attributes["sweep_seconds"], attributes["integration_seconds"])

    def test_the_stored_job_reproduces_the_maps(self):
        self.run_program("sweep", self.job, *COARSE, "--scene.projectile-mass", "55")
        with h5py.File(self.path("job.h5")) as file:
            again = self.write("again.cfg", file.attrs["job"])
        self.run_program("sweep", again, "--output.file", "again.h5")
        self.assertEqual(differences(self.path("again.h5"), self.path("job.h5")), [])

    def test_compression_and_float32_keep_the_values(self):
        self.run_program("sweep", self.job, *COARSE)
        self.run_program("sweep", self.job, *COARSE, "--output.compression", "5",
                         "--output.storage", "float32", "--output.file", "small.h5", ranks=2)
        with h5py.File(self.path("job.h5")) as plain, h5py.File(self.path("small.h5")) as small:
            self.assertEqual(small["speed"].dtype, np.float32)
            self.assertEqual(small["speed"].compression, "gzip")
            self.assertTrue(small["speed"].shuffle)
            np.testing.assert_array_equal(small["speed"][...],
                                          plain["speed"][...].astype(np.float32))
            np.testing.assert_array_equal(small["status"][...], plain["status"][...])

    def test_progress_goes_to_stderr_in_the_chosen_style(self):
        done = self.run_program("sweep", self.job, *COARSE, "--progress", "bar")
        self.assertIn("100 %", done.stderr)
        self.assertNotIn("left", done.stdout)
        done = self.run_program("sweep", self.job, *COARSE, "--progress", "none", "--overwrite")
        self.assertNotIn("%", done.stderr.replace("within 5 %", ""))


if __name__ == "__main__":
    unittest.main()
