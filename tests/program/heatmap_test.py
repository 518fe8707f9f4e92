"""treb-plot heatmap: maps of an archive."""

import contextlib
import io
import os
import shutil
import sys
import unittest
import unittest.mock

import numpy as np

from scripts import FIELDS, LABORATORY_FIELDS, TREB_PLOT, PictureTest
from archives import h5py
from trebsweep import heatmap, maps
from trebsweep.backend import AXES
from trebsweep.picture import plt
from trebsweep.scenes import load
from support import PROGRAM


class Heatmaps(PictureTest):
    def test_heatmaps_are_drawn_of_every_field(self):
        save = plt.Figure.savefig

        def save_small(figure, file, **options):
            save(figure, file, **{**options, "dpi": 40})

        for archive, field in (*(("loads", field) for field in FIELDS.split(", ")),
                               *(("laboratory", field) for field in LABORATORY_FIELDS.split(", "))):
            command = ["heatmap", self.path(f"{archive}.h5"), "--field", field]
            with unittest.mock.patch("sys.argv", command), \
                    unittest.mock.patch.object(plt.Figure, "savefig", save_small), \
                    contextlib.redirect_stdout(io.StringIO()), \
                    contextlib.redirect_stderr(io.StringIO()) as errors:
                heatmap.main()
            self.assertEqual(errors.getvalue(), "")
            self.assert_picture(f"{archive}-{field}.png")

    def test_an_output_name_without_suffix_is_kept_and_holds_a_png(self):
        self.trace()
        for script, source in (("heatmap", ["paper.h5"]), ("trajectory", ["table.txt"]),
                               ("compare", ["paper.h5", "accurate.h5"]),
                               ("loads", ["paper.h5", "--count", "1", "--program", PROGRAM])):
            with self.subTest(script=script):
                name = f"picture of {script}"
                self.run_script(script, *source, "-o", name)
                self.assert_picture(name, "png")

    def test_input_files_are_not_overwritten(self):
        shutil.copy(self.path("paper.h5"), self.path("archive"))
        before = self.read("archive")
        for script, option in (("heatmap", "-o"), ("loads", "-o"), ("optimum", "--job")):
            self.run_script(script, "archive", option, "archive", code=2, says="archive")
        self.run_script("compare", "paper.h5", "archive", "-o", "archive", code=2, says="archive")
        self.assertEqual(self.read("archive"), before)

    def test_labels_stay_inside_the_picture_for_long_names(self):
        name = "a_long_name_of_an_archive_" * 8
        self.sweep("accurate", "--lattice.r1", "0.7", name="flat")
        self.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r3", "0.5", name="thin")
        for source in ("loads", "accurate", "flat", "thin"):
            shutil.copy(self.path(f"{source}.h5"), self.path(f"{source}_{name}.h5"))
        for script, *arguments in (
                ("heatmap", f"loads_{name}.h5", "--field", "energy-drift"),
                ("heatmap", f"flat_{name}.h5"), ("heatmap", f"thin_{name}.h5"),
                ("heatmap", f"thin_{name}.h5", "--field", "status"),
                ("compare", f"loads_{name}.h5", f"accurate_{name}.h5"),
                ("loads", f"loads_{name}.h5", "--count", "1", "--program", PROGRAM)):
            with self.subTest(script=script, arguments=arguments):
                self.run_script(script, *arguments, "-o", "long.png")
                pixels = plt.imread(self.path("long.png"))[..., :3]
                for edge in (pixels[:4], pixels[-4:], pixels[:, :4], pixels[:, -4:]):
                    self.assertTrue((edge == 1).all())

    def test_names_with_markup_or_without_glyphs_are_drawn(self):
        shutil.copy(self.path("paper.h5"), self.path("$r_1$^ \u5f29.h5"))
        self.run_script("heatmap", "$r_1$^ \u5f29.h5", "-o", "markup.png")

    def test_three_free_axes_give_planes_two_a_plane_and_one_a_line(self):
        self.sweep("accurate", "--lattice.r3", "0.58", name="plane")
        self.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r3", "0.5", name="line")
        for archive, panels in (("accurate.h5", 3), ("plane.h5", 1), ("line.h5", 0)):
            meshes = [axes for axes in self.figure(archive, "speed").axes if axes.collections
                      and axes.get_xlabel()]
            self.assertEqual(len(meshes), panels, archive)
        with h5py.File(self.path("line.h5")) as file:
            line = self.figure("line.h5", "speed").axes[0].get_lines()[0]
            np.testing.assert_array_equal(line.get_xdata(), file["r2"])
            np.testing.assert_array_equal(line.get_ydata(), np.ravel(file["speed"]))
        self.run_script("compare", "plane.h5", "plane.h5", "-o", "plane.png")
        self.run_script("compare", "line.h5", "line.h5", "-o", "line.png")

    def test_tick_labels_with_many_digits_do_not_overlap(self):
        self.sweep("accurate", "--lattice.r1", "0.510001:0.510003:0.000001", "--lattice.r3",
                   "0.58:0.5801:0.00001", "--lattice.r2", "0.91:0.9101:0.00001", name="fine")
        figure = self.figure("fine.h5", "speed")
        figure.canvas.draw()
        for axes in figure.axes[:3]:
            boxes = [label.get_window_extent() for label in axes.get_xticklabels()
                     if axes.get_xlim()[0] <= label.get_position()[0] <= axes.get_xlim()[1]]
            for left, right in zip(boxes, boxes[1:]):
                self.assertLess(left.x1 + 5, right.x0)
            self.assertEqual(axes.xaxis.get_offset_text().get_text(), "")

    def test_a_single_design_is_printed_as_a_table(self):
        single = self.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r3", "0.5",
                            "--lattice.r2", "0.9", name="single")
        with h5py.File(single) as file:
            speed = file.attrs["best_speed"]
        done = self.run_script("heatmap", "single.h5", "-o", "single.png",
                               says="single.h5: holds a single design")
        self.assertRegex(done.stdout, r"(?m)^r2 +0\.9 m$")
        self.assertRegex(done.stdout, rf"(?m)^speed +{speed:.10g} m/s$")
        self.assertRegex(done.stdout, r"(?m)^status +released$")
        self.run_script("compare", "single.h5", "single.h5", says="no picture")
        self.assertFalse(os.path.exists(self.path("single.png")))

    def test_contours_have_the_same_levels_in_all_panels_and_labels_that_differ_from_their_ground(self):
        contour, drawn = plt.matplotlib.axes.Axes.contour, []

        def record(*arguments, **options):
            drawn.append(contour(*arguments, **options))
            return drawn[-1]

        for archive, field in (("accurate.h5", "speed"), ("loads.h5", "peak_axle_load")):
            drawn.clear()
            with unittest.mock.patch.object(plt.matplotlib.axes.Axes, "contour", record):
                self.figure(archive, field)
            self.assertEqual(len(drawn), 3)
            for lines in drawn:
                np.testing.assert_array_equal(lines.levels, drawn[0].levels)
                self.assertGreater(len(lines.labelTexts), 0)
                mesh = lines.axes.collections[0]
                for text in lines.labelTexts:
                    self.assertGreaterEqual(text.get_fontsize(), 8)
                    ground = np.mean(mesh.to_rgba(float(text.get_text()))[:3])
                    colour = np.mean(plt.matplotlib.colors.to_rgb(text.get_color()))
                    self.assertGreater(abs(ground - colour), 0.3)

    def test_levels_that_no_panel_reaches_are_left_out(self):
        flat, steep = np.full((3, 3), 2.0), np.arange(9.0).reshape(3, 3)
        self.assertEqual(maps.contour_levels([flat, flat]), [])
        self.assertEqual(maps.contour_levels([np.full((2, 2), np.nan)]), [])
        self.assertIn(4, maps.contour_levels([flat, steep]))

    def test_every_status_has_a_colour_of_its_own(self):
        meanings = load(self.path("paper.h5")).meanings("status")
        style = maps.flag_colours(meanings)
        colours = {style["cmap"](style["norm"](flag)) for flag in range(len(meanings))}
        self.assertEqual(len(colours), len(meanings))

    def test_the_fields_with_a_best_value_are_fields_of_the_program(self):
        usage = self.run_program("sweep", "--help-keys").stdout
        for field in heatmap.LARGEST + heatmap.SMALLEST:
            self.assertRegex(usage, rf"[ ,]{field.replace('_', '-')}[\s,]")

    def test_the_star_and_the_title_show_the_best_design_of_the_field(self):
        with h5py.File(self.path("laboratory.h5")) as file:
            for field, best, word in (("impact_speed", np.nanargmax, "largest"),
                                      ("apex", np.nanargmax, "largest"),
                                      ("peak_hanger_tension", np.nanargmin, "smallest")):
                figure = self.figure("laboratory.h5", field)
                index = np.unravel_index(best(file[field]), file[field].shape)
                self.assertEqual(self.star(figure),
                                 {name: file[name][i] for name, i in zip(AXES, index)})
                self.assertIn(f"\u2605 {word}: ", figure._suptitle.get_text())
        with h5py.File(self.path("loads.h5")) as file:
            for field, best, words in (
                    ("speed", np.nanargmax(file["speed"]), "\u2605 fastest: "),
                    ("range", np.nanargmax(file["range"]), "\u2605 largest: "),
                    ("peak_axle_load", np.nanargmin(file["peak_axle_load"]), "\u2605 smallest: "),
                    ("release_time", np.nanargmin(file["release_time"]), "\u2605 smallest: "),
                    ("status", np.nanargmax(file["speed"]), "\u2605 fastest: ")):
                with self.subTest(field=field):
                    figure = self.figure("loads.h5", field)
                    design = {name: file[name][i] for name, i in
                              zip(AXES, np.unravel_index(best, file["speed"].shape))}
                    self.assertEqual(self.star(figure), design)
                    self.assertIn(words, figure._suptitle.get_text())

    def test_the_star_of_the_objective_is_the_sweeps_optimum(self):
        self.sweep("accurate", "--output.fields", "speed, range, status, peak-axle-load", "--optimum.objective",
                   "range", "--optimum.subject-to", "peak-axle-load <= 180000", name="within")
        with h5py.File(self.path("within.h5")) as file:
            optimum = {axis: file.attrs[f"best_{axis}"] for axis in AXES}
            shape = file["speed"].shape
            fastest, farthest = ({axis: file[axis][i] for axis, i in zip(
                AXES, np.unravel_index(np.nanargmax(file[name]), shape))} for name in ("speed", "range"))
            value = file.attrs["best_value"]
        self.assertNotEqual(optimum, farthest)
        text = f"\u2605 optimum within the constraints: range {value:.10g} m at "
        for field, design, words in (("range", optimum, text), ("status", optimum, text),
                                     ("speed", fastest, "\u2605 largest: ")):
            with self.subTest(field=field):
                figure = self.figure("within.h5", field)
                self.assertEqual(self.star(figure), design)
                self.assertIn(words, figure._suptitle.get_text())
        done = self.run_script("compare", "accurate.h5", "within.h5", "-o", "within.png")
        self.assertIn(f"B         within.h5: range {value:.10g} m at ", done.stdout)
        self.assertRegex(done.stdout, r"A         accurate.h5: [\d.]+ m/s at ")
        self.assertEqual(self.run_script("optimum", "within.h5").stdout,
                         " ".join(f"--{axis} {float(optimum[axis])!r}" for axis in AXES) + "\n")
        self.sweep("accurate", "--optimum.subject-to", "speed >= 100", name="none")
        self.assertIn("none.h5: has no optimum: no released design qualifies\n",
                      self.run_command(sys.executable, "-B", TREB_PLOT, "optimum", "none.h5").stderr)

    def test_units_have_prefixes_that_suit_the_values(self):
        self.sweep("accurate", "--output.fields", "speed, peak-axle-load, peak-beam-stress",
                   "--scene.counterweight-mass", "5", "--scene.projectile-mass", "0.1",
                   "--scene.beam-density", "1", name="toy")
        for archive, field, unit in (("loads.h5", "peak_axle_load", "(kN)"),
                                     ("loads.h5", "peak_beam_stress", "(MPa)"),
                                     ("loads.h5", "speed", "(m/s)"), ("loads.h5", "range", "(m)"),
                                     ("toy.h5", "peak_axle_load", "(N)"),
                                     ("toy.h5", "peak_beam_stress", "(kPa)")):
            label = self.figure(archive, field).axes[-1].get_ylabel().replace("\n", " ")
            self.assertTrue(label.endswith(" " + unit), f"{archive} {field}: {label}")
            values = self.figure(archive, field).axes[0].collections[0].get_array()
            self.assertLess(np.nanmax(values), 1000)


if __name__ == "__main__":
    unittest.main()
