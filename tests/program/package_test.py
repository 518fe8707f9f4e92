"""The Python package trebsweep: archives as datasets, sweeps, optima and swings from Python, installation, types."""

import contextlib
import importlib.util
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import unittest
import unittest.mock

import numpy as np
import pandas
import xarray

from scripts import ANALYSIS, ScriptTest, leave_out
from archives import h5py
from support import JOBS, PROGRAM, REPOSITORY
import trebsweep
from trebsweep import accessor
from trebsweep.backend import AXES
from trebsweep.picture import WIDTH, plt, width

FIELDS = ("--output.fields", "speed, release-time, status, slack, peak-axle-load")


class Datasets(ScriptTest):
    MASSES = (50, 100)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", *FIELDS, "--scene.projectile-mass", ", ".join(map(str, cls.MASSES)), name="study",
                  increment="0.1")
        for mass in cls.MASSES:
            cls.sweep("accurate", *FIELDS, "--scene.projectile-mass", str(mass), name=f"mass{mass}", increment="0.1")

    def open(self, name):
        data = trebsweep.open(self.path(name))
        self.addCleanup(data.close)
        return data

    def table(self, name):
        """All designs of an archive with a speed, read with h5py: a DataFrame."""
        with h5py.File(self.path(name)) as file:
            names = [axis for axis in ("projectile_mass", *AXES) if axis in file]
            axes = dict(zip(names, np.meshgrid(*(file[axis][...] for axis in names), indexing="ij")))
            maps = {field: file[field][...] for field in ("speed", "release_time", "peak_axle_load", "status", "slack")}
            return pandas.DataFrame({key: np.ravel(values) for key, values in {**axes, **maps}.items()}).dropna()

    def test_a_dataset_holds_the_file_with_units_and_flags_and_reads_maps_when_used(self):
        data = self.open("study.h5")
        with h5py.File(self.path("study.h5")) as file:
            for name in ("speed", "status", "best_value", *AXES, "projectile_mass"):
                np.testing.assert_array_equal(data[name], file[name])
            self.assertEqual(data.speed.dims, ("projectile_mass", *AXES))
            np.testing.assert_array_equal(data.treb.designs(), file["status"][...] > 0)
        self.assertEqual(data.speed.attrs["units"], "m s-1")
        self.assertIn("released", data.status.attrs["flag_meanings"])
        self.assertFalse(trebsweep.open(self.path("study.h5"))._variables["speed"]._in_memory)

    def test_cells_that_are_not_done_are_blank(self):
        shutil.copy(self.sweep("accurate", name="whole"), self.path("partial.h5"))
        undone = leave_out(self.path("partial.h5"), 2, junk=99)
        data, whole = self.open("partial.h5"), self.open("whole.h5")
        speed = whole.speed.values.copy()
        for tile in undone:
            speed[tile] = np.nan
        np.testing.assert_array_equal(data.speed, speed)
        for where in ((3, slice(None), 5), ([1, 5, 3], slice(None, None, 2), slice(2, 9)), (slice(None), [0, 5], 0)):
            np.testing.assert_array_equal(data.speed.isel(dict(zip(AXES, where))), xarray.DataArray(
                speed, dims=AXES).isel(dict(zip(AXES, where))))
        self.assertFalse(data.treb.complete)

    def test_the_best_designs_are_those_of_all_scenes(self):
        rows = self.table("study.h5").nlargest(7, "speed").reset_index(drop=True)
        best = self.open("study.h5").treb.best(7)
        for name in ("projectile_mass", *AXES, "speed", "release_time", "peak_axle_load"):
            np.testing.assert_array_equal(best[name], rows[name])
        self.assertEqual(list(best.status), ["released"] * 7)
        rows = self.table("mass50.h5").query("r2 < 0.6 and slack == 1").eval("x = speed / r2").nlargest(3, "x")
        best = self.open("mass50.h5").treb.best(3, "speed / r2", where="(r2 < 0.6) & (slack == 1)")
        np.testing.assert_allclose(best["speed / r2"], rows.x)
        self.assertEqual(len(self.open("mass50.h5").treb.best(3, where="r1 > 99")), 0)
        with self.assertRaisesRegex(trebsweep.Error, "where = mass > 1: mass must be one of"):
            self.open("mass50.h5").treb.best(where="mass > 1")

    def test_the_best_designs_do_not_depend_on_the_size_of_the_parts(self):
        data = self.open("study.h5")
        for most, block in ((1, 5), (500, 4)):
            with unittest.mock.patch.multiple(accessor, MOST=most, BLOCK=block):
                parts = data.treb.best(20, "-peak-axle-load"), data.treb.pareto("speed", "-peak_axle_load")
            pandas.testing.assert_frame_equal(parts[0], data.treb.best(20, "-peak-axle-load"))
            pandas.testing.assert_frame_equal(parts[1], data.treb.pareto("speed", "-peak_axle_load"))

    def test_no_design_beats_one_of_the_front_and_all_others_are_beaten(self):
        rows, front = self.table("study.h5"), self.open("study.h5").treb.pareto("speed", "-peak_axle_load")
        speed, load = rows.speed.to_numpy(), rows.peak_axle_load.to_numpy()
        beaten = [((speed >= s) & (load <= p) & ((speed > s) | (load < p))).any() for s, p in zip(speed, load)]
        want = rows[~np.array(beaten)].sort_values("speed", ascending=False)
        np.testing.assert_array_equal(front.speed, want.speed)
        np.testing.assert_array_equal(front.peak_axle_load, want.peak_axle_load)

    def test_planes_designs_tables_scene_and_job_are_those_of_the_archive(self):
        data = self.open("mass50.h5")
        r1, r3, r2 = (float(data[axis][3]) for axis in AXES)
        np.testing.assert_array_equal(data.treb.plane("speed", r3=r3), data.speed.values[:, 3])
        with self.assertRaisesRegex(trebsweep.Error, "r3 = 0.123: must be a value of the axis"):
            data.treb.plane("speed", r3=0.123)
        self.assertEqual(data.treb.at(r1=r1 + 0.001, r3=r3, r2=r2)["speed"], data.speed.values[3, 3, 3])
        with self.assertRaisesRegex(trebsweep.Error, "must have one value of each of r1, r3, r2"):
            data.treb.at(r1=r1)
        table = pandas.read_csv(io.StringIO(data.treb.to_csv()))
        self.assertEqual(len(table), int(data.treb.designs().sum()))
        pandas.testing.assert_frame_equal(table.dropna()[[*AXES, "speed"]].reset_index(drop=True),
                                          self.table("mass50.h5")[[*AXES, "speed"]].reset_index(drop=True))
        self.assertEqual(data.treb.scene["projectile_mass"], 50)
        self.assertIn("projectile-mass = 50\n", data.treb.job)
        study = self.open("study.h5").sel(projectile_mass=100)
        self.assertIn("projectile-mass = 100\n", study.treb.job)
        self.assertIn("study, projectile-mass = 100 kg", study.treb.heatmap()._suptitle.get_text())

    def test_archives_that_xarray_has_joined_are_drawn_as_one(self):
        parts = [self.open(f"mass{mass}.h5") for mass in self.MASSES]
        masses = pandas.Index([50.0, 100.0], name="projectile_mass")
        with h5py.File(self.path("study.h5")) as file:
            want = file["best_value"][...]
        merged = xarray.merge([parts[0][["speed", "status"]], parts[1][["release_time"]]], compat="override",
                              combine_attrs="override")
        merged.to_netcdf(self.path("merged.h5"), engine="h5netcdf")
        raw = xarray.concat([xarray.open_dataset(self.path(f"mass{mass}.h5"), engine="h5netcdf")
                             for mass in self.MASSES], masses, combine_attrs="override")
        raw.to_netcdf(self.path("raw.h5"), engine="h5netcdf")
        xarray.concat(parts, masses, combine_attrs="override").to_netcdf(self.path("joined.h5"), engine="h5netcdf")
        for name in ("joined.h5", "raw.h5"):
            data = self.open(name)
            np.testing.assert_allclose(data.treb.optima()["value"], want)
            np.testing.assert_array_equal(data.treb.best(3).speed, self.open("study.h5").treb.best(3).speed)
            self.run_script("heatmap", name, "--at", "projectile-mass=100", "-o", "joined.png")
            self.assert_picture("joined.png")
            for command in (("study", name), ("importance", name), ("rules", name, "--rule", "r1 < r2"),
                            ("optimum", name, "--at", "projectile-mass=50"),
                            ("compare", name, "mass50.h5", "--at", "projectile-mass=50")):
                self.run_script(*command)
        self.run_script("heatmap", "merged.h5", "-o", "merged.png")

    def test_a_histogram_and_a_front_are_of_all_designs(self):
        values = self.table("study.h5").eval("x = speed / r2").query("slack == 1")
        done = self.run_script("histogram", "study.h5", "--field", "speed / r2", "--among", "slack == 1", "--log")
        self.assertTrue(done.stdout.startswith(f"{len(values)} designs: least {values.x.min():.6g}, quartiles "
                                               f"{values.x.quantile(0.25):.6g}, {values.x.median():.6g}"), done.stdout)
        self.assert_picture("study-histogram.png")
        done = self.run_script("pareto", "study.h5", "--field", "speed, -peak-axle-load", "-o", "front.png")
        self.assertEqual(len(done.stdout.splitlines()),
                         len(self.open("study.h5").treb.pareto("speed", "-peak_axle_load")) + 2)
        self.assert_picture("front.png")
        self.run_script("pareto", "study.h5", code=2, says="field = None: must be two fields")

    @unittest.skipUnless(importlib.util.find_spec("dask"), "needs python3-dask")
    def test_dask_reads_maps_in_parts(self):
        data = trebsweep.open(self.path("study.h5"), chunks={})
        self.assertIsNotNone(data.speed.chunks)
        self.assertEqual(float(data.speed.max()), float(self.open("study.h5").speed.max()))


class Pages(ScriptTest):
    def test_pictures_are_as_wide_as_asked_with_text_of_8_points(self):
        self.sweep("accurate", *FIELDS, name="a", increment="0.1")
        self.sweep("accurate", "--scene.projectile-mass", "50, 100, 200", name="s", increment="0.1")
        self.trace()
        drawn = []
        save = unittest.mock.patch.object(plt.Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
        for name, *words in (("heatmap", "a.h5"), ("compare", "a.h5", "a.h5"), ("study", "s.h5"),
                             ("importance", "s.h5"), ("heatmap", "s.h5", "--over", "projectile-mass"),
                             ("histogram", "a.h5"), ("loads", "a.h5", "--program", PROGRAM), ("machine",),
                             ("trajectory", "table.txt"), ("trajectory", "table.txt", "--phase"),
                             ("rules", "s.h5", "--rule", "r1 < r2", "--rule", "r1 > 0.6"),
                             ("pareto", "a.h5", "--field", "speed, -peak-axle-load")):
            for option, inches in (((), 17 / 2.54), (("--width", "25"), 25 / 2.54)):
                arguments = [self.path(word) if word.endswith((".h5", ".txt")) else word for word in words]
                arguments += [*option, "-o", self.path("page.png")]
                width[0] = WIDTH  # as in a new process
                with self.subTest(name=name, words=words), save, \
                        unittest.mock.patch("sys.argv", [name, *arguments]), \
                        contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                    importlib.import_module(f"trebsweep.{name}").main()
                    self.assertAlmostEqual(drawn[-1].get_figwidth(), inches)
                    sizes = [text.get_fontsize() for text in drawn[-1].findobj(plt.Text) if text.get_text()]
                    self.assertGreaterEqual(min(sizes), 8)
        width[0] = WIDTH


class Runs(ScriptTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.enterClassContext(unittest.mock.patch.dict(os.environ, TREBSWEEP=PROGRAM))

    def test_a_sweep_from_python_is_that_of_the_command(self):
        data = trebsweep.run(f"{JOBS}/accurate.cfg", increment=0.1, projectile_mass=[50, 100],
                             output_file=self.path("run.h5"))
        with h5py.File(self.sweep("accurate", "--scene.projectile-mass", "50, 100", increment="0.1")) as file:
            np.testing.assert_array_equal(data.speed, file["speed"])

    def test_a_text_is_a_job_and_a_key_of_two_sections_needs_its_section(self):
        found = trebsweep.optimum("[scene]\nprojectile-mass = 50\n", increment=0.1)
        self.assertEqual(found.objective, "speed")
        self.assertEqual(found.values["speed"], found.value)
        swing = trebsweep.trace(found.job, found.r1, found.r2, found.r3)
        self.assertAlmostEqual(swing["speed"].iloc[-1], found.value, places=6)
        self.assertAlmostEqual(swing["t"].iloc[-1], found.release_time, places=6)
        self.assertEqual(swing.attrs["units"]["speed"], "m/s")
        self.assertIn("release-time", swing.attrs["comments"])
        for keys, words in (({"mass": 1}, "mass = 1: must be a key of trebsweep optimum"),
                            ({"projectile_mass": -1}, "projectile-mass")):
            with self.assertRaisesRegex(trebsweep.Error, words) as refusal:
                trebsweep.optimum(f"{JOBS}/accurate.cfg", **keys)
            self.assertEqual(refusal.exception.code, 2)
        with self.assertRaisesRegex(trebsweep.Error, "one of scene.file, output.file"):
            trebsweep.run(f"{JOBS}/accurate.cfg", file="x.h5")

    def test_units_are_known_for_every_column_of_a_trace(self):
        for swing in (trebsweep.trace(f"{JOBS}/lab.cfg", 0.25, 0.975, 0.87),
                      trebsweep.trace(f"{JOBS}/lab.cfg", 0.25, 0.975, 0.87, flight=True)):
            self.assertEqual(list(swing.attrs["units"]), list(swing.columns))


class Documents(ScriptTest):
    """The examples of README.md and analysis/README.md, as they are written there."""

    def blocks(self, language):
        for page in ("README.md", "analysis/README.md"):
            with open(os.path.join(REPOSITORY, page), encoding="utf-8") as file:
                yield from re.findall(rf"```{language}\n(.*?)```", file.read(), re.DOTALL)

    def test_python_examples_run(self):
        self.sweep("accurate", increment="0.01")
        self.sweep("accurate", "--scene.projectile-mass", "50, 100", "--scene.fulcrum-height", "1.5, 2", name="study")
        blocks = list(self.blocks("python"))
        self.assertGreaterEqual(len(blocks), 2)
        for block in blocks:
            before = os.getcwd()
            os.chdir(self.directory)
            try:
                exec(block, {"xarray": xarray})  # pylint: disable=exec-used
            finally:
                os.chdir(before)
                plt.close("all")

    def test_options_of_treb_plot_exist(self):
        lines = [line for block in self.blocks("sh") for line in block.replace("\\\n", " ").splitlines()
                 if line.startswith("analysis/treb-plot ")]
        self.assertGreaterEqual(len(lines), 6)
        for line in lines:
            words = shlex.split(line, comments=True)[1:]
            words = words[:words.index("--")] if "--" in words else words
            usage = self.run_script(words[0], "--help").stdout
            for option in words[1:]:
                if option.startswith("-"):
                    self.assertRegex(usage, rf"(?m)(^|[\s,]){re.escape(option)}(?![\w-])", line)


class Package(ScriptTest):
    def test_it_is_installed_offline_with_the_packages_of_debian(self):
        self.run_command(sys.executable, "-m", "venv", "--system-site-packages", "venv")
        shutil.copytree(ANALYSIS, self.path("analysis"), ignore=shutil.ignore_patterns("explorer", "pictures"))
        self.run_command("venv/bin/pip", "install", "--quiet", "--no-index", "--no-build-isolation", "./analysis")
        done = self.run_command("venv/bin/python", "-I", "-c", "import trebsweep; print(trebsweep.__file__)")
        self.assertIn("/venv/lib/", done.stdout)
        self.assertIn("heatmap", self.run_command("venv/bin/treb-plot", "--help").stdout)
        self.sweep("accurate", name="a", increment="0.1")
        self.run_command("venv/bin/python", "-I", "-c",
                         "import xarray; xarray.open_dataset('a.h5', engine='trebsweep').treb.best()")

    @unittest.skipUnless(shutil.which("mypy"), "needs mypy (Debian: mypy)")
    def test_types_are_right(self):
        subprocess.run(["mypy", "--config-file", f"{ANALYSIS}/pyproject.toml", "--python-executable", sys.executable,
                        "--cache-dir", self.path("mypy"), f"{ANALYSIS}/trebsweep"], check=True, timeout=300)

    @unittest.skipUnless(importlib.util.find_spec("nbclient") and importlib.util.find_spec("ipykernel"),
                         "needs nbclient and ipykernel (Debian: python3-nbclient, python3-ipykernel)")
    def test_the_notebook_runs_and_holds_no_output(self):
        import nbclient
        import nbformat
        notebook = nbformat.read(f"{ANALYSIS}/tour.ipynb", as_version=4)
        self.assertFalse([cell for cell in notebook.cells if cell.get("outputs")])
        os.makedirs(self.path("repository/analysis"), exist_ok=True)
        os.symlink(JOBS, self.path("repository/jobs"))
        os.symlink(f"{ANALYSIS}/trebsweep", self.path("repository/analysis/trebsweep"))
        with unittest.mock.patch.dict(os.environ, TREBSWEEP=PROGRAM, PYTHONDONTWRITEBYTECODE="1"):
            nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources={
                "metadata": {"path": self.path("repository/analysis")}}).execute()


if __name__ == "__main__":
    unittest.main()
