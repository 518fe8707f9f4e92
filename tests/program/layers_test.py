#!/usr/bin/env python3
"""The layers of the sources: includes go one way only, and the numerical core is self-contained."""

import os
import re
import unittest

REPOSITORY = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

# Each layer includes only from those before it; src/README.md says what each holds.
LAYERS = ["base", "simd", "model", "ode", "swing", "job", "archive", "sweep", "optimum", "assess", "cli"]
COMMANDS = {"sweep", "optimum", "assess"}  # do not include each other
CORE = {"simd", "model", "ode", "swing"}
NOT_IN_CORE = re.compile(r"mpi\.h|hdf5|fmt/|boost/program_options|trebsweep/base/mpi")


def sources():
    """(path, layer, text) of every header and source."""
    for top in ("include/trebsweep", "src"):
        for folder, _, names in os.walk(os.path.join(REPOSITORY, top)):
            for name in names:
                if name.endswith((".hpp", ".cpp")):
                    path = os.path.relpath(os.path.join(folder, name), REPOSITORY)
                    with open(os.path.join(REPOSITORY, path), encoding="utf-8") as file:
                        yield path, path.removeprefix(top + "/").split("/")[0], file.read()


def includes(text):
    return re.findall(r'^\s*#include [<"]([^>"]+)[>"]', text, re.MULTILINE)


class Layers(unittest.TestCase):
    def test_every_source_is_in_a_layer(self):
        self.assertEqual({layer for _, layer, _ in sources()} - set(LAYERS), set())

    def test_a_layer_includes_only_from_layers_before_it(self):
        for path, layer, text in sources():
            for include in includes(text):
                if not include.startswith("trebsweep/"):
                    continue
                other = include.split("/")[1]
                with self.subTest(path=path, include=include):
                    self.assertLessEqual(LAYERS.index(other), LAYERS.index(layer))
                    self.assertFalse({layer, other} <= COMMANDS and layer != other)

    def test_the_numerical_core_includes_no_mpi_hdf5_or_text_formatting(self):
        for path, layer, text in sources():
            if layer in CORE:
                with self.subTest(path=path):
                    self.assertEqual([i for i in includes(text) if NOT_IN_CORE.search(i)], [])

    def test_no_source_is_longer_than_350_lines(self):
        self.assertEqual([path for path, _, text in sources() if text.count("\n") > 350], [])

    def test_every_test_is_in_the_folder_of_its_source(self):
        headers = {path.removeprefix("include/trebsweep/")[:-4] for path, _, _ in sources() if path.endswith(".hpp")}
        properties = {"swing/extreme", "swing/machines", "sweep/paper"}  # of many sources together
        for layer in LAYERS:
            folder = os.path.join(REPOSITORY, "tests", layer)
            for name in os.listdir(folder) if os.path.isdir(folder) else []:
                if name.endswith("_test.cpp"):
                    self.assertIn(f"{layer}/{name.removesuffix('_test.cpp')}", headers | properties)


if __name__ == "__main__":
    unittest.main()
