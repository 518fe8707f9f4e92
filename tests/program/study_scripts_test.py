"""treb-plot study and importance, and every subcommand with a scene of a study."""

import contextlib
import io
import itertools
import json
import os
import shutil
import sys
import unittest

import numpy as np

from scripts import TREB_PLOT, ScriptTest, leave_out
from archives import h5py, tiles
from trebsweep import compare, heatmap, importance, study
from trebsweep.backend import AXES
from trebsweep.job import parse_job
from trebsweep.picture import plt
from trebsweep.scenes import load, select
from support import JOBS, PROGRAM


class StudyTest(ScriptTest):
    """Tests with the archives study.h5, of scenes whose lattices differ, and alone<i>.h5, of these scenes."""

    MASSES = (50.0, 100.0)
    HEIGHTS = (1.5, 1.92, 2.5)  # with r1 = 1.12, ... m, r1 = 0.7, ... m and r1 = 0.12, ... m
    RELEASE = ("--scene.release-height", "2.57")
    MANY_MASSES = (20, 50, 100, 200, 500, 1000)
    ALONE = range(6)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", *cls.RELEASE, "--scene.projectile-mass", "50:100:50",
                  "--scene.fulcrum-height", "1.92, 1.5, 2.5", name="study")
        for i in cls.ALONE:
            mass, height = cls.scenes()[i]
            cls.sweep("accurate", *cls.RELEASE, "--scene.projectile-mass", str(mass), "--scene.fulcrum-height",
                      str(height), name=f"alone{i}")

    @classmethod
    def sweep_masses(cls):
        """Writes masses.h5, of many masses, refined and without maps."""
        cls.sweep("accurate", "--scene.projectile-mass", ", ".join(map(str, cls.MANY_MASSES)),
                  "--output.maps", "none", "--optimum.refine", "yes", name="masses")

    @classmethod
    def scenes(cls):
        return [(mass, height) for mass in cls.MASSES for height in cls.HEIGHTS]

    @staticmethod
    def at(mass, height):
        """A scene of study.h5, as Archive.scene() takes it."""
        return [("projectile-mass", mass), ("fulcrum-height", height)]

    @staticmethod
    def words(at):
        """The same as options."""
        return [word for key, value in at for word in ("--at", f"{key}={value:g}")]

    def figure(self, archive, names=study.DEFAULT):
        """The figure that study.py draws."""
        figure = study.picture(archive, list(names))
        self.addCleanup(plt.close, figure)
        return figure

    def tiles(self):
        """(scene, slices) of each tile of study.h5."""
        with h5py.File(self.path("study.h5")) as file:
            yield from zip(file["tile_block"][:, 0].astype(int).tolist(), tiles(file))

    def make_partial(self, done):
        """Copies study.h5 as partial.h5 with only the first `done` tiles done; returns all tiles."""
        shutil.copy(self.path("study.h5"), self.path("partial.h5"))
        leave_out(self.path("partial.h5"), done, junk=99)
        return list(self.tiles())

    def open_quietly(self, name):
        with contextlib.redirect_stderr(io.StringIO()):
            return select(load(self.path(name)), [])


class ScenesOfStudies(StudyTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep_masses()

    def test_a_scene_reads_as_its_own_archive(self):
        with h5py.File(self.path("study.h5")) as file:  # else this test shows little
            self.assertTrue(set(np.diff(file["r1"][...]).round(3)) >= {0.02, 0.03})
        for i, scene in enumerate(self.scenes()):
            with self.subTest(scene=scene):
                one = load(self.path("study.h5")).only(self.at(*scene))
                alone = load(self.path(f"alone{i}.h5")).only()
                for name in AXES:
                    np.testing.assert_array_equal(one.axes[name], alone.axes[name])
                self.assertEqual(one.fields, alone.fields)
                for field in one.fields:
                    for where in ((slice(None),) * 3, (3, slice(None), 5), (slice(2, 4), 1, slice(None)),
                                  (0, 0, 0)):
                        np.testing.assert_array_equal(one.data[field][where], alone.data[field][where])
                self.assertEqual(one.optimum(), alone.optimum())
                self.assertEqual(one.best_text(), alone.best_text())
                np.testing.assert_array_equal(one.best(3, "-release_time"), alone.best(3, "-release_time"))
                self.assertEqual({**one.keys, ("output", "file"): ""}, {**alone.keys, ("output", "file"): ""})
                self.assertEqual(parse_job(one.job), one.keys)

    def test_scenes_with_explicit_axes_read_as_their_own_archives(self):
        for i, (axis, values) in enumerate((("r2", "0.1:0.8:0.1"), ("r1", "0.6:1.2:0.1"), ("r3", "0.3:1.3:0.1"))):
            lattice = (f"--lattice.{axis}", values, *self.RELEASE, "--scene.fulcrum-height")
            path = self.sweep("accurate", *lattice, "1.5, 2.13", name=f"explicit{i}", increment="0.1")
            for height in (1.5, 2.13):
                one = load(path).only([("fulcrum-height", height)])
                alone = load(self.sweep("accurate", *lattice, str(height), name=f"explicit{i}_{height}",
                                        increment="0.1")).only()
                for name in AXES:
                    np.testing.assert_array_equal(one.axes[name], alone.axes[name])
                np.testing.assert_array_equal(one.data["speed"], alone.data["speed"])

    def test_a_heatmap_of_a_scene_is_that_of_its_own_archive(self):
        for i, scene in enumerate(self.scenes()):
            figures = [heatmap.picture(archive, "speed", {}) for archive in (
                load(self.path("study.h5")).only(self.at(*scene)), load(self.path(f"alone{i}.h5")).only())]
            drawn = [[(np.asarray(mesh.get_array()).ravel(), mesh.get_coordinates().ravel(), mesh.get_clim())
                      for axes in figure.axes[:3] for mesh in axes.collections[:1]] for figure in figures]
            self.assertEqual(len(drawn[0]), 3)
            for one, alone in zip(*drawn):
                for a, b in zip(one, alone):
                    np.testing.assert_array_equal(a, b)
            titles = [" ".join(figure._suptitle.get_text().split()).split(": ", 1) for figure in figures]
            self.assertEqual(titles[0][0], f"study, projectile-mass = {scene[0]:g} kg, fulcrum-height = "
                                           f"{scene[1]:g} m")
            self.assertEqual(titles[0][1], titles[1][1])
            for figure in figures:
                plt.close(figure)

    def test_planes_of_all_scenes_along_an_axis_share_colours_and_contours(self):
        archive = select(load(self.path("study.h5")), [("fulcrum-height", 1.92)])
        figure = heatmap.multiples(archive, "speed", "projectile_mass", {"r1": 0.9})
        self.addCleanup(plt.close, figure)
        meshes = [axes.collections[0] for axes in figure.axes[:2]]
        for i, mesh in zip((1, 4), meshes):
            alone = load(self.path(f"alone{i}.h5")).only()
            np.testing.assert_array_equal(np.ma.filled(mesh.get_array(), np.nan).ravel(),
                                          alone.plane("speed", r1=0.9).values.ravel())
            self.assertEqual(mesh.get_clim(), meshes[0].get_clim())
        for scale in ("log", "percentile"):
            self.run_script("heatmap", "study.h5", "--at", "fulcrum-height=1.92", "--over", "projectile-mass",
                            "--scale", scale, "-o", "over.png")
            self.assert_picture("over.png")
        self.run_script("heatmap", "study.h5", "--over", "projectile-mass", code=2,
                        says="over = projectile-mass: must be the only outer axis that --at leaves; these are left: "
                             "projectile-mass, fulcrum-height")
        self.run_script("heatmap", "alone0.h5", "--scale", "log", "-o", "over.png")
        self.sweep("accurate", "--scene.projectile-mass", "50:200:50", name="four", increment="0.2")
        self.run_script("heatmap", "four.h5", "--over", "projectile_mass", "--r3", "0.7")
        self.assert_picture("four-speed-over-projectile-mass.png")

    def test_every_script_takes_a_scene(self):
        at = self.words(self.at(100, 1.92))
        self.run_script("heatmap", "study.h5", *at)
        self.assert_picture("study-projectile-mass=100-fulcrum-height=1.92-speed.png")
        self.run_script("loads", "study.h5", *at, "--count", "1", "--program", PROGRAM)
        self.assert_picture("study-projectile-mass=100-fulcrum-height=1.92-loads.png")
        done = self.run_script("compare", "study.h5", "alone4.h5", *at, "-o", "c.png")
        self.assertIn("largest 0 m/s", done.stdout)
        done = self.run_script("compare", "alone4.h5", "study.h5", *at, "-o", "c.png")
        self.assertIn("largest 0 m/s", done.stdout)
        other = [word.replace("--at", "--at-b") for word in self.words(self.at(50, 1.92))]
        done = self.run_script("compare", "study.h5", "study.h5", *at, *other, "-o", "c.png")
        same = self.run_script("compare", "alone4.h5", "alone1.h5", "-o", "c.png")
        self.assertEqual(done.stdout.splitlines()[2:], same.stdout.splitlines()[2:])
        short = self.run_script("compare", "study.h5", "study.h5", *at, "--at-b", "projectile-mass=50",
                                "-o", "c.png")
        self.assertEqual(short.stdout, done.stdout)
        names = [line.split(": ")[0] for line in done.stdout.splitlines()[:2]]
        self.assertEqual(names, [f"{letter}         study.h5, projectile-mass = {mass} kg, fulcrum-height = 1.92 m"
                                 for letter, mass in (("A", 100), ("B", 50))])
        for options in ((), ("--continuous", "--program", PROGRAM)):
            one = self.run_script("optimum", "study.h5", *at, "--job", "one.cfg", "--overwrite", *options).stdout
            self.assertEqual(one, self.run_script("optimum", "alone4.h5", *options).stdout)
        self.run_script("optimum", "study.h5", *at, "--job", "one.cfg", "--overwrite")
        self.run_program("sweep", "one.cfg", "--output.file", "again.h5", "--overwrite")
        with h5py.File(self.path("again.h5")) as again, h5py.File(self.path("alone4.h5")) as alone:
            np.testing.assert_array_equal(again["speed"], alone["speed"])

    def test_scenes_of_different_lattices_are_compared_where_both_have_designs(self):
        path = self.sweep("accurate", "--scene.counterweight-hanger", "0, 0.1, 0.42", name="hangers")
        with h5py.File(path) as file:
            speed, hold = file["speed"][...], file["status"][...] > 0
        both = hold[0] & hold[1]
        self.assertTrue(both.sum() < max(hold[0].sum(), hold[1].sum()))
        difference = np.abs(speed[0] - speed[1])[both & np.isfinite(speed[0]) & np.isfinite(speed[1])]
        at = [word for i in (0, 1) for word in (("--at", "--at-b")[i], f"counterweight-hanger={(0, 0.1)[i]}")]
        done = self.run_script("compare", "hangers.h5", "hangers.h5", *at, "-o", "c.png")
        lines = done.stdout.splitlines()
        self.assertEqual(lines[2], f"lattices  {both.sum()} designs in common, of {hold[0].sum()} of A and "
                                   f"{hold[1].sum()} of B")
        only = (both & (np.isfinite(speed[0]) != np.isfinite(speed[1]))).sum()
        self.assertEqual(lines[3], f"designs   {difference.size} with a speed in both, {only} in one of them only")
        self.assertIn(f"median {np.median(difference):.6g}, ", lines[4])
        self.assertIn(f"largest {difference.max():.6g} m/s", lines[4])
        self.assert_picture("c.png")
        none = ("study.h5", "study.h5", *self.words(self.at(50, 1.5)), "--at-b", "fulcrum-height=1.92")
        self.run_script("compare", *none, code=1,
                        says="study.h5, projectile-mass = 50 kg, fulcrum-height = 1.5 m and study.h5, "
                             "projectile-mass = 50 kg, fulcrum-height = 1.92 m have no design in common")

    def test_the_star_of_a_comparison_is_an_optimum_that_both_scenes_could_have(self):
        a, b = (load(self.path(f"alone{i}.h5")).only() for i in (0, 1))
        self.assertEqual(compare.optimum_within(b), b.optimum()[0])
        self.assertIsNone(compare.optimum_within(b.data.isel(r1=[0, 1], r3=[0, 1], r2=[0, 1]).treb))
        self.assertEqual(compare.optimum_within(a), a.optimum()[0])

    def test_a_refined_optimum_of_a_scene_is_that_of_the_continuous_search(self):
        done = self.run_script("optimum", "masses.h5", "--at", "projectile-mass=200")
        found = json.loads(self.run_program("optimum", f"{JOBS}/accurate.cfg", "--json", "--lattice.increment",
                                            "0.05", "--scene.projectile-mass", "200").stdout)
        np.testing.assert_allclose([float(word) for word in done.stdout.split()[1::2]],
                                   [found[name] for name in AXES], atol=1e-7)

    def test_a_missing_or_wrong_choice_of_a_scene_is_refused(self):
        both = "study.h5: is a study over projectile-mass (50, 100 kg) and fulcrum-height (1.5, 1.92, 2.5 m); " \
               "choose a scene, such as --at projectile-mass=50 --at fulcrum-height=1.5\n"
        for script in ("heatmap", "loads", "optimum"):
            self.run_script(script, "study.h5", code=2, says=both)
        self.run_script("compare", "study.h5", "study.h5", code=2, says=both)
        self.sweep("accurate", "--scene.projectile-mass", "10:100:10", name="ten", increment="0.2")
        for archive, at, words in (
                ("study.h5", ["projectile-mass=50"], "is a study over fulcrum-height (1.5, 1.92, 2.5 m); choose"),
                ("study.h5", ["projectile-mass=60"], "at = projectile-mass=60: must be one of 50, 100 kg\n"),
                ("ten.h5", ["projectile-mass=5"], "must be one of 10, 20, 30, ..., 100 kg\n"),
                ("study.h5", ["mass=60"], "at = mass=60: must name an outer axis of study.h5, each once: "
                                          "projectile-mass, fulcrum-height\n"),
                ("study.h5", ["projectile-mass=50"] * 2, "at = projectile-mass=50: must name an outer axis"),
                ("study.h5", ["projectile-mass"], "--at: projectile-mass: must be KEY=VALUE, VALUE a number"),
                ("study.h5", ["fulcrum-height=x"], "--at: fulcrum-height=x: must be KEY=VALUE, VALUE a number"),
                ("alone0.h5", ["fulcrum-height=1.5"], "at = fulcrum-height=1.5: must be left out: alone0.h5 is "
                                                      "not a study\n")):
            with self.subTest(archive=archive, at=at):
                self.run_script("heatmap", archive, *(w for text in at for w in ("--at", text)), code=2,
                                says=words)

    def test_a_missing_or_wrong_choice_of_b_is_refused_with_the_option_of_b(self):
        self.sweep("accurate", "--scene.projectile-mass", "50, 100", name="plain")
        mass, height = ("--at", "projectile-mass=50"), ("--at", "fulcrum-height=1.5")
        for a, b, options, words in (
                ("plain.h5", "study.h5", mass, "study.h5: is a study over fulcrum-height (1.5, 1.92, 2.5 m); choose "
                                               "a scene, such as --at-b fulcrum-height=1.5\n"),
                ("study.h5", "study.h5", (*mass, *height, "--at-b", "fulcrum-height=3"),
                 "at-b = fulcrum-height=3: must be one of 1.5, 1.92, 2.5 m"),
                ("study.h5", "study.h5", (*mass, *height, "--at-b", "mass=3"),
                 "at-b = mass=3: must name an outer axis of study.h5"),
                ("study.h5", "study.h5", (*mass, *height, "--at", "mass=3"),
                 "at = mass=3: must name an outer axis of study.h5"),
                ("alone0.h5", "study.h5", (*mass, *height, "--at", "mass=3"),
                 "at-b = mass=3: must name an outer axis of study.h5"),
                ("study.h5", "alone0.h5", (*mass, *height, "--at-b", "projectile-mass=50"),
                 "at-b = projectile-mass=50: must be left out: alone0.h5 is not a study")):
            with self.subTest(a=a, b=b, options=options):
                self.run_script("compare", a, b, *options, code=2, says=words)
        done = self.run_script("compare", "study.h5", "plain.h5", *mass, "--at", "fulcrum-height=1.92",
                               "-o", "c.png")  # fulcrum-height is A's alone
        self.assertIn("B         plain.h5, projectile-mass = 50 kg: ", done.stdout)

    def test_an_axis_of_one_value_needs_no_choice(self):
        self.sweep("accurate", "--scene.projectile-mass", "50:50:1", name="one", increment="0.1")
        self.run_script("heatmap", "one.h5")

    def test_archives_without_maps_have_an_optimum_and_no_heatmap(self):
        for at in ((), ("--at", "projectile-mass=100")):
            for script, *more in (("heatmap",), ("importance",), ("compare", "masses.h5")):
                self.run_script(script, "masses.h5", *more, *at, code=1,
                                says="masses.h5: has no maps (output.maps = none)")
            self.run_script("loads", "masses.h5", *at, code=1, says="masses.h5: has no map of the speed")

    def test_tiles_that_are_not_done_read_as_blank(self):
        tiles = self.make_partial(0)
        for done in (0, 1, 5, len(tiles) // 2, len(tiles) - 1):
            self.make_partial(done)
            partial = self.open_quietly("partial.h5")
            for number, one in enumerate(partial.each_scene()):
                alone = load(self.path(f"alone{number}.h5")).only()
                with h5py.File(self.path("study.h5")) as file:
                    box, speed = file["speed"].shape[2:], file["speed"][np.unravel_index(number, (2, 3))]
                    places = [np.searchsorted(file[name][...], alone.axes[name]) for name in AXES]
                is_done = np.zeros(box, bool)
                for i, tile in tiles[:done]:
                    if i == number:
                        is_done[tile[2:]] = True
                want = np.where(is_done, speed, np.nan)[np.ix_(*places)]
                np.testing.assert_array_equal(one.data["speed"], want)
                self.assertEqual(one.complete, all(i != number for i, _ in tiles[done:]))
                optimum = one.optimum()
                self.assertEqual(optimum is None, np.isnan(want).all())
                if optimum:
                    index = np.unravel_index(np.nanargmax(want), want.shape)
                    design = {name: alone.axes[name][i] for name, i in zip(AXES, index)}
                    self.assertEqual(optimum, (design, np.nanmax(want)))
            partial.data.close()

    def test_a_partial_study_is_reported_once(self):
        tiles = self.make_partial(5)
        numbers = [i for i, _ in tiles]
        at = self.words(self.at(50, 1.5))
        first = numbers.count(0)
        self.assertGreater(first, 0)
        self.make_partial(first)
        text = f"partial.h5: unfinished: {first} of {len(tiles)} tiles done; the rest is left blank\n"
        self.run_script("study", "partial.h5", says=text)
        self.run_script("heatmap", "partial.h5", *at)
        self.run_script("heatmap", "partial.h5", *self.words(self.at(50, 1.92)),
                        says=f"partial.h5: unfinished: 0 of {numbers.count(1)} tiles done")
        self.run_script("importance", "partial.h5", *at)


class Studies(StudyTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep_masses()

    def lines(self, figure):
        """{label: (x, y)} of the curves of a figure."""
        return {line.get_label(): line.get_data() for axes in figure.axes for line in axes.get_lines()
                if line.get_marker() != "*"}

    def test_curves_show_the_optimum_of_each_scene(self):
        figure = self.figure(load(self.path("masses.h5")))
        lines = self.lines(figure)
        with h5py.File(self.path("masses.h5")) as file:
            best = {name: file[f"best_{name}"][...] for name in ("value", *AXES)}
        want = {**best, "r3/r2": best["r3"] / best["r2"], "r2/r1": best["r2"] / best["r1"],
                "(r2+r3)/h0": (best["r2"] + best["r3"]) / 1.5}
        del want["(r2+r3)/h0"]  # 1 in all scenes
        self.assertIn("at the edge of the range of projectile-mass\nin all scenes: (r2+r3)/h0 = 1",
                      figure._suptitle.get_text().replace(" of\n", " of "))
        self.assertEqual(set(lines), set(want))
        for name, (x, y) in lines.items():
            np.testing.assert_array_equal(x, self.MANY_MASSES)
            np.testing.assert_allclose(y, want[name], rtol=1e-14)
        self.assertEqual(len(figure.axes), 4)
        for axes in figure.axes:
            self.assertEqual(axes.get_xscale(), "log")
        self.assertEqual([axes.get_xlabel() for axes in figure.axes],  # in two rows of two
                         ["", "", *["mass m3 of the projectile (kg)"] * 2])
        self.assertEqual([axes.get_ylabel().replace("\n", " ") for axes in figure.axes],
                         ["speed of the optimum (m/s)", "lengths of the optimum (m)", "r3/r2", "r2/r1"])

    def broken(self, **lengths):
        """The intervals in which the curves of masses.h5 with other optimal lengths break, and the title."""
        shutil.copy(self.path("masses.h5"), self.path("jump.h5"))
        with h5py.File(self.path("jump.h5"), "r+") as file:
            for name in AXES:
                file[f"best_{name}"][...] = lengths.get(name, np.full(6, 0.6))
            value = file["best_value"][...]
        archive = load(self.path("jump.h5"))
        figure = self.figure(archive)
        archive.data.close()
        gaps = set()
        for x, y in self.lines(figure).values():
            gap = np.flatnonzero(np.isnan(x))
            self.assertTrue(np.isnan(y[gap]).all())
            np.testing.assert_array_equal(np.delete(x, gap), self.MANY_MASSES)  # no scene is lost
            gaps.add(tuple(gap - np.arange(1, len(gap) + 1)))
        np.testing.assert_array_equal(np.delete(self.lines(figure)["value"][1], gap), value)
        self.assertEqual(len(gaps), 1)  # all curves break alike
        return gaps.pop(), figure._suptitle.get_text()

    def test_curves_break_where_the_optimum_jumps(self):
        words = "\ncurves break where the optimum jumps to another local maximum\n"
        for jump, lengths in ((2, {"r1": (0.5, 0.51, 0.52, 0.9, 0.92, 0.93)}),
                              (2, {"r2": (0.74, 0.71, 0.6, 1.05, 1.08, 1.14), "r1": (0.1, 0.1, 0.1, 0.27, 0.4, 0.67)}),
                              (1, {"r3": (0.9, 0.9, 0.3, 0.3, 0.3, 0.3)})):
            gaps, title = self.broken(**lengths)
            self.assertEqual(gaps, (jump,))
            self.assertIn(words, title)
        for lengths in ({"r1": (0.5, 0.5, 0.5, 0.7, 0.9, 1.0)},        # leaves a bound
                        {"r1": (0.5, 0.5, 0.51, 0.53, 0.58, 0.9)},     # ever faster: no interval follows the last
                        {"r1": (0.9, 0.5, 0.5, 0.5, 0.5, 0.5)},        # nor precedes the first
                        {"r1": (0.5, 0.5, 0.5, 0.6, 0.6, 0.6)},        # by two steps of the lattice
                        {"r1": (0.5, 0.5, np.nan, 0.9, 0.9, 0.9)}):    # where a scene has no optimum
            gaps, title = self.broken(**lengths)
            self.assertEqual(gaps, ())
            self.assertNotIn("break", title)

    def test_a_jump_between_local_maxima_of_a_study_is_found(self):
        # Up to 50 kg a short arm is best, from 100 kg on the longest one.
        path = self.sweep("accurate", "--scene.projectile-mass", "10, 20, 50, 100, 200, 500", "--scene.beam-side", "0.2",
                          "--scene.release-height", "1.6", "--optimum.subject-to", "least-sling-tension >= -1",
                          "--optimum.refine", "yes", "--output.maps", "none", name="heavy")
        archive = load(path)
        np.testing.assert_array_equal(study.jumps(archive, study.read_quantities(archive)), np.arange(5) == 2)

    def test_the_title_tells_how_the_optimum_was_chosen(self):
        best = "\n\u2605 best of all: speed "
        for options, want in (((), ""), (("--optimum.refine", "yes"), " (continuous)"),
                              (("--optimum.subject-to", "speed >= 1"), ", within the constraints"),
                              (("--optimum.refine", "yes", "--optimum.subject-to", "speed >= 1"),
                               " (continuous), within the constraints"),
                              (("--output.optimum", "taut"), ", with a taut sling")):
            self.sweep("accurate", "--scene.projectile-mass", "50, 100", *options, "--overwrite", name="few",
                       increment="0.2")
            archive = load(self.path("few.h5"))
            self.assertIn(f"few: optimum of each scene{want}{best}",
                          self.figure(archive)._suptitle.get_text())
            archive.data.close()

    def test_the_stars_have_the_colours_of_their_curves(self):
        for axes in self.figure(load(self.path("masses.h5"))).axes:
            curves, stars = ([line for line in axes.get_lines() if (line.get_marker() == "*") == is_star]
                             for is_star in (False, True))
            self.assertEqual([line.get_color() for line in stars], [line.get_color() for line in curves])
            self.assertEqual(len({line.get_color() for line in stars}), len(curves))
            for curve, star in zip(curves, stars):
                self.assertIn((star.get_xdata(), star.get_ydata()), list(zip(*curve.get_data())))

    def test_few_values_are_the_only_ticks(self):
        panel = self.figure(load(self.path("study.h5")), ["value"]).axes[0]
        for axis, values in ((panel.xaxis, self.MASSES), (panel.yaxis, self.HEIGHTS)):
            np.testing.assert_array_equal(axis.get_ticklocs(), values)
            self.assertEqual([text.get_text() for text in axis.get_ticklabels()],
                             [f"{value:g}" for value in values])
            self.assertEqual(len(axis.get_ticklocs(minor=True)), 0)

    def test_labels_have_no_remarks(self):
        for key, values in (("release-height", "1.9, 2"), ("counterweight-hanger", "0, 0.1")):
            self.sweep("accurate", f"--scene.{key}", values, name=key, increment="0.2")
            archive = load(self.path(f"{key}.h5"))
            label = study.axis_label(archive, key.replace("-", "_")).replace("\n", " ")
            self.assertRegex(label, r"^(height h|length r4) [^,()]* \(m\)$")

    def test_an_optimum_can_be_found_again_in_the_picture(self):
        lines = self.lines(self.figure(load(self.path("masses.h5"))))
        found = json.loads(self.run_program("optimum", f"{JOBS}/accurate.cfg", "--json", "--scene.projectile-mass",
                                            "500").stdout)
        for name in ("value", *AXES):
            self.assertAlmostEqual(lines[name][1][4], found[name], delta=1e-6)

    def test_maps_show_the_optimum_of_each_scene(self):
        archive = load(self.path("study.h5"))
        figure = self.figure(archive)
        meshes = figure.axes[:7]  # in rows of four and three; the colour bars follow
        with h5py.File(self.path("study.h5")) as file:
            value, r2, r3 = (file[f"best_{name}"][...] for name in ("value", "r2", "r3"))
        self.assertEqual([bool(axes.get_xlabel()) for axes in meshes], [False] * 3 + [True] * 4)
        self.assertEqual([bool(axes.get_ylabel()) for axes in meshes], [i in (0, 4) for i in range(7)])
        for axes in meshes:
            for ticks, label in ((axes.get_xticklabels(), axes.get_xlabel()),
                                 (axes.get_yticklabels(), axes.get_ylabel())):
                self.assertEqual(len(ticks) > 0, bool(label))
        for panel, want in ((0, value), (4, r3 / r2), (6, (r2 + r3) / np.array(self.HEIGHTS))):
            np.testing.assert_allclose(meshes[panel].collections[0].get_array().reshape(3, 2), want.T)
            star = next(line for line in meshes[panel].get_lines() if line.get_marker() == "*")
            index = np.unravel_index(np.argmax(value), value.shape)
            self.assertEqual((float(np.squeeze(star.get_xdata())), float(np.squeeze(star.get_ydata()))),
                             (self.MASSES[index[0]], self.HEIGHTS[index[1]]))
        turned = study.order(archive, "fulcrum-height", None)
        panel = self.figure(turned, ["value"]).axes[0]
        np.testing.assert_array_equal(panel.collections[0].get_array().reshape(2, 3), value)
        self.assertTrue(panel.get_xlabel().startswith("height h0"))

    def test_the_table_holds_what_is_drawn(self):
        done = self.run_script("study", "study.h5", "--csv")
        rows = [line.split(",") for line in done.stdout.splitlines()]
        self.assertEqual(rows[0], ["projectile-mass", "fulcrum-height", "value", "r1", "r2", "r3", "r3/r2",
                                   "r2/r1", "(r2+r3)/h0"])
        self.assertFalse(os.path.exists(self.path("study-study.png")))
        for row, scene, i in zip(rows[1:], self.scenes(), range(6)):
            values = dict(zip(rows[0], map(float, row)))
            design, speed = load(self.path(f"alone{i}.h5")).only().optimum()
            self.assertEqual((values["projectile-mass"], values["fulcrum-height"]), scene)
            self.assertEqual({name: values[name] for name in AXES}, design)
            self.assertEqual(values["value"], speed)
            self.assertEqual(values["(r2+r3)/h0"], (design["r2"] + design["r3"]) / scene[1])
        done = self.run_script("study", "study.h5")
        self.assertEqual(done.stdout.splitlines()[1].split(), ["kg", "m", "m/s", "m", "m", "m"])
        self.assertEqual(len(done.stdout.splitlines()), 2 + 6 + 1)
        np.testing.assert_allclose([list(map(float, line.split())) for line in done.stdout.splitlines()[2:8]],
                                   [list(map(float, row)) for row in rows[1:]], rtol=1e-6)
        self.assert_picture("study-study.png")

    def test_scenes_are_drawn_against_an_expression_of_their_keys(self):
        archive = study.against(load(self.path("study.h5")), "projectile_mass / fulcrum-height")
        with h5py.File(self.path("study.h5")) as file:
            ratio = np.divide.outer(file["projectile_mass"][...], file["fulcrum_height"][...]).ravel()
            value, r1 = (file[f"best_{name}"][...].ravel() for name in ("value", "r1"))
        lines = self.lines(self.figure(archive))
        for name, want in (("value", value), ("r1", r1)):
            np.testing.assert_array_equal(lines[name][0], np.sort(ratio))
            np.testing.assert_array_equal(lines[name][1], want[np.argsort(ratio)])
        self.run_script("study", "study.h5", "--x", "projectile-mass * 0 + 1", "-o", "same.png")
        self.assert_picture("same.png")
        self.run_script("study", "study.h5", "--x", "mass / 2", code=2, says="x = mass / 2: mass must be one of")

    def test_scenes_that_are_not_done_are_blank(self):
        tiles = self.make_partial(0)
        done = [i for i, _ in tiles].index(4)  # the first four scenes
        self.make_partial(done)
        archive = self.open_quietly("partial.h5")
        value = self.figure(archive).axes[0].collections[0].get_array().reshape(3, 2)
        with h5py.File(self.path("study.h5")) as file:
            want = file["best_value"][...].ravel()
        want[4:] = np.nan
        np.testing.assert_array_equal(np.ma.filled(value, np.nan), want.reshape(2, 3).T)
        archive.data.close()
        rows = self.run_script("study", "partial.h5", says="unfinished").stdout.splitlines()[2:-1]
        self.assertEqual([row.split()[2] == "-" for row in rows], [False] * 4 + [True] * 2)
        self.make_partial(0)
        self.run_command(sys.executable, "-B", TREB_PLOT, "study", "partial.h5", "-o", "none.png")
        self.assertFalse(os.path.exists(self.path("none.png")))

    def test_scenes_without_an_optimum_are_blank(self):
        self.sweep("accurate", "--scene.projectile-mass", "100, 2000", "--optimum.subject-to", "speed >= 10",
                   name="weak", increment="0.1")
        _, y = self.lines(self.figure(load(self.path("weak.h5"))))["value"]
        np.testing.assert_array_equal(np.isnan(y), [False, True])
        self.sweep("accurate", "--scene.projectile-mass", "1000, 2000", "--optimum.subject-to", "speed >= 100",
                   name="weaker", increment="0.1")
        self.run_script("study", "weaker.h5", says="weaker.h5: no scene has an optimum; no picture is drawn")

    def test_of_more_axes_at_most_two_are_drawn(self):
        self.sweep("accurate", "--scene.projectile-mass", "50, 100", "--scene.counterweight-mass", "2000, 4000",
                   "--scene.fulcrum-height", "1.5, 1.6", "--output.maps", "none", name="three", increment="0.1")
        with h5py.File(self.path("three.h5")) as file:
            best = np.unravel_index(file["best_value"][...].argmax(), file["best_value"].shape)
            height = file["fulcrum_height"][best[2]]
        done = self.run_script("study", "three.h5",
                               says=f"three.h5: drawn at fulcrum-height = {height:g}, where the best scene is")
        self.assertEqual(done.stdout.split()[:2], ["counterweight-mass", "projectile-mass"])
        self.run_script("study", "three.h5", "--at", "counterweight-mass=4000", "--quantity", "value",
                        "--quantity", "r3/r2", "-o", "map.svg")
        self.assert_picture("map.svg")
        done = self.run_script("study", "three.h5", "--at", "counterweight-mass=4000", "--at",
                               "fulcrum-height=1.6", "--quantity", "value", "--csv")
        with h5py.File(self.path("three.h5")) as file:
            values = file["best_value"][1, :, 1]
        self.assertEqual(done.stdout.splitlines()[1:], [f"{mass:.1f},{float(value)!r}"
                                                        for mass, value in zip((50, 100), values)])
        self.run_script("study", "three.h5", "--at", "counterweight-mass=4000", "--at", "fulcrum-height=1.6",
                        "--at", "projectile-mass=50", says="a single scene, printed as a table")

    def test_axes_are_logarithmic_where_their_values_are(self):
        for values, log in (((1, 2, 4, 8), True), ((1, 2, 5, 10), True), ((1, 2, 3, 4), False), ((1, 10), False),
                            ((0, 1, 10), False), ((-4, -2, -1), False), ((1.5, 1.6, 1.7), False)):
            self.assertEqual(study.is_geometric(np.array(values, float)), log, values)

    def test_invalid_options_are_refused(self):
        for arguments, code, words in (
                (["alone0.h5"], 1, "alone0.h5: is not a study: it has one scene"),
                (["study.h5", "--csv", "-o", "study.csv"], 2,
                 "output = study.csv: must be left out with --csv, which writes to stdout"),
                (["study.h5", "--x", "mass"], 2, "x = mass: must be one of the outer axes that --at leaves: "
                                                 "projectile-mass, fulcrum-height"),
                (["study.h5", "--y", "fulcrum-height", "--at", "fulcrum-height=1.5"], 2,
                 "y = fulcrum-height: must be one of the outer axes that --at leaves: projectile-mass"),
                (["study.h5", "--x", "fulcrum-height", "--y", "fulcrum-height"], 2, "must differ from x"),
                (["study.h5", "--quantity", "mass"], 2, "--quantity: invalid choice: 'mass'"),
                (["study.h5", "-o", "study.h5"], 2, "output = study.h5: must"),
                (["study.h5", "--at", "fulcrum-height=3"], 2, "must be one of 1.5, 1.92, 2.5 m")):
            with self.subTest(arguments=arguments):
                self.run_script("study", *arguments, code=code, says=words)


class Importance(StudyTest):
    ALONE = (0,)

    @staticmethod
    def by_permutations(values):
        """Shapley effects from the formula: the mean, over all orders of the axes, of what each adds to those before."""
        y, places = values[np.isfinite(values)], np.argwhere(np.isfinite(values))

        def explained(axes):
            groups = {}
            for place, value in zip(places, y):
                groups.setdefault(tuple(place[list(axes)]), []).append(value)
            return sum(len(group) * (np.mean(group) - y.mean()) ** 2 for group in groups.values()) / y.size / y.var()

        effects, orders = np.zeros(values.ndim), list(itertools.permutations(range(values.ndim)))
        for order in orders:
            for i, axis in enumerate(order):
                effects[axis] += (explained(order[:i + 1]) - explained(order[:i])) / len(orders)
        return effects

    def test_effects_are_those_of_the_permutation_formula_on_maps_with_holes(self):
        chance = np.random.default_rng(3)
        for shape in ((4,), (3, 5), (3, 2, 4), (2, 3, 2, 3)):
            values = chance.normal(size=shape) + np.arange(shape[-1])
            for holes in (0, 0.2, 0.5):
                values[chance.random(shape) < holes] = np.nan
                effects, alone, _ = importance.shapley_effects(values)
                np.testing.assert_allclose(effects, self.by_permutations(values), atol=1e-12)
                self.assertAlmostEqual(effects.sum(), 1, delta=1e-12)
                self.assertTrue((alone > -1e-12).all())

    def test_effects_of_an_additive_function_are_the_shares_of_its_terms(self):
        x, y, z = (np.linspace(0, 1, n) for n in (4, 5, 6))
        effects, alone, last = importance.shapley_effects(
            np.add.outer(np.add.outer(x, 2 * y), -3 * z ** 2))
        variances = np.array([x.var(), 4 * y.var(), 9 * (z ** 2).var()])
        for found in (effects, alone, last):
            np.testing.assert_allclose(found, variances / variances.sum(), atol=1e-12)

    def test_effects_of_a_product_share_its_interaction_equally(self):
        x, y = np.linspace(1, 2, 4), np.linspace(0, 3, 7)
        mean_x, mean_y, both = x.mean() ** 2 * y.var(), y.mean() ** 2 * x.var(), x.var() * y.var()
        effects, alone, last = importance.shapley_effects(np.multiply.outer(x, y))
        whole = mean_x + mean_y + both
        np.testing.assert_allclose(alone, [mean_y / whole, mean_x / whole], atol=1e-12)
        np.testing.assert_allclose(effects, [(mean_y + both / 2) / whole, (mean_x + both / 2) / whole], atol=1e-12)
        np.testing.assert_allclose(last, [(mean_y + both) / whole, (mean_x + both) / whole], atol=1e-12)

    def test_all_designs_of_a_study_count(self):
        with h5py.File(self.path("study.h5")) as file:
            speed = file["speed"][...]
        done = self.run_script("importance", "study.h5")
        effects, alone, last = importance.shapley_effects(speed)
        names = ["projectile-mass", "fulcrum-height", *AXES]
        for name, *row in zip(names, effects, alone, last):
            self.assertRegex(done.stdout, rf"(?m)^{name} +" + " ".join(f"{share:8.6f}" for share in row).strip())
        self.assertRegex(done.stdout, r"(?m)^sum +1\.000000 ")
        self.assertIn(f"designs  {np.isfinite(speed).sum()}, ", done.stdout)
        self.assert_picture("study-importance.png")

    def test_an_expression_among_some_designs_of_some_scenes_counts_them_alone(self):
        done = self.run_script("importance", "study.h5", "--at", "fulcrum-height=1.5", "--field", "release_time / r2",
                               "--among", "(r1 > 1.2) & (r2 < 0.8)")
        with h5py.File(self.path("study.h5")) as file:
            r1, r2 = file["r1"][...][:, None, None], file["r2"][...]
            values = np.where((r1 > 1.2) & (r2 < 0.8), file["release_time"][:, 0] / r2, np.nan)
        self.assertIn(f"designs  {np.isfinite(values).sum()}, ", done.stdout)
        self.assertRegex(done.stdout, rf"(?m)^r2 +{importance.shapley_effects(values)[0][3]:.6f}")

    def test_what_has_no_variance_is_refused(self):
        shutil.copy(self.path("alone0.h5"), self.path("constant.h5"))
        with h5py.File(self.path("constant.h5"), "r+") as file:
            file["speed"][...] = 7
        for arguments, code, words in (
                (["alone0.h5", "--field", "status"], 2, "field = status: holds flags; must be a map of numbers"),
                (["alone0.h5", "--field", "apex"], 2, "field = apex: alone0.h5 has no map apex; must be one of"),
                (["alone0.h5", "--among", "r1 > 9"], 1, "alone0.h5: speed is constant, or has no value"),
                (["constant.h5"], 1, "constant.h5: speed is constant, or has no value")):
            with self.subTest(arguments=arguments):
                self.run_script("importance", *arguments, code=code, says=words)


if __name__ == "__main__":
    unittest.main()
