"""treb-plot sheet: the sheet to build a machine from."""

import json
import re
import unittest

import numpy as np

from scripts import LABORATORY, ScriptTest
from support import JOBS, PROGRAM
from trebsweep import design_drawing, drawing, sheet
from trebsweep.picture import plt
from trebsweep.units import INCH, UNITS, feet_and_inches

try:
    import ezdxf
except ImportError:
    ezdxf = None

DESIGNS = {  # a fixed counterweight and a hanging sling, a hinged one and a trough, and the other two
    "paper": ("", (0.51, 0.58, 0.91)),
    "laboratory": (LABORATORY.split("[lattice]")[0] + "[solver]\nrelease = farthest\n", (0.25, 0.87, 0.975)),
    "siege_fixed": (f"[scene]\nfile = {JOBS}/scenes/siege_fixed.cfg\n[solver]\nrelease = farthest\n", (2, 7.5, 8)),
    "hinged": ("[scene]\ncounterweight-hanger = 0.3\nrelease-height = 1.7\n[solver]\nrelease = farthest\n",
               (0.51, 0.58, 0.91)),
}


class BuildSheets(ScriptTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.optima = {}
        for name, (text, lengths) in DESIGNS.items():
            axes = "".join(f"{axis} = {length}\n" for axis, length in zip(("r1", "r3", "r2"), lengths))
            job = cls.write(f"{name}.cfg", f"{text}[optimum]\nbuildable = no\n[lattice]\n{axes}")
            optimum = sheet.read_optimum(job, PROGRAM, None)
            cls.optima[name] = design_drawing.Machine(optimum, sheet.trace(optimum, PROGRAM))

    def machine(self, name, **lengths):
        """A machine, or one with other lengths, whose fields are those of the former."""
        machine = self.optima[name]
        if not lengths:
            return machine
        optimum = {**machine.optimum, **lengths}
        return design_drawing.Machine(optimum, sheet.trace(optimum, PROGRAM))

    def machines(self):
        """(name, machine) of all designs, some also with a very short and a very long sling."""
        yield from self.optima.items()
        yield "short sling", self.machine("paper", r3=0.08)
        yield "long sling", self.machine("laboratory", r3=2.4)
        yield "short arm", self.machine("laboratory", r1=0.06)

    def test_texts_cover_neither_lines_nor_each_other_and_stay_on_the_page(self):
        for name, machine in self.machines():
            for units, paper in (("si", "a4"), ("us", "letter")):
                with self.subTest(machine=name, units=units):
                    figure = sheet.draw_page(machine, name, UNITS[units], paper)
                    self.addCleanup(plt.close, figure)
                    figure.canvas.draw()
                    axes = figure.axes[0]
                    texts = [text for text in (*figure.texts, *axes.texts) if text.get_text()]
                    boxes = [text.get_window_extent() for text in texts]
                    for i, box in enumerate(boxes):
                        overlapping = [texts[i + 1 + k].get_text() for k, other in enumerate(boxes[i + 1:])
                                       if box.overlaps(other)]
                        self.assertEqual(overlapping, [], texts[i].get_text())
                        self.assertTrue(0 <= box.x0 and box.x1 <= figure.bbox.width and 0 <= box.y0, texts[i])
                    for text in filter(lambda text: text.get_text(), axes.texts):
                        for line in axes.lines:
                            path = line.get_transform().transform_path(line.get_path())
                            self.assertFalse(path.intersects_bbox(text.get_window_extent(), filled=False), text)

    @unittest.skipUnless(ezdxf, "needs ezdxf")
    def test_dimensions_read_from_the_dxf_are_those_of_the_optimum(self):
        for name, machine in self.optima.items():
            for units, factor in (("si", 1), ("us", 1 / INCH)):
                with self.subTest(machine=name, units=units):
                    self.write(f"{name}.json", json.dumps(machine.optimum))
                    self.run_script("sheet", f"{name}.json", "--units", units, "-o", "sheet.dxf",
                                    "--overwrite", "--program", PROGRAM)
                    document = ezdxf.readfile(self.path("sheet.dxf"))
                    self.assertEqual(document.audit().errors, [])
                    found = {entity.dxf.text.split()[0]: entity.get_measurement()
                             for entity in document.modelspace().query("DIMENSION")}
                    for length in ("r1", "r2", "r3"):
                        self.assertAlmostEqual(found[length] / factor, machine.optimum[length], places=9)
                    self.assertAlmostEqual(found["axle"] / factor, machine.h0, places=9)
                    self.assertEqual("r4" in found, machine.r4 > 0)
                    pin = machine.value("pin-angle")
                    self.assertAlmostEqual(found["pin"], abs(pin) * 180 / 3.141592653589793, places=3)
                    text = " ".join(entity.text for entity in document.modelspace().query("MTEXT"))
                    self.assertIn(UNITS[units].length(machine.r2), text)

    def test_the_sheet_lists_loads_masses_tolerances_and_warnings(self):
        machine = self.optima["laboratory"]
        tables = sheet.texts(machine, UNITS["si"])
        rows = {row[0]: row[1:] for table in tables.values() for row in table}
        self.assertEqual(rows["throwing arm r2"][0], "0.975 m")
        self.assertRegex(rows["throwing arm r2"][1], r"^-\d+ mm / (\+\d+ mm|any)$")
        self.assertRegex(rows["pin, from the arm's line"][0], r"^\d+\.\d deg \(0\.\d{3} rad\)$")
        self.assertEqual(rows["range"][0], "42.8 m")
        self.assertEqual(rows["counterweight"][0], "53.9 kg")
        self.assertEqual(rows["beam"][0], "4.86 kg, measured")
        figure = sheet.draw_page(machine, "laboratory", UNITS["si"], "a4")
        self.addCleanup(plt.close, figure)
        warnings = [text.get_text() for text in figure.texts if text.get_text().startswith("Warning: ")]
        self.assertEqual(warnings, [f"Warning: {text}" for text in machine.optimum["warnings"]])

    def test_a_sheet_is_a_page_in_every_format_and_other_files_are_refused(self):
        self.write("lab.json", json.dumps(self.optima["laboratory"].optimum))
        for paper, size in (("a4", (842, 595)), ("letter", (792, 612))):
            self.run_script("sheet", "lab.json", "--paper", paper, "-o", f"{paper}.pdf", "--program", PROGRAM)
            box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", self.read(f"{paper}.pdf"))
            self.assertEqual(tuple(round(float(length)) for length in box.groups()), size)
        self.run_script("sheet", "lab.json", "-o", "sheet.svg", "--program", PROGRAM)
        self.assert_picture("sheet.svg")
        self.run_script("sheet", "lab.json", "-o", "sheet.xyz", code=2, says="output = sheet.xyz: must end")
        self.run_script("sheet", "none.json", code=1, says="none.json: no such file")
        self.write("bad.json", "{\"speed\": 1}")
        self.run_script("sheet", "bad.json", code=1, says="bad.json: is not an optimum")
        self.write("empty.json", "")
        self.run_script("sheet", "empty.json", code=1, says="empty.json: is empty; did trebsweep")

    def test_limits_are_in_the_units_of_the_sheet(self):
        optimum = {"units": {"counterweight-mass": "kg"},
                   "constraint_units": {"peak-axle-load": "N", "efficiency": "1", "speed": "m s-1", "r1 / r2": "",
                                        "2*r1": "m"}}
        for text, si, us in (("r1 + r2 <= 2.4384", "r1 + r2 <= 2.438 m", "r1 + r2 <= 8 ft 0 in"),
                             ("r2 >= 0.0254", "r2 >= 0.025 m", "r2 >= 1.00 in"),
                             ("2*r1 <= 1.2192", "2*r1 <= 1.219 m", "2*r1 <= 4 ft 0 in"),
                             ("peak-axle-load <= 2668.93297", "peak-axle-load <= 2669 N", "peak-axle-load <= 600 lbf"),
                             ("efficiency >= 0.7", "efficiency >= 0.7", "efficiency >= 0.7"),
                             ("speed >= 44.704", "speed >= 44.7 m/s", "speed >= 100.0 mph"),
                             ("counterweight-mass <= 45.359237", "counterweight-mass <= 45.4 kg",
                              "counterweight-mass <= 100 lb"), ("r1 <= h0 - r4",) * 3,
                             ("r1 / r2 <= 0.25", "r1 / r2 <= 0.25", "r1 / r2 <= 0.25"), ("no release",) * 3):
            self.assertEqual([sheet.limit_text(optimum, text, UNITS[name]) for name in ("si", "us")], [si, us])

    def test_feet_and_inches_are_exact_to_a_sixteenth(self):
        for metres, text in ((0.3048, "1 ft 0 in"), (INCH / 2, "0.50 in"), (5 * INCH + INCH * 3 / 8, "5 3/8 in"),
                             (0.88392, "2 ft 10 13/16 in"), (12 * INCH - INCH / 64, "1 ft 0 in"), (0, "0.00 in")):
            self.assertEqual(feet_and_inches(metres), text)

    def test_the_angle_of_the_pin_is_drawn_from_the_arms_line_to_the_sling(self):
        for name, machine in self.optima.items():
            with self.subTest(machine=name):
                _, _, tip, projectile = machine.points(-1)
                arm, sling = (complex(*vector) / np.hypot(*vector) for vector in (tip, projectile - tip))
                (angle,) = design_drawing.release_dimensions(machine, UNITS["si"])
                sides = np.exp(1j * np.array([angle.first, angle.last]))
                np.testing.assert_allclose(sides, [arm, sling] if machine.value("pin-angle") > 0 else [sling, arm],
                                           atol=1e-4)

    def test_the_panels_do_not_overlap(self):
        machine = self.optima["laboratory"]
        start, release = design_drawing.panels(machine, UNITS["si"])
        for aspect in (0.4, 1, 3):
            shapes = design_drawing.arranged(start, release, aspect)
            (low, high), (other_low, other_high) = map(drawing.bounds, (shapes[:len(start)], shapes[len(start):]))
            self.assertTrue((high < other_low).any() or (other_high < low).any())


if __name__ == "__main__":
    unittest.main()
