"""Quantities as text, in SI or in customary units."""

import numpy as np

INCH, POUND, POUND_FORCE = 0.0254, 0.45359237, 4.4482216152605  # m, kg, N: exact


def feet_and_inches(metres):
    """A length in feet and inches, to the nearest sixteenth; a short one in decimals of an inch."""
    if metres < 3 * INCH:
        return f"{metres / INCH:.2f} in"
    feet, sixteenths = divmod(round(metres / INCH * 16), 12 * 16)
    inches, sixteenths = divmod(sixteenths, 16)
    shift = (sixteenths & -sixteenths) or 16
    fraction = f" {sixteenths // shift}/{16 // shift}" if sixteenths else ""
    return (f"{feet} ft " if feet else "") + f"{inches}{fraction} in"


def with_unit(factor, unit, digits):
    """A function that writes a number of SI units in another unit, to some significant digits."""
    def text(number):
        shown = 0 if abs(number) < 1e-6 else number / factor  # rounding errors
        decimals = max(0, digits - 1 - int(np.floor(np.log10(abs(shown))))) if shown else 0
        return f"{shown:.{decimals}f} {unit}"
    return text


def degrees(angle):
    """An angle in degrees."""
    return f"{np.degrees(angle):.1f} deg"


def both(angle):
    """An angle in degrees and radians."""
    return f"{np.degrees(angle):.1f} deg ({angle:.3f} rad)"


class Units:
    """Functions that write a number of SI units as text."""

    degrees = staticmethod(degrees)
    angle = staticmethod(both)

    def __init__(self, **functions):
        self.__dict__.update(functions)

    def quantity(self, number, unit):
        """A number with a unit of the SI as text, in that of the sheet if it has one for it."""
        tell = {"m": self.length, "N": self.force, "Pa": self.stress, "m s-1": self.speed, "kg": self.mass,
                "rad": self.degrees}.get(unit)
        return tell(number) if tell else f"{number:.6g} {unit if unit != '1' else ''}".rstrip()


UNITS = {
    "si": Units(length=lambda x: f"{x:.3f} m", small=lambda x: f"{1000 * x:.0f} mm",
                distance=lambda x: f"{x:.1f} m", mass=with_unit(1, "kg", 3), force=with_unit(1, "N", 3),
                stress=with_unit(1e6, "MPa", 3), speed=lambda x: f"{x:.1f} m/s",
                dxf_factor=1, dxf_code=6),
    "us": Units(length=feet_and_inches, small=lambda x: f"{x / INCH:.2f} in",
                distance=lambda x: f"{x / (12 * INCH):.0f} ft", mass=with_unit(POUND, "lb", 3),
                force=with_unit(POUND_FORCE, "lbf", 3), stress=with_unit(POUND_FORCE / INCH**2, "psi", 3),
                speed=lambda x: f"{x / (5280 * 12 * INCH / 3600):.1f} mph",
                dxf_factor=1 / INCH, dxf_code=1),
}
