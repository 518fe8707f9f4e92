"""treb-plot machine: sketches of a machine."""

import unittest

import numpy as np

from scripts import ScriptTest
from trebsweep import machine, swing
from trebsweep.picture import plt


class Machine(ScriptTest):
    def assert_traced(self, sketch, *options, design):
        """The three moments are those of a traced swing."""
        rows = swing.read_swing(self.trace("--interval", "0.02", *options, design=design))
        last = len(rows["t"]) - 1
        middle = int(np.argmin(np.abs(rows["phi1"] - sketch.middle[0])))
        hinge = "h" if sketch.r4 else "1"
        for angles, i in ((sketch.start, 0), (sketch.middle, middle), (sketch.release, last)):
            for angle, name in zip(angles, ("phi1", "phi2", "phi3") if sketch.r4 else ("phi1", "phi2")):
                self.assertAlmostEqual(angle, rows[name][i], places=6)
            for point, body in zip(machine.positions(sketch, angles), ("1", hinge, "t", "3")):
                np.testing.assert_allclose(point, (rows[f"x{body}"][i], rows[f"y{body}"][i]), atol=1e-6)

    def test_the_sketches_show_three_moments_of_a_traced_swing(self):
        design = [word for name in ("r1", "r2", "r3")
                  for word in (f"--{name}", str(getattr(machine.PAPER, name)))]
        self.assert_traced(machine.PAPER, design=design)
        self.assert_traced(machine.BUILT, design=machine.BUILT_OPTIONS.split())

    def test_labels_of_the_sketches_overlap_neither_lines_nor_each_other(self):
        for built in (False, True):
            with self.subTest(built=built):
                self.assert_labels_are_free(machine.draw(built))

    def assert_labels_are_free(self, figure):
        """The labels of a sketch, except for turned ones, overlap neither lines nor each other."""
        self.addCleanup(plt.close, figure)
        figure.canvas.draw()
        axes = figure.axes[0]
        boxes = [text.get_window_extent() for text in axes.texts
                 if text.get_text() and not text.get_rotation() % 90]
        self.assertGreater(len(boxes), 10)
        for i, box in enumerate(boxes):
            self.assertEqual([other for other in boxes[i + 1:] if box.overlaps(other)], [])
            for line in axes.lines:
                path = line.get_transform().transform_path(line.get_path())
                self.assertFalse(path.intersects_bbox(box, filled=False), (box, line))

    def test_the_sketch_is_drawn(self):
        for name, options in (("machine.svg", ()), ("built.svg", ("--built",))):
            self.run_script("machine", *options)
            self.assert_picture(name)
        self.run_script("machine", "-o", "sketch.png")
        self.assert_picture("sketch.png")
        self.run_script("machine", "-o", "sketch.xyz", code=2, says="output = sketch.xyz: must end")


if __name__ == "__main__":
    unittest.main()
