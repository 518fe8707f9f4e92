"""The committed pictures that draw.sh draws are those of the present program and scripts."""

import os
import re
import subprocess
import unittest

import matplotlib
import numpy as np

from scripts import ScriptTest  # first: it makes the modules of analysis/ importable
from trebsweep.picture import plt
from support import PROGRAM, REPOSITORY

PICTURES = os.path.join(REPOSITORY, "analysis", "pictures")
DIFFERENT = 0.1  # of the range of a colour; anti-aliasing and rounding are below it
CHANGED = 1e-5   # of the pixels; a digit of a title has more


class Pictures(ScriptTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run([os.path.join(PICTURES, "draw.sh"), cls.directory], check=True, timeout=500,
                       env={**os.environ, "TREBSWEEP": PROGRAM})

    def changed(self, committed, drawn):
        """The part of the pixels that differ; 1 for pictures of different sizes."""
        one, other = (plt.imread(path)[..., :3] for path in (committed, drawn))
        if one.shape != other.shape:
            return 1
        return np.mean((np.abs(one - other) > DIFFERENT).any(axis=-1))

    def test_a_redrawn_picture_is_the_committed_one(self):
        names = sorted(name for name in os.listdir(self.directory) if name.endswith((".png", ".svg")))
        self.assertGreaterEqual(len(names), 10)
        for name in names:
            with self.subTest(picture=name):
                with open(os.path.join(PICTURES, name), "rb") as file:
                    committed = file.read()
                version = re.search(rb"Matplotlib v(?:ersion)?([\d.]+)", committed)[1].decode()
                if version != matplotlib.__version__:  # which places texts differently
                    self.assert_picture(name)
                elif name.endswith(".svg"):
                    self.assertEqual(*(re.sub(rb"<dc:date>.*?</dc:date>", b"", svg) for svg in (committed, self.read(name))))
                else:
                    self.assertLess(self.changed(os.path.join(PICTURES, name), self.path(name)), CHANGED)

    def test_a_changed_digit_of_a_title_is_a_change(self):
        os.mkdir(self.path("titles"))
        for name, text in (("titles/one.png", "16.85559 m/s"), ("titles/other.png", "16.85558 m/s")):
            figure, axes = plt.subplots(figsize=(10, 4))
            axes.set_title(text)
            figure.savefig(self.path(name), dpi=150)
            plt.close(figure)
        one, other = self.path("titles/one.png"), self.path("titles/other.png")
        self.assertGreater(self.changed(one, other), CHANGED)
        self.assertEqual(self.changed(one, one), 0)


if __name__ == "__main__":
    unittest.main()
